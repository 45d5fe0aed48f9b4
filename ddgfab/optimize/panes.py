"""Panes no larger than what is made: quads divided before, a soft term during, a check after.

Quads are divided strip by strip (a strip is what opposite edges connect), so that no vertex comes
to lie on an edge; what divides them lies on the curved surface that the vertex normals describe.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import breadth_first_order, connected_components

from ddgfab.arguments import checked
from ddgfab.errors import InputError, OptimizeError
from ddgfab.mesh import Floats, Ints, Mesh
from ddgfab.optimize.pane_size import FIT, misfit, pane_limit
from ddgfab.optimize.result import OptimizeResult
from ddgfab.optimize.terms.edges import Lengths, edge_bounds

_QUAD: Final = 4
_LIFT: Final = 0.75
"""How far new vertices are lifted towards the tangent planes at the corners."""
_ROOM: Final = 0.92
"""Part of a pane's lengths that its edges are to keep to: what is skew needs more room."""
_MARGIN: Final = 0.9
"""Part of a pane's lengths that quads are divided to: optimizing makes some of them larger."""
_MOST: Final = 64
"""Parts of an edge at most."""
_ROUNDS: Final = 3
"""How often strips whose panes came out too large are divided further."""
_WEIGHT: Final = 3.0


@checked
def pane_lengths(mesh: Mesh, limit: tuple[float, float], *, weight: float = _WEIGHT) -> Lengths:
    """Edges of quads no longer than a pane that lies as the quad does; other faces by diameter."""
    low, high = pane_limit(limit)
    most = np.full(mesh.n_edges, np.inf)
    quads = np.flatnonzero(mesh.face_sizes == _QUAD)
    sides = mesh.corner_edge[mesh.face_start[quads, None] + np.arange(_QUAD)]
    lengths = mesh.edge_lengths[sides]
    first, second = lengths[:, [0, 2]].max(axis=1), lengths[:, [1, 3]].max(axis=1)
    wide = np.maximum(first / high, second / low) < np.maximum(first / low, second / high)
    one = np.where(wide, high, low)[:, None]
    bounds = np.where(np.arange(_QUAD) % 2 == 0, one, low + high - one)
    np.minimum.at(most, sides.ravel(), bounds.ravel())
    other = np.setdiff1d(np.arange(mesh.n_faces), quads)
    rest = np.isin(mesh.corner_face, other)
    np.minimum.at(most, mesh.corner_edge[rest], low)
    return edge_bounds(mesh, _ROOM * most, weight=weight)


def strips(mesh: Mesh) -> Ints:
    """(E,) number of the strip of each edge: opposite edges of quads are in one."""
    quads = np.flatnonzero(mesh.face_sizes == _QUAD)
    sides = mesh.corner_edge[mesh.face_start[quads, None] + np.arange(_QUAD)]
    pairs = np.concatenate([sides[:, [0, 2]], sides[:, [1, 3]]])
    graph = coo_array((np.ones(len(pairs)), pairs.T), shape=(mesh.n_edges, mesh.n_edges))
    found: Ints = np.asarray(connected_components(graph, directed=False)[1], dtype=np.int64)
    return found


@checked
def parts_for_panes(mesh: Mesh, limit: tuple[float, float]) -> Ints:
    """(E,) into how many parts edges are to be divided until all panes fit.

    Raises
    ------
    InputError
        Faces that are too large and no quads; limits so small that an edge needs above 64 parts.
    """
    low, high = (_MARGIN * v for v in pane_limit(limit))
    large = np.flatnonzero(misfit(mesh, (low, high)) > 1 / _MARGIN)
    parts = np.ones(mesh.n_edges, dtype=np.int64)
    if not len(large):
        return parts
    others = np.flatnonzero(mesh.face_sizes != _QUAD)
    if len(others):
        bad = np.intersect1d(large, others)
        named = bad if len(bad) else large
        raise InputError(
            f"{len(large)} faces are larger than a pane of {limit[0]:g} x {limit[1]:g}, and only "
            f"meshes of quads can be divided: faces {', '.join(map(str, named[:5].tolist()))}; "
            "allow larger panes, or give a finer mesh"
        )
    strip = strips(mesh)
    sides = mesh.corner_edge.reshape(-1, _QUAD)
    pairs = strip[sides[:, :2]]
    spans = mesh.edge_lengths[sides]
    spans = np.stack([spans[:, [0, 2]].max(axis=1), spans[:, [1, 3]].max(axis=1)], axis=1)
    best: Ints | None = None
    for first, second in ((low, high), (high, low), (low, low)):
        lengths = np.where(_families(pairs, int(strip.max()) + 1), first, second)
        count = _fewer(pairs, spans, _needed(pairs, spans, lengths), (low, high))
        if best is None or count[pairs].prod(axis=1).sum() < best[pairs].prod(axis=1).sum():
            best = count
    assert best is not None
    if best.max() <= _MOST:
        return np.asarray(best[strip])
    raise InputError(
        f"panes of {limit[0]:g} x {limit[1]:g} need edges in more than {_MOST} parts (edges are up "
        f"to {mesh.edge_lengths.max():.4g} long): allow larger panes"
    )


