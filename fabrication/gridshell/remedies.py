"""Which settings help where pieces of a gridshell are beyond limits that the net decides."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any, Final

import numpy as np

from ddgfab.io.pairs import paired_in_order
from fabrication.gridshell.design import Design
from fabrication.gridshell.foresight import diagonals_are_better
from fabrication.gridshell.net_settings import MESH, OPTIMIZE_OPTIONS, SURFACE
from fabrication.gridshell.pieces import Panel
from fabrication.gridshell.room import settings_with_room
from fabrication.job.problems import FailedCheck
from fabrication.solids.polygon import least_rectangle

LARGEST_PANE_MM: Final = 50_000.0
"""A pane longer than this means that the mesh is in another unit."""

_TRIANGLE, _QUAD = 3, 4


def remedies(design: Design, problems: Sequence[FailedCheck]) -> list[tuple[str, str, Any]]:
    """(section, key, value) of the settings that help.

    A net that is not planar, or whose node axes lean, is optimized: torsion-free where the axes are
    at fault, as no change of the faces alone rights them. Where that was done already, or is not
    possible, and for all other limits, the limit that the net keeps is named. Quads whose panes are
    too large are divided, once; nets on surfaces are traced more closely. Triangles that are quads
    cut in two become quads again: axes of triangle meshes twist. Where normals twist and the faces
    are planar, what is named leaves the pieces clear of each other (`settings_with_room`).
    """
    worst = {problem.check: problem.parts[0][1] for problem in problems}
    goal = design.project.optimize.goal
    found: list[tuple[str, str, Any]] = []
    panes = [] if "size_mm" not in worst else [_sides(p) for p in design.gridshell.panels]
    if panes and max(long for _, long in panes) > LARGEST_PANE_MM:
        return [_unit(design)]
    if "torsion_deg" in worst and design.project.net.kind == MESH and paired_in_order(design.mesh):
        return [("net", "quads", True)]  # clashes grow with the torsion; quads can do without it
    quads = bool((design.mesh.face_sizes == _QUAD).all())
    straight = design.support.kind != "normals"  # those of asymptotic nets twist by their nature
    axes = bool({"lean_deg", "torsion_deg"} & worst.keys()) and straight
    cut = bool((design.mesh.face_sizes > _TRIANGLE).any())
    if axes and cut and goal != "torsion-free":
        found.append(("optimize", "goal", "torsion-free"))
    elif "planarity_percent" in worst and not axes and goal == "none":
        found.append(("optimize", "goal", "planar"))
        if diagonals_are_better(design.mesh):
            found.append(("optimize", "diagonals", True))
    elif "torsion_deg" in worst and not straight and "planarity_percent" not in worst:
        if not (found := _of_normals(design, worst)):
            return []
    else:
        found += _limits(worst)
    if "least_angle_deg" in worst:
        found.append(("checks", "min_angle_deg", _number(worst["least_angle_deg"], math.floor)))
    if panes and design.project.net.kind == SURFACE:
        found += _closer(design, panes)
    elif panes and quads and straight and _divides(design, found):
        if goal == "none" and not any(key == "goal" for _, key, _ in found):
            found.append(("optimize", "goal", "planar"))
        found.append(("optimize", "max_pane_mm", sorted(design.project.panel.max_size_mm)))
    elif panes:
        wide, long = (math.ceil(max(sides) / 10.0) * 10 for sides in zip(*panes, strict=True))
        found.append(("panel", "max_size_mm", [wide, long]))
    return found


def _closer(design: Design, panes: Sequence[tuple[float, float]]) -> list[tuple[str, str, Any]]:
    """Spacings [mm] at which panes fit; a little less than in proportion, as lines fall anew."""
    narrow, wide = sorted(design.project.panel.max_size_mm)
    over = max(max(small / narrow, long / wide) for small, long in panes)
    net = design.project.net
    given = {"spacing_mm": net.spacing_mm, "spacing_across_mm": net.spacing_across_mm}
    return [
        ("net", key, math.floor(0.95 * old / over / 10.0) * 10.0)
        for key, old in given.items()
        if old is not None
    ]


def _divides(design: Design, found: Sequence[tuple[str, str, Any]]) -> bool:
    """Whether quads can be divided until their panes fit, and have not been yet."""
    optimize = design.project.optimize
    goal = next((str(value) for _, key, value in found if key == "goal"), optimize.goal)
    possible = goal in ("none", *OPTIMIZE_OPTIONS["max_pane_mm"])
    return possible and optimize.max_pane_mm is None


def _limits(worst: dict[str, float | str | None]) -> list[tuple[str, str, Any]]:
    """The limits of planarity, lean and torsion that the pieces keep."""
    keys = {
        "planarity_percent": ("checks", "flat_percent"),
        "lean_deg": ("support", "lean_limit_deg"),
        "torsion_deg": ("checks", "torsion_deg"),
    }
    return [
        (*keys[name], _number(value, math.ceil)) for name, value in worst.items() if name in keys
    ]


def _of_normals(design: Design, worst: dict[str, float | str | None]) -> list[tuple[str, str, Any]]:
    """The torsion of normals as a limit, with room for the panes, or axes without torsion.

    Empty where pieces clash with all that was tried.
    """
    limits = _limits(worst)
    limit = next(value for _, key, value in limits if key == "torsion_deg")
    tried = settings_with_room(design, limit)
    if not tried:
        return limits if tried is None else []
    return [*(row for row in limits if row[1] != "torsion_deg"), *tried]


def _number(value: float | str | None, step: Callable[[float], int]) -> float:
    """A value rounded to the next tenth, up or down."""
    return step(10.0 * float(value or 0.0)) / 10.0


def _sides(panel: Panel) -> tuple[float, float]:
    """Smaller and larger side [mm] of the least rectangle round a pane."""
    corners = np.concatenate([panel.shape.inner, panel.shape.outer])
    small, large = least_rectangle(corners).tolist()
    return small, large


def _unit(design: Design) -> tuple[str, str, Any]:
    """The unit that the mesh seems to be in."""
    settings = design.project.project
    return ("project", "units", "mm") if settings.units == "m" else ("project", "scale", 0.001)
