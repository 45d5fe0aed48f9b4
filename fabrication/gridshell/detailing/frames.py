"""Frames of all beams and arms of all nodes as arrays: what every rule of detailing reads."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, Protocol

import numpy as np
from numpy.typing import NDArray

from ddgfab.errors import DetailError
from ddgfab.measures import torsion
from ddgfab.mesh import Floats, Ints, Mesh, unit
from fabrication.parts.beam import BEAM
from fabrication.parts.node import NODE
from fabrication.parts.panel import PANEL

STEEPEST: Final = np.radians(75.0)
"""A beam that leaves the plane across a node axis by more [rad] cannot be cut to meet the node."""

TORSION_IGNORED: Final = np.radians(0.1)
"""Torsion [rad] that optimized structures may leave: less than sawing and welding are exact to."""

SQUARE: Final = 1e-9
"""A cut of a twisted beam with less slope is square: on K-nets axes are perpendicular to edges."""

NAMED: Final = 5
"""How many parts an error names before it only counts."""


class Axes(Protocol):
    """What detailing needs of a support structure: its mesh and (V, 3) unit node axes, upwards."""

    @property
    def mesh(self) -> Mesh:
        """The net."""

    @property
    def axes(self) -> Floats:
        """(V, 3) unit node axes."""


def beam_mark(edge: int) -> str:
    """Piece mark of the beam of a mesh edge."""
    return BEAM.mark_of(edge)


def node_mark(vertex: int) -> str:
    """Piece mark of the node of a mesh vertex."""
    return NODE.mark_of(vertex)


def panel_mark(face: int) -> str:
    """Piece mark of the panel of a mesh face."""
    return PANEL.mark_of(face)


def listed(problems: Sequence[str], advice: str) -> DetailError:
    """One error that names the first few problems, counts the rest, and ends with advice."""
    shown = "; ".join(problems[:NAMED])
    more = f"; and {len(problems) - NAMED} more" if len(problems) > NAMED else ""
    return DetailError(f"{shown}{more}\n{advice}")


@dataclass(frozen=True, eq=False)
class EdgeFrames:
    """Orthonormal frames of the edges: x along, z up in pi(e), y = z x x into the left face.

    x, y, z : (E, 3)
    length : (E,) edge lengths [mm]
    slope, skew : (E, 2) flat cuts at the first and second vertex: planes (slope z + skew y, y, z)
        that hold the node axis; without torsion this runs along (slope, 0, 1) and skew is 0
    roll : (E, 2) angle [rad] about x from z to the node axes; 0 without torsion
    torsion : (E,) angle [rad] between the planes span(e, a_i) and span(e, a_j)
    """

    x: Floats
    y: Floats
    z: Floats
    length: Floats
    slope: Floats
    skew: Floats
    roll: Floats
    torsion: Floats

    @property
    def twisted(self) -> bool:
        """Whether there is torsion that cuts and nodes must reckon with."""
        return bool(self.roll.any())


def edge_frames(mesh: Mesh, axes: Floats) -> EdgeFrames:
    """Frames of all edges; pi(e) holds the edge and bisects its axes as seen along it.

    Torsion of the structure up to `TORSION_IGNORED` counts as none. Beyond it every cut takes its
    own axis: the plane across the part of the edge that is perpendicular to the axis.

    Raises
    ------
    DetailError
        An edge steeper than 75 deg against the plane across a node axis, or axes on two sides.
    """
    x = unit(mesh.edge_vectors)
    ends = axes[mesh.edges]  # (E, 2, 3)
    across = ends - np.einsum("eki,ei->ek", ends, x)[..., None] * x[:, None]
    sides = unit(across)
    z = unit(sides.sum(axis=1))
    y = np.cross(z, x)
    along = np.einsum("eki,ei->ek", ends, x)
    up = np.einsum("eki,ei->ek", ends, z)
    steep = np.arctan2(np.abs(along), up)  # beyond a right angle where the axis points down
    steep[np.einsum("ei,ei->e", sides[:, 0], sides[:, 1]) <= 0] = np.pi
    bad = np.argwhere(steep > STEEPEST)
    if len(bad):
        raise listed(
            [
                f"beam {beam_mark(e)} meets the plane across the axis of node "
                f"{node_mark(mesh.edges[e, k])} at {np.degrees(steep[e, k]):.1f} deg"
                for e, k in bad.tolist()
            ],
            f"at most {np.degrees(STEEPEST):.0f} deg can be cut: the node axes lean too far",
        )
    slope, skew, roll = along / up, np.zeros_like(up), np.zeros_like(up)
    angle = torsion(mesh, axes)
    if angle.max() > TORSION_IGNORED:
        side = np.einsum("eki,ei->ek", ends, y)
        rest = up * up + side * side  # the square of the axis' part across the edge
        slope, skew, roll = along * up / rest, along * side / rest, np.arctan2(side, up)
        skew = np.where(np.abs(skew) < SQUARE, 0.0, skew)
        slope = np.where(np.abs(slope) < SQUARE, 0.0, slope)
    return EdgeFrames(x, y, z, mesh.edge_lengths, slope, skew, roll, angle)


@dataclass(frozen=True, eq=False)
class Arms:
    """Arms of all nodes, node after node, counterclockwise about the axis from the first.

    start : (V + 1,) first arm of each node; a vertex without faces has none
    node, edge : (A,) vertex and edge of each arm
    end : (A,) 0 where the edge begins at the node, 1 where it ends there
    azimuth : (A,) angle [rad] about the axis from the node's first arm, 0..2 pi
    elevation : (A,) angle [rad] above the plane across the axis
    gap : (A,) azimuth difference [rad] to the next arm; 2 pi in all at each node
    x_axis : (V, 3) unit direction of azimuth 0
    """

    start: Ints
    node: Ints
    edge: Ints
    end: Ints
    azimuth: Floats
    elevation: Floats
    gap: Floats
    x_axis: Floats

    def of(self, nodes: NDArray[np.bool_]) -> tuple[Arms, Ints]:
        """Arms of some nodes (V,), and their numbers here."""
        at = np.flatnonzero(nodes[self.node])
        start = np.concatenate([[0], np.cumsum(np.where(nodes, np.diff(self.start), 0))])
        return self._some(at, start), at

    def only(self, at: Ints) -> Arms:
        """Some of the arms, for looking at each alone: `gap` stays that to their neighbours."""
        count = np.bincount(self.node[at], minlength=len(self.start) - 1)
        return self._some(at, np.concatenate([[0], np.cumsum(count)]))

    def _some(self, at: Ints, start: Ints) -> Arms:
        return Arms(
            start,
            self.node[at],
            self.edge[at],
            self.end[at],
            self.azimuth[at],
            self.elevation[at],
            self.gap[at],
            self.x_axis,
        )

    def following(self) -> Ints:
        """(A,) the next arm of the same node."""
        after = np.arange(1, len(self.node) + 1)
        used = np.diff(self.start) > 0
        after[self.start[1:][used] - 1] = self.start[:-1][used]
        return after


def arms_of(mesh: Mesh, axes: Floats, frames: EdgeFrames) -> Arms:
    """Arms of every vertex; the first is the first edge of its star."""
    edge = mesh.star_edges
    node = np.repeat(np.arange(mesh.n_vertices), np.diff(mesh.star_start))
    end = (mesh.edges[edge, 0] != node).astype(np.int64)
    direction = frames.x[edge] * (1 - 2 * end)[:, None]
    axis = axes[node]
    height = np.einsum("ai,ai->a", direction, axis)
    flat = direction - height[:, None] * axis
    first = mesh.star_start[node]
    x = unit(flat)[first]
    y = np.cross(axis, x)
    azimuth = np.arctan2(np.einsum("ai,ai->a", flat, y), np.einsum("ai,ai->a", flat, x))
    azimuth = np.where(azimuth < 0, azimuth + 2 * np.pi, azimuth)
    azimuth[first] = 0.0
    order = np.lexsort((azimuth, node))
    edge, end, azimuth, height = edge[order], end[order], azimuth[order], height[order]
    x_axis = np.zeros_like(axes)
    x_axis[node] = x
    elevation = np.arcsin(np.clip(height, -1.0, 1.0))
    arms = Arms(mesh.star_start, node, edge, end, azimuth, elevation, azimuth, x_axis)
    after = arms.following()
    gap = azimuth[after] - azimuth
    gap[after <= np.arange(len(after))] += 2 * np.pi
    return Arms(mesh.star_start, node, edge, end, azimuth, elevation, gap, x_axis)
