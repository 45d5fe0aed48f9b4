"""Quads of nets all at once: errors that name cells, measures in blocks, evolution in wavefronts.

Kernels work on arrays with the components first, (dim, ...): numpy is then several times faster
than on rows of three numbers, and every kernel serves a single quad, a wavefront and a block.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ddgfab.errors import DegenerateError, InputError
from ddgfab.mesh import Floats, extent
from ddgfab.tolerances import COORDINATE_LIMIT, RELATIVE_DEGENERATE

Bools = NDArray[np.bool_]
Where = Callable[[tuple[int, ...]], str]
Rule = Callable[..., Floats]

_BLOCK = 1 << 14
"""Quads in a block of a measure: its temporaries stay in the cache and add no memory."""


def dot(a: Floats, b: Floats) -> Floats:
    """Scalar products over the first axis."""
    return np.asarray(np.einsum("i...,i...->...", a, b))


def norm(a: Floats) -> Floats:
    """Lengths over the first axis."""
    return np.asarray(np.sqrt(dot(a, a)))


def cross(a: Floats, b: Floats) -> Floats:
    """Vector products over the first axis, of length three."""
    return np.stack(
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    )


MOST_COUNTED: Final = 1e9
"""Counts at and above this are refused: no net holds so many."""


class Place(NamedTuple):
    """Turns an index in a kernel's arrays into the indices of a cell."""

    cell: Callable[[tuple[int, ...]], tuple[int, ...]] = lambda index: index
    name: str = "quad"

    def refuse(self, bad: Bools, what: str, value: Floats | None = None) -> None:
        """Raise `DegenerateError` with the first bad cell, what is wrong and its value."""
        if not bad.any():
            return
        index = tuple(int(i) for i in np.argwhere(bad)[0])
        cell = self.cell(index)
        number = (
            ""
            if value is None
            else f"; value {float(np.broadcast_to(value, bad.shape)[index]):.3g}"
        )
        raise DegenerateError(f"{self.name} {cell}: {what}{number}", cell=cell)


class QuadFrame(NamedTuple):
    """Plane coordinates of a quad: b = along e + across w, with orthonormal e = a / length, w."""

    e: Floats
    length: Floats
    along: Floats
    across: Floats
    w: Floats


def edge_frame(a: Floats, b: Floats, place: Place, what: str) -> QuadFrame:
    """Frame of two edges; refuses edges of no length and parallel ones (saying `what`)."""
    length, other = norm(a), norm(b)
    place.refuse((length == 0) | (other == 0), "an edge has no length", np.minimum(length, other))
    e = a / length
    along = dot(b, e)
    w = b - along * e
    across = norm(w)
    place.refuse(
        across <= RELATIVE_DEGENERATE * other,
        f"{what}: sine of their angle, limit {RELATIVE_DEGENERATE:g}",
        across / other,
    )
    return QuadFrame(e, length, along, across, w / across)


def net_points(points: ArrayLike, dim: int | None = None) -> Floats:
    """Float array (n1, ..., nd, dim), checked: at least a quad, finite, the dimension asked for."""
    x = np.asarray(points, dtype=np.float64)
    if x.ndim < 3 or min(x.shape[:-1]) < 1 or x.shape[-1] < 2:
        raise InputError(f"a net has shape (n1, ..., nd, dim), d > 1, dim > 1; this one {x.shape}")
    if dim is not None and x.shape[-1] != dim:
        raise InputError(f"points in R^{dim} are needed; these have {x.shape[-1]} coordinates")
    finite(x, "net")
    return x


def finite(values: Floats, what: str) -> None:
    """Raise `InputError` at the first entry that is not finite or beyond `COORDINATE_LIMIT`."""
    # Extrema carry NaN along, without an array of flags as large as the net.
    if not values.size or max(values.max(), -values.min()) <= COORDINATE_LIMIT:
        return
    bad = tuple(np.argwhere(~(np.abs(values) <= COORDINATE_LIMIT))[0].tolist())
    raise InputError(
        f"{what}: entry {bad} is {values[bad]:g}, not a finite number below {COORDINATE_LIMIT:g}"
    )


