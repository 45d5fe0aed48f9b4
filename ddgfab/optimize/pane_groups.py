"""Groups of a mesh that was optimized, its quads divided for panes or not: marks stay."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from typing import TypeAlias

import numpy as np

from ddgfab.arguments import checked
from ddgfab.io import Groups
from ddgfab.mesh import Ints, Mesh
from ddgfab.optimize.panes import divided_edges, pieces_of
from ddgfab.optimize.result import OptimizeResult

Row: TypeAlias = tuple[int, int, int, int]


@checked
def kept_groups(groups: Groups, mesh: Mesh, result: OptimizeResult) -> Groups:
    """The groups of a mesh on what was made of it; edges that the result does not have are gone.

    Parameters
    ----------
    mesh : what was optimized
    """
    if result.parts is not None:
        return divided_groups(groups, mesh, result.parts, result.mesh)
    count = mesh.n_vertices
    here, there = (
        pairs.min(axis=1) * count + pairs.max(axis=1) for pairs in (groups.edges, result.mesh.edges)
    )
    kept = np.isin(here, there)
    return replace(
        groups,
        edges=groups.edges[kept],
        edge_set=groups.edge_set[kept],
        edge_face=groups.edge_face[kept],
    )


def divided_groups(groups: Groups, mesh: Mesh, parts: Ints, found: Mesh) -> Groups:
    """The groups of a mesh on the mesh that `divided` makes of it.

    Edges become the edges that they are divided into, faces the faces that they are divided into,
    with all edges of these; points stay.

    Parameters
    ----------
    parts : (E,) number of parts of each edge
    found : the divided mesh, its vertices moved or not
    """
    key = mesh.edges.min(axis=1) * mesh.n_vertices + mesh.edges.max(axis=1)
    edge_of = {pair: edge for edge, pair in enumerate(key.tolist())}
    chains = divided_edges(mesh, parts)
    whole = _faces(groups, mesh)
    kept = {face for faces in whole.values() for face in faces}
    rows: list[Row] = []
    elements = zip(
        groups.edges.tolist(), groups.edge_set.tolist(), groups.edge_face.tolist(), strict=True
    )
    for (a, b), own, face in elements:
        edge = edge_of.get(min(a, b) * mesh.n_vertices + max(a, b))
        if face not in kept and edge is not None:
            rows += [(p, q, own, -1) for p, q in pairwise(chains[edge])]
    counts = pieces_of(mesh, parts)
    start = np.cumsum(counts) - counts  # faces stand in the order of those they are parts of
    for own, face in whole:
        for piece in range(start[face], start[face] + counts[face]):
            loop = found.face(piece).tolist()
            rows += [(loop[k - 1], loop[k], own, piece) for k in range(len(loop))]
    table = np.array(rows, dtype=np.int64).reshape(-1, 4)
    return Groups(
        groups.names, groups.points, groups.point_set, table[:, :2], table[:, 2], table[:, 3]
    )


def _faces(groups: Groups, mesh: Mesh) -> dict[tuple[int, int], list[int]]:
    """By set and face of the mesh, the faces of the file that cover it: itself, or triangles of it.

    Faces of the file that cover no face of the mesh are not in it.
    """
    corners: dict[tuple[int, int], set[int]] = {}
    for (a, b), own, face in zip(
        groups.edges.tolist(), groups.edge_set.tolist(), groups.edge_face.tolist(), strict=True
    ):
        if face >= 0:
            corners.setdefault((own, face), set()).update((a, b))
    at: list[set[int]] = [set() for _ in range(mesh.n_vertices)]
    for vertex, face in zip(mesh.corners.tolist(), mesh.corner_face.tolist(), strict=True):
        at[vertex].add(face)
    covered: dict[tuple[int, int], tuple[set[int], list[int]]] = {}
    for (own, face), vertices in corners.items():
        for target in set.intersection(*(at[vertex] for vertex in vertices)):
            seen, faces = covered.setdefault((own, target), (set(), []))
            seen |= vertices
            faces.append(face)
    return {
        (own, target): faces
        for (own, target), (seen, faces) in covered.items()
        if len(seen) == mesh.face_sizes[target]
    }
