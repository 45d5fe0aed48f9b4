"""Barriers: what an optimised mesh may never lose, whatever its goal demands.

Each row watches a number s of the mesh that must stay above a bound s0: the sine-like measure of a
corner, the length of an edge, the cosine of a fold. Above s1 it costs nothing; between, the cost
b(t) = -(t - 1)^2 ln t of t = (s - s0) / (s1 - s0) rises without limit towards s0. Where a mesh is
beyond the usual bounds already they are widened, and only what becomes worse than it was costs
anything: so every start is possible.

Gradients are exact, the turning of face normals included: with normals frozen the search for a
step stalls near a barrier.

Source: barriers with bounded support after Li et al., Incremental Potential Contact, 2020.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Final

import numpy as np
from scipy.sparse import csr_array

from ddgfab.mesh import Floats, Ints, Mesh, unit
from ddgfab.optimize.terms.planarity import polygon_corners, vector_areas

WEIGHT: Final = 1.0
"""Weight of every row. With a hundredth or a tenth of it several meshes stalled."""

_CORNER_MARGIN, _CORNER_REACH = 0.2, 0.4
"""Bounds of corners: s0 is this much above the bound of the range, s1 this much above s0."""
_EDGE_LOW, _EDGE_HIGH = 0.25, 0.75
"""Bounds of edges, as parts of their first length."""
_FOLD_LOW, _FOLD_HIGH = 0.1, 0.6
"""Bounds of the cosine of the angle between neighbouring face normals."""
_SLACK: Final = np.radians(10.0)
"""What is beyond its bounds in the input may become worse by this angle [rad]."""
_STRAIGHT: Final = 1e-5
"""Corners whose measure is further than this from that of a straight angle [sine] stay on their
side of it."""
_LEAST_ROOM: Final = 0.01
"""Rows that are beyond their bounds may lose as much of their measure, at least; half of that is
the least distance between their bounds."""

_QUAD_RANGE, _LARGE_RANGE = np.radians((90.0, 90.0)), np.radians((120.0, 110.0))
"""Middle of the range of corner angles and half its width [rad]: quads and triangles 0 to 180
degrees, larger faces 10 to 230, because plane hexagons on a saddle have reflex corners."""


def cost(t: Floats) -> float:
    """Sum of b(t); infinite where a t is zero or less."""
    if not t.min(initial=1.0) > 0:
        return np.inf
    near = t[t < 1]
    return float(-((near - 1) ** 2 * np.log(near)).sum())


def cost_slopes(t: Floats) -> tuple[Floats, Floats]:
    """(m,) first and second derivatives of b at 0 < t < 1."""
    first = -2 * (t - 1) * np.log(t) - (t - 1) ** 2 / t
    second = -2 * np.log(t) - 4 * (t - 1) / t + ((t - 1) / t) ** 2
    return np.asarray(first), np.asarray(second)


@dataclass(frozen=True, eq=False, kw_only=True)
class RowBarrier(ABC):
    """Rows s of k unknowns each, that must stay above `low`.

    Attributes
    ----------
    index : (m, k) the unknowns of each row
    low, high : (m,) where the cost is infinite, where it begins
    of, elements : what the rows belong to, and (m,) their ids
    """

    name: str
    index: Ints
    low: Floats
    high: Floats
    of: str
    elements: Ints

    @abstractmethod
    def measure(self, local: Floats) -> Floats:
        """(m,) numbers s from the (m, k) values of their unknowns."""

    @abstractmethod
    def slopes(self, local: Floats) -> Floats:
        """(m, k) derivatives of s."""

    def value(self, x: Floats) -> float:
        """Sum of the costs; infinite where a row is at its bound or below."""
        return cost((self.measure(x[self.index]) - self.low) / (self.high - self.low))

    def active(self, x: Floats) -> tuple[csr_array, Floats, Floats]:
        """The rows that cost something: (a, n) slopes, (a,) first and second derivatives of b."""
        local = x[self.index]
        width = self.high - self.low
        t = (self.measure(local) - self.low) / width
        on = np.flatnonzero(t < 1)
        if not len(on):
            return csr_array((0, len(x))), np.zeros(0), np.zeros(0)
        t, width = t[on], width[on]
        first, second = cost_slopes(t)
        index = self.index[on]
        rows = csr_array(
            (
                self.slopes(local[on]).ravel(),
                index.ravel(),
                np.arange(0, index.size + 1, index.shape[1]),
            ),
            shape=(len(on), len(x)),
        )
        return rows, first / width, second / width**2


def _coordinates(vertices: Ints) -> Ints:
    """(m, 3k) unknowns of (m, k) vertices."""
    index: Ints = (3 * vertices[..., None] + np.arange(3)).reshape(len(vertices), -1)
    return index


def _edge_sums(points: Floats) -> Floats:
    """(m, k, 3) vectors x_(j+1) - x_(j-1) round polygons: dA = 1/2 sum dx_j x (these)."""
    return np.asarray(np.roll(points, -1, axis=1) - np.roll(points, 1, axis=1))


@dataclass(frozen=True, eq=False, kw_only=True)
class Corners(RowBarrier):
    """cos(angle - middle) of a face corner, the first of the face's corners in its row.

    s = <u, w> cos(middle) + <n, u x w> sin(middle) with the unit edges u, w of the corner and the
    unit vector area n of the face: signed, so that a corner that turns inside out is seen.
    """

    middle: float

    def measure(self, local: Floats) -> Floats:
        """(m,) cosines."""
        points = local.reshape(len(local), -1, 3)
        ahead, back = unit(points[:, 1] - points[:, 0]), unit(points[:, -1] - points[:, 0])
        normal = unit(vector_areas(points))
        inner = np.einsum("mx,mx->m", ahead, back)
        turned = np.einsum("mx,mx->m", np.cross(ahead, back), normal)
        return np.asarray(inner * np.cos(self.middle) + turned * np.sin(self.middle))

    def slopes(self, local: Floats) -> Floats:
        """(m, 3k)."""
        points = local.reshape(len(local), -1, 3)
        first, last = points[:, 1] - points[:, 0], points[:, -1] - points[:, 0]
        ahead, back = unit(first), unit(last)
        area = vector_areas(points)
        size = np.linalg.norm(area, axis=1, keepdims=True)
        normal = area / size
        cos, sin = np.cos(self.middle), np.sin(self.middle)
        by_ahead = cos * back + sin * np.cross(back, normal)
        by_back = cos * ahead + sin * np.cross(normal, ahead)
        by_normal = sin * np.cross(ahead, back)
        at_ahead = _across(by_ahead, ahead) / np.linalg.norm(first, axis=1, keepdims=True)
        at_back = _across(by_back, back) / np.linalg.norm(last, axis=1, keepdims=True)
        by_area = _across(by_normal, normal) / (2 * size)
        slope = np.cross(_edge_sums(points), by_area[:, None])
        slope[:, 1] += at_ahead
        slope[:, -1] += at_back
        slope[:, 0] -= at_ahead + at_back
        return np.asarray(slope.reshape(len(local), -1))


def _across(vectors: Floats, normals: Floats) -> Floats:
    """(m, 3) parts of vectors across unit normals."""
    return np.asarray(vectors - np.einsum("mx,mx->m", vectors, normals)[:, None] * normals)


@dataclass(frozen=True, eq=False, kw_only=True)
class Lengths(RowBarrier):
    """Length of an edge."""

    def measure(self, local: Floats) -> Floats:
        """(m,) lengths."""
        return np.asarray(np.linalg.norm(local[:, 3:] - local[:, :3], axis=1))

    def slopes(self, local: Floats) -> Floats:
        """(m, 6) unit directions."""
        way = unit(local[:, 3:] - local[:, :3])
        return np.concatenate([-way, way], axis=1)


@dataclass(frozen=True, eq=False, kw_only=True)
class Folds(RowBarrier):
    """Cosine between the normals of two neighbouring faces; `size` corners belong to the first."""

    size: int

    def _normals(self, local: Floats) -> list[tuple[Floats, Floats, Floats]]:
        points = local.reshape(len(local), -1, 3)
        out = []
        for part in (points[:, : self.size], points[:, self.size :]):
            area = vector_areas(part)
            length = np.linalg.norm(area, axis=1, keepdims=True)
            out.append((part, area / np.maximum(length, np.finfo(float).tiny), length))
        return out

    def measure(self, local: Floats) -> Floats:
        """(m,) cosines."""
        (_, one, _), (_, two, _) = self._normals(local)
        return np.asarray(np.einsum("mx,mx->m", one, two))

    def slopes(self, local: Floats) -> Floats:
        """(m, 3k)."""
        faces = self._normals(local)
        slopes = []
        for (points, normal, length), (_, other, _) in zip(faces, faces[::-1], strict=True):
            by_area = _across(other, normal) / (2 * length)
            slopes.append(np.cross(_edge_sums(points), by_area[:, None]))
        return np.asarray(np.concatenate(slopes, axis=1).reshape(len(local), -1))


def _widened(measure: Floats, low: float, high: float, least: float | None) -> tuple[Floats, ...]:
    """Bounds that rows with these first measures fulfil.

    least : rows above it are not widened beyond it; None for rows without such a limit
    """
    angle = np.arccos(np.clip(measure, -1.0, 1.0))
    lowest = np.minimum(low, np.cos(np.minimum(angle + _SLACK, np.pi)))
    lowest = np.minimum(lowest, measure - _LEAST_ROOM)  # measure -1: turned inside out already
    if least is not None:
        lowest = np.where(measure > least + _STRAIGHT, np.maximum(lowest, least), lowest)
    return lowest, np.minimum(np.maximum(high, lowest + _LEAST_ROOM / 2), measure)


def corner_barriers(mesh: Mesh) -> tuple[Corners, ...]:
    """Barriers of the corner angles, a term for each number of corners."""
    terms = []
    for size in np.unique(mesh.face_sizes).tolist():
        ids, corners = polygon_corners(mesh, size)
        turns = (np.arange(size)[:, None] + np.arange(size)) % size
        index = _coordinates(corners[:, turns].reshape(-1, size))
        middle, half = (_QUAD_RANGE if size <= 4 else _LARGE_RANGE).tolist()
        elements = np.repeat(ids, size)
        none = np.zeros(0)
        plain = Corners(
            name="corners",
            index=index,
            low=none,
            high=none,
            of="face",
            elements=elements,
            middle=middle,
        )
        measure = plain.measure(mesh.vertices.ravel()[index])
        low = float(np.cos(half)) + _CORNER_MARGIN
        bounds = _widened(measure, low, low + _CORNER_REACH, float(np.cos(half)))
        terms.append(
            Corners(
                name="corners",
                index=index,
                low=bounds[0],
                high=bounds[1],
                of="face",
                elements=elements,
                middle=middle,
            )
        )
    return tuple(terms)


def edge_barrier(mesh: Mesh) -> Lengths:
    """No edge collapses."""
    return Lengths(
        name="edges",
        index=_coordinates(mesh.edges),
        low=_EDGE_LOW * mesh.edge_lengths,
        high=_EDGE_HIGH * mesh.edge_lengths,
        of="edge",
        elements=np.arange(mesh.n_edges),
    )


def fold_barriers(mesh: Mesh) -> tuple[Folds, ...]:
    """No face folds over its neighbour: a term for each pair of numbers of corners."""
    inner = np.flatnonzero(~mesh.boundary_edge)
    pairs = mesh.edge_faces[inner]
    sizes = mesh.face_sizes[pairs]
    swap = sizes[:, 0] > sizes[:, 1]
    pairs[swap], sizes[swap] = pairs[swap, ::-1], sizes[swap, ::-1]
    terms = []
    for one, two in np.unique(sizes, axis=0).tolist():
        rows = np.flatnonzero((sizes[:, 0] == one) & (sizes[:, 1] == two))
        corners = np.concatenate(
            [
                mesh.corners[mesh.face_start[pairs[rows, side], None] + np.arange(size)]
                for side, size in enumerate((one, two))
            ],
            axis=1,
        )
        cosine = np.einsum(
            "ex,ex->e", mesh.face_normals[pairs[rows, 0]], mesh.face_normals[pairs[rows, 1]]
        )
        low, high = _widened(cosine, _FOLD_LOW, _FOLD_HIGH, None)
        terms.append(
            Folds(
                name="folds",
                index=_coordinates(corners),
                low=low,
                high=high,
                of="edge",
                elements=inner[rows],
                size=one,
            )
        )
    return tuple(terms)


def barriers(mesh: Mesh) -> tuple[RowBarrier, ...]:
    """The barriers of every goal: corners, edges, folds."""
    return (*corner_barriers(mesh), edge_barrier(mesh), *fold_barriers(mesh))
