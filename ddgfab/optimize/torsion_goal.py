"""Goal torsion-free: planar faces and torsion-free upright node axes, both at once.

On a mesh as it is, torsion-free axes may have to lean far (`ddgfab.support.even_lean`), since edges
turn away from the principal directions. Here the vertices move as well, near the surface, in the
frame of all goals: node axes are further unknowns of length one, equations are the planarity of
faces and det(e, a_i, a_j) of edges, axes are drawn to the vertex normals, and a barrier keeps their
lean below a limit. Vertices slide far in this goal, so the surface's distance from the mesh weighs
more (`ddgfab.optimize.terms.cover`).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from typing import Any, Final

import numpy as np

from ddgfab.errors import DegenerateError, InputError, SupportError
from ddgfab.measures import planarity_percent
from ddgfab.mesh import Floats, Mesh, unit
from ddgfab.optimize.energy import Weights
from ddgfab.optimize.goal import EXACT, Additions, NetGoal
from ddgfab.optimize.problem import Layout, Problem, Term
from ddgfab.optimize.result import WORST, OptimizeResult
from ddgfab.optimize.terms import planarity_terms
from ddgfab.optimize.terms.axes import AXES, AxisLean, axis_torsion, unit_axes
from ddgfab.optimize.within import lean_within
from ddgfab.support.nearest_axes import torsion_free_axes
from ddgfab.support.structure import SupportStructure
from ddgfab.support.triangles import refuse_triangles
from ddgfab.tolerances import LEAN_LIMIT_DEG, RELATIVE_DEGENERATE

LEANS_DEG: Final[tuple[float, ...]] = (12.0, 22.0, 30.0)
"""Limits of lean [deg] that are tried in turn where none is given, until the mesh stays within the
limits of distance: the less axes lean, the further the mesh has to go."""

_UPRIGHT: Final = 0.01
"""Weight of the lean in the energy: draws axes to the normals where nothing else holds them."""
_COVER: Final = 4.0
"""Weight of the surface's distance from the mesh; vertices from the surface count 1."""
_SMOOTHER: Final = 10.0, 1.5
"""How many times smoother movements are than for planar faces, and the least weight of that: this
goal asks more of a mesh, which would rather crumple than leave its surface."""
_EASIER: Final = 1.5
"""What is tried next leans this many times further."""


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class TorsionFreeResult(OptimizeResult):
    """An optimised mesh with the node axes that belong to it.

    Attributes
    ----------
    axes : (V, 3) unit node axes
    """

    axes: Floats

    @property
    def support(self) -> SupportStructure:
        """The support structure of the axes on the mesh."""
        return SupportStructure.of(self.mesh, self.axes, "optimize", status=self.status)

    def own(self) -> dict[str, Any]:
        """Torsion and lean of the axes [deg]."""
        support = self.support
        return {
            "torsion_deg_max": support.torsion_deg_max,
            "lean_deg_max": support.lean_deg_max,
            "lean_deg_mean": support.lean_deg_mean,
            "lean_worst": [
                [int(v), float(np.degrees(support.lean[v]))] for v in support.worst_vertices(WORST)
            ],
        }

    def own_lines(self) -> list[str]:
        """The same for people."""
        support = self.support
        worst = ", ".join(
            f"{v} ({np.degrees(support.lean[v]):.1f})" for v in support.worst_vertices(WORST)
        )
        return [
            f"node axes: torsion max {support.torsion_deg_max:.1e} deg; lean max "
            f"{support.lean_deg_max:.1f}, mean {support.lean_deg_mean:.1f} deg, worst vertices "
            f"{worst}"
        ]


def torsion_free(*, max_lean: float | None = None, axes_only: bool = False) -> tuple[NetGoal, ...]:
    """The goal, with one limit of lean or those of `LEANS_DEG`.

    Measured on a roof of 1,121 vertices: axes lean by 10.7 deg at most (6.4 on average), 0.04 mean
    edges from the surface on average; with vertices fixed by 29 deg, faces not planar. About 25
    steps, a third of a second each.

    Parameters
    ----------
    max_lean : greatest angle [rad] between axis and vertex normal
    axes_only : vertices stay where they are and faces as they are; only axes are found

    Raises
    ------
    InputError
        A limit that is not positive.
    """
    if max_lean is not None and not max_lean > 0:
        raise InputError(f"max_lean = {max_lean:g}: more than zero is needed")
    if axes_only:
        widest = np.pi / 2 if max_lean is None else max_lean
        return (_with_limit(widest, axes_only=True),)
    leans = np.radians(LEANS_DEG).tolist() if max_lean is None else [max_lean]
    return tuple(_with_limit(lean) for lean in leans)


def _with_limit(lean: float, *, axes_only: bool = False) -> NetGoal:
    """The goal with a limit of lean [rad]."""
    higher = min(_EASIER * lean, float(np.radians(LEAN_LIMIT_DEG)))
    return NetGoal(
        "torsion-free",
        _torsion if axes_only else _planar_and_torsion,
        0.0,
        "Pottmann, Liu, Wallner, Bobenko, Wang 2007, Def. 5.1, section 2; mathematics.md 10.2-10.4",
        label=f"lean up to {np.degrees(lean):.3g} deg",
        check=_refuse,
        blocks=partial(_first_axes, max_lean=lean),
        additions=partial(_additions, max_lean=lean),
        weights=_weights,
        still=axes_only,
        result=TorsionFreeResult,
        own=_axes,
        easier=("max_lean", higher) if higher > lean else None,
    )


def _weights(weights: Weights) -> Weights:
    factor, least = _SMOOTHER
    return replace(weights, cover=_COVER, fair=max(factor * weights.fair, least))


def _torsion(mesh: Mesh, layout: Layout) -> tuple[Term, ...]:
    return axis_torsion(mesh, layout), unit_axes(mesh, layout)


def _planar_and_torsion(mesh: Mesh, layout: Layout) -> tuple[Term, ...]:
    return (*planarity_terms(mesh), *_torsion(mesh, layout))


def _additions(mesh: Mesh, layout: Layout, max_lean: float) -> Additions:
    return Additions(
        (AxisLean(mesh=mesh, layout=layout, weight=_UPRIGHT),),
        barriers=(lean_within(mesh, layout, max_lean),),
    )


def _axes(problem: Problem, x: Floats) -> dict[str, Any]:
    return {"axes": unit(problem.layout.values(x, AXES))}


def _refuse(mesh: Mesh) -> None:
    """Raise for triangle meshes, whose only torsion-free axes meet in one point, and bad faces."""
    if (mesh.face_sizes == 3).all():
        raise refuse_triangles(mesh)
    empty = np.flatnonzero(mesh.face_areas <= RELATIVE_DEGENERATE * mesh.diameter**2)
    if len(empty):
        raise DegenerateError(
            f"face {empty[0]} has no area ({mesh.face_areas[empty[0]]:.1e}), so no plane: repair it"
        )


def _first_axes(mesh: Mesh, max_lean: float) -> dict[str, Floats]:
    """Vertex normals; where faces are planar already, torsion-free axes that lean little enough.

    So a mesh that meets the goal is left as it is.
    """
    axes = mesh.vertex_normals
    if planarity_percent(mesh).max() / 100 <= EXACT:
        try:
            found = torsion_free_axes(mesh)
        except SupportError:
            return {AXES: axes}
        if found.lean.max() < max_lean:
            axes = found.axes
    return {AXES: axes}
