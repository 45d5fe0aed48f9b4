"""Panels: the faces' polygons, offset, with joints measured from pi(e). docs/parts.md, Panel."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ddgfab.measures import dihedral_angles, planarity, planarity_percent
from ddgfab.mesh import Floats, Mesh, unit
from fabrication.gridshell.detailing.frames import NAMED, EdgeFrames, listed, panel_mark
from fabrication.gridshell.pieces import Panel, Side
from fabrication.gridshell.project import Project
from fabrication.parts.panel import PanelShape
from fabrication.solids.polygon import least_rectangle
from fabrication.specs import Check
from fabrication.standards.profiles import first_crossing

LEAST_SIDE: Final = 1.0
"""Least side of a pane [mm]; below it a joint has used the pane up."""

STRAIGHT: Final = 1e-4
"""Sides that turn by less than this (sine of the angle) share one line."""

ALIGNED: Final = 0.01
"""How far apart [mm] the lines of two sides in a row may be where the corner is straight."""

FLATTEST_SIDE: Final = 0.1
"""Least sine of the angle between pi(e) and a pane; below it the side is not a side."""


@dataclass(frozen=True, eq=False)
class Planes:
    """Planes of the faces and frames in them.

    origin : (F, 3) mean of the corners; x, y, z : (F, 3), z the outward unit normal, x along the
    first side
    """

    origin: Floats
    x: Floats
    y: Floats
    z: Floats


def face_planes(mesh: Mesh) -> Planes:
    """Planes of least squares of all faces."""
    z = np.empty((mesh.n_faces, 3))
    for size in np.unique(mesh.face_sizes).tolist():
        faces = np.flatnonzero(mesh.face_sizes == size)
        corners = mesh.corners[mesh.face_start[faces, None] + np.arange(size)]
        points = mesh.vertices[corners] - mesh.face_centers[faces, None]
        z[faces] = np.linalg.svd(points, full_matrices=False)[2][:, -1]
    z *= np.where(np.einsum("fi,fi->f", z, mesh.face_normals) < 0, -1.0, 1.0)[:, None]
    first = mesh.face_start[:-1]
    side = mesh.vertices[mesh.corners[first + 1]] - mesh.vertices[mesh.corners[first]]
    x = unit(side - np.einsum("fi,fi->f", side, z)[:, None] * z)
    return Planes(mesh.face_centers, x, np.cross(z, x), z)


def outward_normals(mesh: Mesh, frames: EdgeFrames) -> Floats:
    """(C, 3) unit normal of pi(e) of the side at each corner, out of the face."""
    edge = mesh.corner_edge
    left = mesh.edge_faces[edge, 0] == mesh.corner_face
    return np.where(left[:, None], -frames.y[edge], frames.y[edge])


def polygons(
    mesh: Mesh, planes: Planes, frames: EdgeFrames, offset: float, project: Project
) -> tuple[Floats, Floats]:
    """Corners (C, 2) of the inner and outer surface of all panes, in the frames of `planes`.

    Raises
    ------
    DetailError
        A joint as wide as the pane, a side almost in the pane's plane, corners that do not fit.
    """
    settings = project.panel
    face = mesh.corner_face
    normal = outward_normals(mesh, frames)
    z = planes.z[face]
    inside = planes.origin[face] + offset * z - mesh.vertices[mesh.corners]
    line = np.stack(
        [
            np.einsum("ci,ci->c", normal, planes.x[face]),
            np.einsum("ci,ci->c", normal, planes.y[face]),
        ],
        axis=1,
    )
    slant = np.linalg.norm(line, axis=1)
    _check(
        slant < FLATTEST_SIDE,
        mesh,
        lambda c: (
            f"the side along edge {mesh.corner_edge[c]} of panel {panel_mark(int(face[c]))} "
            f"meets the pane at {np.degrees(np.arcsin(slant[c])):.1f} deg"
        ),
        "the node axes lie down there: no pane can be made",
    )
    # The side's line {p : line . p = at(z)} keeps half the gap from pi(e) at the height z.
    at_inner = -0.5 * settings.gap_mm - np.einsum("ci,ci->c", inside, normal)
    at_outer = at_inner - settings.thickness_mm * np.einsum("ci,ci->c", z, normal)
    line, at_inner, at_outer = line / slant[:, None], at_inner / slant, at_outer / slant
    if settings.edge == "mitred":
        return _corners(mesh, line, at_inner, project), _corners(mesh, line, at_outer, project)
    at = {"inner": at_inner, "outer": at_outer, "tightest": np.minimum(at_inner, at_outer)}
    both = _corners(mesh, line, at[settings.gap_at], project)
    return both, both


def _corners(mesh: Mesh, line: Floats, at: Floats, project: Project) -> Floats:
    """Corners (C, 2) where each side's line meets the one before, checked."""
    back, at_back = line[mesh.corner_previous], at[mesh.corner_previous]
    sine = back[:, 0] * line[:, 1] - back[:, 1] * line[:, 0]
    straight = np.abs(sine) < STRAIGHT
    safe = np.where(straight, 1.0, sine)
    meet = np.stack(
        [
            (at_back * line[:, 1] - at * back[:, 1]) / safe,
            (at * back[:, 0] - at_back * line[:, 0]) / safe,
        ],
        axis=1,
    )
    if straight.any():
        meet[straight] = _straight_corners(mesh, line, at, at - at_back, straight, meet)
    length = np.einsum(
        "ci,ci->c", meet[mesh.corner_next] - meet, np.stack([-line[:, 1], line[:, 0]], axis=1)
    )
    face = mesh.corner_face
    _check(
        length < LEAST_SIDE,
        mesh,
        lambda c: (
            f"panel {panel_mark(int(face[c]))}: a gap of {project.panel.gap_mm:g} mm leaves "
            f"nothing of its side along edge {mesh.corner_edge[c]} "
            f"({mesh.edge_lengths[mesh.corner_edge[c]]:.1f} mm)"
        ),
        "take a smaller [panel] gap_mm, or check units and scale",
    )
    for f in np.unique(face[sine < 0]).tolist():
        own = meet[mesh.face_start[f] : mesh.face_start[f + 1]]
        crossing = first_crossing(own)
        if crossing is not None:
            raise listed(
                [f"panel {panel_mark(f)}: its sides {crossing[0]} and {crossing[1]} cross"],
                f"take a smaller [panel] gap_mm than {project.panel.gap_mm:g}",
            )
    _check_corner_radius(mesh, meet, length, project)
    return meet


