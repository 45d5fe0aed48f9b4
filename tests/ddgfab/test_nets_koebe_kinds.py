"""The kinds "koebe" and "minimal": parameters, choices, files, edge offsets, circles as curves."""

from __future__ import annotations

import csv
import warnings
from pathlib import Path

import numpy as np
import pytest

from ddgfab.circles import Circles
from ddgfab.errors import DegenerateError, InputError, MeshError, SupportError
from ddgfab.forms.koebe import SHAPES
from ddgfab.forms.minimal import SURFACES
from ddgfab.forms.registry import ParameterError, find_generator, generate
from ddgfab.io import write_obj
from ddgfab.io.cells import read_cells
from ddgfab.io.circles import COLUMNS, write_circles
from ddgfab.measures import planarity
from ddgfab.mesh import Mesh
from ddgfab.nets import SIsothermic
from ddgfab.nets.koebe import koebe
from ddgfab.nets.koebe.grids import enneper_koebe
from ddgfab.nets.koebe.solids import cube_cells, pillow
from ddgfab.nets.minimal import minimal_surface
from ddgfab.offsets import classify_offset, edge_offset
from ddgfab.support import beam_heights, edge_axes, support_structure

PLANE = [s for s in SURFACES if s not in ("helicoid", "schwarz_d", "file")]
DEPTH = 120.0


def edge_offset_is_exact(mesh: Mesh) -> None:
    """Beams 120 mm high: lower edges of the parallel mesh at one distance, on the node axes."""
    structure = support_structure(mesh, "edge")
    assert structure.torsion_deg_max < 1e-9
    assert structure.beam_height_spread is not None
    assert structure.beam_height_spread < 1e-9
    moved = edge_offset(mesh, -DEPTH)
    report = classify_offset(mesh, moved)
    assert report.is_parallel
    assert report.spread["edge"] < 1e-9  # mm
    assert report.distance["edge"] == pytest.approx(DEPTH)
    shift = moved.vertices - mesh.vertices
    aside = np.linalg.norm(np.cross(shift, structure.axes), axis=1)
    assert aside[mesh.valences > 0].max() < 1e-9
    assert planarity(mesh).max() < 1e-11 * mesh.diameter


@pytest.mark.parametrize("shape", [*SHAPES])
def test_balls(shape: str) -> None:
    mesh = generate("koebe", {"shape": shape, "radius_mm": 5000.0})
    assert not len(mesh.boundary_loops)
    assert mesh.vertices[:, 2].min() == pytest.approx(0.0, abs=1e-9)
    edge_offset_is_exact(mesh)
    # Node axes run through the center of the sphere that all edges touch.
    axes = edge_axes(mesh)
    lengths = beam_heights(mesh, axes)
    assert np.abs(lengths - 1).max() < 1e-11
    center = np.linalg.lstsq(
        (np.eye(3) - np.einsum("vi,vj->vij", axes, axes)).reshape(-1, 3),
        (mesh.vertices - axes * np.einsum("vx,vx->v", axes, mesh.vertices)[:, None]).ravel(),
        rcond=None,
    )[0]
    start = mesh.vertices[mesh.edges[:, 0]] - center
    along = mesh.edge_vectors / mesh.edge_lengths[:, None]
    away = np.linalg.norm(np.cross(start, along), axis=1)
    assert np.abs(away - 5000).max() < 1e-8


def test_domes_are_balls_cut_off() -> None:
    whole = generate("koebe", {"shape": "cube", "cells": 8})
    dome = generate("koebe", {"shape": "cube", "cells": 8, "base": 0.2})
    assert 0 < dome.n_faces < whole.n_faces
    assert len(dome.boundary_loops) == 1
    edge_offset_is_exact(dome)


@pytest.mark.parametrize("surface", PLANE)
def test_minimal_surfaces(surface: str) -> None:
    mesh = generate("minimal", {"surface": surface, "cells": 5, "panel_mm": 1200.0})
    assert np.median(mesh.edge_lengths) == pytest.approx(1200)
    assert mesh.vertices[:, 2].min() == pytest.approx(0.0, abs=1e-9)
    assert mesh.vector_areas[:, 2].sum() >= -1e-6
    edge_offset_is_exact(mesh)
    assert find_generator("minimal").support == "edge"


