"""Combinatorial polyhedra with rough vertices: input of `koebe`, which finds the true places."""

from __future__ import annotations

import numpy as np

from ddgfab.errors import InputError
from ddgfab.mesh import Floats, Ints, Mesh, unit
from ddgfab.quads import whole

MERGE_DIGITS = 9
"""Decimals to which places in a solid of size 1 are one vertex."""

_GOLDEN = (1.0 + 5.0**0.5) / 2.0


def merged_mesh(points: Floats, faces: Ints) -> Mesh:
    """Mesh of points (N, 3) of size about 1, several of which may be one vertex, and (F, n) ids."""
    rounded = np.round(points, MERGE_DIGITS) + 0.0  # no negative zeros
    _, first, inverse = np.unique(rounded, axis=0, return_index=True, return_inverse=True)
    order = np.argsort(first, kind="stable")  # in order of first appearance
    rank = np.empty_like(order)
    rank[order] = np.arange(len(order))
    return Mesh.build(points[first[order]], rank[inverse.ravel()][faces])


def cube_cells(cells: int) -> Mesh:
    """Surface of the cube of side 2 with cells x cells quads a face.

    Faces of the mesh run side after side of the cube: -x, +x, -y, +y, -z, +z.

    Raises
    ------
    InputError
        Fewer than one cell.
    """
    cells = whole(cells, 1, "cells on a side of the cube")
    place = np.linspace(-1.0, 1.0, cells + 1)
    u, v = (grid.ravel() for grid in np.meshgrid(place, place, indexing="ij"))
    ids = np.arange((cells + 1) ** 2).reshape(cells + 1, cells + 1)
    quads = np.stack([ids[:-1, :-1], ids[1:, :-1], ids[1:, 1:], ids[:-1, 1:]], axis=-1)
    points: list[Floats] = []
    faces: list[Ints] = []
    for axis in range(3):
        for side in (-1.0, 1.0):
            side_points = np.empty((len(u), 3))
            side_points[:, axis] = side
            side_points[:, (axis + 1) % 3], side_points[:, (axis + 2) % 3] = u, v
            own = quads.reshape(-1, 4) + len(points) * len(u)
            faces.append(own if side > 0 else own[:, ::-1])
            points.append(side_points)
    return merged_mesh(np.concatenate(points), np.concatenate(faces))


def pillow(cells: int) -> Mesh:
    """Two square grids of cells x cells glued along their rims, the four corners cut off.

    The corner vertices, which had two edges, are gone: the corner cells are triangles. Faces of
    the upper grid come first.

    Raises
    ------
    InputError
        Fewer than three cells, so that nothing but corners would be left.
    """
    cells = whole(cells, 3, "cells on a side of the pillow")
    place = np.linspace(-1.0, 1.0, cells + 1)
    u, v = np.meshgrid(place, place, indexing="ij")
    height = np.sqrt((1.0 - u**2) * (1.0 - v**2))
    ids = np.arange(u.size).reshape(u.shape)
    quads = np.stack([ids[:-1, :-1], ids[1:, :-1], ids[1:, 1:], ids[:-1, 1:]], axis=-1)
    quads = quads.reshape(-1, 4)
    below = ids + u.size
    rim = np.ones(u.shape, dtype=bool)
    rim[1:-1, 1:-1] = False
    below[rim] = ids[rim]
    under = below.ravel()[quads][:, ::-1]
    corners = {int(ids[i, j]) for i in (0, -1) for j in (0, -1)}
    faces = [
        [v for v in face if v not in corners] for face in np.concatenate([quads, under]).tolist()
    ]
    used, own = np.unique([v for face in faces for v in face], return_inverse=True)
    points = np.stack([np.tile(u.ravel(), 2), np.tile(v.ravel(), 2)], axis=1)
    z = np.concatenate([height.ravel(), -height.ravel()])
    sizes = np.cumsum([len(face) for face in faces])[:-1]
    return Mesh.build(np.column_stack([points, z])[used], np.split(own, sizes))


