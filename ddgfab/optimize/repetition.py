"""Families of congruent panels and of equal edges within a tolerance: counted and clustered."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np
from scipy.spatial import cKDTree

from ddgfab.mesh import Floats, Ints, Mesh
from ddgfab.optimize.terms.planarity import polygon_corners

Piece: TypeAlias = Literal["panel", "edge"]
"""What repeats: panels (faces), or edges by their length alone."""

_ROUNDS = 30
"""Rounds of k-means; they settle much earlier."""


@dataclass(frozen=True, eq=False)
class Pieces:
    """Pieces of one kind and number of corners.

    Attributes
    ----------
    ids : (n,) faces or edges
    corners : (n, k) vertex ids in order
    pairs : (p, 2) places of the corners whose distances make the shape
    turns : (m, p) for each way of turning a piece, which pair takes the place of which
    """

    ids: Ints
    corners: Ints
    pairs: Ints
    turns: Ints

    def distances(self, vertices: Floats) -> Floats:
        """(n, p) distances of the pairs of corners."""
        ends = vertices[self.corners[:, self.pairs]]
        lengths: Floats = np.linalg.norm(ends[:, :, 1] - ends[:, :, 0], axis=2)
        return lengths


def pieces(mesh: Mesh, of: Piece) -> list[Pieces]:
    """The panels by their number of corners, or the edges, of a mesh."""
    if of == "edge":
        one = np.zeros((1, 1), dtype=np.int64)
        return [Pieces(np.arange(mesh.n_edges), mesh.edges, np.array([[0, 1]]), one)]
    found = []
    for size in np.unique(mesh.face_sizes).tolist():
        ids, corners = polygon_corners(mesh, size)
        pairs = np.stack(np.triu_indices(size, 1), axis=1)
        place = np.zeros((size, size), dtype=np.int64)
        place[pairs[:, 0], pairs[:, 1]] = place[pairs[:, 1], pairs[:, 0]] = np.arange(len(pairs))
        turned = (pairs[None] + np.arange(size)[:, None, None]) % size
        found.append(Pieces(ids, corners, pairs, place[turned[..., 0], turned[..., 1]]))
    return found


def family_labels(mesh: Mesh, of: Piece, tolerance: float) -> Ints:
    """(n,) family of each face or edge: the number of its first member, in order of appearance.

    In order, every piece not yet taken leads those that match it, as in the part numbers of a
    job. Panels match where a rigid motion that keeps the outer side brings all corners within the
    tolerance of the leader's (best fit of centroid and rotation); edges where lengths do.

    Parameters
    ----------
    tolerance : in the unit of the mesh
    """
    labels = np.full(mesh.n_edges if of == "edge" else mesh.n_faces, -1)
    for group in pieces(mesh, of):
        labels[group.ids] = group.ids[_leaders(mesh, group, of, tolerance)]
    return labels


def count_families(mesh: Mesh, of: Piece, tolerance: float) -> int:
    """Number of families of `family_labels`."""
    return len(np.unique(family_labels(mesh, of, tolerance)))


def _leaders(mesh: Mesh, group: Pieces, of: Piece, tolerance: float) -> Ints:
    """(n,) for each piece of a group, which one leads its family."""
    shapes = group.distances(mesh.vertices)
    tree = cKDTree(shapes)
    flat = _flattened(mesh, group) if of == "panel" else None
    # Corners within the tolerance change distances by twice as much at most.
    reach = tolerance if flat is None else 2 * tolerance
    leader = np.full(len(shapes), -1)
    for i in range(len(shapes)):
        if leader[i] >= 0:
            continue
        leader[i] = i
        near = tree.query_ball_point(shapes[i][group.turns], reach, p=np.inf)
        for turn, found in enumerate(near):
            hits = np.array([k for k in found if leader[k] < 0], dtype=np.int64)
            if flat is not None and len(hits):
                hits = hits[_deviation(np.roll(flat[i], -turn), flat[hits]) <= tolerance]
            leader[hits] = i
    return leader


def _flattened(mesh: Mesh, group: Pieces) -> Floats:
    """(n, k) corners as complex numbers in the plane of the face, centroid at zero."""
    points = mesh.vertices[group.corners]
    points = points - points.mean(axis=1, keepdims=True)
    normal = mesh.face_normals[group.ids]
    first = points[:, 0] - np.einsum("nx,nx->n", points[:, 0], normal)[:, None] * normal
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    second = np.cross(normal, first)
    flat: Floats = np.einsum("nkx,nx->nk", points, first) + 1j * np.einsum(
        "nkx,nx->nk", points, second
    )
    return flat


def _deviation(one: Floats, others: Floats) -> Floats:
    """(h,) greatest distance of corners of (h, k) shapes from a shape turned onto them."""
    product = np.sum(others * np.conj(one), axis=1)
    turn = product / np.abs(product)
    worst: Floats = np.abs(others - turn[:, None] * one).max(axis=1)
    return worst


@dataclass(frozen=True, eq=False)
class Clusters:
    """Shapes that pieces are near to.

    Attributes
    ----------
    shapes : (K, p) shapes of the clusters
    cluster : (n,) number of each piece's
    places : (n, p) which distance of it stands for each of the piece's: the way it is turned
    """

    shapes: Floats
    cluster: Ints
    places: Ints

    @property
    def targets(self) -> Floats:
        """(n, p) distances that the clusters ask of the pieces."""
        return self.shapes[self.cluster[:, None], self.places]


def cluster_shapes(shapes: Floats, turns: Ints, count: int) -> Clusters:
    """k-means of (n, p) shapes up to turning.

    Starts with the shape nearest to the mean and, one after another, those farthest from all
    taken; deterministic.
    """
    variants = shapes[:, turns]  # (n, m, p)

    def distances(center: Floats) -> Floats:
        apart: Floats = np.linalg.norm(variants - center, axis=2)
        return apart

    first = int(np.linalg.norm(shapes - shapes.mean(axis=0), axis=1).argmin())
    centers = [shapes[first]]
    least = distances(centers[0]).min(axis=1)
    for _ in range(count - 1):
        centers.append(shapes[int(least.argmax())])
        least = np.minimum(least, distances(centers[-1]).min(axis=1))
    at, cluster = np.array(centers), np.full(len(shapes), -1)
    for _ in range(_ROUNDS):
        apart, nearest = cKDTree(at).query(variants)  # (n, m)
        turn = apart.argmin(axis=1)
        new = nearest[np.arange(len(shapes)), turn]
        if np.array_equal(new, cluster):
            break
        cluster = new
        total = np.zeros_like(at)
        np.add.at(total, cluster, variants[np.arange(len(shapes)), turn])
        members = np.bincount(cluster, minlength=len(at))[:, None]
        at = np.where(members > 0, total / np.maximum(members, 1), at)
    return Clusters(at, cluster, np.argsort(turns[turn], axis=1))