@pytest.mark.parametrize("surface", ["helicoid", "schwarz_d"])
def test_conjugate_surfaces_have_skew_panels_and_no_edge_offset(surface: str) -> None:
    mesh = generate("minimal", {"surface": surface})
    assert planarity(mesh).max() > 1.0
    with pytest.raises(SupportError, match="from planar"):
        support_structure(mesh, "edge")


def test_auto_leans_no_more_than_beams_of_one_height() -> None:
    """Beams of one height are chosen by the kind of net; "auto" only minimizes
    the lean. Both structures are exact."""
    mesh = generate("minimal", {"surface": "enneper"})
    auto, edge = support_structure(mesh), support_structure(mesh, "edge")
    assert auto.torsion_free
    assert edge.torsion_free
    assert auto.lean_deg_mean < edge.lean_deg_mean
    assert edge.beam_height_spread is not None
    assert edge.beam_height_spread < 1e-9
    assert support_structure(generate("translation")).kind == "offset"


def test_edge_axes_of_other_nets_are_refused_with_the_edge() -> None:
    with pytest.raises(SupportError, match=r"parallel to a Koebe net: .*\(edge \d+\)"):
        support_structure(generate("translation"), "edge")
    ball = generate("koebe", {"shape": "icosahedron", "cells": 2})  # triangles: through the center
    assert support_structure(ball, "edge").torsion_free


