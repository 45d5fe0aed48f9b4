"""support_structure: the torsion-free structure that a net allows, by kind or automatically."""

from __future__ import annotations

from typing import Final, Literal, get_args

import numpy as np

from ddgfab.arguments import checked
from ddgfab.errors import DegenerateError, SupportError
from ddgfab.measures import circular_defect, conical_defect, planarity_percent, torsion
from ddgfab.mesh import Floats, Mesh
from ddgfab.support.asymptotic import ASYMPTOTIC_BEND, edge_bend, surface_normals
from ddgfab.support.edge import edge_axes
from ddgfab.support.exact import cone_axes, reflected_axes
from ddgfab.support.nearest_axes import torsion_free_axes
from ddgfab.support.parallel import parallel_axes
from ddgfab.support.structure import SupportStructure
from ddgfab.support.triangles import central, refuse_triangles
from ddgfab.tolerances import (
    LEAN_LIMIT_DEG,
    LEAN_UPRIGHT_DEG,
    NET_ANGLE_DEG,
    NET_EDGE_OFFSET,
    NET_PLANAR_PERCENT,
    TORSION_EXACT_DEG,
)

SupportKind = Literal["auto", "offset", "normal", "axis", "optimize", "central", "normals", "edge"]

LEAN_EQUAL_DEG: Final = 1e-6
"""Mean leans [deg] that differ by less are equal, as those of all kinds on a sphere."""

_EXACT = {
    "normal": reflected_axes,
    "axis": cone_axes,
    "edge": lambda mesh: edge_axes(mesh, NET_EDGE_OFFSET),
    "offset": parallel_axes,
}


@checked
def support_structure(
    mesh: Mesh,
    kind: SupportKind = "auto",
    *,
    lean_limit_deg: float = LEAN_LIMIT_DEG,
    torsion_limit_deg: float = TORSION_EXACT_DEG,
    axes: Floats | None = None,
) -> SupportStructure:
    """Node axes on a mesh, vertices fixed; torsion-free except for the kind "normals".

    Kinds: "normal" (circular nets: vertex normals by reflection), "axis" (conical nets: axes of
    the vertex cones), "edge" (meshes parallel to a Koebe net: its vertices, which give beams of one
    height), "offset" (planar faces: the parallel mesh nearest to the vertex normals),
    "optimize" (any mesh: axes nearest to the vertex normals), "central" (any mesh: axes through
    one point), "normals" (A-nets and K-nets: surface normals, whose torsion stays; reported by
    the structure; never taken by "auto"), "auto": of all of "normal", "axis", "edge", "offset"
    that the net allows exactly, the one that leans least on average; if none stays within the lean
    limit, "optimize" where that leans less. A net that is circular, conical or planar only within
    tolerance gets the torsion-free axes nearest to those of the kind asked for.

    Parameters
    ----------
    lean_limit_deg : structures that lean by more somewhere are taken by "auto" only where none
        stays below; the caller judges what comes back (`SupportStructure.leaning`)
    torsion_limit_deg : greatest torsion of what is taken where no axes are free of torsion to the
        digits of a double, as on closed nets from files of six digits
    axes : (V, 3) axes that were found together with the mesh (`ddgfab.optimize.torsion_free`).
        "auto" takes them, as kind "given", if they are torsion-free within the lean limit

    Raises
    ------
    SupportError
        An unknown kind; axes of the wrong shape; a kind that the net does not allow, with the
        defect; a triangle mesh (Prop. 5.2); no torsion-free axes; axes that lie in the surface
        (`LEAN_UPRIGHT_DEG`), as on nets along asymptotic lines.

    Examples
    --------
    >>> from ddgfab.forms.registry import generate
    >>> structure = support_structure(generate("conical"))
    >>> structure.kind, structure.torsion_free
    ('offset', True)
    """
    if kind not in get_args(SupportKind):
        raise SupportError(
            f'unknown support kind "{kind}"; one of {", ".join(get_args(SupportKind))}'
        )
    if kind == "auto" and axes is not None:
        given = SupportStructure.of(mesh, axes, "given")
        if given.torsion_deg_max <= torsion_limit_deg and given.lean_deg_max <= lean_limit_deg:
            return given
    if kind == "normals":
        return SupportStructure.of(mesh, surface_normals(mesh), kind)
    if kind == "central":
        return _upright(central(mesh), torsion_limit_deg)
    if (mesh.face_sizes == 3).all() and kind != "edge":
        raise refuse_triangles(mesh)
    if kind == "optimize":
        return _optimized(mesh, torsion_limit_deg)
    if kind != "auto":
        objection = _objection(mesh, kind)
        if objection:
            raise SupportError(
                f'support kind "{kind}" does not fit this net: {objection}\n'
                'take [support] kind = "optimize", or optimise the net first'
            )
        return _upright(_exact(mesh, kind), torsion_limit_deg)
    return _automatic(mesh, lean_limit_deg, torsion_limit_deg)


