"""Edges labelled + and -, alternating round every face: whether it can be, and the double cover."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import breadth_first_order, connected_components

from ddgfab.arguments import checked
from ddgfab.errors import InputError, MeshError
from ddgfab.mesh import Ints, Mesh
from ddgfab.trees import alternating_signs, corner_graph

SHOWN = 12
"""How many faces an error names."""

_ADVICE = (
    "take the branched double cover (SIsothermic.covered, or sheets = 2) or a simply connected "
    "piece without them (KoebePolyhedron.net(faces), sisothermic_labels.piece)"
)


@checked
def label_edges(mesh: Mesh) -> Ints:
    """(E,) +1 and -1, alternating round every face; +1 at the first edge of each component.

    Round an inner vertex they alternate too, so faces and inner vertices must be even.

    Raises
    ------
    MeshError
        It cannot be: names the faces of an odd cycle (a face, the faces round a vertex, or a ring
        of faces round a hole).

    Source: mathematics.md 7.5; S-quad-graphs: Bobenko, Hoffmann, Springborn 2006, section 2.
    """
    signs, failing = alternating_signs(mesh)
    if len(failing):
        raise MeshError(f"no labelling of edges: {_odd_cycle(mesh, int(failing[0]))}")
    return signs


def checked_labels(mesh: Mesh, labels: ArrayLike | None) -> Ints:
    """(E,) labels that were given, of the right shape and +1 or -1; those found where none were.

    Raises
    ------
    InputError
        Another shape, or another value; names the edge.
    MeshError
        As `label_edges`.
    """
    if labels is None:
        return label_edges(mesh)
    given = np.asarray(labels)
    if given.shape != (mesh.n_edges,):
        raise InputError(f"labels have shape {given.shape}; {(mesh.n_edges,)} is needed")
    bad = np.flatnonzero((given != 1) & (given != -1))
    if len(bad):
        raise InputError(f"edge {bad[0]} has the label {given[bad[0]]}; +1 or -1 is needed")
    return np.asarray(given, dtype=np.int64)


def _odd_cycle(mesh: Mesh, corner: int) -> str:
    """Where signs cannot alternate: an odd face, an odd vertex, or a ring through a corner."""
    odd = np.flatnonzero(mesh.face_sizes % 2)
    if len(odd):
        names = ", ".join(map(str, odd[:SHOWN])) + (", ..." if len(odd) > SHOWN else "")
        return (
            f"{len(odd)} faces have an odd number of sides (faces {names}); round an odd face the "
            f"signs cannot alternate\n{_ADVICE}"
        )
    inner = ~mesh.boundary_vertex & (mesh.valences % 2 == 1)
    if inner.any():
        vertex = int(inner.argmax())
        faces = ", ".join(map(str, np.sort(mesh.star(vertex)[1])[:SHOWN]))
        return (
            f"{int(inner.sum())} inner vertices have an odd number of edges (the first is vertex "
            f"{vertex} between faces {faces})\n{_ADVICE}"
        )
    link = int(mesh.corner_edge[corner]), int(mesh.corner_edge[mesh.corner_next[corner]])
    before = breadth_first_order(corner_graph(mesh), 0, directed=False)[1]
    ways: list[list[int]] = []
    for edge in link:
        ways.append([edge])
        while before[ways[-1][-1]] >= 0:
            ways[-1].append(int(before[ways[-1][-1]]))
    ring = sorted(set(ways[0]) ^ set(ways[1])) or list(link)
    faces = ", ".join(map(str, np.unique(mesh.edge_faces[ring, 0])[:SHOWN]))
    return f"it fails on a ring round a hole (faces {faces}, ...)\n{_ADVICE}"


@dataclass(frozen=True, eq=False)
class Submesh:
    """Some faces of a mesh as a mesh of their own.

    Attributes
    ----------
    mesh : the faces, in rising order of their old ids
    vertices, faces : old ids of its vertices and faces
    """

    mesh: Mesh
    vertices: Ints
    faces: Ints


@checked
def piece(mesh: Mesh, faces: Ints | NDArray[np.bool_]) -> Submesh:
    """The given faces (ids, or a mask of all) as a mesh of their own.

    Raises
    ------
    InputError
        Neither whole ids nor a mask of all faces.
    MeshError
        No face, an id out of range, or faces that meet in a vertex only.
    """
    given = np.asarray(faces)
    mask = given.dtype == bool and given.shape == (mesh.n_faces,)
    if not (mask or (given.ndim == 1 and (given.dtype.kind in "iu" or not len(given)))):
        raise InputError(
            f"faces of type {given.dtype} and shape {given.shape}: ids, or a mask of the "
            f"{mesh.n_faces} faces, are needed"
        )
    chosen = np.flatnonzero(given) if mask else np.unique(given).astype(np.int64)
    if not len(chosen):
        raise MeshError("the piece has no faces")
    if chosen[0] < 0 or chosen[-1] >= mesh.n_faces:
        out = chosen[0] if chosen[0] < 0 else chosen[-1]
        raise MeshError(f"face {out} is not in the mesh of {mesh.n_faces} faces")
    inside = np.zeros(mesh.n_faces, dtype=bool)
    inside[chosen] = True
    corners = mesh.corners[inside[mesh.corner_face]]
    vertices, own = np.unique(corners, return_inverse=True)
    lists = np.split(own, np.cumsum(mesh.face_sizes[chosen])[:-1])
    return Submesh(Mesh.build(mesh.vertices[vertices], lists), vertices, chosen)


@dataclass(frozen=True, eq=False)
class DoubleCover:
    """Two sheets over a mesh on which edges can be labelled; see `double_cover`.

    Attributes
    ----------
    mesh : the cover; its vertices lie where those below lie
    vertices, faces : (V',), (F',) the vertex and face below each
    sheets : (F',) 0 or 1: the sheet of each face; an odd face, which winds twice, has 0
    labels : (E',) +1 and -1, alternating round every face
    """

    mesh: Mesh
    vertices: Ints
    faces: Ints
    sheets: Ints
    labels: Ints


@checked
def double_cover(mesh: Mesh) -> DoubleCover:
    """The branched double cover on which edges alternate: branched at odd vertices and faces.

    An edge has a copy with each sign; round a face the signs alternate. Faces and inner vertices
    with an even number of edges have two copies, odd ones a single copy with twice as many.
    Where the mesh itself can be labelled, the cover falls into two copies of it.

    Raises
    ------
    MeshError
        Two copies of an edge would join the same vertices (edges between two odd vertices, as on
        the plain cube): subdivide first.

    Source: Bobenko, Hoffmann, Springborn 2006, section 2; mathematics.md 7.5.
    """
    count = len(mesh.corners)
    begin = np.concatenate([mesh.face_start[:-1], mesh.face_start[:-1]])
    size = np.concatenate([mesh.face_sizes, mesh.face_sizes])
    face = np.concatenate([np.arange(mesh.n_faces)] * 2)
    sheet = np.repeat([0, 1], mesh.n_faces)
    odd = size % 2 == 1
    keep = ~(odd & (sheet == 1))
    begin, size, face, sheet, odd = begin[keep], size[keep], face[keep], sheet[keep], odd[keep]
    length = np.where(odd, 2 * size, size)
    own = np.repeat(np.arange(len(face)), length)
    step = np.arange(len(own)) - np.repeat(np.cumsum(length) - length, length)
    below = begin[own] + step % size[own]
    sign = (step + sheet[own]) % 2
    half = 2 * below + sign  # a corner with the sign of the edge that starts there
    # Round a vertex: from a corner over the edge before it to the next corner, the other sign.
    order = np.argsort(mesh.corner_edge, kind="stable")
    twin = np.full(count, -1)
    pair = np.flatnonzero(np.diff(mesh.corner_edge[order]) == 0)
    twin[order[pair]], twin[order[pair + 1]] = order[pair + 1], order[pair]
    turn = twin[mesh.corner_previous]
    here = np.flatnonzero(turn >= 0)
    links = [
        np.concatenate([2 * here, 2 * here + 1]),
        np.concatenate([2 * turn[here] + 1, 2 * turn[here]]),
    ]
    graph = coo_array((np.ones(len(links[0]), dtype=np.int8), tuple(links)), shape=(2 * count,) * 2)
    vertex_of = connected_components(graph, directed=False)[1]
    corners = vertex_of[half]
    used, corners = np.unique(corners, return_inverse=True)
    vertices = np.empty(len(used), dtype=np.int64)
    vertices[corners] = mesh.corners[below]
    lists = np.split(corners, np.cumsum(length)[:-1])
    try:
        cover = Mesh.build(mesh.vertices[vertices], lists)
    except MeshError as error:
        raise MeshError(
            f"the double cover needs a finer mesh: {error}\nsubdivide the faces first"
        ) from None
    labels = np.empty(cover.n_edges, dtype=np.int64)
    labels[cover.corner_edge] = 1 - 2 * sign
    return DoubleCover(cover, vertices, face, sheet, labels)