def test_heights_of_beams_differ_on_a_vertex_offset() -> None:
    """mathematics.md 11a: with a circular vertex offset only the distances of vertices are
    constant."""
    mesh = generate("circular")
    spread = support_structure(mesh, "normal").beam_height_spread
    assert spread is not None
    assert spread > 1e-4
    heights = beam_heights(mesh, support_structure(mesh, "normal").axes)
    assert np.abs(heights[:, 0] - heights[:, 1]).max() < 1e-10  # the lower edges are parallel
    assert heights.mean() == pytest.approx(1)
    flat = Mesh.build([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    with pytest.raises(DegenerateError, match="axis of vertex 0 runs along edge 0"):
        beam_heights(flat, np.tile([1.0, 0.0, 0.0], (3, 1)))


@pytest.mark.parametrize(
    ("kind", "values", "words"),
    [
        ("minimal", {"surface": "catenoit"}, "surface = .catenoit. is unknown; did you mean cat"),
        ("minimal", {"surface": 3}, "surface = 3 must be a text in quotes"),
        ("minimal", {"surface": "scherk", "cells": 2}, "scherk needs 3 or more"),
        ("minimal", {"surface": "schwarz_p_cell", "cells": 1}, "needs 2 or more"),
        ("minimal", {"surface": "file"}, "go together"),
        ("minimal", {"polyhedron_file": "x.obj"}, "go together"),
        ("minimal", {"rings_below": 0, "rings_above": 0}, "one is needed"),
        ("minimal", {"panel_mm": 0}, "0.001 or more"),
        ("koebe", {"shape": "cub"}, "did you mean cube"),
        ("koebe", {"shape": "prism", "cells": 2}, "3 sides or more"),
        ("koebe", {"shape": "file"}, "go together"),
        ("koebe", {"shape": "prism", "cells": 3, "base": 0.95}, "leaves no panel"),
        ("minimal", {"surface": "file", "polyhedron_file": "none.obj"}, "no such file"),
    ],
)
def test_mistakes(kind: str, values: dict[str, object], words: str) -> None:
    with pytest.raises((ParameterError, MeshError), match=words):
        generate(kind, values)


@pytest.mark.parametrize("kind", ["koebe", "minimal"])
def test_any_parameters_give_an_exact_net_or_an_error(kind: str) -> None:
    rng = np.random.default_rng(8)
    made = 0
    for _ in range(30):
        values: dict[str, object] = {}
        for p in find_generator(kind).parameters:
            if p.choices:
                values[p.name] = str(rng.choice([c for c in p.choices if c != "file"]))
            elif p.type is int:
                values[p.name] = int(rng.integers(p.low, min(p.high, 9) + 1))
            elif p.type is float:
                low, high = max(p.low, 0.0), min(p.high, 30000.0)
                values[p.name] = float(rng.choice([low, high, p.default, p.default]))
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            try:
                mesh = generate(kind, values)
            except (DegenerateError, InputError):
                continue
        assert np.isfinite(mesh.vertices).all()
        if values.get("surface") not in ("helicoid", "schwarz_d"):
            assert planarity(mesh).max() < 1e-10 * mesh.diameter
        made += 1
    assert made > 10


def test_files_are_found_beside_the_project(tmp_path: Path) -> None:
    write_obj(tmp_path / "p.obj", pillow(5))
    given = {"shape": "file", "polyhedron_file": "p.obj"}
    mesh = generate("koebe", given, tmp_path)
    assert mesh.n_faces == pillow(5).n_faces
    edge_offset_is_exact(mesh)
    cells = read_cells(tmp_path / "p.obj")
    assert cells.groups == {}
    with pytest.raises(MeshError, match="marked in the file: none"):
        cells.group("piece")
    bad = tmp_path / "bad.obj"
    bad.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\n")
    with pytest.raises(MeshError, match=r"bad\.obj: faces 0 and 1 run the same way"):
        read_cells(bad)


# --- circles and spheres as curves -------------------------------------------------------------
def test_circles_of_a_koebe_net_from_its_mesh_alone() -> None:
    solid = koebe(cube_cells(4))
    curves = SIsothermic.of(solid.mesh.scaled(3000.0)).curves()
    assert list(curves) == ["incircle", "vertex-circle", "sphere"]
    for name, own in (("incircle", solid.face_circles), ("vertex-circle", solid.vertex_circles)):
        found, wanted = curves[name], own.scaled(3000.0)
        assert isinstance(found, Circles)
        assert np.abs(found.centers - wanted.centers).max() < 1e-8
        assert np.abs(found.radii - wanted.radii).max() < 1e-8
        assert np.abs(found.normals - wanted.normals).max() < 1e-8
    assert np.abs(curves["sphere"].radii - 3000 * solid.radii).max() < 1e-8
    dual = minimal_surface(enneper_koebe((4, 4), 0.1))
    assert list(SIsothermic.of(dual.mesh).curves()) == ["incircle", "sphere"]


def test_circles_are_written_and_read_again(tmp_path: Path) -> None:
    net = minimal_surface(enneper_koebe((3, 4), 0.1), scale=40.0)
    curves = SIsothermic.of(net.mesh).curves()
    write_circles(tmp_path / "c.csv", curves)
    with (tmp_path / "c.csv").open() as stream:
        rows = list(csv.DictReader(stream))
    assert tuple(rows[0]) == COLUMNS
    assert len(rows) == 12 + 20
    spheres = [row for row in rows if row["kind"] == "sphere"]
    assert [float(row["radius_mm"]) for row in spheres] == pytest.approx(net.radii.tolist())
    assert float(spheres[7]["y_mm"]) == net.mesh.vertices[7, 1]
    write_circles(tmp_path / "c.obj", curves, points=24)
    text = (tmp_path / "c.obj").read_text().split("\n")
    points = np.array([line.split()[1:] for line in text if line.startswith("v ")], dtype=float)
    lines = [[int(k) for k in line.split()[1:]] for line in text if line.startswith("l ")]
    assert len(lines) == 12 + 3 * 20
    assert all(line[0] == line[-1] and len(line) == 25 for line in lines)
    circles = net.circles
    for k in (0, 5, 11):
        arm = points[np.array(lines[k]) - 1] - circles.centers[k]
        assert np.abs(np.linalg.norm(arm, axis=1) - circles.radii[k]).max() < 1e-12
        assert np.abs(arm @ circles.normals[k]).max() < 1e-12
    with pytest.raises(InputError, match=r"as \.csv or \.obj, not as '\.txt'"):
        write_circles(tmp_path / "c.txt", curves)
    with pytest.raises(InputError, match="3 or more"):
        circles.points(2)
