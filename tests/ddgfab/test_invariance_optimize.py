"""Goals of optimization and node axes go with similarities and with the labels of a mesh."""

from __future__ import annotations

from typing import get_args

import numpy as np
import pytest
from invariance_cases import (
    MESHES,
    NEAR,
    relabelled,
)
from net_cases import koebe_net, planar_net
from optimize_meshes import wavy

from ddgfab.errors import SupportError
from ddgfab.grid import grid_mesh
from ddgfab.mesh import Floats, Mesh
from ddgfab.optimize import Goal, TorsionFreeResult, optimize
from ddgfab.support import SupportKind, support_structure


# --- goals ---------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    "goal", [g for g in get_args(Goal) if g in ("planar", "circular", "conical")]
)
def test_goals_under_similarities(goal: Goal) -> None:
    mesh = wavy(4)
    plain = optimize(mesh, goal, rise_limit=0.5).mesh.vertices
    for at in NEAR:
        found = optimize(at.mesh(mesh), goal, rise_limit=0.5).mesh.vertices
        error = np.abs(found - at(plain)).max() / at.scale
        assert error < max(1e-6, 1e3 * at.rounding), (at.name, error)
    other, vertices, _ = relabelled(mesh)
    found = optimize(other, goal, rise_limit=0.5).mesh.vertices
    assert np.abs(found - plain[vertices]).max() < 1e-6


def bent(m: int = 5, n: int = 4) -> Mesh:
    """A bent grid off the principal directions, without symmetry."""
    i, j = np.meshgrid(np.arange(m + 1.0), np.arange(n + 1.0), indexing="ij")
    x, y = i + 0.15 * j, 1.1 * j - 0.1 * i + 0.01 * i**2
    return grid_mesh(np.stack([x, y, -0.08 * x**2 - 0.05 * y**2 - 0.03 * x * y], axis=-1))


def test_torsion_free_meshes_and_axes_under_similarities() -> None:
    mesh = bent()

    def run(one: Mesh) -> tuple[Floats, Floats]:
        found = optimize(one, "torsion-free", max_lean=np.radians(15.0))
        assert isinstance(found, TorsionFreeResult)
        return found.mesh.vertices, found.axes

    points, axes = run(mesh)
    for at in NEAR:
        moved, turned = run(at.mesh(mesh))
        limit = max(1e-6, 1e4 * at.rounding)
        assert np.abs(moved - at(points)).max() / at.scale < limit, at.name
        assert np.abs(turned - at.vectors(axes, 0)).max() < limit, at.name
    other, vertices, _ = relabelled(mesh)
    moved, turned = run(other)
    assert np.abs(moved - points[vertices]).max() < 1e-6
    assert np.abs(turned - axes[vertices]).max() < 1e-6


# --- node axes -----------------------------------------------------------------------------------
SUPPORTS: dict[str, Mesh] = {
    "normal": MESHES["circular"],
    "axis": MESHES["conical"],
    "offset": grid_mesh(planar_net() / 1000.0),
    "optimize": MESHES["skew"],
    "central": grid_mesh(koebe_net()),
    "normals": MESHES["K-net"],
    "edge": grid_mesh(koebe_net()),
    "auto": MESHES["circular"],
}


@pytest.mark.parametrize("kind", get_args(SupportKind))
def test_node_axes_under_similarities(kind: SupportKind) -> None:
    mesh = SUPPORTS[kind]
    plain = support_structure(mesh, kind).axes
    for at in NEAR:
        found = support_structure(at.mesh(mesh), kind).axes
        error = np.abs(found - at.vectors(plain, 0)).max()
        assert error < max(1e-6, 1e4 * at.rounding), (at.name, error)
    other, vertices, _ = relabelled(mesh)
    assert np.abs(support_structure(other, kind).axes - plain[vertices]).max() < 1e-6


def test_refusals_do_not_depend_on_the_place() -> None:
    for at in NEAR:
        with pytest.raises(SupportError, match="from planar"):
            support_structure(at.mesh(MESHES["skew"]), "normal")
