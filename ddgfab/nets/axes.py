"""Axes of the circles of a circular net, their discrete developables, and vertex normals.

Source: Bobenko, Suris, Discrete Differential Geometry, 3.1; Pottmann, Wallner 2008; mathematics.md
2.5, 2.7.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ddgfab.arguments import checked, of_shape
from ddgfab.errors import InputError
from ddgfab.mesh import Floats, unit
from ddgfab.quads import Place, cross, edge_frame, finite, measure, net_points
from ddgfab.tolerances import RELATIVE_DEGENERATE


@checked
def circle_axes(points: ArrayLike) -> tuple[Floats, Floats]:
    """Centers and unit directions (M, N, 3) of the axes of the quads' circles.

    Parameters
    ----------
    points : (M + 1, N + 1, 3) circular net; of others, the circle through x, x_1, x_2 is taken

    Raises
    ------
    DegenerateError
        Three corners on a line or parallel diagonals; names the quad.

    Source: mathematics.md 2.5.
    """

    def kernel(x: Floats, x1: Floats, x2: Floats, x12: Floats, place: Place) -> Floats:
        edges = edge_frame(x1 - x, x2 - x, place, "three corners lie on a line")
        half = 0.5 * edges.length
        up = (edges.along * (edges.along - edges.length) + edges.across**2) / (2.0 * edges.across)
        diagonals = edge_frame(x12 - x, x2 - x1, place, "the diagonals are parallel")
        center = x + half * edges.e + up * edges.w
        return np.concatenate([center, cross(diagonals.e, diagonals.w)])

    both = measure(points, (0, 1), kernel, dim=3)
    return both[..., :3], both[..., 3:]


@checked
def axis_coplanarity(centers: ArrayLike, directions: ArrayLike, axis: int) -> Floats:
    """det(c' - c, n, n') of neighbouring axes: zero where they meet or are parallel (2.5).

    Parameters
    ----------
    centers, directions : (M, N, 3) from `circle_axes`
    axis : the direction in which neighbours are taken
    """
    c = of_shape(centers, (None, None, 3), "centers")
    n = of_shape(directions, c.shape, "directions")
    if axis not in (0, 1):
        raise InputError(f"axis {axis}: 0 or 1 is needed")
    axis = int(axis)
    before, after = (np.take(n, range(k, n.shape[axis] - 1 + k), axis) for k in (0, 1))
    return np.asarray(np.sum(np.diff(c, axis=axis) * np.cross(before, after), axis=-1))


@checked
def axis_intersections(
    centers: ArrayLike, directions: ArrayLike
) -> tuple[Floats, NDArray[np.bool_]]:
    """Where neighbouring axes of a strip of quads meet: the line of regression of its developable.

    Parameters
    ----------
    centers, directions : (..., K, 3) points and directions of the axes of rows of quads, as from
        `circle_axes`; turn its arrays with ``swapaxes(0, 1)`` for the strips of the other direction

    Returns
    -------
    points : (..., K - 1, 3) points of intersection (midpoints of nearest points); where the axes
        are parallel, the unit direction in which they meet at infinity
    infinite : (..., K - 1) True where the axes are parallel

    Raises
    ------
    InputError
        Shapes other than these, entries that are not finite.
    DegenerateError
        A direction that is zero; names its index.

    Source: mathematics.md 2.5.
    """
    c, n = np.asarray(centers, dtype=np.float64), np.asarray(directions, dtype=np.float64)
    if c.ndim < 2 or c.shape[-1] != 3 or n.shape != c.shape or c.shape[-2] < 2:
        raise InputError(
            f"axes of strips have shape (..., K, 3), K > 1; not {c.shape} and {n.shape}"
        )
    finite(c, "centers")
    finite(n, "directions")
    Place(name="axis").refuse(np.asarray(~n.any(axis=-1)), "its direction is zero")
    points = np.empty((*c.shape[:-2], c.shape[-2] - 1, 3))
    infinite = np.empty(points.shape[:-1], dtype=bool)
    # Strip by strip: temporaries as large as the net would be several times its memory.
    for at in np.ndindex(c.shape[:-2]):
        points[at], infinite[at] = _strip_intersections(c[at], unit(n[at]))
    return points, infinite


def _strip_intersections(c: Floats, n: Floats) -> tuple[Floats, NDArray[np.bool_]]:
    first, second = n[:-1], n[1:]
    normal = np.cross(first, second)
    square = np.sum(normal * normal, axis=1)
    infinite = square <= RELATIVE_DEGENERATE**2
    square = np.where(infinite, 1.0, square)
    step = c[1:] - c[:-1]
    along = np.sum(np.cross(step, second) * normal, axis=1) / square
    back = np.sum(np.cross(step, first) * normal, axis=1) / square
    meet = 0.5 * (c[:-1] + along[:, None] * first + c[1:] + back[:, None] * second)
    return np.where(infinite[:, None], first, meet), infinite


@checked
def vertex_normals(points: ArrayLike, first: ArrayLike) -> Floats:
    """Unit normals at the vertices: each edge's bisector plane reflects one end to the other.

    n_k = n - 2 <n, e> e with unit e = x_k - x. On circular nets the result does not depend on
    the path (`normals_closure`); ``points + d * normals`` is parallel, circular, and has vertex
    distance |d|. Neighbouring normals and their edge lie in one plane: no torsion.

    Parameters
    ----------
    points : (n1, ..., nd, 3)
    first : (3,) normal at the first point, free on the sphere; made unit

    Raises
    ------
    InputError
        A first normal of no length.
    DegenerateError
        An edge of no length; names its first point.

    Source: mathematics.md 2.7.
    """
    x = net_points(points, 3)
    start = np.asarray(first, dtype=np.float64)
    if start.shape != (3,) or not 0 < np.linalg.norm(start) < np.inf:
        raise InputError(f"first normal {start.tolist()}: three numbers, not all zero, are needed")
    normals = np.empty_like(x)
    d = x.ndim - 1
    origin = (0,) * d
    normals[origin] = unit(start)
    for axis in range(d):
        # Directions before this one are filled; those after it are at their first layer.
        for step in range(1, x.shape[axis]):
            here = (slice(None),) * axis + (step,) + origin[axis + 1 :]
            back = (slice(None),) * axis + (step - 1,) + origin[axis + 1 :]
            normals[here] = _reflected(normals[back], x[here] - x[back], axis, step - 1)
    return normals


def _reflected(normal: Floats, edge: Floats, axis: int, at: int) -> Floats:
    length = np.linalg.norm(edge, axis=-1, keepdims=True)
    place = Place(lambda index: (*index[:axis], at), name=f"edge of direction {axis} at")
    place.refuse(length[..., 0] == 0, "it has no length")
    along = edge / length
    return np.asarray(normal - 2.0 * np.sum(normal * along, axis=-1, keepdims=True) * along)


@checked
def normals_closure(points: ArrayLike, normals: ArrayLike) -> float:
    """Greatest defect of n_k = n - 2 <n, e> e over all edges: zero for circular nets (2.7)."""
    x, n = net_points(points, 3), np.asarray(normals, dtype=np.float64)
    if n.shape != x.shape:
        raise InputError(f"normals have shape {n.shape}; the net {x.shape}")
    worst = 0.0
    for axis in range(x.ndim - 1):
        y, m = np.moveaxis(x, axis, 0), np.moveaxis(n, axis, 0)
        for step in range(len(y) - 1):
            image = _reflected(m[step], y[step + 1] - y[step], axis, step)
            worst = max(worst, float(np.abs(m[step + 1] - image).max()))
    return worst