def _straight_corners(
    mesh: Mesh, line: Floats, at: Floats, step: Floats, straight: NDArray[np.bool_], meet: Floats
) -> Floats:
    """Corners between sides in one line: halfway along from the corner before to the one after."""
    face = mesh.corner_face
    _check(
        straight & (np.abs(step) > ALIGNED),
        mesh,
        lambda c: (
            f"panel {panel_mark(int(face[c]))} has a straight corner at vertex "
            f"{mesh.corners[c]}, but its sides there are {abs(step[c]):.2f} mm apart"
        ),
        "give the two sides one plane, or merge their edges",
    )
    which = np.flatnonzero(straight)
    around = 0.5 * (meet[mesh.corner_previous[which]] + meet[mesh.corner_next[which]])
    away = at[which] - np.einsum("ci,ci->c", around, line[which])
    points: Floats = around + away[:, None] * line[which]
    return points


def _check_corner_radius(mesh: Mesh, meet: Floats, length: Floats, project: Project) -> None:
    radius = project.panel.corner_radius_mm
    if radius == 0:
        return
    ahead = meet[mesh.corner_next] - meet
    back = meet - meet[mesh.corner_previous]
    cross = back[:, 0] * ahead[:, 1] - back[:, 1] * ahead[:, 0]
    turn = np.abs(np.arctan2(cross, np.einsum("ci,ci->c", back, ahead)))
    used = radius * np.tan(0.5 * turn)
    left = length - used - used[mesh.corner_next]
    _check(
        left < LEAST_SIDE,
        mesh,
        lambda c: (
            f"panel {panel_mark(int(mesh.corner_face[c]))}: corners of radius {radius:g} mm use "
            f"{length[c] - left[c]:.1f} of the {length[c]:.1f} mm along edge {mesh.corner_edge[c]}"
        ),
        "take a smaller [panel] corner_radius_mm",
    )


def _check(bad: NDArray[np.bool_], mesh: Mesh, message: Callable[[int], str], advice: str) -> None:
    """Raise one error for all bad corners (C,), at most one of each panel."""
    corners = np.flatnonzero(bad)
    if len(corners):
        first = corners[np.unique(mesh.corner_face[corners], return_index=True)[1]]
        raise listed([message(c) for c in first.tolist()], advice)