def whole(value: float, least: int, what: str) -> int:
    """A whole number of `least` or more; raises `InputError` for others."""
    if not (least <= value < MOST_COUNTED and int(value) == value):
        shown = value if abs(value) < MOST_COUNTED else f"{float(value):g}"
        raise InputError(
            f"{what} = {shown}: a whole number of {least} or more is needed, below {MOST_COUNTED:g}"
        )
    return int(value)


def refuse_growth(new: Floats, place: Place) -> None:
    """Raise `DegenerateError` at the first new point, components first, beyond the limit."""
    top = np.abs(new).max(axis=0)
    place.refuse(~(top <= COORDINATE_LIMIT), f"coordinates grow beyond {COORDINATE_LIMIT:g}", top)


def columns(*points: ArrayLike) -> tuple[Floats, ...]:
    """Arrays (..., dim) broadcast and turned to components first, for single calls of kernels."""
    given = [np.asarray(p, dtype=np.float64) for p in points]
    try:
        arrays = list(np.broadcast_arrays(*given))
    except ValueError:
        arrays = []
    if not arrays or not arrays[0].ndim:
        shapes = ", ".join(str(p.shape) for p in given)
        raise InputError(f"points of shapes {shapes} do not go together; (..., dim) is needed")
    for array in arrays:
        finite(array, "point")
    if not arrays[0].shape[-1]:
        raise InputError("points have no coordinates; (..., dim) is needed")
    return tuple(np.moveaxis(array, -1, 0) for array in arrays)


