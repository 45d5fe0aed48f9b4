"""Node axes of a design: those that came with the net, or what helps where there are none."""

from __future__ import annotations

from typing import Any, Final

from ddgfab.errors import SupportError
from ddgfab.io.pairs import paired_in_order
from ddgfab.mesh import Floats, Mesh
from ddgfab.support import SupportKind, SupportStructure, support_structure
from ddgfab.support.asymptotic import ASYMPTOTIC_BEND, edge_bend
from ddgfab.support.triangles import central_lean_deg
from fabrication.gridshell.net_settings import MESH
from fabrication.gridshell.project import Project

_TRIANGLE: Final = 3
_QUAD: Final = 4


class AxesError(SupportError):
    """No usable node axes, and the settings that help.

    Attributes
    ----------
    settings : (section, key, value)
    """

    def __init__(self, reason: str, settings: tuple[tuple[str, str, Any], ...]) -> None:
        super().__init__(reason)
        self.settings = settings


def node_axes(
    mesh: Mesh, kind: SupportKind, project: Project, axes: Floats | None
) -> SupportStructure:
    """The support structure of a project on a net [mm]; `axes` are those that the net carries.

    Raises
    ------
    AxesError
        There is none, but optimising the net may help.
    SupportError
        There is none.
    """
    try:
        return support_structure(
            mesh,
            kind,
            axes=axes,
            lean_limit_deg=project.support.lean_limit_deg,
            torsion_limit_deg=project.checks.torsion_deg,
        )
    except SupportError as error:
        if bool((mesh.face_sizes == _TRIANGLE).all()) and kind in ("auto", "optimize"):
            raise AxesError(str(error), (_for_triangles(mesh, project),)) from error
        quads = bool((mesh.face_sizes == _QUAD).all())
        if not quads or kind not in ("auto", "optimize") or project.optimize.goal == "torsion-free":
            raise
        if edge_bend(mesh) < ASYMPTOTIC_BEND:
            raise AxesError(str(error), (("support", "kind", "normals"),)) from error
        raise AxesError(str(error), (("optimize", "goal", "torsion-free"),)) from error


def _for_triangles(mesh: Mesh, project: Project) -> tuple[str, str, Any]:
    """What helps triangles: the quads they were cut from, a center, or normals that twist."""
    if project.net.kind == MESH and paired_in_order(mesh):
        return "net", "quads", True
    upright = central_lean_deg(mesh) <= project.support.lean_limit_deg
    return "support", "kind", "central" if upright else "normals"


def notes_on_axes(
    mesh: Mesh, axes: Floats | None, support: SupportStructure, project: Project, kind: SupportKind
) -> tuple[str, ...]:
    """Why node axes that came with the net were not taken."""
    if axes is None or support.kind == "given":
        return ()
    if kind != "auto":
        return (f'the net has node axes; [support] kind = "{support.kind}" is taken instead',)
    given = SupportStructure.of(mesh, axes, "given")
    return (
        f"the net has node axes, which are not used: torsion up to {given.torsion_deg_max:.2g} deg "
        f"([checks] torsion_deg = {project.checks.torsion_deg:g}), lean up to "
        f"{given.lean_deg_max:.3g} deg "
        f"([support] lean_limit_deg = {project.support.lean_limit_deg:g})",
    )
