"""What planar faces of a mesh will cost, on its own edges and on other ones, before solving."""

from __future__ import annotations

from typing import Final

from ddgfab.arguments import checked
from ddgfab.errors import DegenerateError, InputError
from ddgfab.mesh import Mesh
from ddgfab.optimize.diagonals import diagonal_net
from ddgfab.optimize.forecast import HARMLESS, forecast_of
from ddgfab.optimize.frame import Frame
from ddgfab.optimize.goal import net_problem, violation
from ddgfab.optimize.net_goals import PLANAR
from ddgfab.optimize.result import Forecast

_QUAD: Final = 4


@checked
def expected(mesh: Mesh) -> Forecast | None:
    """What planar faces of a mesh will cost, from one linear solve; None where they are planar.

    Raises
    ------
    DegenerateError
        The system is singular, as on meshes with faces without area.
    """
    frame = Frame.of(mesh)
    small = frame.inside(mesh)
    problem = net_problem(small, PLANAR)
    if violation(problem, problem.start) <= PLANAR.tolerance:
        return None
    return forecast_of(problem, frame.unit, small.vertex_normals)


@checked
def better_diagonals(mesh: Mesh) -> Forecast | None:
    """The forecast of the net of diagonals where that net can be planar without creases.

    None for meshes with other faces than quads, and where diagonals are no help. Where they are
    planar already, the forecast is zero.
    """
    if (mesh.face_sizes != _QUAD).any():
        return None
    try:
        net = diagonal_net(mesh)
        forecast = expected(net)
    except (DegenerateError, InputError):
        return None
    if forecast is None:
        return Forecast(Frame.of(net).unit, 0.0, 0.0, 0.0)
    return forecast if forecast.distance_mean < HARMLESS * forecast.unit else None
