"""Nodes: cylinders about the axes, with seats, holes and a mark. docs/parts.md, Node element."""

from __future__ import annotations

from typing import Final

import numpy as np

from ddgfab.errors import DetailError
from ddgfab.measures import lean
from ddgfab.mesh import Floats, Mesh
from fabrication.gridshell.detailing.frames import Arms, EdgeFrames, beam_mark, listed, node_mark
from fabrication.gridshell.detailing.radius import NodeSize
from fabrication.gridshell.pieces import Arm, Node
from fabrication.gridshell.project import Project, bolt_diameters
from fabrication.parts.node import NodeShape, RadialHole, ReferenceMark, Seat
from fabrication.specs import Check, Profile
from fabrication.standards.profiles import z_range

STEP_SLACK: Final = 1e-6
"""Part of a height step by which rounding outwards may fall short, so that noise adds no step."""

THREAD: Final = 1.5
"""Depth of a blind bolt hole, in bolt diameters; at least one must be left."""

HOLE_WALL: Final = 3.0
"""Steel [mm] left between the tips of neighbouring blind holes."""

OFF_MIDDLE: Final = 1e-6
"""A profile is centered on its edge when its two halves differ by less [mm]."""

MARK: Final = (3.0, 1.0)
"""Diameter and depth [mm] of the reference mark where there is room."""

MARK_PART: Final = 0.4
"""Greatest part of the land between bore and seat that the mark may take."""


def end_heights(
    frames: EdgeFrames, arms: Arms, size: NodeSize, profile: Profile, project: Project
) -> tuple[Floats, Floats, Floats]:
    """Lowest, middle and highest point (A,) [mm] of each arm's end face along its node axis.

    A point of the beam at distance rho from the axis and z above the vertex lies at
    s rho + z sqrt(1 + s^2) along it, s the slope seen away from the node. Where torsion rolls the
    beam against the axis, its sides count too.

    Raises
    ------
    DetailError
        Bolts in the nodes, but rolled beams that are not centered on their edges.
    """
    if frames.twisted:
        return _rolled_heights(frames, arms, size, profile, project)
    slope = frames.slope[arms.edge, arms.end] * (1 - 2 * arms.end)
    stretch = np.hypot(1.0, slope)
    low, high = (z + project.beam.eccentricity_mm for z in z_range(profile))
    near = size.cut
    if project.beam.end == "cope":  # the corners of a coped end lie nearer to the axis plane
        near = (size.cut**2 - 0.25 * profile.width**2) ** 0.5
    reach = np.stack([slope * near, slope * size.cut])
    return (
        reach.min(axis=0) + low * stretch,
        slope * size.cut + 0.5 * (low + high) * stretch,
        reach.max(axis=0) + high * stretch,
    )


def _rolled_heights(
    frames: EdgeFrames, arms: Arms, size: NodeSize, profile: Profile, project: Project
) -> tuple[Floats, Floats, Floats]:
    """As `end_heights`, for node axes along (lean, sin(roll), cos(roll)) in the beam's frame.

    Their cuts have slope = lean cos(roll) and skew = lean sin(roll).
    """
    at = arms.edge, arms.end
    slope, skew, roll = frames.slope[at], frames.skew[at], frames.roll[at]
    lean = slope * np.cos(roll) + skew * np.sin(roll)
    unit = 1.0 / np.hypot(1.0, lean)
    away = (1 - 2 * arms.end) * lean * size.cut
    by_z = (lean * slope + np.cos(roll)) * unit
    by_y = np.abs(lean * skew + np.sin(roll)) * unit
    low, high = (z + project.beam.eccentricity_mm for z in z_range(profile))
    if project.node.bolt != "none" and abs(low + high) > OFF_MIDDLE:
        raise DetailError(
            f"beams are rolled by torsion about the mesh edges, {0.5 * abs(low + high):.6g} mm "
            f"from the middle of {profile.name}: bolts there miss the node axes\n"
            f"set [beam] eccentricity_mm = {-0.5 * sum(z_range(profile)):g}"
        )
    both = np.stack([low * by_z, high * by_z])
    half = 0.5 * profile.width * by_y
    return away + both.min(axis=0) - half, away + both.mean(axis=0), away + both.max(axis=0) + half


def node_ends(
    mesh: Mesh, arms: Arms, low: Floats, high: Floats, project: Project
) -> tuple[Floats, Floats]:
    """Bottom and top (V,) [mm] of the nodes along their axes; zero for unused vertices."""
    step = project.node.height_step_mm
    bottom, top = np.zeros(mesh.n_vertices), np.zeros(mesh.n_vertices)
    used = np.flatnonzero(np.diff(arms.start))
    lowest = np.minimum.reduceat(low, arms.start[used]) - project.node.margin_mm
    highest = np.maximum.reduceat(high, arms.start[used]) + project.node.top_margin_mm
    bottom[used] = step * np.floor(lowest / step + STEP_SLACK)
    top[used] = step * np.ceil(highest / step - STEP_SLACK)
    return bottom, top


