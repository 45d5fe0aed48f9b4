"""[optimize] of a project, carried out: the mesh that everything else is built on."""

from __future__ import annotations

import math
from typing import Any, cast

from ddgfab.mesh import Mesh
from ddgfab.optimize import Goal, Limits, OptimizeResult, optimize
from fabrication.gridshell.net_settings import OptimizeSettings
from fabrication.progress import Progress, silent


def optimized_mesh(
    mesh: Mesh,
    settings: OptimizeSettings,
    progress: Progress | None = None,
    *,
    surface: Mesh | None = None,
    rim: Mesh | None = None,
) -> OptimizeResult:
    """The mesh [mm] made what the settings ask for, with its report.

    Parameters
    ----------
    progress : called as (step, done, of)
    surface : to stay near to [mm]; the mesh itself by default
    rim : whose boundary that of the mesh stays near to [mm]; the mesh itself by default

    Raises
    ------
    OptimizeError
        The goal is missed or costs too much; carries the best mesh as `result`.
    InputError
        A vertex to be fixed that the mesh does not have.
    """
    report = progress or silent
    angle, limits = settings.feature_angle_deg, limits_of(settings)
    return optimize(
        mesh,
        cast(Goal, settings.goal),
        flat=settings.flat_percent,
        keep=settings.keep,
        fixed=settings.fix if isinstance(settings.fix, tuple) else (),
        boundary="fixed" if settings.fix == "boundary" else settings.boundary,
        surface=surface,
        feature_angle=None if angle is None else math.radians(angle),
        max_movement=settings.max_movement_mm,
        distance_limit=settings.distance_limit_edges,
        rise_limit=limits.rise,
        zigzag_limit=limits.zigzag,
        stretch_limit=limits.stretch,
        max_pane=settings.max_pane_mm,
        rim=rim,
        diagonals=settings.diagonals,
        equal_edges=settings.equal_edges,
        equal_panels=settings.equal_panels,
        equal_weight=settings.equal_weight,
        **_own_options(settings),
        progress=lambda stage, number, step: report(f"optimize: {stage}", number, 0),
    )


def limits_of(settings: OptimizeSettings) -> Limits:
    """What a result may cost."""
    return Limits.given(
        settings.distance_limit_edges,
        rise=settings.rise_limit_percent / 100,
        zigzag=math.radians(settings.zigzag_limit_deg),
        stretch=settings.stretch_limit_percent / 100,
    )


def _own_options(settings: OptimizeSettings) -> dict[str, Any]:
    """What not all goals take."""
    if settings.goal == "torsion-free":
        lean = settings.max_lean_deg
        return {
            "axes_only": settings.axes_only,
            "max_lean": None if lean is None else math.radians(lean),
        }
    if settings.goal == "families":
        return {"of": settings.families_of, "fit_tolerance": settings.fit_tolerance_mm}
    return {}
