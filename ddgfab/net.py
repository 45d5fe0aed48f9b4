"""Net: points on a box of Z^d in R^n, with shifts, differences, sub-nets, and quads as a mesh.

x_k is the net one step forward in direction k: a shorter array, or one as long where the direction
is closed. Source: Bobenko, Suris, Discrete Differential Geometry, 2.1; mathematics.md 0, 1.1.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.arguments import checked
from ddgfab.errors import InputError, MeshError
from ddgfab.grid import grid_mesh
from ddgfab.mesh import Floats, Ints, Mesh


@checked
def shift(values: ArrayLike, axis: int, step: int = 1, *, periodic: bool = False) -> Floats:
    """Array `step` forward in a direction: shorter by |step|, or rolled when periodic.

    ``shift(x, k, 1)[u] = x[u + e_k]``. A step back, ``shift(x, k, -1)``, is defined from index 1
    on, so its entry 0 belongs to u_k = 1.

    Raises
    ------
    InputError
        As many steps as there are points, or more, in a direction that is not periodic.

    Examples
    --------
    >>> shift([1.0, 2.0, 4.0], 0)
    array([2., 4.])
    >>> shift([1.0, 2.0, 4.0], 0, periodic=True)
    array([2., 4., 1.])

    Source: mathematics.md 1.1.
    """
    if not np.isfinite(step):
        raise InputError(f"step is {step:g}; a finite number is needed")
    array, axis, step = _along(values, axis), int(axis), int(step)
    if periodic:
        return np.roll(array, -step, axis=axis)
    size = array.shape[axis]
    if abs(step) >= size:
        raise InputError(f"direction {axis} has {size} points; it cannot be shifted by {step}")
    part = range(step, size) if step >= 0 else range(size + step)
    return np.take(array, part, axis=axis)


@checked
def difference(values: ArrayLike, axis: int, *, periodic: bool = False) -> Floats:
    """Delta_k x = x_k - x: one shorter in the direction, or as long when periodic.

    Examples
    --------
    >>> difference([1.0, 2.0, 4.0], 0)
    array([1., 2.])
    >>> difference([1.0, 2.0, 4.0], 0, periodic=True)
    array([ 1.,  2., -3.])
    """
    array, axis = _along(values, axis), int(axis)
    if periodic:
        return np.asarray(np.roll(array, -1, axis=axis) - array)
    return np.diff(array, axis=axis)


def _along(values: ArrayLike, axis: int) -> Floats:
    """The array, of which `axis` has to be a direction."""
    array = np.asarray(values, dtype=np.float64)
    if not -array.ndim <= axis < array.ndim:
        raise InputError(f"axis {axis}: an array of shape {array.shape} has no such direction")
    return array


@dataclass(frozen=True, eq=False, repr=False)
class Net:
    """Points on a box of Z^d.

    Make one with `Net.build`; the constructor trusts its arrays. ``np.asarray(net)`` is an open
    array with the first layer of closed directions repeated at their end, so that functions of
    arrays (`planarity`, `circularity`, ...) take nets and see the closing quads too.

    Attributes
    ----------
    points : (n1, ..., nd, dim) float, read only
    periodic : for each direction, whether the layer after the last is the first
    """

    points: Floats
    periodic: tuple[bool, ...]

    @staticmethod
    @checked
    def build(points: ArrayLike, periodic: Sequence[bool] | None = None) -> Net:
        """Net of an array (n1, ..., nd, dim), d > 0, dim > 1; checked and copied.

        Parameters
        ----------
        points : (n1, ..., nd, dim)
        periodic : d flags; by default all directions are open

        Raises
        ------
        InputError
            Wrong shape, a point that is not finite, as many flags as directions missing, or a
            closed direction with fewer than three points.
        """
        x = np.array(points, dtype=np.float64)
        if x.ndim < 2 or x.shape[-1] < 2 or 0 in x.shape:
            raise InputError(f"a net has shape (n1, ..., nd, dim), dim > 1; this one {x.shape}")
        bad = np.argwhere(~np.isfinite(x).all(axis=-1))
        if len(bad):
            raise InputError(f"point {tuple(bad[0].tolist())} of the net is not finite")
        closed = (False,) * (x.ndim - 1) if periodic is None else tuple(map(bool, periodic))
        if len(closed) != x.ndim - 1:
            raise InputError(f"{len(closed)} flags for the {x.ndim - 1} directions of the net")
        for axis, flag in enumerate(closed):
            if flag and x.shape[axis] < 3:
                raise InputError(
                    f"direction {axis} is closed but has {x.shape[axis]} points; 3 are needed"
                )
        x.setflags(write=False)
        return Net(x, closed)

    # --- sizes -------------------------------------------------------------------------------
    @property
    def d(self) -> int:
        """Number of directions."""
        return self.points.ndim - 1

    @property
    def dim(self) -> int:
        """Number of coordinates."""
        return int(self.points.shape[-1])

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of points in each direction."""
        return self.points.shape[:-1]

    @property
    def cells(self) -> tuple[int, ...]:
        """Number of steps in each direction."""
        return tuple(
            n if flag else n - 1 for n, flag in zip(self.shape, self.periodic, strict=True)
        )

    def __repr__(self) -> str:
        size = " x ".join(map(str, self.shape))
        cells = " x ".join(map(str, self.cells))
        closed = [str(k) for k, flag in enumerate(self.periodic) if flag]
        note = f", closed in direction {' and '.join(closed)}" if closed else ""
        return f"Net({size} points in R^{self.dim}, {cells} cells{note})"

    # --- shifts ------------------------------------------------------------------------------
    def __array__(self, dtype: Any = None, copy: bool | None = None) -> Floats:
        x = self.points
        for axis, flag in enumerate(self.periodic):
            if flag:
                x = np.concatenate([x, np.take(x, [0], axis=axis)], axis=axis)
        return x.astype(dtype or np.float64, copy=bool(copy) and x is self.points)

    @checked
    def shift(self, axis: int, step: int = 1) -> Floats:
        """x_k: the points `step` forward; see `shift`."""
        return shift(self.points, axis, step, periodic=self._closed(axis))

    @checked
    def difference(self, axis: int) -> Floats:
        """Delta_k x, the edges of a direction; see `difference`."""
        return difference(self.points, axis, periodic=self._closed(axis))

    def _closed(self, axis: int) -> bool:
        if not 0 <= axis < self.d:
            raise InputError(f"direction {axis}; the net has directions 0 to {self.d - 1}")
        return self.periodic[axis]

    # --- sub-nets ----------------------------------------------------------------------------
    def __getitem__(self, key: int | slice | tuple[int | slice, ...]) -> Net:
        """Sub-net: a whole number fixes a direction, a slice keeps a part of it.

        A closed direction stays closed only when all of it is kept.

        Raises
        ------
        InputError
            More entries than directions, an index out of range, all directions fixed, or an empty
            part.
        """
        keys = key if isinstance(key, tuple) else (key,)
        if len(keys) > self.d:
            raise InputError(f"{len(keys)} indices for a net of {self.d} directions")
        keys = (*keys, *(slice(None),) * (self.d - len(keys)))
        periodic = []
        for axis, (part, size) in enumerate(zip(keys, self.shape, strict=True)):
            if isinstance(part, slice):
                whole = part.indices(size) == (0, size, 1)
                periodic.append(self.periodic[axis] and whole)
            elif not -size <= part < size:
                raise InputError(f"index {part} in direction {axis}, which has {size} points")
        if not periodic:
            raise InputError("all directions are fixed: that is a point; use net.points")
        return Net.build(self.points[keys], periodic)

    # --- meshes ------------------------------------------------------------------------------
    def to_mesh(self) -> Mesh:
        """Quad mesh of a net with two directions in R^3; vertex ids row by row (`grid_mesh`).

        Raises
        ------
        MeshError
            Another number of directions or coordinates, fewer than two points in one.
        """
        if self.d != 2:
            raise MeshError(f"{self!r} has {self.d} directions; a mesh needs two: take a sub-net")
        return grid_mesh(self.points, (self.periodic[0], self.periodic[1]))

    @staticmethod
    @checked
    def from_mesh(mesh: Mesh) -> Net:
        """Net of a rectangular quad mesh, whatever the order of its vertices and faces.

        Open rectangles start at their corner of lowest id (direction 0 runs along the boundary
        with the mesh on its left), bands and closed tori at face 0. The side of the faces is kept.

        Raises
        ------
        MeshError
            A face that is not a quad, or faces that are not grid; names one.
        """
        return Net.build(*_grid(mesh))


