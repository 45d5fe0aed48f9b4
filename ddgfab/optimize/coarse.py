"""Coarser meshes to begin with: polylines of quads are left out, every other one if possible.

Far from planar faces vertices move over many edges; on a mesh of a quarter of the faces a step
costs a quarter and goes twice as far. The movement found there, taken over to the fine mesh, leaves
few steps to be done.

A polyline that is left out merges the two strips of quads along it. It has to run through regular
vertices alone, from boundary to boundary or closed; and each strip is merged once, with one beside
it. Where their number is odd, the wider one at the ends is left as it is.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csr_array
from scipy.sparse.csgraph import connected_components

from ddgfab.mesh import Floats, Ints, Mesh
from ddgfab.optimize.panes import strips
from ddgfab.optimize.terms.shape import polyline_triples

_QUAD: Final = 4
_LEAST: Final = 0.6
"""Meshes with more than this part of the faces are hardly coarser."""
_RING: Final = 6
"""Strips of a closed sequence that are merged; three have to remain."""


@dataclass(frozen=True, eq=False)
class Coarse:
    """A mesh without some of its polylines.

    Attributes
    ----------
    mesh : the coarse mesh
    kept : (n,) its vertices in the fine one
    middles, centers : (V, V) weights of the vertices of the fine mesh for those on one polyline
        that is left out, from those kept, and for those on two, from these
    """

    mesh: Mesh
    kept: Ints
    middles: csr_array
    centers: csr_array

    def prolonged(self, values: Floats) -> Floats:
        """(V, 3) values at the fine vertices from (n, 3) at the coarse ones."""
        fine = np.zeros((self.middles.shape[0], 3))
        fine[self.kept] = values
        fine += self.middles @ fine
        return np.asarray(fine + self.centers @ fine)


def coarsened(mesh: Mesh) -> Coarse | None:
    """A mesh of quads without some of its polylines; None where too few can be left out."""
    if (mesh.face_sizes != _QUAD).any():
        return None
    regular = np.where(mesh.boundary_vertex, mesh.valences == 3, mesh.valences == _QUAD)
    triples = polyline_triples(mesh)
    triples = triples[regular[triples[:, 1]]]
    straight = _Straight(mesh, triples)
    gone = _left_out(mesh, straight.lines(), regular)
    kind = np.bincount(mesh.edges[gone].ravel(), minlength=mesh.n_vertices)
    kind[~mesh.boundary_vertex] //= 2  # lines through a vertex: each has one edge at a boundary
    corners = _merged(mesh, gone, kind == 0)
    if corners is None or len(corners) > _LEAST * mesh.n_faces:
        return None
    kept = np.flatnonzero((kind == 0) & (mesh.valences > 0))
    number = np.full(mesh.n_vertices, -1)
    number[kept] = np.arange(len(kept))
    on_line = np.zeros(mesh.n_edges, dtype=bool)
    on_line[gone] = True
    across = ~on_line[straight.edges].any(axis=1)
    return Coarse(
        Mesh.build(mesh.vertices[kept], number[corners]),
        kept,
        straight.weights(across & (kind[triples[:, 1]] == 1)),
        straight.weights(kind[triples[:, 1]] == 2),
    )


class _Straight:
    """Polylines through regular vertices.

    Attributes
    ----------
    triples : (m, 3) consecutive vertices
    edges : (m, 2) the edges between them
    """

    def __init__(self, mesh: Mesh, triples: Ints) -> None:
        self._mesh, self.triples = mesh, triples
        low, high = np.sort(mesh.edges, axis=1).T
        order = np.lexsort((high, low))
        keys = (low * mesh.n_vertices + high)[order]
        ways = np.sort(np.stack([triples[:, :2], triples[:, 1:]], axis=1), axis=2)
        self.edges: Ints = order[
            np.searchsorted(keys, ways[..., 0] * mesh.n_vertices + ways[..., 1])
        ]

    def lines(self) -> Ints:
        """(E,) number of the polyline of each edge."""
        size = (self._mesh.n_edges, self._mesh.n_edges)
        graph = coo_array((np.ones(len(self.edges)), self.edges.T), shape=size)
        found: Ints = np.asarray(connected_components(graph, directed=False)[1], dtype=np.int64)
        return found

    def weights(self, which: NDArray[np.bool_]) -> csr_array:
        """(V, V) weights of the ends of some triples for what lies between, linear in the lengths.

        The mean of the triples with the same middle.
        """
        points, count, triples = self._mesh.vertices, self._mesh.n_vertices, self.triples[which]
        middle, ends = triples[:, 1], triples[:, [0, 2]]
        away = np.linalg.norm(points[ends] - points[middle, None], axis=2)
        away = np.maximum(away, np.finfo(float).tiny)
        share = away[:, ::-1] / away.sum(axis=1, keepdims=True)
        share /= np.bincount(middle, minlength=count)[middle, None]
        return csr_array(
            coo_array((share.ravel(), (np.repeat(middle, 2), ends.ravel())), shape=(count, count))
        )


def _left_out(mesh: Mesh, line: Ints, regular: NDArray[np.bool_]) -> Ints:
    """Edges of the polylines that are left out."""
    count = int(line.max()) + 1
    free = np.ones(count, dtype=bool)
    free[line[mesh.boundary_edge | ~regular[mesh.edges].all(axis=1)]] = False
    strip = strips(mesh)
    # strips along both sides of an edge are those of the edges that follow on it in its faces
    beside = strip[mesh.corner_edge[mesh.corner_next]]
    own = line[mesh.corner_edge]
    least, most = np.full(count, mesh.n_edges), np.full(count, -1)
    np.minimum.at(least, own, beside)
    np.maximum.at(most, own, beside)
    free &= least < most
    widths = np.bincount(strip, mesh.edge_lengths) / np.bincount(strip)
    taken = _alternate(least[free], most[free], widths)
    return np.flatnonzero(np.isin(line, np.flatnonzero(free)[taken]))


def _alternate(one: Ints, two: Ints, widths: Floats) -> Ints:
    """Links between strips, of which each has at most two, such that no strip has two of them.

    Of an odd number in a row the first or the last one is left, the wider one.
    """
    links: list[list[int]] = [[] for _ in widths]
    for number, ends in enumerate(zip(one.tolist(), two.tolist(), strict=True)):
        for end in ends:
            links[end].append(number)
    done = np.zeros(len(widths), dtype=bool)
    taken: list[int] = []
    ends_first = sorted(range(len(links)), key=lambda k: (len(links[k]) != 1, k))
    for first in ends_first:
        if done[first] or not links[first]:
            continue
        row, between, last = [first], list[int](), -1
        done[first] = True
        while True:
            onward = [k for k in links[row[-1]] if k != last]
            if not onward:
                break
            last = onward[0]
            between.append(last)
            other = int(one[last] + two[last]) - row[-1]
            if done[other]:
                break
            done[other] = True
            row.append(other)
        closed = len(between) == len(row)
        if closed and len(row) < _RING:
            continue
        skip = len(row) % 2 and not closed and widths[row[0]] > widths[row[-1]]
        taken += between[int(skip) :: 2][: len(row) // 2]
    return np.array(sorted(taken), dtype=np.int64)


def _merged(mesh: Mesh, gone: Ints, kept: NDArray[np.bool_]) -> Ints | None:
    """(n, 4) corners of the coarse faces, vertices of the fine mesh; None if some are no quads."""
    corner = np.flatnonzero(kept[mesh.corners])
    after = mesh.corner_next[corner]
    # past the end of an edge that is left out: on along the other face beside it
    over = mesh.corner_next[mesh.corner_next[mesh.corner_twin[after]]]
    follows = np.full(len(mesh.corners), -1)
    follows[corner] = np.where(kept[mesh.corners[after]], after, over)
    turn = [corner]
    for _ in range(_QUAD):
        turn.append(follows[turn[-1]])
        if (turn[-1] < 0).any():
            return None
    if (turn[-1] != corner).any():
        return None
    around = np.stack(turn[:-1], axis=1)
    corners = mesh.corners[around[around.argmin(axis=1) == 0]]
    pairs = np.stack([corners, np.roll(corners, -1, axis=1)], axis=-1).reshape(-1, 2)
    twice = len(np.unique(pairs, axis=0)) < len(pairs)
    return None if twice or (pairs[:, 0] == pairs[:, 1]).any() else corners