def triangle_cells(solid: str, cells: int) -> Mesh:
    """Tetrahedron, octahedron or icosahedron whose sides are divided into cells^2 triangles.

    Raises
    ------
    InputError
        Another solid, or fewer than one cell.
    """
    cells = whole(cells, 1, "cells on an edge")
    corners, faces = _triangles(solid)
    i, j = (a.ravel() for a in np.meshgrid(np.arange(cells + 1), np.arange(cells + 1)))
    inside = i + j <= cells
    i, j = i[inside], j[inside]
    ids = np.full((cells + 2, cells + 2), -1)
    ids[i, j] = np.arange(len(i))
    up = np.stack([ids[i, j], ids[i + 1, j], ids[i, j + 1]], axis=1)
    down = np.stack([ids[i + 1, j], ids[i + 1, j + 1], ids[i, j + 1]], axis=1)
    small = np.concatenate([up, down])
    small = small[(small >= 0).all(axis=1)]
    weights = np.stack([cells - i - j, i, j], axis=1) / cells
    points = np.einsum("pk,fkx->fpx", weights, corners[faces]).reshape(-1, 3)
    shift = len(i) * np.arange(len(faces))
    return merged_mesh(points, (small[None] + shift[:, None, None]).reshape(-1, 3))


def dual_solid(mesh: Mesh) -> Mesh:
    """The dual of a closed mesh: a vertex for each face, a face for each vertex."""
    lists = [mesh.star(v)[1] for v in range(mesh.n_vertices)]
    return Mesh.build(mesh.face_centers, lists)


def goldberg(cells: int) -> Mesh:
    """Hexagons and twelve pentagons: the dual of the icosahedron with cells^2 triangles a side."""
    return dual_solid(triangle_cells("icosahedron", cells))


def prism(sides: int) -> Mesh:
    """Prism over a regular polygon.

    Raises
    ------
    InputError
        Fewer than three sides.
    """
    sides = whole(sides, 3, "sides of a prism")
    ring = np.arange(sides)
    after = (ring + 1) % sides
    angle = 2.0 * np.pi * ring / sides
    circle = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    points = np.concatenate([np.insert(circle, 2, z, axis=1) for z in (-1.0, 1.0)])
    walls = np.stack([ring, after, sides + after, sides + ring], axis=1)
    return Mesh.build(points, [ring[::-1], sides + ring, *walls])


def antiprism(sides: int) -> Mesh:
    """Antiprism over a regular polygon.

    Raises
    ------
    InputError
        Fewer than three sides.
    """
    sides = whole(sides, 3, "sides of an antiprism")
    ring = np.arange(sides)
    after = (ring + 1) % sides
    angle = 2.0 * np.pi * np.concatenate([ring, ring + 0.5]) / sides
    z = np.repeat([-1.0, 1.0], sides)
    points = np.stack([np.cos(angle), np.sin(angle), z], axis=1)
    up = np.stack([ring, after, sides + ring], axis=1)
    down = np.stack([after, sides + after, sides + ring], axis=1)
    return Mesh.build(points, [ring[::-1], sides + ring, *up, *down])


def _triangles(solid: str) -> tuple[Floats, Ints]:
    """Unit corners, and the triangles counterclockwise seen from outside."""
    if solid == "tetrahedron":
        corners = np.array([(1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)], dtype=np.float64)
    elif solid == "octahedron":
        corners = np.concatenate([np.eye(3), -np.eye(3)])
    elif solid == "icosahedron":
        signs = [(s, t * _GOLDEN) for s in (-1, 1) for t in (-1, 1)]
        corners = np.array(
            [np.roll((0.0, s, t), k) for s, t in signs for k in range(3)], dtype=np.float64
        )
    else:
        raise InputError(f'solid "{solid}": tetrahedron, octahedron or icosahedron')
    corners = unit(corners)
    apart = np.linalg.norm(corners[:, None] - corners[None], axis=2)
    near = (apart < 1.5 * apart[apart > 0].min()) & (apart > 0)
    if solid == "octahedron":
        near = (apart > 0) & (apart < apart.max())
    triples = [
        (a, b, c)
        for a in range(len(corners))
        for b in range(a + 1, len(corners))
        for c in range(b + 1, len(corners))
        if near[a, b] and near[b, c] and near[a, c]
    ]
    faces = np.array(triples, dtype=np.int64)
    turned = np.linalg.det(corners[faces]) < 0
    faces[turned] = faces[turned][:, [0, 2, 1]]
    return corners, faces