def _families(pairs: Ints, count: int) -> NDArray[np.bool_]:
    """(S,) strips in two families, so that those that cross are in different ones where possible.

    Parameters
    ----------
    pairs : (F, 2) the two strips that cross in each quad
    """
    graph = coo_array((np.ones(len(pairs)), pairs.T), shape=(count, count)).tocsr()
    graph = graph + graph.T
    depth = np.full(count, -1)
    for begin in range(count):
        if depth[begin] < 0:
            order, before = breadth_first_order(graph, begin, directed=False)
            depth[begin] = 0
            for strip in order[1:].tolist():
                depth[strip] = depth[before[strip]] + 1
    return np.asarray(depth % 2 == 0)


def _needed(pairs: Ints, spans: Floats, lengths: Floats) -> Ints:
    """(S,) parts of strips so that no piece is longer than the (S,) lengths."""
    count = np.ones(len(lengths), dtype=np.int64)
    need = np.ceil(spans / lengths[pairs] * (1 - FIT)).astype(np.int64)
    np.maximum.at(count, pairs.ravel(), need.ravel())
    return count


def _fewer(pairs: Ints, spans: Floats, count: Ints, limit: tuple[float, float]) -> Ints:
    """(S,) parts of strips, less where all their pieces fit all the same."""
    count = count.copy()
    for strip in np.argsort(-np.bincount(pairs.ravel(), minlength=len(count)), kind="stable"):
        mine = (pairs == strip).any(axis=1)
        while count[strip] > 1:
            count[strip] -= 1
            pieces = np.sort(spans[mine] / count[pairs[mine]], axis=1)
            if (pieces > np.array(limit) * (1 + FIT)).any():
                count[strip] += 1
                break
    return count


