"""Curves as polynomials in Bernstein form, as CAD programs hold them: a curve has n + 1 poles."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Final

import numpy as np

from ddgfab.mesh import Floats
from fabrication.boundary import Boundary

DEGREES: Final = (9, 13, 17, 21)
"""Degrees that curves where cylinders cross are tried with; the kernel allows 25."""

OFF: Final = 2e-10
"""How far [mm] such a polynomial may be off the curve; with the last degree it may be farther."""


PCURVE_ERROR: Final = 1e-10
"""How far [mm] the polynomial that stands for a wave in a cylinder's (u, v) may be off."""

PCURVE_DEGREES: Final = (3, 21)
"""Least and greatest degree of that polynomial; the kernel allows 25."""


@lru_cache(maxsize=32)
def wave_basis(n: int) -> tuple[Floats, Floats]:
    """Interpolation nodes on -1..1, and the matrix from values there to Bernstein coefficients."""
    nodes = np.cos((np.arange(n + 1) + 0.5) * math.pi / (n + 1))
    # Exact ends: the curve must meet the vertices.
    nodes[0], nodes[-1] = 1.0, -1.0
    matrix = np.linalg.inv(_bernstein(n, (nodes + 1.0) / 2.0))
    return np.asarray(nodes, dtype=np.float64), np.asarray(matrix, dtype=np.float64)


def wave_degree(height: float, half: float) -> int:
    """Least degree that follows a wave of some height over 2 half [rad] (Chebyshev's bound)."""
    n, error = 1, height * half * half / 4.0
    while (n < PCURVE_DEGREES[0] or error > PCURVE_ERROR / 4.0) and n < PCURVE_DEGREES[1]:
        n += 1
        error *= half / (2.0 * (n + 1))
    return n


def _bernstein(n: int, s: Floats) -> Floats:
    """(m, n + 1) Bernstein polynomials of degree n at parts s (m,)."""
    return np.array([math.comb(n, k) * s**k * (1.0 - s) ** (n - k) for k in range(n + 1)]).T


@lru_cache(maxsize=8)
def _between(n: int) -> tuple[Floats, Floats]:
    """Where a polynomial of degree n is compared with its curve, on -1..1, and the values there."""
    nodes = np.cos(np.arange(1, n + 1) * math.pi / (n + 1))
    return nodes, _bernstein(n, (nodes + 1.0) / 2.0)


@lru_cache(maxsize=8)
def crossing_poles(boundary: Boundary) -> dict[int, Floats]:
    """Poles (n + 1, 3) of the curves where cylinders cross, by arc; over the arc's own range."""
    rows = np.flatnonzero(boundary.arc_crosses)
    found: dict[int, Floats] = {}
    for n in DEGREES:
        if not len(rows):
            break
        nodes, matrix = wave_basis(n)
        between, values = _between(n)
        first, last = boundary.arc_range[rows].T[:, :, None]
        t = 0.5 * (first + last) + 0.5 * (last - first) * np.concatenate([nodes, between])
        points = boundary.arc_points(rows, t)
        poles = matrix @ points[:, : n + 1]
        off = np.abs(values @ poles - points[:, n + 1 :]).max(axis=(1, 2))
        done = (off <= OFF) | (n == DEGREES[-1])
        found |= {row: poles[k] for k, row in enumerate(rows.tolist()) if done[k]}
        rows = rows[~done]
    return found
