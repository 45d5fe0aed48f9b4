"""A new term and a new goal, defined here alone: what a goal has to say, and what it gets."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from optimize_meshes import dome

from ddgfab.errors import InputError, OptimizeError
from ddgfab.measures import planarity_percent
from ddgfab.mesh import Floats, Mesh, unit
from ddgfab.optimize import Additions, NetGoal, OptimizeResult, Term, goals, mean_edge, optimize
from ddgfab.optimize.problem import VERTICES, Layout
from ddgfab.optimize.report import comparison
from ddgfab.optimize.terms import LocalTerm, planarity_terms


@dataclass(frozen=True, eq=False, kw_only=True)
class DiagonalDifferences(LocalTerm):
    """|c - a| - size and |d - b| - size of quads a, b, c, d with sizes that are unknown as well."""

    def values(self, local: Floats) -> Floats:
        """(m,) residuals."""
        return np.asarray(np.linalg.norm(local[:, 3:6] - local[:, :3], axis=1) - local[:, 6])

    def gradients(self, local: Floats) -> Floats:
        """(m, 7)."""
        way = unit(local[:, 3:6] - local[:, :3])
        return np.concatenate([-way, way, np.full((len(way), 1), -1.0)], axis=1)


def equal_diagonals(mesh: Mesh, layout: Layout) -> tuple[Term, ...]:
    quads = mesh.corners.reshape(-1, 4)
    sizes = layout.index("sizes", np.arange(mesh.n_faces))
    index = [
        np.concatenate([layout.index(VERTICES, quads[:, [k, k + 2]]).reshape(-1, 6), sizes], axis=1)
        for k in (0, 1)
    ]
    return (
        DiagonalDifferences(
            name="equal diagonals",
            index=np.concatenate(index),
            hard=True,
            of="face",
            elements=np.tile(np.arange(mesh.n_faces), 2),
        ),
    )


def diagonals(mesh: Mesh) -> Floats:
    """(F, 2) lengths."""
    points = mesh.vertices[mesh.corners.reshape(-1, 4)]
    return np.linalg.norm(points[:, [2, 3]] - points[:, [0, 1]], axis=2)


def sizes(mesh: Mesh) -> dict[str, Floats]:
    return {"sizes": diagonals(mesh).mean(axis=1, keepdims=True)}


GOAL = NetGoal(
    "equal diagonals",
    lambda m, layout: (*planarity_terms(m), *equal_diagonals(m, layout)),
    0.0,
    "this test",
    blocks=sizes,
    own=lambda problem, x: {"remarks": (f"{len(problem.layout.values(x, 'sizes'))} sizes",)},
)


SMALL: dict[str, Any] = {"zigzag_limit": 1.0, "rise_limit": 0.0}
"""Four by four quads crumple before they count as a surface."""


def check(result: OptimizeResult) -> None:
    found = diagonals(result.mesh)
    edge = mean_edge(result.original)
    assert np.ptp(found, axis=1).max() < 1e-8 * edge
    assert np.ptp(diagonals(result.original), axis=1).max() > 0.1 * edge
    assert planarity_percent(result.mesh).max() < 1e-8
    assert result.change.distance_mean < 0.25 * edge
    assert not len(result.change.folded)
    assert comparison(result)["goal"] == "equal diagonals"
    assert result.prices


def sheared() -> Mesh:
    """A dome over rhombs."""
    mesh = dome(4)
    return mesh.with_vertices(mesh.vertices @ np.array([[1, 0, 0], [0.1, 1, 0], [0, 0, 1.0]]))


def test_a_goal_of_ones_own() -> None:
    check(optimize(sheared(), GOAL, **SMALL))


def test_a_line_in_the_table_gives_it_a_name(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(InputError, match="one of planar, circular, conical, torsion-free"):
        optimize(sheared(), "equal diagonals")  # type: ignore[arg-type]
    monkeypatch.setitem(goals.GOALS, "equal diagonals", lambda: [GOAL])
    check(optimize(sheared(), "equal diagonals", **SMALL))  # type: ignore[arg-type]
    with pytest.raises(OptimizeError, match="distance from the surface"):
        optimize(sheared(), "equal diagonals", distance_limit=(1e-6, 1e-6))  # type: ignore[arg-type]


def test_additions_of_a_goal_are_in_the_energy() -> None:
    """Faces planar and, as a soft term alone, diagonals equal: nearer to equal than without."""

    def softly(mesh: Mesh, layout: Layout) -> Additions:
        (term,) = equal_diagonals(mesh, layout)
        assert isinstance(term, DiagonalDifferences)
        soft: Any = DiagonalDifferences(name="soft", index=term.index, weight=10.0)
        return Additions((soft,))

    plain, softened = (
        NetGoal("planar", lambda m, _: planarity_terms(m), 0.0, "", blocks=sizes, **more)
        for more in ({}, {"additions": softly})
    )
    found = [optimize(sheared(), goal, **SMALL).mesh for goal in (plain, softened)]
    uneven = [np.ptp(diagonals(mesh), axis=1).mean() for mesh in found]
    assert uneven[1] < 0.5 * uneven[0]