@checked
def divided(mesh: Mesh, parts: Ints) -> Mesh:
    """A mesh of quads with edges divided into parts, on the surface its normals describe.

    Vertices of the mesh keep their numbers; those of edges and then of faces follow.

    Parameters
    ----------
    parts : (E,) number of parts of each edge, the same for opposite edges

    Raises
    ------
    InputError
        Faces that are not quads, or opposite edges with different parts.
    """
    if (mesh.face_sizes != _QUAD).any():
        raise InputError("only meshes of quads can be divided")
    sides = mesh.corner_edge.reshape(-1, _QUAD)
    corners = mesh.corners.reshape(-1, _QUAD)
    if (parts < 1).any() or (parts[sides[:, :2]] != parts[sides[:, 2:]]).any():
        raise InputError("opposite edges of a quad have the same number of parts, 1 or more")
    first = _first_points(mesh, parts)
    total = mesh.n_vertices + int((parts - 1).sum())
    points = [mesh.vertices, np.zeros((total - mesh.n_vertices, 3))]
    faces: list[tuple[Ints, Ints]] = []
    shapes = parts[sides[:, :2]]
    on_edges = np.concatenate(points)

    for u, v in np.unique(shapes, axis=0).tolist():
        rows = np.flatnonzero((shapes == (u, v)).all(axis=1))
        grid = np.zeros((len(rows), u + 1, v + 1), dtype=np.int64)
        grid[:, 0, 0], grid[:, u, 0], grid[:, u, v], grid[:, 0, v] = corners[rows].T
        inside = np.arange((u - 1) * (v - 1)).reshape(u - 1, v - 1)
        grid[:, 1:u, 1:v] = total + inside.size * np.arange(len(rows))[:, None, None] + inside
        total += inside.size * len(rows)
        rims = (np.s_[:, 1:u, 0], np.s_[:, u, 1:v], np.s_[:, 1:u, v], np.s_[:, 0, 1:v])
        for side, (start, place) in enumerate(zip((0, 1, 3, 0), rims, strict=True)):
            edge = sides[rows, side]
            steps = np.arange(1, (v if side % 2 else u))
            ahead = (mesh.edges[edge, 0] == corners[rows, start])[:, None]
            order = np.where(ahead, steps, parts[edge][:, None] - steps)
            grid[place] = first[edge][:, None] + order - 1
        s, t = np.meshgrid(np.arange(u + 1) / u, np.arange(v + 1) / v, indexing="ij")
        weights = np.stack([(1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t], axis=-1)
        found = _lifted(mesh, corners[rows], weights.reshape(-1, _QUAD))
        found = found.reshape(len(rows), u + 1, v + 1, 3)
        for place in rims:
            on_edges[grid[place].ravel()] = found[place].reshape(-1, 3)
        points.append(found[:, 1:u, 1:v].reshape(-1, 3))
        quads = np.stack(
            [grid[:, :-1, :-1], grid[:, 1:, :-1], grid[:, 1:, 1:], grid[:, :-1, 1:]], axis=-1
        )
        faces.append((np.repeat(rows, u * v), quads.reshape(-1, _QUAD)))
    order = np.argsort(np.concatenate([f for f, _ in faces]), kind="stable")
    return Mesh.build(
        np.concatenate([on_edges, *points[2:]]), np.concatenate([q for _, q in faces])[order]
    )


def divided_edges(mesh: Mesh, parts: Ints) -> list[list[int]]:
    """The vertices along each edge of a mesh that `divided` divides, ends included."""
    first, ends = _first_points(mesh, parts).tolist(), mesh.edges.tolist()
    return [
        [start, *range(begin, begin + count - 1), end]
        for (start, end), begin, count in zip(ends, first, parts.tolist(), strict=True)
    ]


def pieces_of(mesh: Mesh, parts: Ints) -> Ints:
    """(F,) into how many faces each quad is divided; these stand one after the other."""
    sides = mesh.corner_edge.reshape(-1, _QUAD)
    return np.asarray(parts[sides[:, 0]] * parts[sides[:, 1]])


def _first_points(mesh: Mesh, parts: Ints) -> Ints:
    """(E,) number of the first of the points that divide each edge."""
    return np.asarray(mesh.n_vertices + np.cumsum(parts - 1) - (parts - 1))


def _lifted(mesh: Mesh, corners: Ints, weights: Floats) -> Floats:
    """(f, w, 3) points of quads (f, 4) at bilinear weights (w, 4), lifted to the curved surface."""
    at, normals = mesh.vertices[corners], mesh.vertex_normals[corners]
    flat = np.einsum("wk,fkx->fwx", weights, at)
    away = np.einsum("fwkx,fkx->fwk", flat[:, :, None] - at[:, None], normals)
    return np.asarray(flat - _LIFT * np.einsum("wk,fwk,fkx->fwx", weights, away, normals))


def further(mesh: Mesh, parts: Ints, found: Mesh, limit: tuple[float, float]) -> Ints:
    """(E,) parts of edges, one more across the longer side of quads whose panes came out too large.

    Parameters
    ----------
    found : the divided mesh after optimizing
    """
    sides = mesh.corner_edge.reshape(-1, _QUAD)
    owner = np.repeat(np.arange(mesh.n_faces), pieces_of(mesh, parts))
    quads = np.unique(owner[misfit(found, limit) > 1 + FIT])
    lengths = mesh.edge_lengths[sides[quads, :2]] / parts[sides[quads, :2]]
    strip = strips(mesh)
    more = strip[sides[quads, lengths.argmax(axis=1)]]
    return np.asarray(parts + np.isin(strip, more))


def with_panes(
    mesh: Mesh, limit: tuple[float, float], run: Callable[[Mesh], OptimizeResult]
) -> OptimizeResult:
    """Divide a mesh for panes and optimize it; strips whose panes come out too large once more.

    Parameters
    ----------
    run : optimizes a mesh, with the soft term and the limit of panes

    Raises
    ------
    OptimizeError
        As `run`, or panes stay too large after three rounds.
    InputError
        Faces that are too large, and no quads.
    """
    parts = parts_for_panes(mesh, limit)
    for left in range(_ROUNDS, 0, -1):
        start = divided(mesh, parts) if (parts > 1).any() else mesh
        try:
            result = run(start)
        except OptimizeError as error:
            if not isinstance(error.result, OptimizeResult):
                raise
            error.result = result = _with_parts(error.result, parts)
            large = misfit(result.mesh, limit) > 1 + FIT
            if left == 1 or not large.any() or (mesh.face_sizes != _QUAD).any():
                raise
        else:
            result = _with_parts(result, parts)
            large = misfit(result.mesh, limit) > 1 + FIT
            if left == 1 or not large.any() or (mesh.face_sizes != _QUAD).any():
                break
        parts = further(mesh, parts, result.mesh, limit)
    return result


def _with_parts(result: OptimizeResult, parts: Ints) -> OptimizeResult:
    """The result with how its edges were divided, if they were."""
    return result.revised(parts=parts) if (parts > 1).any() else result
