"""What planar faces will cost, before solving: one linear system at the mesh as it is.

The movement dx that would meet the linearized equations at least energy. Its part along the normal
is what the surface will be left by: edges that can turn in the surface until they follow conjugate
directions leave it by little, the others by a thirteenth of an edge or more, and then they crease
or flatten it.

Source: mathematics.md 1.3: planar quads are conjugate nets.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from ddgfab.arguments import checked
from ddgfab.mesh import Floats, Ints
from ddgfab.optimize.linear import SymmetricSolver
from ddgfab.optimize.merit import Merit, damped
from ddgfab.optimize.problem import Problem
from ddgfab.optimize.result import Forecast

_STIFF: Final = 1e7
_DAMPING: Final = 1e-8

HARMLESS: Final = 0.045
"""Below this mean distance [mean edges] edges follow conjugate directions well enough: all results
measured were smooth."""
CREASES: Final = 0.075
"""Above this mean distance [mean edges] creases or flattened parts are to be expected."""


@checked
def doubtful(forecast: Forecast) -> bool:
    """Whether creases or flattened parts are to be expected, so that another net is better."""
    return forecast.distance_mean > CREASES * forecast.unit


def forecast_of(problem: Problem, unit: float, normals: Floats) -> Forecast:
    """The forecast of a problem on a mesh whose mean edge is one.

    Parameters
    ----------
    unit : mean edge in the unit that the forecast is in
    normals : (V, 3) unit normals of the surface
    """
    merit, mesh = Merit(problem), problem.mesh
    merit.freeze(problem.start)
    model = merit.model(problem.start)
    stiff = damped(model.hessian + _STIFF * (model.lines.T @ model.lines), _DAMPING)
    right = -_STIFF * (model.lines.T @ model.values)
    step = SymmetricSolver(nodes=merit.nodes).factor(stiff)(right)
    move = problem.vertices(merit.moved(np.zeros_like(problem.start), step))
    used: Ints = np.flatnonzero(mesh.valences > 0)
    away = np.abs(np.einsum("vx,vx->v", move, normals))[used]
    start, end = move[mesh.edges].transpose(1, 0, 2)
    stretch = np.linalg.norm(end - start, axis=1) / mesh.edge_lengths
    return Forecast(
        unit=unit,
        distance_mean=unit * float(away.mean()),
        movement_mean=unit * float(np.linalg.norm(move[used], axis=1).mean()),
        stretch=float(stretch.max(initial=0.0)),
    )


@checked
def forecast_text(
    forecast: Forecast,
    unit: str = "mm",
    diagonals: Forecast | None = None,
    *,
    traceable: bool = True,
) -> str:
    """The forecast as one sentence.

    Parameters
    ----------
    diagonals : the forecast of the net of diagonals, where that is better
    traceable : whether a net can be traced on the surface: on one piece with one boundary
    """
    distance = f"about {forecast.distance_mean:.3g} {unit} from the surface on average"
    edges = f"{forecast.distance_mean / forecast.unit:.2g} mean edges"
    if forecast.distance_mean < HARMLESS * forecast.unit:
        return f"planar faces: expect {distance} ({edges})"
    if not doubtful(forecast):
        return (
            "planar faces: edges follow conjugate directions only roughly; expect "
            f"{distance} ({edges})"
        )
    other = "a traced net follows them (ddgfab optimize --retrace)"
    if not traceable:
        other = "a traced net follows them, on pieces cut open to one boundary each"
    if diagonals is not None:
        other = (
            f"their diagonals do, with about {diagonals.distance_mean:.3g} {unit} (ddgfab optimize "
            "--diagonals)"
        )
    return (
        f"planar faces: edges do not follow conjugate directions; expect {distance} ({edges}), "
        f"with creases or flattened parts; {other}"
    )
