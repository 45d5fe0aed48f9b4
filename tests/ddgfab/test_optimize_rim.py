"""optimize: the boundary of a mesh moves without bends across itself."""

from __future__ import annotations

import numpy as np
import pytest

from ddgfab.grid import grid_mesh
from ddgfab.mesh import Floats, Mesh
from ddgfab.optimize import optimize
from ddgfab.optimize.terms.shape import fair_rim

FLAT = grid_mesh(
    np.stack([*np.meshgrid(np.arange(6.0), np.arange(4.0), indexing="ij"), np.zeros((6, 4))], -1)
)
SIDE = np.flatnonzero(FLAT.vertices[:, 1] == 0)[1:-1]


def cost(move: Floats) -> float:
    """Of moving the inner vertices of a straight side by (4, 3)."""
    points = FLAT.vertices.copy()
    points[SIDE] += move
    residual = fair_rim(FLAT, 1.0).residual(points.ravel())
    return float(residual @ residual)


def test_it_may_glide_along_itself_and_shift_but_not_become_ragged() -> None:
    assert cost(np.array([[0.1, 0, 0], [-0.2, 0, 0], [0.1, 0, 0], [0.3, 0, 0]])) < 1e-25
    teeth = 0.1 * np.array([[0.0, 1, 0], [0, -1, 0], [0, 1, 0], [0, -1, 0]])
    assert cost(teeth) == pytest.approx(2 * 0.3**2 + 2 * 0.4**2)  # second differences
    assert cost(teeth[:, [0, 2, 1]]) == pytest.approx(cost(teeth))
    shift = np.array([0.3, -2.0, 1.0])
    moved = fair_rim(FLAT, 1.0).residual((FLAT.vertices + shift).ravel())
    assert np.abs(moved).max() < 1e-12
    larger = FLAT.scaled(1e3)
    points = FLAT.vertices.copy()
    points[SIDE] += teeth
    residual = fair_rim(larger, 1.0).residual(1e3 * points.ravel())
    assert residual @ residual == pytest.approx(cost(teeth))


def test_boundaries_stay_smooth_lines() -> None:
    """A saddle off its straight lines: what slides in the surface must not make its rim ragged."""
    u, v = np.meshgrid(np.arange(-8.0, 9.0), np.arange(-6.0, 7.0), indexing="ij")
    x, y = np.cos(0.52) * u - np.sin(0.52) * v, np.sin(0.52) * u + np.cos(0.52) * v
    mesh = grid_mesh(np.stack([u, v, 0.045 * x**2 - 0.06 * y**2], axis=-1))
    result = optimize(mesh, throw=False)  # it is crumpled
    assert np.degrees(turns(result.mesh)).max() < 45  # 93 without `fair_rim`


def turns(mesh: Mesh) -> Floats:
    """(n,) angles [rad] between boundary edges that follow each other, corners left out."""
    (loop,) = mesh.boundary_loops
    ways = np.roll(mesh.vertices[loop], -1, axis=0) - mesh.vertices[loop]
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    cosines = np.einsum("nx,nx->n", ways, np.roll(ways, 1, axis=0))
    return np.asarray(np.arccos(np.clip(cosines, -1, 1))[mesh.valences[loop] > 2])
