"""Nodes place by place: their size, and how the beams of each profile are joined to them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ddgfab.errors import DetailError
from ddgfab.mesh import Floats, Ints, Mesh
from fabrication.gridshell.detailing.arm_room import arm_width
from fabrication.gridshell.detailing.connections import registry as connections
from fabrication.gridshell.detailing.connections.base import Connection, Joined
from fabrication.gridshell.detailing.connections.bolts import MARK, bolt_specs
from fabrication.gridshell.detailing.frames import Arms, EdgeFrames, node_mark
from fabrication.gridshell.detailing.nodes.base import Joints, NodeSize
from fabrication.gridshell.detailing.nodes.heights import end_heights, node_ends
from fabrication.gridshell.detailing.nodes.pieces import node_specs
from fabrication.gridshell.detailing.nodes.registry import find
from fabrication.gridshell.detailing.sections import Sections
from fabrication.gridshell.pieces import Bolt, Node
from fabrication.gridshell.project import Project
from fabrication.parts.node.shape import Upright
from fabrication.specs import Profile


@dataclass(frozen=True, eq=False)
class Place:
    """Nodes of one [[node]] and one [[connection]] table, or of none, with the arms of their beams.

    at : their arms in the structure's
    joints : all of these arms
    size : dimensions that these nodes share
    rule : its [[connection]] rule, counted from 1; 0 without
    each : for every profile of their beams the joints, how they are joined, and which of the
        arms (A,) these are
    """

    at: Ints
    joints: Joints
    size: NodeSize
    rule: int
    each: tuple[tuple[Joints, Joined, Ints], ...]

    @property
    def joined(self) -> list[Joined]:
        """How each arm is joined."""
        found = [self.each[0][1]] * len(self.at)
        for _, joined, own in self.each:
            for k in own.tolist():
                found[k] = joined
        return found


@dataclass(frozen=True, eq=False)
class Fitted:
    """The nodes by vertex, the bolts by node and arm, and where the nodes end.

    bottoms, tops, radii : (V,) of the nodes [mm]
    lows, cuts : (V,) lowest point of the beams' ends along the axis, and distance of their cuts
    """

    nodes: tuple[Node, ...]
    bolts: tuple[Bolt, ...]
    bottoms: Floats
    tops: Floats
    radii: Floats
    lows: Floats
    cuts: Floats


@dataclass(frozen=True, eq=False)
class Ends:
    """Where beams end at their nodes.

    cut, seat : (E, 2) distances [mm] from the node axes
    joined : how each end is joined, by edge and end
    """

    cut: Floats
    joined: tuple[tuple[Joined, Joined], ...]


def joined_places(
    frames: EdgeFrames,
    arms: Arms,
    sections: Sections,
    project: Project,
    rules: tuple[Ints, Ints],
) -> tuple[Place, ...]:
    """The nodes of each pair of rules sized, and joined to their beams.

    Parameters
    ----------
    rules : (V,) the [[node]] rule of each vertex, and its [[connection]] rule; 0 without

    Raises
    ------
    DetailError
        What nodes and connections raise.
    """
    of_node, of_joint = rules
    places = []
    for first, second in np.unique(np.stack(rules)[:, arms.node], axis=1).T.tolist():
        node, joint = project.node.of_rule(first), project.connection.of_rule(second)
        own_project = project.model_copy(update={"node": node, "connection": joint})
        connection = connections.find(joint.kind).of(own_project)
        own, at = arms.of((of_node == first) & (of_joint == second))
        _check_kinds(node.kind, joint.kind, int(own.node[0]))
        profile_of = sections.of_edge[own.edge]
        numbers = np.unique(profile_of).tolist()
        if len(numbers) > 1 and connection.discs(sections.profiles[numbers[0]]) is not None:
            raise DetailError(
                f'[connection] kind = "{joint.kind}": the discs of a node have one '
                f"distance, but beams {sections.profiles[numbers[0]].name} and "
                f"{sections.profiles[numbers[1]].name} meet at {node_mark(_mixed(own, profile_of))}"
                "\ntake one [beam] profile"
            )
        width = max(
            max(arm_width(frames, profile, project), connection.arm_width(profile))
            for profile in (sections.profiles[k] for k in numbers)
        )
        each = []
        for k in numbers:
            mine = np.flatnonzero(profile_of == k)
            ends = np.zeros((len(frames.length), 2), dtype=bool)
            ends[own.edge[mine], own.end[mine]] = True
            joints = Joints(
                frames, own, width, sections.profiles[k], own_project, connection, sections, ends
            )
            connection.check(joints.only(mine))
            each.append((joints, mine))
        _check_tongues(connection, [sections.profiles[k] for k in numbers])
        kind = find(node.kind).joined_by(connection, each[0][0].profile)
        size = max((kind.fit(joints) for joints, _ in each), key=lambda found: found.radius)
        parts = tuple((joints, connection.fit(joints, size), mine) for joints, mine in each)
        places.append(Place(at, each[0][0], size, second, parts))
    return tuple(places)


def _check_kinds(node: str, connection: str, vertex: int) -> None:
    """Raise where kinds of node and connection are for others; vertex: one of the nodes."""
    needed, wanted = connections.find(connection).nodes, find(node).only_with
    where = f"node {node_mark(vertex)} (and others): "
    if needed and node not in needed:
        kinds = " or ".join(f'"{kind}"' for kind in needed)
        raise DetailError(
            f'{where}[connection] kind = "{connection}" needs [node] kind = {kinds}, not '
            f'"{node}": it joins beams to their plates\ntake [node] kind = {kinds}, or '
            f'[connection] kind = "{wanted or "welded"}"'
        )
    if wanted not in ("", connection):
        raise DetailError(
            f'{where}[node] kind = "{node}" is for [connection] kind = "{wanted}", not '
            f'"{connection}"\ntake [node] kind = "cylinder" or "tube", or '
            f'[connection] kind = "{wanted}"'
        )


def _check_tongues(connection: Connection, profiles: list[Profile]) -> None:
    """Raise where beams that meet need tongues of several thicknesses."""
    found = {p.name: t.thickness for p in profiles if (t := connection.tongue(p)) is not None}
    if len(set(found.values())) > 1:
        shown = ", ".join(f"{thick:g} mm for {name}" for name, thick in found.items())
        raise DetailError(
            f"the tongues of a node have one thickness; {shown}\ntake [beam] profiles of one "
            'width, or [connection] ends = "slotted"'
        )


def _mixed(arms: Arms, profile_of: Ints) -> int:
    """A node at which beams of several profiles meet, or the first one."""
    other = np.flatnonzero(profile_of != profile_of[arms.start[arms.node]])
    return int(arms.node[other[0] if len(other) else 0])


def ends_of(places: tuple[Place, ...], mesh: Mesh) -> Ends:
    """Where and how the beams end."""
    cut = np.zeros((mesh.n_edges, 2))
    joined: list[list[Joined]] = [[places[0].each[0][1]] * 2 for _ in range(mesh.n_edges)]
    for place in places:
        arms = place.joints.arms
        cut[arms.edge, arms.end] = place.size.cut
        for edge, end, how in zip(arms.edge.tolist(), arms.end.tolist(), place.joined, strict=True):
            joined[edge][end] = how
    return Ends(cut, tuple((start, end) for start, end in joined))


def nodes_and_bolts(
    mesh: Mesh, axes: Floats, places: tuple[Place, ...], sections: Sections
) -> Fitted:
    """The nodes and bolts of all places.

    Raises
    ------
    DetailError
        A node cannot be made.
    """
    bottoms, tops, radii, lows, cuts = np.zeros((5, mesh.n_vertices))
    nodes: list[Node] = []
    bolts: list[tuple[int, Bolt]] = []
    for place in places:
        joints, size, arms = place.joints, place.size, place.joints.arms
        low, middle, high = end_heights(joints.frames, arms, size, sections, joints.project)
        used = np.flatnonzero(np.diff(arms.start))
        lows[used] = np.minimum.reduceat(low, arms.start[used])
        half = 0.5 * np.array([joined.cover for joined in place.joined])
        low, high = np.minimum(low, middle - half), np.maximum(high, middle + half)
        bottom, top = size.ends(joints, *node_ends(mesh, arms, low, high, joints.project))
        bottoms[used], tops[used] = bottom[used], top[used]
        radii[used], cuts[used] = size.radius, size.cut
        nodes += node_specs(mesh, axes, joints, size, place.joined, (bottom, top), middle)
        for own, joined, mine in place.each:
            found = bolt_specs(mesh, axes, own, size, joined, middle, mine)
            bolts += ((int(place.at[k]), bolt) for k, bolt in found)
    nodes.sort(key=lambda node: node.vertex)
    for node in nodes:
        if isinstance(node.shape, Upright):  # discs lie where their slots are
            bottoms[node.vertex] = node.shape.z0
    bolts.sort(key=lambda pair: pair[0])
    marked = tuple(bolt.named(f"{MARK}-{k:04d}") for k, (_, bolt) in enumerate(bolts))
    return Fitted(tuple(nodes), marked, bottoms, tops, radii, lows, cuts)
