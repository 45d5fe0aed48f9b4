"""Nets that several tests of nets and offsets start from: nothing symmetric, nothing special."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from ddgfab.forms import monge, profile_polyline
from ddgfab.forms.canal import canal_net
from ddgfab.mesh import Floats, unit
from ddgfab.nets import conjugate as cn
from ddgfab.transforms import invert


def circular_net() -> Floats:
    """(8, 6, 3) image of a Monge net on a helix under an inversion; sizes about 1000."""
    way = np.linspace(0.0, 1.2, 8)
    tangents = np.stack([np.cos(way), np.sin(way), 0.3 + 0 * way], axis=1)
    profile = profile_polyline(np.linspace(0.7, -0.6, 6), np.linspace(0.8, 1.1, 5))
    x = monge(profile, tangents, np.linspace(0.9, 1.2, 7), (0.0, 0.0, 1.0)) * 1000.0
    return invert(x, (-9000.0, 2000.0, -4000.0), 11000.0)


def planar_net(rows: int = 5, cols: int = 4) -> Floats:
    """A projective image of a translation surface: planar quads, neither circular nor conical."""
    u, v = np.meshgrid(np.linspace(-1, 1, rows + 1), np.linspace(-1, 1, cols + 1), indexing="ij")
    x = np.stack([u + 0.1 * v, v + 0.2 * u, 1.5 - 0.3 * u**2 - 0.2 * v**2 - 0.1 * u**3], axis=-1)
    return np.asarray(1000 * x / (1 + 0.15 * x[..., :1] + 0.1 * x[..., 1:2]))


def skew_net(rows: int = 5, cols: int = 4, seed: int = 7) -> Floats:
    """A net whose quads are far from planar."""
    noise = np.random.default_rng(seed).normal(size=(rows + 1, cols + 1, 3))
    return planar_net(rows, cols) + 60.0 * noise


def space_canal(rings: int = 9, points: int = 6) -> Floats:
    """A canal net along a helix with a radius that grows and shrinks."""
    way = np.linspace(0.0, 1.5, rings + 1)
    centers = np.stack([np.cos(way), np.sin(way), 0.5 * way], axis=1) * 9000.0
    radii = 3000.0 + 500.0 * np.sin(2.0 * way)
    return canal_net(centers, radii, np.linspace(0.6, 2.6, points))


def koebe_net(sectors: int = 6, rings: tuple[int, int] = (-2, 3)) -> Floats:
    """(sectors + 1, rings, 3) rotational Koebe net, closed form of mathematics.md 7.6 (I, J
    even)."""
    alpha = np.pi / sectors
    step = np.arcsinh(np.tan(alpha))
    i = 2.0 * np.arange(rings[0], rings[1] + 1) * step
    j = 2.0 * np.arange(sectors + 1) * alpha
    radius = 1.0 / np.cosh(i) / np.cos(alpha)
    z = np.broadcast_to(np.tanh(i), (len(j), len(i)))
    return np.stack([np.outer(np.cos(j), radius), np.outer(np.sin(j), radius), z], axis=-1)


def catenoid_net(sectors: int = 6, rings: tuple[int, int] = (-2, 3)) -> Floats:
    """The discrete catenoid dual to `koebe_net`, closed form of mathematics.md 7.6."""
    alpha = np.pi / sectors
    step = np.arcsinh(np.tan(alpha))
    i = 2.0 * np.arange(rings[0], rings[1] + 1)
    j = 2.0 * np.arange(sectors + 1) * alpha
    radius, z = np.cosh(i * step), i * np.sinh(step)
    z = np.broadcast_to(z, (len(j), len(i)))
    return np.stack([np.outer(np.cos(j), radius), np.outer(np.sin(j), radius), z], axis=-1)


def concyclic_defect(x: Floats) -> float:
    """Second route to circularity: |imaginary part| of the cross-ratio of quaternions, greatest."""
    a, b, c, d = x[:-1, :-1], x[1:, :-1], x[1:, 1:], x[:-1, 1:]

    def times(p: tuple[Floats, Floats], q: tuple[Floats, Floats]) -> tuple[Floats, Floats]:
        real = p[0] * q[0] - np.einsum("ijk,ijk->ij", p[1], q[1])
        imaginary = p[0][..., None] * q[1] + q[0][..., None] * p[1] + np.cross(p[1], q[1])
        return real, imaginary

    def pure(v: Floats) -> tuple[Floats, Floats]:
        return np.zeros(v.shape[:2]), v

    def inverse(v: Floats) -> tuple[Floats, Floats]:
        return np.zeros(v.shape[:2]), -v / np.einsum("ijk,ijk->ij", v, v)[..., None]

    q = times(times(pure(a - b), inverse(b - c)), times(pure(c - d), inverse(d - a)))
    return float(np.linalg.norm(q[1], axis=-1).max())


def parallel_defect(x: Floats, y: Floats) -> float:
    """Greatest sine between corresponding edges of two nets."""
    return max(
        float(
            np.linalg.norm(
                np.cross(unit(np.diff(x, axis=k)), unit(np.diff(y, axis=k))), axis=-1
            ).max()
        )
        for k in (0, 1)
    )


def centered(points: Floats) -> Floats:
    return np.asarray(points - points.mean(axis=0))


def apart(one: Floats, two: Floats) -> float:
    """Greatest distance of two sets of points up to a rotation, a reflection and a shift."""
    a, b = centered(one), centered(two)
    u, _, vt = np.linalg.svd(a.T @ b)
    return float(np.abs(a @ (u @ vt) - b).max())


def surfaces(sizes: tuple[int, ...], dim: int, seed: int = 0, size: float = 0.1) -> dict:
    """Random conjugate coordinate surfaces with common axes."""
    rng = np.random.default_rng(seed)
    lines = []
    for k, n in enumerate(sizes):
        steps = 0.15 * rng.normal(size=(n - 1, dim))
        steps[:, k % dim] += 1.0
        if k >= dim:
            steps += 0.5
        lines.append(np.concatenate([np.zeros((1, dim)), np.cumsum(steps, axis=0)]))
    out = {}
    for k, m in combinations(range(len(sizes)), 2):
        c = rng.uniform(-size, size, size=(2, sizes[k] - 1, sizes[m] - 1))
        out[k, m] = cn.evolve_conjugate(lines[k], lines[m], c[0], c[1])
    return out
