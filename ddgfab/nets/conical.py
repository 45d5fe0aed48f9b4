"""Conical nets: the four faces at a vertex touch a cone of revolution; their circular partners."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.arguments import checked, of_shape
from ddgfab.errors import DegenerateError, InputError
from ddgfab.mesh import Floats, unit
from ddgfab.nets.axes import circle_axes, vertex_normals
from ddgfab.nets.conjugate import planarity
from ddgfab.tolerances import RELATIVE_DEGENERATE


@checked
def face_normals(points: ArrayLike) -> Floats:
    """(M, N, 3) unit normals of the quads, on the side of (first direction) x (second direction).

    n = unit((x12 - x) x (x2 - x1)), which is across both diagonals.

    Parameters
    ----------
    points : (M + 1, N + 1, 3)

    Raises
    ------
    InputError
        Points of another shape, or not finite.
    DegenerateError
        Parallel diagonals; names the quad and the sine.

    Source: mathematics.md 1.3.
    """
    x = _net(points)
    first, second = x[1:, 1:] - x[:-1, :-1], x[:-1, 1:] - x[1:, :-1]
    normal = np.cross(first, second)
    area = np.linalg.norm(normal, axis=-1)
    lengths = np.linalg.norm(first, axis=-1) * np.linalg.norm(second, axis=-1)
    _refuse_small(area, lengths, "quad", "its diagonals are parallel (sine {:.1e}, limit {:g})")
    return np.asarray(normal / area[..., None])


def _net(points: ArrayLike, least: int = 2) -> Floats:
    x = np.asarray(points, dtype=np.float64)
    if x.ndim != 3 or x.shape[2] != 3 or min(x.shape[:2]) < least:
        raise InputError(f"a net of shape {x.shape}; at least ({least}, {least}, 3) is needed")
    bad = np.argwhere(~np.isfinite(x).all(axis=-1))
    if len(bad):
        raise InputError(f"point ({bad[0, 0]}, {bad[0, 1]}) of the net is not finite")
    return x


def _refuse_small(values: Floats, scale: Floats, element: str, words: str) -> None:
    bad = np.argwhere(np.abs(values) <= RELATIVE_DEGENERATE * scale)
    if len(bad):
        i, j = bad[0]
        part = abs(values[i, j]) / scale[i, j] if scale[i, j] > 0 else 0.0
        raise DegenerateError(
            f"{element} ({i}, {j}): " + words.format(part, RELATIVE_DEGENERATE),
            cell=(int(i), int(j)),
        )


def _stars(values: Floats) -> Floats:
    """(M - 1, N - 1, 4, ...) values of the four faces at each interior vertex, going round."""
    return np.stack([values[:-1, :-1], values[1:, :-1], values[1:, 1:], values[:-1, 1:]], axis=2)


@checked
def conical_determinant(points: ArrayLike, normals: ArrayLike | None = None) -> Floats:
    """(M - 1, N - 1) det(N1 - N0, N2 - N0, N3 - N0) of the unit face normals at interior vertices.

    Zero just when the four end on one circle of the unit sphere, that is when the oriented faces
    touch a cone of revolution: the first test of a conical net. The faces have to be planar.

    Parameters
    ----------
    points : (M + 1, N + 1, 3), M, N > 1
    normals : (M, N, 3) unit normals; by default `face_normals`. Where a net folds over, normals
        of one orientation are those of an unfolded parallel net

    Raises
    ------
    InputError
        Points or normals of another shape.
    DegenerateError
        A quad with parallel diagonals; names it.

    Source: mathematics.md 2.9 (a); Liu, Pottmann, Wallner, Yang, Wang 2006.
    """
    x = _net(points, 3)
    faces = face_normals(x) if normals is None else np.asarray(normals, dtype=np.float64)
    if faces.shape != (len(x) - 1, x.shape[1] - 1, 3):
        raise InputError(f"normals of shape {faces.shape} for a net of shape {x.shape}")
    n = _stars(faces)
    a, b, c = (n[:, :, k] - n[:, :, 0] for k in (1, 2, 3))
    return np.asarray(np.einsum("ijk,ijk->ij", a, np.cross(b, c)))


@checked
def angle_balance(points: ArrayLike) -> Floats:
    """(M - 1, N - 1) w0 + w2 - w1 - w3 [rad] of the face angles at interior vertices, going round.

    Zero on conical nets at ordinary vertices, not at folded ones; prefer `conical_determinant`.

    Source: mathematics.md 2.9 (b); Wang, Wallner, Liu 2007.
    """
    x = _net(points, 3)
    middle = x[1:-1, 1:-1]
    around = [x[:-2, 1:-1], x[1:-1, :-2], x[2:, 1:-1], x[1:-1, 2:]]
    ways = [side - middle for side in around]
    total = np.zeros(middle.shape[:2])
    for k in range(4):
        a, b = ways[k], ways[(k + 1) % 4]
        angle = np.arctan2(np.linalg.norm(np.cross(a, b), axis=-1), np.einsum("ijk,ijk->ij", a, b))
        total += angle if k % 2 == 0 else -angle
    return total


@checked
def conical_residuals(points: ArrayLike) -> dict[str, float]:
    """How far a net is from conical: greatest planarity and greatest defect of its normals.

    "planarity": distance of the diagonals over their mean length. "normals":
    `conical_determinant` over the product of the lengths of its three differences, so that it
    does not shrink with the cells (0 where two faces of a vertex are parallel). Both zero for a
    conical net.

    Source: mathematics.md 0, 1.3, 2.9.
    """
    x = _net(points, 3)
    n = _stars(face_normals(x))
    scale = np.linalg.norm(n[:, :, 1:] - n[:, :, :1], axis=-1).prod(axis=-1)
    defect = np.zeros_like(scale)
    np.divide(np.abs(conical_determinant(x)), scale, out=defect, where=scale > RELATIVE_DEGENERATE)
    return {"planarity": float(np.abs(planarity(x)).max()), "normals": float(defect.max())}


@checked
def cone_offsets(points: ArrayLike) -> Floats:
    """(M - 1, N - 1, 3) how interior vertices move when every face moves by 1 along its normal.

    The vector d with <d, N> = 1 for all four faces, along the axis of the cone; its length is
    1 / cos of the angle between axis and faces' normals. On nets that are not conical: the best
    fit by least squares.

    Raises
    ------
    DegenerateError
        Face normals that cancel (a cone that is a line); names the vertex.

    Source: mathematics.md 2.10, 10.6: v' = v + d axis / <axis, N>.
    """
    n = _stars(face_normals(_net(points, 3)))
    offset = np.einsum("ijxk->ijx", np.linalg.pinv(n, rcond=FLAT_STAR))
    height = np.einsum("ijkx,ijx->ijk", n, offset).min(axis=-1)
    _refuse_small(
        np.maximum(height, 0.0), np.ones_like(height), "inner vertex", "its cone has no axis ({})"
    )
    return np.asarray(offset)


FLAT_STAR = 1e-6
"""Relative singular value below which the four normals of a vertex count as one or two."""


@checked
def cone_axes(points: ArrayLike) -> Floats:
    """(M - 1, N - 1, 3) unit axes of the cones at interior vertices, on the side of the normals.

    Source: mathematics.md 2.9, 2.10; see `cone_offsets`.
    """
    return unit(cone_offsets(points))


@checked
def best_normal(points: ArrayLike) -> Floats:
    """(3,) the first normal for which the reflected vertex normals are nearest to the surface's.

    Reflected normals depend linearly on the first one, so the nearest is found in closed form. The
    surface's normals are means over four faces; at the boundary they would be one-sided, and the
    reflected ones then alternate, so that inner vertices alone count where there are any.

    Source: least squares on the two-parameter family of mathematics.md 2.7.
    """
    x = _net(points)
    moved = np.stack([vertex_normals(x, basis) for basis in np.eye(3)], axis=-1)  # (M+1, N+1, 3, 3)
    faces = face_normals(x)
    target = np.zeros_like(x)
    for i in (0, 1):
        for j in (0, 1):
            target[i : len(x) - 1 + i, j : x.shape[1] - 1 + j] += faces
    inner = tuple(slice(1, -1) if count > 2 else slice(None) for count in x.shape[:2])
    return unit(np.einsum("ijkl,ijk->l", moved[inner], unit(target[inner])))


@checked
def circular_to_conical(points: ArrayLike, first: ArrayLike | None = None) -> Floats:
    """(M, N, 3) conical net whose faces lie in the planes across the normals of a circular net.

    Vertex (i, j) of the result is where the planes at the four corners of quad (i, j) meet, on
    the axis of its circle, which is the axis of the cone there. Face (i, j) of the result belongs
    to the interior vertex (i + 1, j + 1) and passes through it.

    Parameters
    ----------
    points : (M + 1, N + 1, 3) circular net, M, N > 1
    first : (3,) normal at points[0, 0]; by default the one nearest to the surface (`best_normal`)

    Raises
    ------
    DegenerateError
        Three corners on a line, or planes along the axis of the circle; names the quad.

    Source: Bobenko, Suris 2007; mathematics.md 2.8. The axis is met by each plane in one point,
    which stays well defined where all four planes are nearly one.
    """
    x = _net(points, 3)
    normals = vertex_normals(x, best_normal(x) if first is None else first)
    center, axis = circle_axes(x)
    height = np.zeros(center.shape[:2])
    weight = np.zeros_like(height)
    for i in (0, 1):
        for j in (0, 1):
            part = slice(i, len(x) - 1 + i), slice(j, x.shape[1] - 1 + j)
            across = np.einsum("ijk,ijk->ij", axis, normals[part])
            # Least squares on the four planes; they agree on circular nets.
            height += across * np.einsum("ijk,ijk->ij", x[part] - center, normals[part])
            weight += across**2
    _refuse_small(
        weight,
        np.ones_like(weight),
        "quad",
        "the planes at its corners hold its circle's axis ({})",
    )
    return np.asarray(center + (height / weight)[..., None] * axis)


@checked
def conical_to_circular(points: ArrayLike, first: ArrayLike | None = None) -> Floats:
    """(M, N, 3) circular net with one point in each face of a conical net.

    The bisector plane of two neighbouring faces reflects the point of one to that of the other.

    Parameters
    ----------
    points : (M + 1, N + 1, 3) conical net
    first : (3,) point in face (0, 0) (what is off its plane is dropped): a two-parameter family;
        by default the one whose points are nearest to the faces' centers

    Raises
    ------
    DegenerateError
        Neighbouring faces folded back onto each other; names the edge.

    Source: Pottmann, Wallner 2008; mathematics.md 2.10. The bisector's normal m ~ e x (N + N') is
    that of N - N', and stays defined where the faces are nearly one.
    """
    x = _net(points)
    origin = x[0, 0].copy()  # reflections about a point of the net: far from it they lose digits
    x = x - origin
    n = face_normals(x)
    mirrors = [_mirrors(x, n, axis) for axis in (0, 1)]
    start = np.zeros(3) if first is None else of_shape(first, (3,), "first") - origin
    if first is None:
        # Points depend on the first by motions; average where those ask it to be.
        zero = _reflect_all(np.zeros(3), mirrors, n.shape)
        turns = [(np.zeros_like(on), m) for on, m in mirrors]
        turned = np.stack([_reflect_all(b, turns, n.shape) for b in np.eye(3)], axis=-1)
        centers = 0.25 * (x[1:, 1:] + x[1:, :-1] + x[:-1, 1:] + x[:-1, :-1])
        start = np.einsum("ijkl,ijk->ijl", turned, centers - zero).mean(axis=(0, 1))
    start = start - (start @ n[0, 0]) * n[0, 0]
    return np.asarray(origin + _reflect_all(start, mirrors, n.shape))


def _mirrors(x: Floats, n: Floats, axis: int) -> tuple[Floats, Floats]:
    """Points on and unit normals of the bisector planes between neighbours along an axis."""
    if axis == 0:
        on, along, both = x[1:-1, :-1], x[1:-1, 1:] - x[1:-1, :-1], n[1:] + n[:-1]
    else:
        on, along, both = x[:-1, 1:-1], x[1:, 1:-1] - x[:-1, 1:-1], n[:, 1:] + n[:, :-1]
    normal = np.cross(unit(along), both)
    size = np.linalg.norm(normal, axis=-1)
    if size.size:
        _refuse_small(size, np.ones_like(size), "inner edge", "its faces are folded together ({})")
    return on, unit(normal)


def _reflect_all(
    first: Floats, mirrors: list[tuple[Floats, Floats]], shape: tuple[int, ...]
) -> Floats:
    out = np.empty(shape)
    out[0, 0] = first
    (on, m), (over, k) = mirrors
    for i in range(1, shape[0]):
        out[i, 0] = _reflected(out[i - 1, 0], on[i - 1, 0], m[i - 1, 0])
    for j in range(1, shape[1]):
        out[:, j] = _reflected(out[:, j - 1], over[:, j - 1], k[:, j - 1])
    return out


def _reflected(point: Floats, on: Floats, normal: Floats) -> Floats:
    height = np.sum((point - on) * normal, axis=-1, keepdims=True)
    return np.asarray(point - 2.0 * height * normal)