def _automatic(mesh: Mesh, lean_limit_deg: float, torsion_limit_deg: float) -> SupportStructure:
    """Of the exact kinds that the net allows the one that leans least, or "optimize"."""
    candidates = [
        SupportStructure.of(mesh, _EXACT[name](mesh), name)
        for name in _EXACT
        if not _objection(mesh, name)
    ]
    found = [structure for structure in candidates if structure.torsion_free]
    upright = [structure for structure in found if structure.lean_deg_max <= lean_limit_deg]
    if upright:
        least = min(structure.lean_deg_mean for structure in upright)
        # Of equals (a sphere has the same axes by all kinds) the first: the most special.
        return next(s for s in upright if s.lean_deg_mean <= least + LEAN_EQUAL_DEG)
    try:
        found.append(_optimized(mesh, torsion_limit_deg))
    except SupportError:
        found = found or [s for s in candidates if s.torsion_deg_max <= torsion_limit_deg]
        if not found:
            raise
    return _upright(min(found, key=lambda s: s.lean_deg_max), torsion_limit_deg)


def _objection(mesh: Mesh, kind: str) -> str:
    """Why a net does not allow an exact kind, with numbers; empty when it does."""
    flat = planarity_percent(mesh)
    worst = int(flat.argmax())
    if flat[worst] > NET_PLANAR_PERCENT:
        return f"face {worst} is {flat[worst]:.2g} % from planar (limit {NET_PLANAR_PERCENT:g} %)"
    if kind == "normal":
        odd = np.flatnonzero(mesh.face_sizes % 2)
        if len(odd):
            return f"face {odd[0]} has {mesh.face_sizes[odd[0]]} sides; reflections need even"
        return _defect("face", "circular", circular_defect(mesh))
    if kind == "edge":
        try:
            edge_axes(mesh, NET_EDGE_OFFSET)
        except DegenerateError as error:
            return str(error)
    if kind == "axis":
        if mesh.boundary_vertex[mesh.valences > 0].all():
            return "it has no interior vertex, so no cones"
        return _defect("vertex", "conical", conical_defect(mesh))
    return ""


def _defect(element: str, name: str, values: Floats) -> str:
    worst, angle = int(values.argmax()), float(np.degrees(values.max()))
    if angle <= NET_ANGLE_DEG:
        return ""
    return f"{element} {worst} is {angle:.2g} deg from {name} (limit {NET_ANGLE_DEG:g} deg)"


def _exact(mesh: Mesh, kind: str) -> SupportStructure:
    """Structure of an exact kind; where the net is so only nearly, moved onto torsion zero."""
    axes = _EXACT[kind](mesh)
    structure = SupportStructure.of(mesh, axes, kind)
    if structure.torsion_free:
        return structure
    near = torsion_free_axes(mesh, target=axes, throw=False)
    return SupportStructure.of(
        mesh,
        near.axes,
        kind,
        status=near.status,
        history_deg=structure.history_deg + near.history_deg,
    )


def _optimized(mesh: Mesh, limit_deg: float) -> SupportStructure:
    """The optimised structure, upright; explains itself where the solver fails on such a net."""
    return _upright(torsion_free_axes(mesh, throw=False), limit_deg)


def _upright(structure: SupportStructure, limit_deg: float) -> SupportStructure:
    """Pass a structure that stands up with torsion below a limit [deg]; explain the others."""
    mesh = structure.mesh
    lying = structure.lean_deg_max > LEAN_UPRIGHT_DEG
    if structure.torsion_deg_max <= max(limit_deg, TORSION_EXACT_DEG) and not lying:
        return structure
    angles = np.degrees(torsion(mesh, mesh.vertex_normals))
    worst = int(angles.argmax())
    normals = (
        f"the vertex normals have torsion {angles[worst]:.2f} deg at edge {worst}, "
        f"{angles.mean():.2f} deg on average"
    )
    if lying:
        found = (
            f"axes lean by up to {structure.lean_deg_max:.0f} deg (vertex "
            f"{structure.worst_vertices(1)[0]}; {structure.lean_deg_mean:.0f} deg on average)"
        )
    else:
        edges = ", ".join(str(i) for i in structure.worst_edges(3))
        found = (
            f"torsion stays at {structure.torsion_deg_max:.2g} deg (limit {limit_deg:g}, edges "
            f"{edges})"
        )
    raise SupportError(f"no upright torsion-free node axes: {found}{_reason(structure)}\n{normals}")


def _reason(structure: SupportStructure) -> str:
    """Why a net has no upright axes, where that is known."""
    mesh = structure.mesh
    if structure.kind == "central":
        return "; axes through one center suit nets like domes only"
    bend = edge_bend(mesh)
    if bend < ASYMPTOTIC_BEND:
        return (
            "; the net follows asymptotic lines (its edges bend by "
            f"{100 * bend:.0f} % of what the normals turn), where axes end up lying in the surface"
            '; [support] kind = "normals" takes the normals and leaves the torsion'
        )
    flat = planarity_percent(mesh)
    if not len(mesh.boundary_loops):
        return (
            "; a closed quad mesh leaves as many conditions as axes have freedom, so that in "
            "general there are none: cut it open, or optimise its vertices"
        )
    if (mesh.face_sizes == 4).all():
        return (
            f" (faces are up to {flat.max():.2g} %, on average {flat.mean():.2g} % from planar); "
            'vertices and axes together can be optimised: goal "torsion-free"'
        )
    return (
        f"; its edges are far from conjugate directions (faces are up to {flat.max():.2g} % and "
        f"on average {flat.mean():.2g} % from planar): optimise the net for planarity first"
    )
