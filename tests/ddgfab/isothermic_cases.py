"""Isothermic nets that several tests start from."""

from __future__ import annotations

import numpy as np

EXACT = 1e-12


def catenoid(rings: int = 6, around: int = 7, n: int = 12) -> np.ndarray:
    """Rotational isothermic net: the discrete catenoid of mathematics.md 7.6, every second ring."""
    alpha = np.pi / n
    length = np.arcsinh(np.tan(alpha))
    i, j = np.meshgrid(2.0 * np.arange(rings), 2.0 * np.arange(around), indexing="ij")
    r = np.cosh(i * length)
    return np.stack([r * np.cos(j * alpha), r * np.sin(j * alpha), i * np.sinh(length)], axis=-1)


def random_lines(seed: int, cells: int) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    u = np.linspace(0.0, 1.0, cells + 1)[:, None]
    wobble = 0.05 * rng.standard_normal((2, cells + 1, 3))
    wobble[:, 0] = 0.0
    return u * [1.0, 0.1, 0.2] + wobble[0], u * [-0.1, 1.0, 0.1] + wobble[1]


def same_up_to_translation(x: np.ndarray, y: np.ndarray) -> float:
    flat = (-1, x.shape[-1])
    return float(np.abs((x - x.reshape(flat)[0]) - (y - y.reshape(flat)[0])).max())