def node_specs(
    mesh: Mesh,
    axes: Floats,
    arms: Arms,
    size: NodeSize,
    ends: tuple[Floats, Floats],
    middle: Floats,
    profile: Profile,
    project: Project,
) -> tuple[Node, ...]:
    """A node for every vertex that faces use.

    Raises
    ------
    DetailError
        Bolts wider than the seat, or so near each other that their holes meet.
    """
    depths = _hole_depths(arms, size, profile, project)
    bolt = bolt_diameters(project.node.bolt)
    leans = lean(mesh, axes).tolist()
    least = project.checks.min_angle_deg
    closest = np.degrees(arms.gap).tolist()
    limit = project.support.lean_limit_deg
    mark = _mark(size)
    flat = project.beam.end == "flat"
    placements = np.zeros((mesh.n_vertices, 4, 4))
    placements[:, :3, 0], placements[:, :3, 2] = arms.x_axis, axes
    placements[:, :3, 1] = np.cross(axes, arms.x_axis)
    placements[:, :3, 3], placements[:, 3, 3] = mesh.vertices, 1.0
    placements.setflags(write=False)
    bottom, top = ends[0].tolist(), ends[1].tolist()
    azimuths, elevations = arms.azimuth.tolist(), arms.elevation.tolist()
    edges, heights, starts = arms.edge.tolist(), middle.tolist(), arms.start.tolist()
    nodes = []
    for v in np.flatnonzero(np.diff(arms.start)).tolist():
        own = range(starts[v], starts[v + 1])
        shape = NodeShape(
            size.radius,
            size.bore,
            bottom[v],
            top[v],
            tuple(Seat(azimuths[k], size.seat, size.width) for k in own) if flat else (),
            tuple(RadialHole(azimuths[k], heights[k], bolt[1], depths[k]) for k in own)
            if bolt
            else (),
            mark,
        )
        degrees, angle = float(np.degrees(leans[v])), min(closest[k] for k in own)
        nodes.append(
            Node(
                mark=node_mark(v),
                vertex=v,
                position=mesh.vertices[v],
                axis=axes[v],
                lean=leans[v],
                arms=tuple(
                    Arm(edges[k], beam_mark(edges[k]), azimuths[k], elevations[k]) for k in own
                ),
                shape=shape,
                placement=placements[v],
                checks=(
                    Check("lean_deg", degrees <= limit, degrees, limit),
                    Check("least_angle_deg", angle >= least, angle, least),
                ),
            )
        )
    return tuple(nodes)


def _mark(size: NodeSize) -> ReferenceMark:
    land = size.seat - size.bore
    diameter = min(MARK[0], MARK_PART * land)
    return ReferenceMark(size.bore + 0.5 * land, diameter, MARK[1])


def _hole_depths(
    arms: Arms, size: NodeSize, profile: Profile, project: Project
) -> list[float | None]:
    """Depth (A,) of each arm's radial hole; None through a tube's wall.

    Holes of diameter d at azimuth difference phi meet at (d/2) / tan(phi/2) along their axes.
    """
    bolt = bolt_diameters(project.node.bolt)
    if bolt is None or size.bore > 0:
        if bolt and project.beam.end == "flat" and bolt[1] >= profile.width:
            raise _too_wide(bolt[1], profile, project)
        return [None] * len(arms.node)
    nominal, diameter = bolt
    if project.beam.end == "flat" and diameter >= profile.width:
        raise _too_wide(diameter, profile, project)
    before = np.empty_like(arms.gap)
    before[arms.following()] = arms.gap
    half_angle = 0.5 * np.minimum(np.minimum(arms.gap, before), np.pi)
    room = size.seat - HOLE_WALL - 0.5 * diameter / np.tan(half_angle)
    shallow = np.flatnonzero(room < nominal)
    if len(shallow):
        raise listed(
            [
                f"node {node_mark(arms.node[k])}: the hole for beam {beam_mark(arms.edge[k])} "
                f"can be {room[k]:.1f} mm deep"
                for k in shallow.tolist()
            ],
            f"{project.node.bolt} needs {nominal:g} mm: take a larger [node] diameter_mm, a "
            f'smaller bolt, or kind = "tube"',
        )
    return [float(depth) for depth in np.minimum(room, THREAD * nominal)]


def _too_wide(diameter: float, profile: Profile, project: Project) -> DetailError:
    return DetailError(
        f"the hole of {diameter:g} mm for [node] bolt {project.node.bolt} is wider than the seats "
        f"({profile.width:g} mm, the width of {profile.name}): take a smaller bolt or a wider "
        f"profile"
    )
