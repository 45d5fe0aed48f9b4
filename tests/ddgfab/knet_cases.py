"""K-nets that several tests start from, and their conditions by a second route."""

from __future__ import annotations

import numpy as np

from ddgfab.mesh import Floats, unit
from ddgfab.nets.knet import KNet, knet

EXACT = 1e-12
"""Agreement of nets of about 20 x 20 cells with closed forms and conditions (mathematics.md 0,
3.5)."""


def cauchy(
    *cells: int, seed: int = 0, largest: float = 0.5
) -> tuple[list[Floats], list[Floats], Floats]:
    """Uneven angles, turns to both sides, corner angles; nothing symmetric."""
    rng = np.random.default_rng(seed)
    return (
        [rng.uniform(0.1, largest, n) for n in cells],
        [0.3 * rng.normal(size=n - 1) for n in cells],
        rng.uniform(1.0, 2.2, len(cells) - 1),
    )


def any_knet(*cells: int, seed: int = 0, r: float = 1.0) -> KNet:
    """A K-net of uneven data."""
    return knet(*cauchy(*cells, seed=seed), r=r)


def by_projection(x: Floats, d: int) -> Floats:
    """Normals of vertices with two or more edges, by crossing two edges: a second route to n.

    Forward edges of directions 0 and 1, backward ones at the end; up to sign.
    """
    size = x.shape[:-1]
    out = np.empty(x.shape)
    for at in np.ndindex(*size):
        edges = []
        for k in (0, 1):
            step = list(at)
            step[k] += 1 if at[k] + 1 < size[k] else -1
            edges.append(unit(x[tuple(step)] - x[at]))
        out[at] = unit(np.cross(edges[0], edges[1]))
    return out