def _grid(mesh: Mesh) -> tuple[Floats, tuple[bool, bool]]:
    """Points and closed directions of a mesh that is a grid."""
    odd = np.flatnonzero(mesh.face_sizes != 4)
    if len(odd):
        raise MeshError(f"no grid: face {odd[0]} has {mesh.face_sizes[odd[0]]} corners, not 4")
    twin = _twins(mesh)
    follow = mesh.corner_next
    # Half-edges that run in direction 0, each at the first corner (i, j) of its face; across the
    # opposite side lies (i, j + 1), across the next one (i + 1, j).
    column = [_start(mesh, twin)]
    above = int(twin[follow[follow[column[0]]]])
    while above >= 0 and above != column[0] and len(column) <= mesh.n_faces:
        column.append(above)
        above = int(twin[follow[follow[above]]])
    rows = [np.array(column)]
    while len(rows) <= mesh.n_faces:
        across = twin[follow[rows[-1]]]
        if (across < 0).all() or np.array_equal(follow[across], rows[0]):
            break
        if (across < 0).any():
            face = mesh.corner_face[rows[-1][np.argmax(across < 0)]]
            raise MeshError(f"no grid: the row of faces through face {face} ends before the others")
        rows.append(follow[across])
    closed = bool((across >= 0).all()), above >= 0
    heads = np.stack(rows)
    _check_grid(mesh, heads, follow)
    corners = mesh.corners
    ids = corners[heads]
    if not closed[1]:
        ids = np.concatenate([ids, corners[follow[follow[follow[heads[:, -1:]]]]]], axis=1)
    if not closed[0]:
        last = corners[follow[heads[-1]]]
        if not closed[1]:
            last = np.append(last, corners[follow[follow[heads[-1, -1]]]])
        ids = np.concatenate([ids, last[None]])
    _check_ids(mesh, ids, heads, follow, closed)
    return mesh.vertices[ids], closed


