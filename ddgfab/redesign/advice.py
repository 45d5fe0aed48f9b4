"""What to do with a mesh that is not planar: optimise it, change its surface, or its net."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final, Literal, TypeAlias

from ddgfab.arguments import checked
from ddgfab.errors import DegenerateError, MeshError
from ddgfab.measures import planarity_percent
from ddgfab.mesh import Mesh
from ddgfab.optimize import Forecast, better_diagonals, expected
from ddgfab.optimize.problem import mean_edge
from ddgfab.redesign.dilemma import Movement, forecast_dict, mesh_forecast
from ddgfab.tolerances import NET_PLANAR_PERCENT
from ddgfab.trace.alignment import Alignment, alignment

Way: TypeAlias = Literal["none", "optimize", "diagonals", "dilemma", "retrace"]
"""What is recommended: nothing, or one of four commands."""

_NEAR: Final = 0.1
"""Planar faces this near to the surface [mean edges, on average] are worth optimising for."""
_STRETCH: Final = 0.4
"""Edges that change by less than this part of their length follow conjugate directions."""
_SMALL: Final = 0.25
"""A surface that moves by less than this [mean edges] is still the design."""
_LARGEST: Final = 20_000
"""Faces up to which directions and forecasts are worth their time in a report."""


@dataclass(frozen=True, eq=False)
class Advice:
    """Directions of the edges of a mesh, what planar faces will cost, and what to do.

    Attributes
    ----------
    way : what is recommended; reason : why, in a sentence
    aligned : directions of the edges, or None where no surface fits (`why` says it)
    planar : forecast of planar faces; principal : of principal edges
    """

    way: Way
    reason: str
    why: str
    aligned: Alignment | None
    planar: Forecast | None
    principal: Movement | None

    def lines(self, file: str = "MESH", unit: str = "mm") -> list[tuple[str, str]]:
        """Titles and texts for people; `file` is named in the command to try."""
        rows = [("from principal", f"unknown: {self.why}")]
        if self.aligned is not None:
            rows = self.aligned.lines()
        if self.principal is not None:
            rows.append(
                (
                    "to be principal",
                    f"the surface would move by {self.principal.greatest:.3g} {unit} at most",
                )
            )
        command = {
            "none": "",
            "optimize": f"ddgfab optimize {file}",
            "diagonals": f"ddgfab optimize {file} --diagonals",
            "dilemma": f"ddgfab dilemma {file}",
            "retrace": f"ddgfab optimize {file} --retrace",
        }[self.way]
        rows.append(("advice", f"{self.reason}{': ' if command else ''}{command}"))
        return rows

    def to_dict(self) -> dict[str, Any]:
        """Plain values for JSON."""
        return {
            "advice": self.way,
            "reason": self.reason,
            "edges": None if self.aligned is None else self.aligned.to_dict(),
            "principal_forecast": None if self.principal is None else forecast_dict(self.principal),
        }


@checked
def advise(mesh: Mesh) -> Advice | None:
    """What to do with a mesh of quads; None for meshes without quads, and for very large ones."""
    if not (mesh.face_sizes == 4).any() or mesh.n_faces > _LARGEST:
        return None
    aligned, why, principal = None, "", None
    try:
        aligned = alignment(mesh)
        principal = mesh_forecast(mesh, aligned, None)
    except (MeshError, DegenerateError) as error:
        why = str(error).splitlines()[0]
    if float(planarity_percent(mesh).max()) <= NET_PLANAR_PERCENT:
        return Advice("none", "the faces are planar already", why, aligned, None, principal)
    try:
        planar = expected(mesh)
    except DegenerateError:
        planar = None
    edge = mean_edge(mesh)
    near = planar is None or planar.distance_mean <= _NEAR * edge
    if near and (planar is None or planar.stretch < _STRETCH):
        way: Way = "optimize"
        reason = "edges follow conjugate directions well enough"
    elif planar is not None and better_diagonals(mesh) is not None:
        way, reason = "diagonals", "the edges run the wrong way, their diagonals do not"
    elif aligned is None:
        way, reason = "optimize", "the result will be far from the surface, or creased"
    elif principal is not None and principal.greatest <= _SMALL * edge:
        way, reason = "dilemma", "a small change of the surface makes the edges principal"
    else:
        way, reason = "retrace", "edges run the wrong way: let the net follow the surface"
    return Advice(way, reason, why, aligned, planar, principal)