def panel_specs(
    mesh: Mesh, planes: Planes, frames: EdgeFrames, offset: float, project: Project
) -> tuple[Panel, ...]:
    """A panel for every face, its inner surface `offset` [mm] above the face's plane.

    Raises
    ------
    DetailError
        As `polygons`.
    """
    inner, outer = polygons(mesh, planes, frames, offset, project)
    placements = np.zeros((mesh.n_faces, 4, 4))
    placements[:, :3, 0], placements[:, :3, 1], placements[:, :3, 2] = planes.x, planes.y, planes.z
    placements[:, :3, 3], placements[:, 3, 3] = planes.origin + offset * planes.z, 1.0
    for array in (inner, outer, placements):
        array.setflags(write=False)
    checks = _checks(mesh, inner, outer, project)
    sides = _sides(mesh)
    heights = planarity(mesh).tolist()
    percents = planarity_percent(mesh).tolist()
    settings, limits = project.panel, project.checks
    start = mesh.face_start.tolist()
    panels = []
    for f in range(mesh.n_faces):
        own = slice(start[f], start[f + 1])
        percent = percents[f]
        kind = (
            "flat"
            if percent <= limits.flat_percent
            else "cold-bend"
            if percent <= limits.bend_percent
            else "reject"
        )
        panels.append(
            Panel(
                mark=panel_mark(f),
                face=f,
                planarity_mm=heights[f],
                planarity_percent=percent,
                planarity_class=kind,
                sides=sides[own],
                shape=PanelShape(
                    settings.thickness_mm, inner[own], outer[own], settings.corner_radius_mm
                ),
                placement=placements[f],
                checks=(*_planarity_checks(heights[f], percent, project), checks[f]),
            )
        )
    return tuple(panels)


def _planarity_checks(height: float, percent: float, project: Project) -> tuple[Check, ...]:
    limits = project.checks
    limit = limits.flat_percent if limits.accept == "flat" else limits.bend_percent
    first = Check("planarity_percent", percent <= limit, percent, limit)
    if limits.planarity_mm is None:
        return (first,)
    second = Check("planarity_mm", height <= limits.planarity_mm, height, limits.planarity_mm)
    return first, second


def not_flat(mesh: Mesh, panels: Sequence[Panel]) -> str | None:
    """What the planarity of the panels beyond their limit means in mm, worst first; or None."""
    failed = [
        panel
        for panel in panels
        if not all(check.passed for check in panel.checks if check.name.startswith("planarity"))
    ]
    if not failed:
        return None
    failed.sort(key=lambda panel: (-panel.planarity_percent, panel.face))
    named = [
        f"{panel.mark} {panel.planarity_percent:.2f} % is {panel.planarity_mm:.1f} mm from its "
        f"plane, a corner lift of {corner_lift(mesh, panel.face):.1f} mm ({panel.planarity_class})"
        for panel in failed[:NAMED]
    ]
    bent = sum(panel.planarity_class == "cold-bend" for panel in failed)
    reject = sum(panel.planarity_class == "reject" for panel in failed)
    return (
        f"{len(failed)} panels are not flat, {bent} of them for cold bending, {reject} beyond "
        f"that; their plane panes are drawn for study: {'; '.join(named)}"
    )


def corner_lift(mesh: Mesh, face: int) -> float:
    """Greatest distance [mm] of a corner from the plane of the three before it."""
    p = mesh.vertices[mesh.face(face)]
    a, b, c = (np.roll(p, k, axis=0) for k in (3, 2, 1))
    return float(np.abs(np.einsum("ki,ki->k", p - a, unit(np.cross(b - a, c - a)))).max())


def _checks(mesh: Mesh, inner: Floats, outer: Floats, project: Project) -> list[Check]:
    """The size check of every panel: its least rectangle against the greatest stock."""
    small, large = sorted(project.panel.max_size_mm)
    sides = np.empty((mesh.n_faces, 2))
    for size in np.unique(mesh.face_sizes).tolist():
        faces = np.flatnonzero(mesh.face_sizes == size)
        own = mesh.face_start[faces, None] + np.arange(size)
        sides[faces] = least_rectangle(np.concatenate([inner[own], outer[own]], axis=1))
    limit = f"{small:g} x {large:g}"
    return [
        Check("size_mm", a <= small and b <= large, f"{a:.1f} x {b:.1f}", limit)
        for a, b in sides.tolist()
    ]


def _sides(mesh: Mesh) -> tuple[Side, ...]:
    """The sides of all panels, corner by corner."""
    edge = mesh.corner_edge
    faces = mesh.edge_faces[edge]
    other = np.where(faces[:, 0] == mesh.corner_face, faces[:, 1], faces[:, 0])
    dihedral = dihedral_angles(mesh)[edge]
    return tuple(
        Side(e, panel_mark(f) if f >= 0 else None, d if f >= 0 else 0.0)
        for e, f, d in zip(edge.tolist(), other.tolist(), dihedral.tolist(), strict=True)
    )
