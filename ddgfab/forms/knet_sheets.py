"""K-nets as meshes to build: bands cut along their diagonals, sides turned outwards, placement.

A K-net (i, j) is cut to a band by j - i (across) and i + j (along): its border then zigzags, as
that of a crab net does, and follows the lines of curvature of the smooth surface.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.errors import InputError
from ddgfab.forms.placing import grounded
from ddgfab.mesh import Floats, Mesh
from ddgfab.nets.knet.net import knet


def band_mesh(points: Floats, across: tuple[int, int], along: tuple[int, int]) -> Mesh:
    """Mesh of the quads of a net (M + 1, N + 1, 3) whose corners all lie in a band.

    Parameters
    ----------
    points : of the net, point (i, j)
    across, along : least and greatest j - i, and i + j, of a point

    Raises
    ------
    InputError
        A band without quads.
    """
    m, n = points.shape[:2]
    p, s = (op(np.arange(n - 1), np.arange(m - 1)[:, None]) for op in (np.subtract, np.add))
    # A quad spans two steps of j - i, and of i + j.
    inside = (p > across[0]) & (p < across[1]) & (s >= along[0]) & (s + 2 <= along[1])
    i, j = np.nonzero(inside)
    if not len(i):
        raise InputError(f"no quad of {m} x {n} points lies in the band {across}, {along}")
    corner = i * n + j
    faces = np.stack([corner, corner + n, corner + n + 1, corner + 1], axis=-1)
    used, ids = np.unique(faces, return_inverse=True)
    return Mesh.build(points.reshape(-1, 3)[used], ids.reshape(-1, 4))


def ring_mesh(radii: Floats, heights: Floats, n_fold: int) -> Mesh:
    """Mesh of rings of points, each half a step on from the one below; quads of three rings.

    Parameters
    ----------
    radii, heights : (K,) of the rings
    n_fold : points on a ring
    """
    azimuth = np.pi / n_fold * (2 * np.arange(n_fold) + np.arange(len(radii))[:, None])
    wide, high = radii[:, None], heights[:, None] + 0.0 * azimuth
    points = np.stack([wide * np.cos(azimuth), wide * np.sin(azimuth), high], axis=-1)
    ids = np.arange(azimuth.size).reshape(azimuth.shape)
    low, middle, top = ids[:-2], ids[1:-1], np.roll(ids[2:], 1, axis=1)
    faces = np.stack([low, middle, top, np.roll(middle, 1, axis=1)], axis=-1)
    return Mesh.build(points.reshape(-1, 3), faces.reshape(-1, 4))


def facing(mesh: Mesh, outwards: ArrayLike) -> Mesh:
    """The mesh with its faces turned, all together, to the side that a field points to.

    Parameters
    ----------
    outwards : (3,), or (F, 3) by face; mostly along or against the face normals
    """
    flow = np.einsum("fx,fx->", mesh.vector_areas, np.broadcast_to(outwards, (mesh.n_faces, 3)))
    if flow >= 0:
        return mesh
    return Mesh.build(mesh.vertices, [face[::-1] for face in mesh.faces])


def round_tower(mesh: Mesh) -> Mesh:
    """The mesh on the ground z = 0, its faces outwards from its axis."""
    away = mesh.face_centers * [1.0, 1.0, 0.0]
    return facing(mesh, away).with_vertices(grounded(mesh.vertices))


def roof(mesh: Mesh) -> Mesh:
    """The mesh on the ground z = 0, its faces upwards."""
    return facing(mesh, [0.0, 0.0, 1.0]).with_vertices(grounded(mesh.vertices))


def levelled(mesh: Mesh) -> Mesh:
    """The mesh turned so that its principal axes stand along x, y, z, in falling order of extent.

    Vertex 0 comes to the side of negative x and below the middle.
    """
    middle = mesh.vertices.mean(axis=0)
    axes = np.linalg.svd(mesh.vertices - middle, full_matrices=False)[2]
    first = axes @ (mesh.vertices[0] - middle)
    along, normal = (-np.copysign(1.0, first[k]) * axes[k] for k in (0, 2))
    frame = np.stack([along, np.cross(normal, along), normal], axis=-1)
    return mesh.with_vertices(mesh.vertices @ frame)


def crossing_lines(cells: tuple[int, int], delta: float, angle: float, r: float) -> Floats:
    """(2 M + 1, 2 N + 1, 3) Amsler net about the point where its two straight lines cross.

    Four K-nets from one corner: the steps back along a line obey the same rule as those forth, so
    that each quadrant has the angle between its own two half lines, and no turns.

    Parameters
    ----------
    cells : (M, N) cells on each side of the crossing, along either line
    delta : normal angle of all edges [rad]
    angle : between the lines [rad], in (0, pi)
    r : scale
    """
    m, n = cells
    out = np.empty((2 * m + 1, 2 * n + 1, 3))
    for forth in (1, -1):
        for left in (1, -1):
            corner = angle if forth * left > 0 else angle - np.pi
            part = knet(
                [np.full(m, delta), np.full(n, delta)],
                [np.zeros(m - 1), np.zeros(n - 1)],
                corner,
                r=r,
                normal=[0.0, 0.0, 1.0],
                edge=[float(forth), 0.0, 0.0],
            )
            out[m::forth, n::left] = part.points
    return out
