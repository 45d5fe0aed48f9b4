"""Beams: frames and end cuts along the edges. docs/parts.md, Beam."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from ddgfab.errors import DetailError
from ddgfab.mesh import Floats, Mesh
from fabrication.gridshell.detailing.connections.base import Joined
from fabrication.gridshell.detailing.frames import (
    EdgeFrames,
    beam_mark,
    listed,
    node_mark,
    panel_mark,
)
from fabrication.gridshell.detailing.joining import Ends
from fabrication.gridshell.detailing.sections import Sections
from fabrication.gridshell.pieces import Beam
from fabrication.gridshell.project import Project
from fabrication.parts.beam import BeamShape, CombEnd, CrossHole, EndCut, SlotEnd
from fabrication.specs import Check

ENDS: Final = ("stud", "end_plate")
"""Kinds of connections whose ends go together on one bar."""


@dataclass(frozen=True, eq=False)
class Cuts:
    """Where the beams end, in their frames.

    x : (E, 2) of the first and second cut on the x axis [mm]
    stretch : (E, 2) mm along x for one mm across the cut: 1 / cos(mitre)
    """

    x: Floats
    stretch: Floats


def end_cuts(frames: EdgeFrames, cut: Floats, eccentricity: float) -> Cuts:
    """Cuts parallel to the node axes and `cut` (E, 2) away from them [mm].

    The beams are moved up by `eccentricity` [mm].
    """
    stretch = np.hypot(np.hypot(1.0, frames.slope), frames.skew)
    x = frames.slope * eccentricity + cut * stretch * [1.0, -1.0]
    x[:, 1] += frames.length
    return Cuts(x, stretch)


def beam_specs(
    mesh: Mesh,
    frames: EdgeFrames,
    cuts: Cuts,
    ends: Ends,
    sections: Sections,
    project: Project,
) -> tuple[Beam, ...]:
    """A beam for every edge.

    Raises
    ------
    DetailError
        A beam shorter than the project's least length, or than its connections.
    """
    _check_lengths(mesh, frames, cuts, sections, ends, project)
    _check_coped(frames, project)
    _check_mixed(ends)
    placements = np.zeros((mesh.n_edges, 4, 4))
    placements[:, :3, 0], placements[:, :3, 1], placements[:, :3, 2] = frames.x, frames.y, frames.z
    origin = mesh.vertices[mesh.edges[:, 0]] + project.beam.eccentricity_mm * frames.z
    origin += cuts.x[:, :1] * frames.x  # x = 0 where the first cut meets the datum
    lengths = cuts.x[:, 1] - cuts.x[:, 0]
    offsets = ends.cut * cuts.stretch
    placements[:, :3, 3], placements[:, 3, 3] = origin, 1.0
    placements.setflags(write=False)
    coped = project.beam.end == "cope"
    radii = ends.cut.tolist()
    holes = _cross_holes(frames, lengths, sections, ends)
    profiles, of_edge = sections.profiles, sections.of_edge.tolist()
    limit = project.checks.torsion_deg
    glass = project.panel.kind != "none"
    beams = []
    for e, (x, offset, slope, skew, roll, (i, j), faces, length, torsion) in enumerate(
        zip(
            lengths.tolist(),
            offsets.tolist(),
            frames.slope.tolist(),
            frames.skew.tolist(),
            frames.roll.tolist(),
            mesh.edges.tolist(),
            mesh.edge_faces.tolist(),
            frames.length.tolist(),
            frames.torsion.tolist(),
            strict=True,
        )
    ):
        joined = ends.joined[e]
        start, end = (
            EndCut(
                at,
                slope[k],
                radii[e][k] if coped else None,
                skew[k],
                how.end,
                _slot(how),
                how.plate,
                _comb(how, e, k),
                None if how.tongue is None else how.tongue.straps,
            )
            for k, (at, how) in enumerate(zip((0.0, x), joined, strict=True))
        )
        shape = BeamShape(profiles[of_edge[e]], start, end, holes[e])
        left, right = (panel_mark(face) if glass and face >= 0 else None for face in faces)
        degrees = float(np.degrees(torsion))
        beams.append(
            Beam(
                mark=beam_mark(e),
                edge=e,
                vertices=(i, j),
                nodes=(node_mark(i), node_mark(j)),
                panels=(left, right),
                length_axis=length,
                torsion=torsion,
                shape=shape,
                placement=placements[e],
                checks=(Check("torsion_deg", degrees <= limit, degrees, limit),),
                roll=(roll[0], roll[1]),
                offsets=(offset[0], offset[1]),
                joined=joined,
            )
        )
    return tuple(beams)


def _comb(joined: Joined, edge: int, end: int) -> CombEnd | None:
    """The slots for discs at an end of a beam."""
    if joined.comb is None or joined.offsets is None:
        return None
    return replace(joined.comb, offset=float(joined.offsets[edge, end]))


def _check_lengths(
    mesh: Mesh,
    frames: EdgeFrames,
    cuts: Cuts,
    sections: Sections,
    ends: Ends,
    project: Project,
) -> None:
    """Raise where the shortest fibre from cut to cut is below the least length."""
    least = np.minimum(
        *(
            cuts.x[:, 1] - cuts.x[:, 0] + z * (frames.slope[:, 1] - frames.slope[:, 0])
            for z in (sections.low, sections.high)
        )
    ) - 0.5 * sections.width * np.abs(frames.skew[:, 1] - frames.skew[:, 0])
    taken = np.array([[how.end_length for how in both] for both in ends.joined])
    limit = np.maximum(project.beam.min_length_mm, taken.sum(axis=1))
    short = np.flatnonzero(least < limit)
    if len(short):
        raise listed(
            [
                f"beam {beam_mark(e)} between nodes {node_mark(mesh.edges[e, 0])} and "
                f"{node_mark(mesh.edges[e, 1])} (edge {frames.length[e]:.1f} mm) is left "
                f"{least[e]:.1f} mm long"
                for e in short.tolist()
            ],
            f"the least length is {limit[short[0]]:.6g} mm: check units and scale, take smaller "
            f"nodes, or change [beam] min_length_mm"
            + (
                f"; connections take {taken[short[0]].max():.1f} mm at each end"
                * bool(taken[short[0]].any())
            ),
        )


def _check_coped(frames: EdgeFrames, project: Project) -> None:
    """Raise `DetailError` where beams with coped ends are twisted."""
    if project.beam.end == "cope" and frames.twisted:
        worst = int(frames.torsion.argmax())
        raise DetailError(
            f"beam {beam_mark(worst)} has torsion {np.degrees(frames.torsion[worst]):.2f} deg: a "
            'coped end needs the node axis in the plane of the beam\ntake [beam] end = "flat"'
        )


def _check_mixed(ends: Ends) -> None:
    """Raise `DetailError` where the two ends of a beam cannot be made on one bar."""
    bad = [
        f"beam {beam_mark(e)} has {start} at its start and {end} at its end"
        for e, (start, end) in enumerate(map(_shown_kinds, ends.joined))
        if start != end and "welded" not in (start, end) and not {start, end} <= set(ENDS)
    ]
    if bad:
        raise listed(
            bad,
            'one bar can have any kind of [[connection]] at one end and "welded" at the other, or '
            f"{' and '.join(ENDS)}: give both ends of these beams one kind",
        )


def _shown_kinds(joined: tuple[Joined, Joined]) -> tuple[str, str]:
    """The kinds of both ends; tongues between straps are not those in slots."""
    start, end = (
        how.kind + " between straps" * (how.tongue is not None and how.tongue.straps is not None)
        for how in joined
    )
    return start, end


def _slot(joined: Joined) -> SlotEnd | None:
    """The slot that a tongue needs."""
    tongue = joined.tongue
    if tongue is None or tongue.straps is not None:
        return None
    return SlotEnd(tongue.slot, tongue.depth)


def _cross_holes(
    frames: EdgeFrames, lengths: Floats, sections: Sections, ends: Ends
) -> list[tuple[CrossHole, ...]]:
    """The holes of every beam for its tongues, in the middle of its depth, along x."""
    middle = 0.5 * (sections.low + sections.high)
    stretch = np.hypot(1.0, frames.slope)
    found = []
    for e, (start, end) in enumerate(ends.joined):
        z, x = float(middle[e]), float(lengths[e])
        first = frames.slope[e] * z
        holes = []
        if start.tongue is not None:
            holes += [
                CrossHole(float(first[0] + stretch[e, 0] * step), z, start.tongue.hole)
                for step in start.tongue.steps
            ]
        if end.tongue is not None:
            holes += [
                CrossHole(float(x + first[1] - stretch[e, 1] * step), z, end.tongue.hole)
                for step in end.tongue.steps[::-1]
            ]
        found.append(tuple(holes))
    return found
