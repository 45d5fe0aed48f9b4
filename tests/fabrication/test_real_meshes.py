"""The meshes that the main job must master, made by others; scaled to a median edge of 1.5 m."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner, Result

from ddgfab.io import read_mesh, write_obj
from ddgfab.mesh import Mesh
from fabrication import design
from fabrication.cli import app
from fabrication.specs import rejected

pytestmark = pytest.mark.slow
MeshFile = Callable[[str], Path]
SCALED = ("--set", "project.median_edge_mm=1500")


def make(mesh: Path, folder: Path, *words: str) -> Result:
    """`ddgfab make` with the cheap checks."""
    options = ["make", str(mesh), "-o", str(folder), "--verify", "none", *SCALED, *words]
    return CliRunner().invoke(app, options)


def manifest_of(folder: Path) -> dict:
    return json.loads((folder / "manifest.json").read_text("utf-8"))


def test_conical_net_keeps_its_limits(mesh_file: MeshFile, tmp_path: Path) -> None:
    """4,453 parts; the benchmark makes them all and reads every file back."""
    plan = design(mesh_file("conical1.obj"), project={"median_edge_mm": 1500})
    assert len(plan.gridshell.pieces) == 1147 + 2226 + 1080
    assert not rejected(plan.gridshell.pieces)
    assert plan.support.torsion_deg_max < 1e-6
    assert plan.support.lean_deg_max < 3.0


def test_patch_of_a_conical_net_with_every_file_read_back(
    mesh_file: MeshFile, tmp_path: Path
) -> None:
    mesh = read_mesh(mesh_file("conical1.obj")).mesh
    away = np.linalg.norm(mesh.face_centers - mesh.face_centers[0], axis=1)
    faces = [mesh.faces[f] for f in np.argsort(away, kind="stable")[:48].tolist()]
    used = sorted({v for face in faces for v in face})
    place = {v: k for k, v in enumerate(used)}
    patch = Mesh.build(mesh.vertices[used], [[place[v] for v in face] for face in faces])
    write_obj(tmp_path / "patch.obj", patch)
    result = make(tmp_path / "patch.obj", tmp_path / "out", "--verify", "all")
    assert result.exit_code == 0, result.output
    manifest = manifest_of(tmp_path / "out")
    assert len(manifest["parts"]) == patch.n_vertices + len(patch.edges) + 48
    assert manifest["checks"]["failed"] == 0


def test_planarised_mesh(mesh_file: MeshFile, tmp_path: Path) -> None:
    result = make(mesh_file("six_quad.obj"), tmp_path / "out", "--formats", "step,csv")
    assert result.exit_code == 0, result.output
    assert manifest_of(tmp_path / "out")["support"]["lean_deg_max"] < 9.9


def test_dome_with_bent_faces(mesh_file: MeshFile, tmp_path: Path) -> None:
    """1.4 % from planar: refused as panels, fine without them."""
    bent = make(mesh_file("quad_dome.obj"), tmp_path / "bent", "--anyway")
    assert bent.exit_code == 1
    assert re.search(r"FAILED planarity: 48 panels \(limit 0.2 %\): P-\d{4} 1.4\d* %", bent.output)
    assert list((tmp_path / "bent" / "rejected" / "step").glob("PP-*.step"))
    assert not list((tmp_path / "bent" / "parts" / "step").glob("PP-*.step"))
    bare = make(mesh_file("quad_dome.obj"), tmp_path / "bare", "--set", "panel.kind=none")
    assert bare.exit_code == 0, bare.output
    assert manifest_of(tmp_path / "bare")["support"]["lean_deg_max"] < 1.5


LEANS = {"botanic_garden_bubble": (34.6, 10.8), "heart": (66.0, 33.0)}
"""Greatest and mean [deg] of an independent study (33.9 / 10.5, 64.7 / 32), 2 % over."""


@pytest.mark.parametrize("name", LEANS)
def test_skew_faces_have_torsion_free_axes_that_lean(name: str, mesh_file: MeshFile) -> None:
    plan = design(mesh_file(f"{name}.obj"), project={"median_edge_mm": 1500})
    assert plan.support.torsion_deg_max < 1e-6
    greatest, mean = LEANS[name]
    assert 30.0 < plan.support.lean_deg_max < greatest
    assert plan.support.lean_deg_mean < mean
    failed = {c.name for p in plan.gridshell.pieces for c in p.checks if not c.passed}
    assert {"lean_deg", "planarity_percent"} <= failed


def test_skew_faces_get_torsion_free_beams_and_nodes(mesh_file: MeshFile, tmp_path: Path) -> None:
    result = make(mesh_file("heart.obj"), tmp_path / "out", "--formats", "csv", "--anyway")
    assert result.exit_code == 1, result.output
    assert "FAILED lean:" in result.output
    assert "FAILED planarity:" in result.output
    assert re.search(r"P-\d{4} .*mm from its plane", result.output)
    support = manifest_of(tmp_path / "out")["support"]
    assert support["torsion_deg_max"] < 1e-6
    assert 30.0 < support["lean_deg_max"] < LEANS["heart"][0]
    assert support["lean_deg_mean"] < LEANS["heart"][1]


@pytest.mark.parametrize(
    ("name", "torsion"), [("knet1", "6.52 deg"), ("helical_minimal", "8.30 deg")]
)
def test_nets_along_asymptotic_lines_are_refused(
    name: str, torsion: str, mesh_file: MeshFile, tmp_path: Path
) -> None:
    result = make(mesh_file(f"{name}.obj"), tmp_path / "out")
    assert result.exit_code == 2
    assert "no upright torsion-free node axes" in result.output
    assert torsion in result.output
    assert not (tmp_path / "out").exists()


def test_triangles_are_offered_the_central_structure(mesh_file: MeshFile, tmp_path: Path) -> None:
    result = make(mesh_file("tri_dome.obj"), tmp_path / "out")
    assert result.exit_code == 2
    assert "Prop. 5.2" in result.output
    assert 'kind = "central"' in result.output
    central = make(
        mesh_file("tri_dome.obj"),
        tmp_path / "out",
        *("--formats", "csv", "--set", "support.kind=central", "--set", "panel.kind=none"),
    )
    assert central.exit_code in (0, 1), central.output
    assert manifest_of(tmp_path / "out")["support"]["torsion_deg_max"] < 1e-6


@pytest.mark.parametrize(
    ("name", "edge_mm", "optimize", "lean"),
    [
        ("botanic_garden_bubble", 950, ["goal=conical", "keep=close", "boundary=glide"], 18.0),
        ("heart", 1200, ["goal=torsion-free", "max_lean_deg=25"], 25.0),
    ],
)
def test_optimised_designs_are_buildable(
    mesh_file: MeshFile,
    tmp_path: Path,
    name: str,
    edge_mm: int,
    optimize: list[str],
    lean: float,
) -> None:
    """As they are these end with leaning axes and skew panels; with [optimize] all passes."""
    words = [f"--set=optimize.{word}" for word in optimize]
    words += [f"--set=project.median_edge_mm={edge_mm}", "--formats", "csv"]
    result = make(mesh_file(f"{name}.obj"), tmp_path / "out", *words)
    assert result.exit_code == 0, result.output
    manifest = manifest_of(tmp_path / "out")
    assert manifest["checks"]["failed"] == 0
    assert manifest["support"]["torsion_deg_max"] < 1e-6
    assert manifest["support"]["lean_deg_max"] < lean
    assert manifest["net"]["measures"]["planarity_percent"]["greatest"] < 1e-7
    assert manifest["optimize"]["movement_max"] > 0
    assert (tmp_path / "out" / "optimized.png").exists() or manifest["notes"]
