"""The design dilemma: edges go where the designer draws them, so the surface has to move.

Faces are planar when edges follow conjugate directions; node axes, beams and panes are best when
they follow principal ones. Where the drawn net follows others, a small change of the surface may
make them principal: small where both curvatures are nearly equal. Source: Pottmann, Eigensatz,
Vaxman, Wallner 2015, Architectural Geometry, 3; docs/surfaces.md.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, Final, Literal, TypeAlias, get_args

import numpy as np

from ddgfab.arguments import checked
from ddgfab.errors import DegenerateError, InputError, OptimizeError
from ddgfab.measures import planarity_percent
from ddgfab.mesh import Floats, Mesh
from ddgfab.optimize import optimize
from ddgfab.redesign.nearest_net import bent_further, heights_only, nearest_net
from ddgfab.surfaces.nearest import nearest_points
from ddgfab.surfaces.principal import principal
from ddgfab.surfaces.spline import SplineSurface
from ddgfab.trace.alignment import Alignment, alignment

DilemmaGoal: TypeAlias = Literal["principal", "planar"]
"""What drawn edges are to be: principal directions, or conjugate ones (planar faces only)."""

KEPT: Final = 0.5
"""Part of the anisotropy that is kept by default where edges are turned by more than `_TURNED`."""
_TURNED: Final = np.radians(25.0)
_LARGE: Final = 0.05
"""Forecasts beyond this part of the size are not small changes."""
_OFF: Final = 0.01
"""Drawn nets whose vertices lie further from the surface than this part of its size are refused."""


@dataclass(frozen=True)
class Movement:
    """How far a surface must move, known before anything is solved. Angles in radians.

    Attributes
    ----------
    turn : by which the edges are turned from the principal directions, 0 to pi / 4
    half : half the difference of the principal curvatures
    side : half a side of a square as large as the mesh
    keep : part of the anisotropy to keep; None: whatever the nearest surface leaves
    greatest, rms : movement along the normal
    anisotropy : part of the anisotropy that is left
    """

    turn: float
    half: float
    side: float
    keep: float | None
    greatest: float
    rms: float
    anisotropy: float


@checked
def movement_forecast(turn: float, half: float, side: float, keep: float | None = None) -> Movement:
    """Movement by which edges turned from the principal directions become principal themselves.

    With u, v along the edges the surface moves by w = half (A (u^2 - v^2) / 2 + S u v) along its
    normal, S = sin 2 turn, A = keep - cos 2 turn; the nearest solution has A = 0.

    Parameters
    ----------
    turn : [rad]; half : half the difference of the principal curvatures
    side : half a side of the patch, a square
    keep : part of the difference of the curvatures to keep, 0 to 1 or more

    Raises
    ------
    InputError
        A number that is not finite, a side that is not positive, a part that is negative.
    """
    if not (np.isfinite([turn, half, side]).all() and side > 0):
        raise InputError(
            f"turn {turn:g}, curvature {half:g}, side {side:g}: finite, a side above 0"
        )
    if keep is not None and not (np.isfinite(keep) and keep >= 0):
        raise InputError(f"keep {keep:g}: a part of the anisotropy, 0 to 1, is needed")
    folded = abs(turn - np.pi / 2 * round(turn / (np.pi / 2)))
    s = float(np.sin(2 * folded))
    a = 0.0 if keep is None else keep - float(np.cos(2 * folded))
    size = abs(half) * side**2
    greatest = size * (s if s >= abs(a) else (a**2 + s**2) / (2 * abs(a)))
    rms = size * float(np.sqrt(2 * a**2 / 45 + s**2 / 9))
    left = float(np.cos(2 * folded)) if keep is None else keep
    return Movement(folded, abs(half), side, keep, greatest, rms, left)


def mesh_forecast(mesh: Mesh, aligned: Alignment, keep: float | None) -> Movement:
    """The forecast of a mesh, from the median of the angles and the mean of the curvatures."""
    turn = float(np.median(np.abs(aligned.turn)))
    side = 0.5 * float(np.sqrt(mesh.face_areas.sum()))
    return movement_forecast(turn, float(aligned.half.mean()), side, keep)


@dataclass(frozen=True, eq=False, repr=False)
class Dilemma:
    """A drawn net, and the nearest surface on which it is principal or conjugate.

    Attributes
    ----------
    goal : "principal" or "planar"; keep : part of the anisotropy that was to be kept, or None
    original, mesh : before and after, the same faces
    before, after : directions of the edges; forecast : what was expected
    residual : greatest residual of the equations (parts of diagonals, angles in rad)
    """

    goal: DilemmaGoal
    keep: float | None
    original: Mesh
    mesh: Mesh
    before: Alignment
    after: Alignment
    forecast: Movement
    residual: float

    def __repr__(self) -> str:
        return f"Dilemma({self.goal}: moved {self.greatest:.4g} along the normal at most)"

    @cached_property
    def normal(self) -> Floats:
        """(V,) movement along the normal, to the side that faces show."""
        moved = self.mesh.vertices - self.original.vertices
        return np.asarray(np.einsum("vx,vx->v", moved, self.original.vertex_normals))

    @property
    def greatest(self) -> float:
        """Greatest movement along the normal."""
        return float(np.abs(self.normal).max())

    @property
    def rms(self) -> float:
        """Root mean square of the movement along the normal."""
        return float(np.sqrt(np.mean(self.normal[self.original.valences > 0] ** 2)))

    @property
    def movement(self) -> float:
        """Greatest movement of a vertex."""
        moved = self.mesh.vertices - self.original.vertices
        return float(np.linalg.norm(moved, axis=1).max())

    def lines(self, unit: str = "mm") -> list[tuple[str, str]]:
        """Titles and texts for people."""
        return [
            *self.before.lines(),
            *forecast_lines(self.forecast, unit),
            *self.change_lines(unit),
        ]

    def change_lines(self, unit: str = "mm") -> list[tuple[str, str]]:
        """What was done, without what was known before."""
        flat = [float(planarity_percent(mesh).max()) for mesh in (self.original, self.mesh)]
        return [
            (
                "moved",
                f"{self.greatest:.4g} {unit} at most along the normal, rms {self.rms:.4g}; "
                f"{self.movement:.4g} {unit} in all directions",
            ),
            *[(f"now {title}", text) for title, text in self.after.lines()],
            ("planarity", f"greatest {flat[0]:.3g} % before, {flat[1]:.2g} % after"),
        ]

    def to_dict(self) -> dict[str, Any]:
        """Plain values for JSON, in the unit of the mesh and degrees."""
        return {
            "goal": self.goal,
            "keep": self.keep,
            "forecast": forecast_dict(self.forecast),
            "normal_max": self.greatest,
            "normal_rms": self.rms,
            "movement_max": self.movement,
            "residual": self.residual,
            "before": self.before.to_dict(),
            "after": self.after.to_dict(),
        }


def forecast_lines(forecast: Movement, unit: str = "mm") -> list[tuple[str, str]]:
    """The forecast for people."""
    kept = "nearest surface" if forecast.keep is None else f"anisotropy kept: {forecast.keep:g}"
    return [
        (
            "forecast",
            f"{forecast.greatest:.4g} {unit} at most along the normal, rms {forecast.rms:.4g} "
            f"(edges {np.degrees(forecast.turn):.3g} deg from principal, {kept}, "
            f"{100 * forecast.anisotropy:.0f} % of the anisotropy left)",
        )
    ]


def forecast_dict(forecast: Movement) -> dict[str, float | None]:
    """The forecast as plain values, in the unit of the mesh and degrees."""
    return {
        "turn_deg": float(np.degrees(forecast.turn)),
        "half_difference_of_curvatures": forecast.half,
        "normal_max": forecast.greatest,
        "normal_rms": forecast.rms,
        "keep": forecast.keep,
        "anisotropy_left": forecast.anisotropy,
    }


def kept_by_default(aligned: Alignment) -> float | None:
    """Half of the anisotropy where edges are turned by more than 25 deg, else what is left.

    At 45 deg the nearest surface is umbilic: its principal directions are those of noise.
    """
    return KEPT if float(np.median(np.abs(aligned.turn))) > _TURNED else None


@checked
def dilemma(
    mesh: Mesh,
    goal: DilemmaGoal = "principal",
    *,
    keep: float | None = None,
    nearest: bool = False,
    surface: SplineSurface | None = None,
    plan: bool = False,
) -> Dilemma:
    """The least change of a surface for which the edges drawn on it are principal, or conjugate.

    Parameters
    ----------
    mesh : quads drawn as asked on the surface; other faces at the rim
    goal : "principal", or "planar": conjugate directions only, which may be skew
    keep : part of the difference of the principal curvatures to keep; by default 0.5 where the
        edges are turned by more than 25 deg, otherwise whatever the nearest surface leaves
    nearest : keep no anisotropy, whatever the angle
    surface : that the mesh is drawn on; by default one fitted to its vertices
    plan : move heights only, across the least-squares plane of the mesh ("planar" only)

    Raises
    ------
    InputError
        An unknown goal, a part that is negative, vertices off the surface (names the worst).
    MeshError, DegenerateError
        No quads, or no surface that fits (see `alignment`); no net near the mesh.
    OptimizeError
        The net is far from the goal, and `optimize` does not reach it either.
    """
    if goal not in get_args(DilemmaGoal):
        raise InputError(f'goal "{goal}" is unknown; one of {", ".join(get_args(DilemmaGoal))}')
    if plan and goal != "planar":
        raise InputError('heights only make faces planar, not principal: choose goal "planar"')
    if surface is not None:
        _check_drawn(mesh, surface)
    before = alignment(mesh, surface)
    chosen = keep if keep is not None or nearest else kept_by_default(before)
    chosen = None if goal == "planar" and keep is None else chosen
    forecast = mesh_forecast(mesh, before, chosen)
    if plan:
        up = np.linalg.svd(mesh.vertices - mesh.vertices.mean(axis=0), full_matrices=False)[2][2]
        after, residual = heights_only(mesh, up), 0.0
    else:
        after, residual = _moved(mesh, goal, chosen, before)
    return Dilemma(goal, chosen, mesh, after, before, alignment(after), forecast, residual)


def large(forecast: Movement, mesh: Mesh) -> str:
    """A warning where the forecast is not a small change of the surface; else empty."""
    size = mesh.diameter
    if forecast.greatest <= _LARGE * size:
        return ""
    return (
        f"the forecast is {100 * forecast.greatest / size:.0f} % of the size (limit "
        f"{100 * _LARGE:g} %): the surface would become another one. Where curvatures differ as "
        "much as here, let the net follow the surface: ddgfab optimize --retrace"
    )


def _moved(
    mesh: Mesh, goal: DilemmaGoal, keep: float | None, before: Alignment
) -> tuple[Mesh, float]:
    target = None
    if keep is not None:
        target = bent_further(mesh, keep * _differences(mesh, before))
    found = nearest_net(mesh, goal, target)
    if found is not None:
        return found.mesh, found.residual
    if keep is not None:
        raise DegenerateError(
            f"no {goal} net near the mesh keeps {100 * keep:g} % of the anisotropy\nkeep less: "
            "--keep 0.25, or --nearest"
        )
    try:
        other: Literal["planar", "circular"] = "planar" if goal == "planar" else "circular"
        result = optimize(mesh, other, flat=0.0, surface=mesh, distance_limit=(np.inf, np.inf))
    except OptimizeError as error:
        raise OptimizeError(
            f"no {goal} net near the mesh: {str(error).splitlines()[0]}\nlet the net follow the "
            "surface: ddgfab optimize --retrace",
            result=error.result,
        ) from None
    return result.mesh, result.residual


def _differences(mesh: Mesh, before: Alignment) -> Floats:
    """(V,) difference of the principal curvatures at the vertices."""
    jets = before.surface.jets(nearest_points(before.surface, mesh.vertices).uv)
    found = principal(jets)
    return np.asarray(found.larger - found.smaller)


def _check_drawn(mesh: Mesh, surface: SplineSurface) -> None:
    far = np.where(mesh.valences > 0, nearest_points(surface, mesh.vertices).distance, 0.0)
    worst = int(far.argmax())
    if far[worst] > _OFF * mesh.diameter:
        raise InputError(
            f"vertex {worst} lies {far[worst]:.4g} from {surface.name} (limit "
            f"{_OFF * mesh.diameter:.4g}, 1 % of the size): draw the net on the surface"
        )
