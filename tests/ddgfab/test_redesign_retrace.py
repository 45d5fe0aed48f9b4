"""Nets that run the wrong way: what is advised, and the net traced anew."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from surface_cases import graph

from ddgfab.errors import DegenerateError
from ddgfab.grid import grid_mesh
from ddgfab.io import read_mesh
from ddgfab.measures import planarity_percent
from ddgfab.mesh import Mesh
from ddgfab.optimize import optimize
from ddgfab.redesign.advice import advise
from ddgfab.redesign.retrace import retrace
from ddgfab.surfaces.nearest import nearest_points
from ddgfab.trace import PrincipalField, network_mesh, place
from ddgfab.trace.reference import reference_mesh

HEART = Path(__file__).resolve().parents[3] / "shared" / "data" / "meshes" / "heart.obj"


def saddle(turn: float, count: int = 16) -> Mesh:
    """A plan lattice on a saddle, turned from its curvature lines [rad]."""
    along = np.linspace(-1, 1, count + 1)
    u, v = np.meshgrid(along, along, indexing="ij")
    x, y = np.cos(turn) * u - np.sin(turn) * v, np.sin(turn) * u + np.cos(turn) * v
    return grid_mesh(np.stack([x, y, 0.35 * x**2 - 0.25 * y**2 + 0.03 * x**3], axis=-1))


@pytest.fixture(scope="module")
def turned() -> Mesh:
    return saddle(np.radians(35))


def test_advice_follows_the_edges(turned: Mesh) -> None:
    found = advise(turned)
    assert found is not None
    assert found.way == "diagonals"  # 10 deg off: their movement is harmless
    assert "ddgfab optimize roof.obj --diagonals" in found.lines("roof.obj")[-1][1]
    between = advise(saddle(np.radians(22)))
    assert between is not None
    assert between.way == "retrace"
    assert "ddgfab optimize roof.obj --retrace" in between.lines("roof.obj")[-1][1]
    straight = advise(saddle(np.radians(2)))
    assert straight is not None
    assert straight.way == "optimize"
    planar = advise(grid_mesh(np.moveaxis(np.mgrid[0:9, 0:9, 0:1], 0, -1)[:, :, 0].astype(float)))
    assert planar is not None
    assert planar.way == "none"
    triangles = [t for a, b, c, d in turned.faces for t in ((a, b, c), (a, c, d))]
    assert advise(Mesh.build(turned.vertices, triangles)) is None


def test_a_retraced_net_is_planar_near_the_surface(turned: Mesh) -> None:
    found = retrace(turned)
    edge = float(np.median(turned.edge_lengths))
    assert found.spacing == edge
    inner = found.traced.traced.inner_faces
    assert planarity_percent(found.mesh)[inner].mean() < 0.1 * planarity_percent(turned).mean()
    result = optimize(found.mesh, keep="close", surface=found.reference, rim=found.reference)
    far = nearest_points(found.fitted.surface, result.mesh.vertices).distance
    assert far.max() < 0.15 * edge
    x, y, z = result.mesh.vertices.T
    assert np.abs(z - 0.35 * x**2 + 0.25 * y**2 - 0.03 * x**3).max() < 0.2 * edge
    assert "retraced on a smooth surface" in found.notes()[0]


def test_reference_refines_the_net_and_ends_on_the_trim() -> None:
    angle = np.linspace(0, 2 * np.pi, 97)[:-1]
    circle = 0.9 * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    surface = graph(lambda x, y: 0.3 * x**2 - 0.2 * y**2, trim=[circle])
    traced = network_mesh(place(PrincipalField(surface), (0.25, 0.25)))
    fine = reference_mesh(surface, traced)
    assert fine.n_faces == 4 * int(traced.mesh.face_sizes.sum())
    assert nearest_points(surface, fine.vertices).distance.max() < 1e-12
    rim = fine.vertices[fine.boundary_vertex]
    off = np.abs(np.hypot(rim[:, 0], rim[:, 1]) - 0.9)
    assert off.max() < 1e-3  # the trim is a polygon of 96 sides
    coarse = traced.mesh.vertices[traced.mesh.edges[traced.mesh.boundary_edge]].mean(axis=1)
    assert np.abs(np.hypot(coarse[:, 0], coarse[:, 1]) - 0.9).max() > 5e-3


def test_rim_stays_on_the_trimming_curve() -> None:
    angle = np.linspace(0, 2 * np.pi, 97)[:-1]
    circle = 0.9 * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    surface = graph(lambda x, y: 0.3 * x**2 - 0.2 * y**2, trim=[circle])
    traced = network_mesh(place(PrincipalField(surface), (0.25, 0.25)))
    fine = reference_mesh(surface, traced)
    result = optimize(
        traced.mesh, flat=0.01, boundary="glide", surface=fine, rim=fine, keep="close"
    )
    rim = result.mesh.vertices[result.mesh.boundary_vertex]
    assert np.abs(np.hypot(rim[:, 0], rim[:, 1]) - 0.9).max() < 4e-3


def test_meshes_without_a_net_say_why() -> None:
    along = np.linspace(-1, 1, 17)
    x, y = np.meshgrid(along, along, indexing="ij")
    sphere = grid_mesh(np.stack([x, y, np.sqrt(9 - x**2 - y**2)], axis=-1))
    with pytest.raises(DegenerateError, match="directions are not determined on"):
        retrace(sphere)


@pytest.mark.slow
@pytest.mark.skipif(not HEART.exists(), reason="shared data are not here")
def test_heart_becomes_planar() -> None:
    """12 % from planar; planar near its shape only with other edges."""
    mesh = read_mesh(HEART).mesh
    advice = advise(mesh)
    assert advice is not None
    assert advice.way == "retrace"
    found = retrace(mesh)
    result = optimize(found.mesh, keep="close", surface=found.reference, rim=found.reference)
    assert planarity_percent(result.mesh).max() <= 0.2
    far = nearest_points(found.fitted.surface, result.mesh.vertices).distance
    assert far.mean() < 0.03 * found.spacing