def _twins(mesh: Mesh) -> Ints:
    """(C,) the half-edge opposite to each, or -1."""
    order = np.argsort(mesh.corner_edge, kind="stable")
    pair = np.flatnonzero(np.diff(mesh.corner_edge[order]) == 0)
    twin = np.full(len(order), -1)
    twin[order[pair]], twin[order[pair + 1]] = order[pair + 1], order[pair]
    return twin


def _start(mesh: Mesh, twin: Ints) -> int:
    """The first half-edge: at a corner of the rectangle, else on the boundary, else any."""
    rim = np.flatnonzero(twin < 0)
    if not len(rim):
        return 0
    corner = rim[mesh.valences[mesh.corners[rim]] == 2]
    return int(corner[np.argmin(mesh.corners[corner])] if len(corner) else rim[0])


def _check_grid(mesh: Mesh, heads: Ints, follow: Ints) -> None:
    faces = mesh.corner_face[heads].ravel()
    used, counts = np.unique(faces, return_counts=True)
    if (counts > 1).any():
        raise MeshError(f"no grid: face {used[np.argmax(counts > 1)]} lies in two rows or columns")
    if len(used) < mesh.n_faces:
        missing = np.setdiff1d(np.arange(mesh.n_faces), used)
        raise MeshError(
            f"no grid: face {missing[0]} is not among the {heads.shape[0]} x {heads.shape[1]} "
            f"found from face {faces[0]}"
        )


def _check_ids(mesh: Mesh, ids: Ints, heads: Ints, follow: Ints, closed: tuple[bool, bool]) -> None:
    """Every face has the corners that its place in the grid says, no vertex has two places."""
    for axis in (0, 1):
        if closed[axis]:
            ids = np.concatenate([ids, ids.take([0], axis=axis)], axis=axis)
    wanted = [ids[:-1, :-1], ids[1:, :-1], ids[1:, 1:], ids[:-1, 1:]]
    corner = heads
    for place in wanted:
        bad = np.argwhere(mesh.corners[corner] != place)
        if len(bad):
            raise MeshError(
                f"no grid: face {mesh.corner_face[heads[tuple(bad[0])]]} is out of line"
            )
        corner = follow[corner]
    inner = ids[: -1 if closed[0] else None, : -1 if closed[1] else None]
    used, counts = np.unique(inner, return_counts=True)
    if (counts > 1).any():
        raise MeshError(f"no grid: vertex {used[np.argmax(counts > 1)]} has two places in it")