def measure(
    points: ArrayLike,
    axes: tuple[int, int],
    kernel: Callable[[Floats, Floats, Floats, Floats, Place], Floats],
    dim: int | None = None,
) -> Floats:
    """A kernel of (x, x_k, x_l, x_kl, place) on all quads of two directions of a net.

    Returns the kernel's values with the shape of the quads' base points: the net's shape, one less
    in the two directions; values with components come with these last.
    """
    x = net_points(points, dim)
    d = x.ndim - 1
    if not (min(axes) >= 0 and max(axes) < d and axes[0] != axes[1]):
        raise InputError(f"directions {axes}: two different ones below {d} are needed")
    y = np.moveaxis(x, axes, (0, 1))
    order = [*axes, *(k for k in range(d) if k not in axes)]
    rows = y.shape[0] - 1
    width = max(1, int(np.prod(y.shape[1:-1])))
    step = max(1, _BLOCK // width)
    name = "quad" if d == 2 else f"quad of directions {axes} at"
    out: Floats | None = None
    for start in range(0, max(rows, 1), step):
        block = np.ascontiguousarray(np.moveaxis(y[start : min(start + step, rows) + 1], -1, 0))

        def cell(index: tuple[int, ...], start: int = start) -> tuple[int, ...]:
            moved = dict(zip(order, (start + index[0], *index[1:]), strict=True))
            return tuple(moved[k] for k in range(d))

        values = kernel(
            block[:, :-1, :-1],
            block[:, 1:, :-1],
            block[:, :-1, 1:],
            block[:, 1:, 1:],
            Place(cell, name),
        )
        values = np.moveaxis(values, 0, -1) if values.ndim > d else values
        if out is None:
            out = np.empty((rows, *values.shape[1:]))
        out[start : start + step] = values
    assert out is not None
    return np.moveaxis(out, (0, 1), axes)


def pairs(points: ArrayLike) -> list[tuple[int, int]]:
    """All pairs of directions of a net."""
    d = net_points(points).ndim - 1
    return [(k, m) for k in range(d) for m in range(k + 1, d)]


def layer(d: int, k: int, part: slice | int) -> tuple[slice | int, ...]:
    """Index of all of the directions before k, a part of k, the first of those after."""
    return tuple(slice(None) if a < k else part if a == k else 0 for a in range(d))


def summed(steps: Callable[[int], Floats], shape: tuple[int, ...], origin: ArrayLike) -> Floats:
    """Net (n1, ..., nd, dim) of a shape from its differences, and its first point.

    Sums along direction 0 on the axis, then direction 1 from there and so on; so of direction k
    only the differences in ``layer(d, k, slice(None))`` count: ``steps(k)``, an array of its own.
    """
    d = len(shape) - 1
    x = np.empty(shape)
    x[(0,) * d] = origin
    for k in range(d):
        ahead = x[layer(d, k, slice(1, None))]
        np.cumsum(steps(k), axis=k, out=ahead)
        ahead += x[layer(d, k, slice(0, 1))]
    return x


def sweep(first: ArrayLike, second: ArrayLike, data: tuple[ArrayLike, ...], rule: Rule) -> Floats:
    """(M + 1, N + 1, dim) net from two polylines and a rule for the fourth point of a quad.

    Cells on one anti-diagonal do not depend on each other, so each is one call
    ``rule(x, x_1, x_2, *data, place)`` on arrays.

    Parameters
    ----------
    first, second : (M + 1, dim), (N + 1, dim) polylines in directions 0 and 1 from one point
    data : arrays (M, N), or numbers

    Raises
    ------
    InputError
        Shapes that do not fit, first points that differ, entries that are not finite.
    DegenerateError
        From the rule, or where coordinates grow beyond all numbers; names the cell.
    """
    net, cells = _boundary(first, second, data)
    rows, cols, dim = net.shape
    flat = net.reshape(-1, dim)
    # Point (i, s - i) is row s + i (cols - 1) of the flat net: an anti-diagonal is a plain slice.
    step, inner = cols - 1, max(cols - 2, 1)
    for s in range(2, rows + cols - 1):
        low, count = max(1, s - cols + 1), min(rows - 1, s - 1) - max(1, s - cols + 1) + 1

        def diagonal(offset: int, start: int = low * step, count: int = count) -> slice:
            return slice(start + offset, start + offset + (count - 1) * step + 1, step)

        begin = low * (cols - 2) + s - cols
        part = slice(begin, begin + (count - 1) * inner + 1, inner)

        def cell(index: tuple[int, ...], low: int = low, s: int = s) -> tuple[int, ...]:
            return low - 1 + index[0], s - low - 1 - index[0]

        place = Place(cell)
        corners = [np.ascontiguousarray(flat[diagonal(s - k)].T) for k in (cols + 1, 1, cols)]
        with np.errstate(over="ignore", invalid="ignore"):
            new = rule(*corners, *(c[part] if c.ndim else c for c in cells), place)
        refuse_growth(new, place)
        flat[diagonal(s)] = new.T
    return net


def _boundary(
    first: ArrayLike, second: ArrayLike, data: tuple[ArrayLike, ...]
) -> tuple[Floats, list[Floats]]:
    a, b = np.asarray(first, dtype=np.float64), np.asarray(second, dtype=np.float64)
    if a.ndim != 2 or b.ndim != 2 or a.shape[1] != b.shape[1] or a.shape[1] < 2:
        raise InputError(
            f"polylines have shapes (M + 1, dim), (N + 1, dim); not {a.shape}, {b.shape}"
        )
    if min(len(a), len(b)) < 2:
        raise InputError(f"polylines of {len(a)} and {len(b)} points: two at least are needed")
    finite(a, "first polyline")
    finite(b, "second polyline")
    size = max(extent(a), extent(b))
    gap = float(np.linalg.norm(a[0] - b[0]))
    if gap > RELATIVE_DEGENERATE * size:
        raise InputError(f"the polylines start {gap:g} apart; they must share their first point")
    shape = (len(a) - 1, len(b) - 1)
    cells = []
    for values in data:
        array = np.asarray(values, dtype=np.float64)
        if array.ndim and array.shape != shape:
            raise InputError(f"data of cells have shape {array.shape}; {shape} is needed")
        finite(array, "data of cells")
        cells.append(array.reshape(-1) if array.ndim else array)
    net = np.empty((len(a), len(b), a.shape[1]))
    net[:, 0], net[0] = a, b
    return net, cells
