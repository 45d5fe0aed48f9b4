"""What a mesh must not lose while it is optimised: unfolded faces, corner angles, smoothness."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ddgfab.arguments import checked
from ddgfab.errors import InputError
from ddgfab.measures import dihedral_angles, interior_angles, planarity_percent
from ddgfab.mesh import Floats, Ints, Mesh
from ddgfab.optimize.problem import mean_edge
from ddgfab.optimize.terms.shape import second_differences

_TURNED = np.pi / 2
"""Faces whose normals differ by more than this [rad] across an edge are folded over it."""
_STRAIGHT = 1e-9
"""Corners bent back by less than this [rad] are straight."""
_COLLAPSED = 1e-3
"""Sides shorter than this part of the mean edge have collapsed: no beam is left of them."""


@dataclass(frozen=True)
class Quality:
    """Numbers that people judge a mesh by.

    Attributes
    ----------
    planarity : greatest distance of the diagonals over their mean (see `planarity_percent`)
    angles : least and greatest interior angle [rad]; reflex corners count above pi
    fairness : root mean square of the bends of polylines, |x0 - 2 x1 + x2| over the mean edge
    """

    planarity: float
    angles: tuple[float, float]
    fairness: float

    @staticmethod
    def of(mesh: Mesh) -> Quality:
        """Measure a mesh."""
        angles = interior_angles(mesh)
        return Quality(
            float(planarity_percent(mesh).max()) / 100,
            (float(angles.min()), float(angles.max())),
            roughness(mesh),
        )


@checked
def roughness(mesh: Mesh) -> float:
    """Root mean square of the bends of polylines, |x0 - 2 x1 + x2| over the mean edge."""
    bends = second_differences(mesh) @ mesh.vertices
    if not len(bends):
        return 0.0
    return float(np.sqrt((bends**2).sum(axis=1).mean())) / mean_edge(mesh)


def zigzag(mesh: Mesh) -> Floats:
    """(E,) by how much the bend at an edge differs from the bends beside it [rad].

    Beside an edge lie those opposite to it in its two faces; the bend is the dihedral angle. On a
    smooth mesh bends change little from edge to edge; where a mesh is crumpled they alternate, or
    gather in creases between flat parts. 0 at the boundary, and where both faces are triangles.
    """
    bends = dihedral_angles(mesh)
    pairs = [np.zeros((0, 2), dtype=np.int64)]
    for size in np.unique(mesh.face_sizes[mesh.face_sizes > 3]).tolist():
        ids = np.flatnonzero(mesh.face_sizes == size)
        sides = mesh.corner_edge[mesh.face_start[ids, None] + np.arange(size)]
        around = np.arange(size if size % 2 else size // 2)
        pairs.append(np.stack([sides[:, around], sides[:, (around + size // 2) % size]], -1))
    beside = np.concatenate([p.reshape(-1, 2) for p in pairs])
    inner = ~mesh.boundary_edge
    beside = beside[inner[beside].all(axis=1)]
    count = np.bincount(beside.ravel(), minlength=mesh.n_edges)
    total = np.bincount(beside[:, 0], bends[beside[:, 1]], mesh.n_edges)
    total += np.bincount(beside[:, 1], bends[beside[:, 0]], mesh.n_edges)
    differs: Floats = np.where(count > 0, np.abs(bends - total / np.maximum(count, 1)), 0.0)
    return differs


def reflex_faces(mesh: Mesh, vertices: Ints | None = None) -> Ints:
    """Faces with an interior angle above pi, anywhere or at one of the vertices given."""
    reflex = interior_angles(mesh) > np.pi + _STRAIGHT
    if vertices is not None:
        reflex &= np.isin(mesh.corners, vertices)
    found: Ints = np.unique(mesh.corner_face[reflex])
    return found


def _crossed(mesh: Mesh) -> NDArray[np.bool_]:
    """(F,) faces of which two sides cross, seen along the face normal."""
    crossed = np.zeros(mesh.n_faces, dtype=bool)
    for size in np.unique(mesh.face_sizes[mesh.face_sizes > 3]).tolist():
        ids = np.flatnonzero(mesh.face_sizes == size)
        points = mesh.vertices[mesh.corners[mesh.face_start[ids, None] + np.arange(size)]]
        normal = mesh.face_normals[ids]

        def side(a: Floats, b: Floats, c: Floats, up: Floats = normal) -> Floats:
            return np.asarray(np.einsum("fx,fx->f", np.cross(b - a, c - a), up))

        for i in range(size):
            for j in range(i + 2, size - (i == 0)):
                a, b = points[:, i], points[:, i + 1]
                c, d = points[:, j], points[:, (j + 1) % size]
                crossed[ids] |= (side(a, b, c) * side(a, b, d) < 0) & (
                    side(c, d, a) * side(c, d, b) < 0
                )
    return crossed


@checked
def folded_faces(mesh: Mesh, before: Mesh | None = None) -> Ints:
    """Faces of which sides cross or have collapsed, without area, or folded over a neighbour.

    Parameters
    ----------
    before : the same mesh earlier; what was folded there already does not count
    """

    def folded(one: Mesh) -> NDArray[np.bool_]:
        bad = _crossed(one) | ~(one.face_areas > 0)
        over = np.abs(dihedral_angles(one)) > _TURNED
        bad[one.edge_faces[over].ravel()] = True
        sides = np.linalg.norm(np.subtract(*one.vertices[one.edges.T]), axis=1)
        gone = one.edge_faces[sides < _COLLAPSED * sides.mean()].ravel()
        bad[gone[gone >= 0]] = True  # edges of the boundary have one face
        return bad

    if before is not None and before.n_faces != mesh.n_faces:
        raise InputError(f"before has {before.n_faces} faces; {mesh.n_faces} are needed")
    now = folded(mesh)
    return np.flatnonzero(now if before is None else now & ~folded(before))
