"""Barriers of radius: vectors that may not become longer than a limit, as lean or movement.

With t = (1 - |r|^2 / R^2) / (1 - q^2), the cost b(t) = -(t - 1)^2 ln t is zero up to |r| = q R and
rises without limit towards R. The square of a length is convex, so its curvature is part of the
model of a step: at r = 0 it is all there is, since the slope vanishes there.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Final

import numpy as np
from scipy.sparse import csr_array, vstack

from ddgfab.mesh import Floats, Mesh
from ddgfab.optimize.barriers import cost, cost_slopes
from ddgfab.optimize.problem import VERTICES, Layout
from ddgfab.optimize.terms.axes import AxisLean, block_matrix

LEAN_WEIGHT: Final = 0.1
"""Weight of the limit of lean. Ten times as much keeps axes far below it, at the cost of distance;
a tenth stalled on two of nine meshes."""

_FREE: Final = 0.5
"""Part of the limit of movement up to which it costs nothing."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Within(ABC):
    """Vectors r of three numbers each, shorter than `limit`.

    Attributes
    ----------
    limit : R, without unit, or in mean edges
    free : q, part of the limit up to which it costs nothing
    """

    layout: Layout
    limit: float
    free: float = 0.0
    weight: float = 1.0

    @abstractmethod
    def vectors(self, x: Floats) -> Floats:
        """(m, 3) vectors."""

    @abstractmethod
    def turns(self, x: Floats) -> csr_array:
        """(3m, n) derivative of the vectors."""

    def _inside(self, vectors: Floats) -> Floats:
        square = np.einsum("mx,mx->m", vectors, vectors) / self.limit**2
        return np.asarray((1.0 - square) / (1.0 - self.free**2))

    def value(self, x: Floats) -> float:
        """Sum of the costs; infinite where a vector is as long as its limit or longer."""
        return self.weight * cost(self._inside(self.vectors(x)))

    def active(self, x: Floats) -> tuple[csr_array, Floats, Floats]:
        """Rows that cost something, their first derivatives and the weights of their squares."""
        vectors = self.vectors(x)
        t = self._inside(vectors)
        on = np.flatnonzero(t < 1)
        if not len(on):
            return csr_array((0, len(x))), np.zeros(0), np.zeros(0)
        first, second = cost_slopes(t[on])
        scale = 2.0 / (self.limit**2 * (1.0 - self.free**2))
        rows = (3 * on[:, None] + np.arange(3)).ravel()
        turns = csr_array(self.turns(x)[rows])
        ids = np.arange(len(on))
        slopes = block_matrix(-scale * vectors[on][:, None], ids, ids, (len(on), len(on))) @ turns
        return (
            csr_array(vstack([slopes, turns], format="csr")),
            self.weight * np.concatenate([first, np.zeros(3 * len(on))]),
            self.weight * np.concatenate([second, np.repeat(-scale * first, 3)]),
        )


@dataclass(frozen=True, eq=False, kw_only=True)
class LeanWithin(Within):
    """Node axes near the vertex normals; make with `lean_within`."""

    lean: AxisLean

    def vectors(self, x: Floats) -> Floats:
        """(V, 3) axis minus normal."""
        return self.lean.residual(x).reshape(-1, 3)

    def turns(self, x: Floats) -> csr_array:
        """(3V, n)."""
        return self.lean.jacobian(x)


def lean_within(mesh: Mesh, layout: Layout, limit: float) -> LeanWithin:
    """Axes that lean by less than a limit [rad]."""
    return LeanWithin(
        layout=layout,
        limit=2.0 * float(np.sin(min(limit, np.pi) / 2.0)),
        weight=LEAN_WEIGHT,
        lean=AxisLean(mesh=mesh, layout=layout),
    )


@dataclass(frozen=True, eq=False, kw_only=True)
class MovementWithin(Within):
    """Vertices near their places; make with `movement_within`."""

    places: Floats

    def vectors(self, x: Floats) -> Floats:
        """(V, 3) movements."""
        return np.asarray(self.layout.values(x, VERTICES) - self.places)

    def turns(self, x: Floats) -> csr_array:
        """(3V, n)."""
        count = self.places.size
        return csr_array((np.ones(count), (np.arange(count),) * 2), shape=(count, len(x)))


def movement_within(mesh: Mesh, layout: Layout, limit: float) -> MovementWithin:
    """Vertices that move by less than a limit, in the unit of the mesh."""
    return MovementWithin(layout=layout, limit=limit, free=_FREE, places=mesh.vertices)
