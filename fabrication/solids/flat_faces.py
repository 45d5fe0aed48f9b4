"""Plane faces of a boundary as triangles over the points along their edges."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Final

import numpy as np

from ddgfab.mesh import Floats, Ints
from fabrication.boundary import Boundary, cross_rows

QUAD: Final = 4
"""Polygons of so few corners are fanned out when they are convex."""

SLIVER: Final = 1e-6
"""A triangle lower than this part of its longest side has its three corners in line."""


def flat_triangles(
    boundary: Boundary, points: Floats, ring: Callable[[Ints], tuple[Ints, Ints]]
) -> Ints:
    """(n, 3) ids of points: the triangles of all plane faces, outward.

    Parameters
    ----------
    points : of the mesh [mm]
    ring : ids along some coedges, the last point of each left out, and how many each has
    """
    b = boundary
    on = np.flatnonzero(~b.face_cylinder[b.coedge_face])
    ids, counts = ring(b.coedges[on])
    loop_of = np.repeat(np.arange(len(b.loop_face)), np.diff(b.loop_start))[on]
    plane_loops = np.flatnonzero(~b.face_cylinder[b.loop_face])
    sizes = np.bincount(loop_of, counts, len(b.loop_face)).astype(np.int64)[plane_loops]
    starts = np.cumsum(sizes) - sizes
    face = b.loop_face[plane_loops]
    of_point = np.repeat(face, sizes)
    ydir = cross_rows(b.face_axis, b.face_xdir)
    place = points[ids]
    flat = np.stack(
        [np.einsum("ni,ni->n", place, axis[of_point]) for axis in (b.face_xdir, ydir)], axis=1
    )
    alone = np.bincount(face, minlength=b.n_faces)[face] == 1
    fans, done = [], np.zeros(len(face), dtype=np.bool_)
    for size in (QUAD - 1, QUAD):
        few = np.flatnonzero(alone & (sizes == size))
        corners = starts[few, None] + np.arange(size)
        convex = _convex(flat[corners])
        done[few[convex]] = True
        corners = corners[convex]
        fans += [corners[:, [0, k, k + 1]] for k in range(1, size - 1)]
    rest = np.flatnonzero(~done)
    cut = _triangulated(flat, starts[rest], sizes[rest], face[rest])
    return np.asarray(ids[np.concatenate([*fans, *cut])])


def _convex(polygons: Floats) -> Ints:
    """(n,) whether small polygons (n, k, 2) turn left at every corner."""
    ahead = np.roll(polygons, -1, axis=1) - polygons
    after = np.roll(ahead, -1, axis=1)
    turn = ahead[..., 0] * after[..., 1] > after[..., 0] * ahead[..., 1]
    return np.asarray(turn.all(axis=1))


def _triangulated(flat: Floats, starts: Ints, sizes: Ints, faces: Ints) -> list[Ints]:
    """Triangles of polygons with holes, as rows of `flat` (n, 2); loops of a face in a row."""
    if not len(starts):
        return []
    import manifold3d

    first = np.flatnonzero(np.diff(faces, prepend=-1))
    begin, end = starts.tolist(), (starts + sizes).tolist()
    found = []
    for one, after in zip(first.tolist(), [*first[1:].tolist(), len(faces)], strict=True):
        loops = [flat[begin[k] : end[k]] for k in range(one, after)]
        found.append(np.asarray(manifold3d.triangulate(loops), dtype=np.int64) + begin[one])
    flatness = _slivers(np.concatenate(found), flat)
    if flatness.any():
        parts = np.split(flatness, np.cumsum([len(triangles) for triangles in found])[:-1])
        found = [
            np.array(without_slivers(triangles.tolist(), flat)) if thin.any() else triangles
            for triangles, thin in zip(found, parts, strict=True)
        ]
    return found


def _slivers(triangles: Ints, points: Floats) -> Ints:
    """(n,) whether triangles may have their corners in line."""
    corners = points[triangles]
    one, two = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    doubled = np.abs(one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0])
    reach = np.maximum(np.einsum("ni,ni->n", one, one), np.einsum("ni,ni->n", two, two))
    return np.asarray(doubled <= 2.0 * SLIVER * reach)


def without_slivers(triangles: list[list[int]], points: Floats) -> list[list[int]]:
    """The same polygon without triangles whose corners are in line.

    Such triangles lie between the letters of a row: each gives its longest side to the other
    diagonal of the two triangles there.
    """

    def longest(triangle: Sequence[int]) -> tuple[list[int], bool]:
        """The triangle beginning with its longest side, and whether it has no height."""
        corners = points[list(triangle)]
        sides = np.roll(corners, -1, axis=0) - corners
        square = np.einsum("ij,ij->i", sides, sides)
        k = int(square.argmax())
        area = abs(sides[0, 0] * sides[1, 1] - sides[0, 1] * sides[1, 0])
        return [*triangle[k:], *triangle[:k]], bool(area <= SLIVER * square[k])

    todo = np.flatnonzero(_slivers(np.array(triangles), points)).tolist()
    owner = {(t[k - 1], t[k]): n for n, t in enumerate(triangles) for k in range(3)}
    for _ in range(len(triangles) ** 2):
        if not todo:
            break
        here = todo.pop()
        (a, b, c), flat = longest(triangles[here])
        there = owner.get((b, a))
        if not flat or there is None:
            continue
        del owner[a, b], owner[b, a]
        d = next(corner for corner in triangles[there] if corner not in (a, b))
        triangles[here], triangles[there] = [a, d, c], [d, b, c]
        for number in (here, there):
            t = triangles[number]
            owner |= {(t[k - 1], t[k]): number for k in range(3)}
            todo.append(number)
    return triangles
