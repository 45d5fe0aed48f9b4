"""Which beams and nodes the rules of a project select, and what each place has."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Final, Protocol

import numpy as np

from ddgfab.errors import DetailError
from ddgfab.io import Groups
from ddgfab.mesh import Ints, Mesh
from ddgfab.suggest import suggestion
from fabrication.gridshell.detailing.frames import beam_mark, node_mark
from fabrication.gridshell.ground_settings import NOWHERE, GroundSettings
from fabrication.gridshell.where import BOUNDARY, SUPPORTS, group_of, shown

Where = str | tuple[int, ...]


class Placed(Protocol):
    """A rule with a place."""

    @property
    def where(self) -> Where:
        """The place."""


@dataclass(frozen=True, eq=False)
class Net:
    """What places are found in: the mesh, the groups of its file, and where it is supported."""

    mesh: Mesh
    groups: Groups
    ground: GroundSettings

    @cached_property
    def supports(self) -> Ints:
        """The vertices that stand on the ground; none where [ground] names none.

        Raises
        ------
        DetailError
            [ground] selects nothing; what `vertices` raises.
        """
        where, below = self.ground.where, self.ground.below_mm
        if where == NOWHERE:
            return np.zeros(0, dtype=np.int64)
        label = "[ground] where"
        found = self.vertices(where, label)
        if not len(found):
            raise DetailError(f"{label} = {shown(where)} selects no node")
        if below is None:
            return found
        height = self.mesh.vertices[found, 2]
        return np.asarray(found[height <= height.min() + below])

    def _on_ground(self, label: str) -> Ints:
        """The supports, which a rule asks for."""
        if self.ground.where == NOWHERE:
            raise DetailError(
                f'{label} is for "{SUPPORTS}", and [ground] names none\nset [ground] where = '
                '"boundary", "group:NAME" or vertex numbers'
            )
        return self.supports

    def edges(self, where: Where, label: str) -> Ints:
        """Edges of a place, each once; none where there are none. Of supports those that end there.

        Raises
        ------
        DetailError
            A number beyond the last edge, an unknown group; `label` names the rule.
        """
        mesh = self.mesh
        name = group_of(where)
        if name is not None:
            pairs = self._known(name, label).edges_of(name)
            key = mesh.edges.min(axis=1) * mesh.n_vertices + mesh.edges.max(axis=1)
            return np.flatnonzero(np.isin(key, pairs[:, 0] * mesh.n_vertices + pairs[:, 1]))
        if where == BOUNDARY:
            return np.flatnonzero((mesh.edge_faces < 0).any(axis=1))
        if where == SUPPORTS:
            return np.flatnonzero(np.isin(mesh.edges, self._on_ground(label)).any(axis=1))
        return _numbers(where, mesh.n_edges, f"{label} selects edge", "edges")

    def vertices(self, where: Where, label: str) -> Ints:
        """Vertices of a place that faces use, each once; none where there are none.

        Raises
        ------
        DetailError
            A number beyond the last vertex, a vertex without faces, an unknown group.
        """
        mesh = self.mesh
        used = mesh.valences > 0
        name = group_of(where)
        if name is not None:
            found = self._known(name, label).vertices_of(name)
            return found[used[found]]
        if where == BOUNDARY:
            return np.flatnonzero(mesh.boundary_vertex & used)
        if where == SUPPORTS:
            return self._on_ground(label)
        found = _numbers(where, mesh.n_vertices, f"{label} selects vertex", "vertices")
        if not used[found].all():
            raise DetailError(
                f"{label} selects vertex {found[~used[found]][0]}, which has no faces"
            )
        return found

    def _known(self, name: str, label: str) -> Groups:
        names = self.groups.all_names
        if name in names:
            return self.groups
        if not names:
            raise DetailError(
                f'{label}: the net has no groups, so none is "{name}"; they are lines "g NAME" or '
                '"o NAME" of an OBJ file before faces, lines and points'
            )
        raise DetailError(f'{label}: the net has no group "{name}"; {suggestion(name, names)}')


def _numbers(where: Where, count: int, label: str, what: str) -> Ints:
    """The numbers of a place, each once."""
    ids = np.unique(np.array(where, dtype=np.int64))
    bad = ids[(ids < 0) | (ids >= count)]
    if len(bad):
        raise DetailError(f"{label} {bad[0]}; there are {what} 0 to {count - 1}")
    return ids


def by_rule(
    rules: Sequence[Placed],
    count: int,
    section: str,
    what: str,
    find: Callable[[Where, str], Ints],
    mark: Callable[[int], str],
) -> Ints:
    """(count,) the rule of each beam or node, counted from 1; 0 without.

    Parameters
    ----------
    section, what : where the rules stand, and what they select: "beam" or "node"

    Raises
    ------
    DetailError
        A rule that selects nothing, two that select the same; what `find` raises.
    """
    rule_of = np.zeros(count, dtype=np.int64)
    for number, rule in enumerate(rules, 1):
        label = f"[[{section}]] rule {number}"
        chosen = find(rule.where, label)
        if not len(chosen):
            raise DetailError(f"{label} (where = {shown(rule.where)}) selects no {what}")
        taken = chosen[rule_of[chosen] > 0]
        if len(taken):
            first = int(rule_of[taken[0]])
            raise DetailError(
                f"[[{section}]] rules {first} (where = {shown(rules[first - 1].where)}) and "
                f"{number} (where = {shown(rule.where)}) both select {what} "
                f"{mark(int(taken[0]))}"
                + (f" and {len(taken) - 1} more" if len(taken) > 1 else "")
                + f": let each {what} have one"
            )
        rule_of[chosen] = number
    return rule_of


def rules_of_nodes(net: Net, rules: Sequence[Placed], section: str = "node") -> Ints:
    """(V,) the [[node]] or [[connection]] rule of each vertex, counted from 1; 0 without.

    Raises
    ------
    DetailError
        As `by_rule`.
    """
    return by_rule(rules, net.mesh.n_vertices, section, "node", net.vertices, node_mark)


def rules_of_beams(net: Net, rules: Sequence[Placed]) -> Ints:
    """(E,) the [[beam]] rule of each edge, counted from 1; 0 without.

    Raises
    ------
    DetailError
        As `by_rule`.
    """
    return by_rule(rules, net.mesh.n_edges, "beam", "beam", net.edges, beam_mark)


NO_GROUPS: Final = Groups()
"""Of nets that are no OBJ file."""
