"""From lines of two families to a mesh: the cells of the planar map of lines and trim.

Nodes are crossings, ends of lines on the trimming curves, and corners of those. Cells are found by
walking half-edges in the parameter plane; their areas must add up to the area of the trim.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Final, Literal, TypeAlias

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from ddgfab.arguments import checked
from ddgfab.errors import DegenerateError, MeshError
from ddgfab.mesh import Floats, Ints, Mesh
from ddgfab.trace.cells import cells
from ddgfab.trace.cleaning import cleaned
from ddgfab.trace.crossings import crossings
from ddgfab.trace.lines import Line
from ddgfab.trace.placing import Network

Tag: TypeAlias = Literal["inner", "rim", "corner"]
TAGS: Final[tuple[Tag, ...]] = ("inner", "rim", "corner")

_SAME: Final = 1e-6
"""Nodes nearer than this part of the spacing are one."""
_CORNER_DEG: Final = 30.0
"""A trimming curve that turns by more [deg] has a corner."""
_PART: Final = 0.3
"""Edges leave a node towards the point at this part of their length."""
_PARTS: Final = (_PART, 0.5, 0.75, 1.0)
_INSIDE: Final = 0.1
"""Sine of the angle to the rim from which a line is clearly inside."""
AREA: Final = 1e-8
"""How far the areas of the cells may be from that of the trim, relative to it."""


@dataclass(frozen=True, eq=False)
class TracedMesh:
    """The mesh of a network.

    Attributes
    ----------
    mesh : vertices on the surface, faces counterclockwise seen from x_u × x_v
    uv : (V, 2) parameters of the vertices
    tag : (V,) index into `TAGS`
    area_error : relative difference of the cells' areas in the parameter plane from the trim's
    """

    mesh: Mesh
    uv: Floats
    tag: Ints
    area_error: float

    @property
    def inner_faces(self) -> Ints:
        """Ids of the faces that do not touch the rim."""
        rim = self.mesh.boundary_vertex[self.mesh.corners]
        return np.flatnonzero(~np.logical_or.reduceat(rim, self.mesh.face_start[:-1]))


@dataclass(eq=False)
class _Graph:
    """Nodes and edges of a planar map under construction; rank 0 inner, 1 rim, 2 corner."""

    uv: list[Floats]
    rank: list[Ints]
    count: int = 0

    def add(self, uv: Floats, rank: int) -> Ints:
        """Ids of new nodes."""
        ids = np.arange(self.count, self.count + len(uv))
        self.uv.append(uv)
        self.rank.append(np.full(len(uv), rank))
        self.count += len(uv)
        return ids


@checked
def network_mesh(network: Network) -> TracedMesh:
    """The mesh whose edges are the lines of a network and the trimming curves.

    Raises
    ------
    DegenerateError
        Cells that do not cover the trim (a hole that no line reaches, lines that touch); names the
        areas.
    MeshError
        Cells that are not a manifold mesh.
    """
    surface, trim = network.field.surface, network.field.surface.trim
    graph, stops, rim_stops = _nodes(network)
    same, uv, rank = _merged(network, graph)
    edges: list[tuple[int, int]] = []
    towards: list[Floats] = []
    chords: list[float] = []
    for line, on_line in zip(
        [line for family in network.lines for line in family], stops, strict=True
    ):
        for a, b, s0, s1 in _pieces(on_line, line, same):
            edges.append((a, b))
            towards.append(_leaving(network, line, s0, s1))
            chords.append(0.5 * (uv[a, 0] * uv[b, 1] - uv[a, 1] * uv[b, 0]))
    along_lines = len(edges)
    for loop, stations in enumerate(rim_stops):
        for a, b, path in _rim_pieces(network, loop, stations, same, uv):
            edges.append((a, b))
            towards.append(_points_along(path, (_PART, 1 - _PART)))
            after = path[1:]
            chords.append(
                0.5 * float(np.sum(path[:-1, 0] * after[:, 1] - path[:-1, 1] * after[:, 0]))
            )
    if not edges:
        raise DegenerateError(f"{surface.name}: no line of the network reaches its rim")
    found, areas = cells(
        uv,
        np.array(edges),
        np.array(towards),
        np.array(chords),
        np.arange(len(edges)) >= along_lines,
    )
    inner = [face for face, area in zip(found, areas, strict=True) if area > 0]
    total = float(areas[areas > 0].sum())
    error = abs(total - trim.area) / trim.area
    if error > AREA:
        raise DegenerateError(
            f"{surface.name}: the cells cover {total:.6g} of {trim.area:.6g} in the parameter "
            "plane: lines touch each other or the rim, or no line reaches a hole\nchange the "
            "spacing a little"
        )
    mesh, keep = _mesh_of(surface.name, surface.points(uv), rank, inner)
    return TracedMesh(mesh, uv[keep], rank[keep], error)


_Stops: TypeAlias = list[list[tuple[float, int]]]
"""Per line or loop, places along it with the nodes there."""


def _nodes(network: Network) -> tuple[_Graph, _Stops, _Stops]:
    """Crossings, ends on the rim and corners as nodes, with their places on lines and loops."""
    trim = network.field.surface.trim
    first, second = network.lines
    graph = _Graph([], [])
    hits = crossings(first, second)
    crossing = graph.add(hits.uv, 0)
    stops: _Stops = [[] for _ in range(len(first) + len(second))]
    for offset, lines, s in (
        (0, hits.first, hits.s_first),
        (len(first), hits.second, hits.s_second),
    ):
        for line, at, node in zip(lines.tolist(), s.tolist(), crossing.tolist(), strict=True):
            stops[offset + line].append((at, node))
    rim_stops: _Stops = [[] for _ in trim.loops]
    for number, line in enumerate([*first, *second]):
        for end, index in ((0, 0), (1, -1)):
            if line.rim[end] < 0:
                continue
            node = int(graph.add(line.uv[index][None], 1)[0])
            stops[number].append((float(line.s[index]), node))
            segment = line.rim[end]
            loop = int(np.searchsorted(trim.loop_start, segment, side="right")) - 1
            rim_stops[loop].append((_rim_place(network, segment, line.uv[index]), node))
    for loop, corner, place in _corners(network):
        rim_stops[loop].append((place, int(graph.add(corner[None], 2)[0])))
    return graph, stops, rim_stops


def _mesh_of(name: str, points: Floats, rank: Ints, inner: list[Ints]) -> tuple[Mesh, Ints]:
    """The mesh of cells without slivers, and the nodes that are its vertices."""
    faces, keep = cleaned(points, rank, inner)
    if not faces:
        raise DegenerateError(f"{name}: the network has no cells; choose a smaller spacing")
    new = np.full(len(points), -1)
    new[keep] = np.arange(len(keep))
    try:
        mesh = Mesh.build(points[keep], [new[face] for face in faces])
    except MeshError as fault:
        raise MeshError(f"{name}: cells of the network do not fit: {fault}") from None
    twice = np.flatnonzero(mesh.edge_faces[:, 0] == mesh.edge_faces[:, 1])
    if len(twice):
        x, y, z = mesh.vertices[mesh.edges[twice[0]]].mean(axis=0)
        raise DegenerateError(
            f"{name}: a cell touches itself at ({x:.4g}, {y:.4g}, {z:.4g}): lines end in "
            "the open there\nchange the spacing a little"
        )
    return mesh, keep


def _leaving(network: Network, line: Line, s0: float, s1: float) -> Floats:
    """(2, 2) points of a piece of a line that show its directions at its first and last node.

    At the rim a line may run along it for a while: the first point that is clearly inside counts.
    """
    out = line.at(np.array([s0 + _PART * (s1 - s0), s1 - _PART * (s1 - s0)]))
    trim = network.field.surface.trim
    for end, at, way in ((0, s0, s1 - s0), (1, s1, s0 - s1)):
        segment = line.rim[end]
        if segment < 0 or at not in (line.s[0], line.s[-1]):
            continue
        along = trim.ends[segment] - trim.starts[segment]
        inward = np.array([-along[1], along[0]]) / np.linalg.norm(along)
        gap = line.at(at + np.array(_PARTS) * way) - line.uv[-end]
        depth = gap @ inward / np.maximum(np.linalg.norm(gap, axis=1), np.finfo(float).tiny)
        clear = np.flatnonzero(depth > _INSIDE)
        out[end] = line.uv[-end] + gap[clear[0] if len(clear) else int(depth.argmax())]
    return np.asarray(out)


def _rim_place(network: Network, segment: int, uv: Floats) -> float:
    """Segment of its loop plus the part of it, of a point on the trim."""
    trim = network.field.surface.trim
    a, way = trim.starts[segment], trim.ends[segment] - trim.starts[segment]
    loop = int(np.searchsorted(trim.loop_start, segment, side="right")) - 1
    part = float(np.clip((uv - a) @ way / (way @ way), 0, 1))
    return float(segment - trim.loop_start[loop]) + part


def _corners(network: Network) -> list[tuple[int, Floats, float]]:
    """Loop, parameters and place of the corners of the trim, as they are in space."""
    surface = network.field.surface
    out = []
    for number, loop in enumerate(surface.trim.loops):
        jets = surface.jets(loop)
        ahead = np.roll(loop, -1, axis=0) - loop
        back = loop - np.roll(loop, 1, axis=0)
        one, two = (way[:, :1] * jets.u + way[:, 1:] * jets.v for way in (back, ahead))
        angle = np.arctan2(
            np.linalg.norm(np.cross(one, two), axis=1), np.einsum("nx,nx->n", one, two)
        )
        for k in np.flatnonzero(np.degrees(angle) > _CORNER_DEG):
            out.append((number, loop[k], float(k)))
    return out


def _merged(network: Network, graph: _Graph) -> tuple[Ints, Floats, Ints]:
    """New id of each node, parameters and ranks of the nodes after joining those at one place."""
    uv, rank = np.concatenate(graph.uv), np.concatenate(graph.rank)
    x = network.field.surface.points(uv)
    pairs = cKDTree(x).query_pairs(_SAME * min(network.spacing), output_type="ndarray")
    links = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(len(uv), len(uv)))
    count, label = connected_components(links, directed=False)
    best = np.full(count, -1)
    order = np.lexsort((-np.arange(len(uv)), rank))
    best[label[order]] = order  # the highest rank comes last
    return label.astype(np.int64), uv[best], rank[best]


def _pieces(
    stations: list[tuple[float, int]], line: Line, same: Ints
) -> list[tuple[int, int, float, float]]:
    """Edges of a line between consecutive nodes: ids and arc lengths; round a closed line."""
    row: list[tuple[float, int]] = []
    for s, node in sorted(stations):
        if not row or row[-1][1] != same[node]:
            row.append((s, int(same[node])))
    if line.closed and len(row) > 1:
        if row[0][1] != row[-1][1]:
            row = [(row[-1][0] - line.length, row[-1][1]), *row]
        # the piece that contains the seed is shown by its longer side of it
        out = []
        for (s0, a), (s1, b) in pairwise(row):
            if s0 >= 0:
                out.append((a, b, s0, s1))
            elif s1 > -s0:
                out.append((a, b, 0.0, s1))
            else:
                out.append((a, b, s0 + line.length, line.length))
        return out
    return [(a, b, s0, s1) for (s0, a), (s1, b) in pairwise(row)]


def _rim_pieces(
    network: Network, loop: int, stations: list[tuple[float, int]], same: Ints, uv: Floats
) -> list[tuple[int, int, Floats]]:
    """Edges of a trimming loop between consecutive nodes: ids and paths in the parameter plane."""
    corners = network.field.surface.trim.loops[loop]
    row: list[tuple[float, int]] = []
    for place, node in sorted(stations):
        if not row or row[-1][1] != same[node]:
            row.append((place, int(same[node])))
    if len(row) > 1 and row[0][1] == row[-1][1]:
        row.pop()
    if len(row) < 2:
        return []
    out = []
    for (p, a), (q, b) in zip(row, [*row[1:], row[0]], strict=True):
        end = q if q > p else q + len(corners)
        between = [
            corners[k % len(corners)] for k in range(int(np.floor(p)) + 1, int(np.ceil(end)))
        ]
        out.append((a, b, np.array([uv[a], *between, uv[b]])))
    return out


def _points_along(path: Floats, parts: tuple[float, float]) -> Floats:
    """(2, 2) points of a polyline at parts of its length."""
    lengths = np.linalg.norm(np.diff(path, axis=0), axis=1)
    s = np.concatenate([[0.0], np.cumsum(lengths)])
    at = np.array(parts) * s[-1]
    return np.stack([np.interp(at, s, path[:, k]) for k in (0, 1)], axis=1)
