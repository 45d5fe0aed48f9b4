"""Beams: frames and end cuts along the edges. docs/parts.md, Beam."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ddgfab.errors import DetailError
from ddgfab.mesh import Floats, Mesh
from fabrication.gridshell.detailing.frames import (
    EdgeFrames,
    beam_mark,
    listed,
    node_mark,
    panel_mark,
)
from fabrication.gridshell.detailing.nodes.base import NodeSize
from fabrication.gridshell.pieces import Beam
from fabrication.gridshell.project import Project, bolt_diameters
from fabrication.parts.beam import BeamShape, CrossHole, EndCut
from fabrication.specs import Check, Profile
from fabrication.standards import bolt_end_distance, bolt_least_distance
from fabrication.standards.profiles import z_range


@dataclass(frozen=True, eq=False)
class Cuts:
    """Where the beams end, in their frames.

    x : (E, 2) of the first and second cut on the x axis [mm]
    stretch : (E, 2) mm along x for one mm across the cut: 1 / cos(mitre)
    """

    x: Floats
    stretch: Floats


def end_cuts(frames: EdgeFrames, size: NodeSize, eccentricity: float) -> Cuts:
    """Cuts parallel to the node axes and `size.cut` away from them.

    The beams are moved up by `eccentricity` [mm].
    """
    stretch = np.hypot(np.hypot(1.0, frames.slope), frames.skew)
    x = frames.slope * eccentricity + size.cut * stretch * [1.0, -1.0]
    x[:, 1] += frames.length
    return Cuts(x, stretch)


def beam_specs(
    mesh: Mesh, frames: EdgeFrames, cuts: Cuts, size: NodeSize, profile: Profile, project: Project
) -> tuple[Beam, ...]:
    """A beam for every edge.

    Raises
    ------
    DetailError
        A beam shorter than the project's least length, or too shallow or short for its bolts.
    """
    holes = _cross_holes(frames, cuts, profile, project)
    _check_lengths(mesh, frames, cuts, profile, project)
    _check_coped(frames, project)
    placements = np.zeros((mesh.n_edges, 4, 4))
    placements[:, :3, 0], placements[:, :3, 1], placements[:, :3, 2] = frames.x, frames.y, frames.z
    origin = mesh.vertices[mesh.edges[:, 0]] + project.beam.eccentricity_mm * frames.z
    placements[:, :3, 3], placements[:, 3, 3] = origin, 1.0
    placements.setflags(write=False)
    radius = size.cut if project.beam.end == "cope" else None
    limit = project.checks.torsion_deg
    glass = project.panel.kind != "none"
    beams = []
    for e, (x, slope, skew, roll, (i, j), faces, length, torsion) in enumerate(
        zip(
            cuts.x.tolist(),
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
        shape = BeamShape(
            profile,
            EndCut(x[0], slope[0], radius, skew[0]),
            EndCut(x[1], slope[1], radius, skew[1]),
            holes[e] if holes else (),
        )
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
            )
        )
    return tuple(beams)


def _check_lengths(
    mesh: Mesh, frames: EdgeFrames, cuts: Cuts, profile: Profile, project: Project
) -> None:
    """Raise where the shortest fibre from cut to cut is below the least length."""
    low, high = z_range(profile)
    least = np.minimum(
        *(
            cuts.x[:, 1] - cuts.x[:, 0] + z * (frames.slope[:, 1] - frames.slope[:, 0])
            for z in (low, high)
        )
    ) - 0.5 * profile.width * np.abs(frames.skew[:, 1] - frames.skew[:, 0])
    limit = project.beam.min_length_mm
    if project.beam.bolt != "none":
        reach = bolt_end_distance(project.beam.bolt) * cuts.stretch
        limit = max(limit, 2 * float((reach + 0.5 * profile.width * np.abs(frames.skew)).max()))
    short = np.flatnonzero(least < limit)
    if len(short):
        raise listed(
            [
                f"beam {beam_mark(e)} between nodes {node_mark(mesh.edges[e, 0])} and "
                f"{node_mark(mesh.edges[e, 1])} (edge {frames.length[e]:.1f} mm) is left "
                f"{least[e]:.1f} mm long"
                for e in short.tolist()
            ],
            f"the least length is {limit:.6g} mm: check units and scale, take smaller nodes, or "
            f"change [beam] min_length_mm",
        )


def _check_coped(frames: EdgeFrames, project: Project) -> None:
    """Raise `DetailError` where beams with coped ends are twisted."""
    if project.beam.end == "cope" and frames.twisted:
        worst = int(frames.torsion.argmax())
        raise DetailError(
            f"beam {beam_mark(worst)} has torsion {np.degrees(frames.torsion[worst]):.2f} deg: a "
            'coped end needs the node axis in the plane of the beam\ntake [beam] end = "flat"'
        )


def _cross_holes(
    frames: EdgeFrames, cuts: Cuts, profile: Profile, project: Project
) -> list[tuple[CrossHole, ...]]:
    """A hole near each end at half depth, the bolt's end distance from the cut; or nothing."""
    bolt = bolt_diameters(project.beam.bolt)
    if bolt is None:
        return []
    diameter = bolt[1]
    low, high = z_range(profile)
    needed = 2 * bolt_least_distance(project.beam.bolt)
    if high - low < needed:
        raise DetailError(
            f"profile {profile.name} is {high - low:.6g} mm deep; a hole of {diameter:g} mm for "
            f"{project.beam.bolt} needs {needed:.6g} mm: take a smaller [beam] bolt"
        )
    z = 0.5 * (low + high)
    distance = bolt_end_distance(project.beam.bolt) * cuts.stretch
    distance = (distance + 0.5 * profile.width * np.abs(frames.skew)) * [1.0, -1.0]
    x = cuts.x + z * frames.slope + distance
    return [(CrossHole(a, z, diameter), CrossHole(b, z, diameter)) for a, b in x.tolist()]
