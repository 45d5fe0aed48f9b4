"""Is a mesh parallel to a Koebe net? Then it has an offset at a constant distance of edges."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from ddgfab.arguments import checked
from ddgfab.errors import DegenerateError
from ddgfab.mesh import Floats, Mesh, unit
from ddgfab.tolerances import RELATIVE_DEGENERATE
from ddgfab.trees import alternating_signs

EDGE_RELATIVE: Final = 1e-9
"""Greatest turn of edges [rad], and spread of their distance in parts of it, of an edge offset."""


@checked
def koebe_field(mesh: Mesh, tolerance: float = EDGE_RELATIVE) -> Floats:
    """(V, 3) vertices of the parallel Koebe net: every edge touches the unit sphere.

    The edges at a vertex touch a sphere just when they lie on a cone of revolution, whose axis
    solves <u_i, a> = 1 for the unit edges u_i; |k| is 1 / sin of its angle. Where the mesh is a
    saddle, one family of its edges runs against that of the Koebe net, so u_i changes sign.
    Corners with two edges follow from their neighbours.

    Parameters
    ----------
    tolerance : greatest turn of edges [rad], and spread of their distance in parts of it

    Raises
    ------
    DegenerateError
        The mesh is not parallel to a Koebe net; names the worst edge, or the vertex.

    Source: Pottmann, Liu, Wallner, Bobenko, Wang 2007, section 3.3; mathematics.md 10.6, 7.4.
    """
    patterns = [np.ones(mesh.n_edges)]
    alternate, failing = alternating_signs(mesh)
    if not len(failing):
        patterns.append(alternate.astype(np.float64))
    failures: list[DegenerateError] = []
    for signs in patterns:
        try:
            field = _touching(mesh, signs)
            if np.einsum("vx,vx->", field, mesh.vertex_normals) < 0:
                field = -field
            _refuse(mesh, field, tolerance)
        except DegenerateError as error:
            failures.append(error)
        else:
            return field
    raise failures[0]


def _touching(mesh: Mesh, signs: Floats) -> Floats:
    """Field of `koebe_field` for given signs of the edges."""
    field = np.zeros_like(mesh.vertices)
    known = np.zeros(mesh.n_vertices, dtype=bool)
    along = unit(mesh.edge_vectors) * signs[:, None]
    for valence in np.unique(mesh.valences[mesh.valences > 2]).tolist():
        ids = np.flatnonzero(mesh.valences == valence)
        edges = mesh.star_edges[mesh.star_start[ids, None] + np.arange(valence)]
        away = np.where(mesh.edges[edges, 0] == ids[:, None], 1.0, -1.0)
        axis = np.linalg.pinv(along[edges] * away[..., None]).sum(axis=-1)
        square = np.einsum("vx,vx->v", axis, axis)
        good = square > 1.0  # 1 / cos^2 of the cone's angle
        field[ids[good]] = -axis[good] / np.sqrt(square[good] - 1.0)[:, None]
        known[ids[good]] = True
    todo = np.flatnonzero(~known & (mesh.valences > 0)).tolist()
    while todo:
        rest = [v for v in todo if not _from_neighbours(mesh, along, v, field, known)]
        if len(rest) == len(todo):
            raise DegenerateError(
                f"vertex {rest[0]}: its {mesh.valences[rest[0]]} edges lie on no cone of "
                "revolution, so the mesh has no offset at a constant distance of edges"
            )
        todo = rest
    return field


def _from_neighbours(
    mesh: Mesh, along: Floats, vertex: int, field: Floats, known: NDArray[np.bool_]
) -> bool:
    """Write the field at a vertex from those at known neighbours; False where they are too few.

    Two neighbours: where the lines of their edges meet. One, at a corner with edges w, w': on the
    line of w, with <k, w> = <k, w'>, as the sphere is at one distance along both.
    """
    edges = mesh.star(vertex)[0]
    away = along[edges] * np.where(mesh.edges[edges, 0] == vertex, 1.0, -1.0)[:, None]
    ends = mesh.edges[edges].sum(axis=1) - vertex
    sure = np.flatnonzero(known[ends])
    across = np.eye(3) - np.einsum("ki,kj->kij", away[sure], away[sure])
    matrix = across.sum(axis=0)
    if len(sure) > 1 and np.linalg.eigvalsh(matrix)[0] > RELATIVE_DEGENERATE:
        field[vertex] = np.linalg.solve(matrix, np.einsum("kij,kj->i", across, field[ends[sure]]))
    elif len(sure) == 1 and len(edges) == 2:
        near, line = field[ends[sure[0]]], away[sure[0]]
        turn = line - away[1 - sure[0]]
        slope = float(line @ turn)
        if abs(slope) <= RELATIVE_DEGENERATE:
            return False
        field[vertex] = near - (near @ turn) / slope * line
    else:
        return False
    known[vertex] = True
    return True


def _refuse(mesh: Mesh, field: Floats, tolerance: float) -> None:
    """Raise `DegenerateError` unless the field is a mesh parallel to this one, at distance 1."""
    start, end = mesh.edges.T
    along = unit(mesh.edge_vectors)
    size = float(np.median(mesh.edge_lengths))
    turned = np.linalg.norm(np.cross(field[end] - field[start], along), axis=1)
    turned *= size / mesh.edge_lengths
    away = np.linalg.norm(np.cross(0.5 * (field[start] + field[end]), along), axis=1)
    spread = float(np.ptp(away)) / float(np.linalg.norm(field, axis=1).max())
    if turned.max() <= tolerance and spread <= tolerance:
        return
    raise DegenerateError(
        "the mesh is not parallel to a Koebe net: offset by one edge length its edges turn by up "
        f"to {np.degrees(turned.max()):.2g} deg (edge {int(turned.argmax())}) and the distance of "
        f"its edges varies by {spread:.1e} (limit {tolerance:g})"
    )


def edge_offset_kinds(mesh: Mesh, tolerance: float) -> tuple[bool, bool]:
    """Whether the mesh is parallel to a Koebe net, and whether it is one: edges touch a sphere."""
    try:
        field = koebe_field(mesh, tolerance)
    except DegenerateError:
        return False, False
    used = mesh.valences > 0
    v, k = mesh.vertices[used], field[used]
    v, k = v - v.mean(axis=0), k - k.mean(axis=0)
    radius = float(np.einsum("vx,vx->", v, k) / np.einsum("vx,vx->", k, k))
    off = np.linalg.norm(v - radius * k, axis=1).max()
    return True, bool(off <= tolerance * np.linalg.norm(v, axis=1).max())
