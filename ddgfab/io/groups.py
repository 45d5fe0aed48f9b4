"""Named groups of a mesh file: OBJ `g` and `o`, as vertices and edges that follow welding."""

from __future__ import annotations

from array import array
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TypeAlias

import numpy as np

from ddgfab.mesh import Floats, Ints

Ids: TypeAlias = Sequence[int] | Ints
Pairs: TypeAlias = Sequence[Sequence[int]] | Ints

NEAR = 1e-6
"""Points of lines nearer to a vertex than this part of the size of the mesh are that vertex."""


@dataclass(frozen=True, eq=False, repr=False)
class Groups:
    """Named groups of a mesh: each has vertices, and edges as pairs of vertices.

    A group has the vertices and edges of its faces, of its lines, and its points. Elements stand
    in sets, each with one or several names, as `g roof rim` gives an element two.

    Attributes
    ----------
    names : names of each set
    points, point_set : (m,) vertex ids, and the set of each
    edges, edge_set : (n, 2), (n,) the same of edges
    edge_face : (n,) which face of the file each edge goes round, counted from 0; -1 for lines
    """

    names: tuple[tuple[str, ...], ...] = ()
    points: Ints = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    point_set: Ints = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    edges: Ints = field(default_factory=lambda: np.zeros((0, 2), dtype=np.int64))
    edge_set: Ints = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    edge_face: Ints = field(default_factory=lambda: np.zeros(0, dtype=np.int64))

    @staticmethod
    def of(
        groups: Mapping[str, tuple[Sequence[int] | Ints, Sequence[Sequence[int]] | Ints]],
    ) -> Groups:
        """Groups of names, each with its vertices and edges.

        >>> Groups.of({"rim": ([0, 1], [[0, 1]])}).vertices_of("rim").tolist()
        [0, 1]
        """
        points = [np.asarray(p, dtype=np.int64).reshape(-1) for p, _ in groups.values()]
        edges = [np.asarray(e, dtype=np.int64).reshape(-1, 2) for _, e in groups.values()]
        at = np.arange(len(groups))
        empty = np.zeros(0, dtype=np.int64)
        return Groups(
            tuple((name,) for name in groups),
            np.concatenate([empty, *points]),
            np.repeat(at, [len(p) for p in points]),
            np.concatenate([empty.reshape(0, 2), *edges]),
            np.repeat(at, [len(e) for e in edges]),
            np.full(sum(len(e) for e in edges), -1),
        )

    def __bool__(self) -> bool:
        """Whether there is any."""
        return bool(self.names)

    def __repr__(self) -> str:
        return f"Groups({', '.join(self.all_names)})"

    @property
    def all_names(self) -> tuple[str, ...]:
        """Every name once, in the file's order."""
        return tuple(dict.fromkeys(name for names in self.names for name in names))

    def edges_of(self, name: str) -> Ints:
        """(n, 2) edges of a group, each once, the lower vertex first; none of an unknown one."""
        edges = self.edges[np.isin(self.edge_set, self._sets(name))]
        return np.unique(np.sort(edges, axis=1), axis=0)

    def vertices_of(self, name: str) -> Ints:
        """(m,) vertices of a group: its points, and the ends of its edges."""
        points = self.points[np.isin(self.point_set, self._sets(name))]
        return np.unique(np.concatenate([points, self.edges_of(name).ravel()]))

    def lines(self) -> Iterator[str]:
        """Lines of an OBJ file: `g`, with points `p` and lines `l`; blanks in names become _."""
        for k, names in enumerate(self.names):
            yield "g " + " ".join("_".join(name.split()) or "_" for name in names)
            yield from (f"p {v + 1}" for v in self.points[self.point_set == k].tolist())
            yield from (f"l {a + 1} {b + 1}" for a, b in self.edges[self.edge_set == k].tolist())

    def _sets(self, name: str) -> list[int]:
        return [k for k, names in enumerate(self.names) if name in names]

    def renumbered(self, new: Ints) -> Groups:
        """With vertex v as `new[v]`; what is below 0 is gone, and edges that shrank to a point."""
        points, edges = new[self.points], new[self.edges]
        kept = points >= 0
        whole = (edges >= 0).all(axis=1) & (edges[:, 0] != edges[:, 1])
        return Groups(
            self.names,
            points[kept],
            self.point_set[kept],
            edges[whole],
            self.edge_set[whole],
            self.edge_face[whole],
        )

    def onto(self, points: Floats, used: Ints, within: float) -> Groups:
        """With points that no face uses as the nearest one that a face uses, if it is near.

        Programs give lines points of their own at the places of vertices.

        Parameters
        ----------
        points : (V, 3); used : ids of those that faces use; within : distance
        """
        new = np.full(len(points), -1, dtype=np.int64)
        new[used] = used
        own = np.unique(np.concatenate([self.points, self.edges.ravel()]))
        own = own[new[own] < 0]
        if len(own) and len(used):
            from scipy.spatial import cKDTree  # heavy: only where it is needed

            away, at = cKDTree(points[used]).query(points[own])
            near = away <= within
            new[own[near]] = used[at[near]]
        return self.renumbered(new)


class GroupRows:
    """Groups while a file is read: the names that hold, and what came under them."""

    def __init__(self) -> None:
        self._object: tuple[str, ...] = ()
        self._group: tuple[str, ...] = ()
        self._sets: dict[tuple[str, ...], int] = {}
        self._points, self._point_set = array("q"), array("q")
        self._edges, self._edge_set = array("q"), array("q")
        self._edge_face, self._faces = array("q"), 0

    @property
    def named(self) -> bool:
        """Whether a name holds."""
        return bool(self._object + self._group)

    def name(self, key: str, names: Sequence[str]) -> None:
        """A line `g` with its names, or `o` with one name that may have blanks."""
        if key == "o":
            self._object = (" ".join(names),) if names else ()
        else:
            self._group = tuple(names)

    def add(self, ids: Sequence[int], *, closed: bool = False) -> bool:
        """The vertices of a face (closed), a line, or a point; whether a name holds."""
        names = self._object + self._group
        if not names:
            return False
        number = self._sets.setdefault(names, len(self._sets))
        if len(ids) == 1:
            self._points.append(ids[0])
            self._point_set.append(number)
        after = [*ids[1:], ids[0]] if closed else ids[1:]
        for pair in zip(ids, after, strict=False):
            self._edges.extend(pair)
            self._edge_set.append(number)
            self._edge_face.append(self._faces if closed else -1)
        self._faces += closed
        return True

    def groups(self, count: int) -> Groups:
        """All of them; ids that no vertex of the `count` has are left to other checks."""
        made = Groups(
            tuple(self._sets),
            np.array(self._points, dtype=np.int64),
            np.array(self._point_set, dtype=np.int64),
            np.array(self._edges, dtype=np.int64).reshape(-1, 2),
            np.array(self._edge_set, dtype=np.int64),
            np.array(self._edge_face, dtype=np.int64),
        )
        points, edges = made.points < count, (made.edges < count).all(axis=1)
        return Groups(
            made.names,
            made.points[points],
            made.point_set[points],
            made.edges[edges],
            made.edge_set[edges],
            made.edge_face[edges],
        )
