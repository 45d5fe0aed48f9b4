"""Smooth isothermic parametrisations and their duals: mathematics.md 5.4, 6.2."""

from __future__ import annotations

import numpy as np
import pytest

from ddgfab.errors import DegenerateError, InputError
from ddgfab.surfaces.isothermic import smooth_dual, smooth_isothermic_residuals


def sphere(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    return np.stack([np.cos(v) / np.cosh(u), np.sin(v) / np.cosh(u), np.tanh(u)], axis=-1)


def catenoid(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    return np.stack([-np.cosh(u) * np.cos(v), -np.cosh(u) * np.sin(v), u], axis=-1)


def enneper(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    x = u - u**3 / 3 + u * v**2
    return 0.5 * np.stack([x, -v + v**3 / 3 - u**2 * v, u**2 - v**2], axis=-1)


def skewed(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    return np.stack([u + 0.3 * v, v, u * v], axis=-1)


U, V = np.linspace(-0.9, 0.7, 9), np.linspace(0.1, 1.4, 8)


@pytest.mark.parametrize("surface", [sphere, catenoid, enneper])
def test_isothermic_surfaces(surface: object) -> None:
    found = smooth_isothermic_residuals(surface, U[:, None], V[None])  # type: ignore[arg-type]
    assert max(found.values()) < 1e-8


def test_other_parametrisations_are_told_apart() -> None:
    def monge(u: np.ndarray, v: np.ndarray) -> np.ndarray:
        return np.stack([u, v, 0.3 * u * v], axis=-1)

    assert min(smooth_isothermic_residuals(skewed, U[:, None], V[None]).values()) > 1e-2
    assert smooth_isothermic_residuals(monge, U[:, None], V[None])["conjugate"] > 1e-2


def test_dual_of_the_sphere_is_the_catenoid() -> None:
    """mathematics.md 6.2; Simpson's rule has order 4, the closing defect shows the same."""
    errors, defects = [], []
    for n in (8, 16, 32):
        u, v = np.linspace(-0.8, 0.8, n + 1), np.linspace(0.0, 1.6, n + 1)
        dual, defect = smooth_dual(sphere, u, v)
        wanted = catenoid(*np.meshgrid(u, v, indexing="ij"))
        errors.append(np.abs(dual - (wanted - wanted[0, 0])).max())
        defects.append(defect)
    assert errors[0] / errors[1] == pytest.approx(16, rel=0.1)
    assert errors[1] / errors[2] == pytest.approx(16, rel=0.1)
    assert errors[2] < 1e-6
    assert defects[2] < 1e-8


def test_dual_of_enneper_is_a_sphere() -> None:
    dual, defect = smooth_dual(enneper, U, V)
    assert defect < 1e-5
    rows = np.column_stack([2 * dual.reshape(-1, 3), np.ones(dual[..., 0].size)])
    squares = (dual.reshape(-1, 3) ** 2).sum(axis=1)
    center = np.linalg.lstsq(rows, squares, rcond=None)[0]
    assert np.abs(rows @ center - squares).max() < 1e-4 * squares.max()


def test_what_is_not_isothermic_does_not_close() -> None:
    assert smooth_dual(skewed, U, V)[1] > 1e-3


def test_refusals() -> None:
    def still(u: np.ndarray, v: np.ndarray) -> np.ndarray:
        return np.stack([u, 0 * v, 0 * v], axis=-1)

    with pytest.raises(DegenerateError, match=r"stands still at u = -0\.9"):
        smooth_isothermic_residuals(still, U[:, None], V[None])
    with pytest.raises(DegenerateError, match="not finite at u = "), np.errstate(all="ignore"):
        smooth_dual(lambda u, v: sphere(u, v) * np.sqrt(0.5 - u)[..., None], U, V)
    with pytest.raises(InputError, match="gave shape"):
        smooth_dual(lambda u, v: u, U, V)
    with pytest.raises(InputError, match="two numbers"):
        smooth_dual(sphere, U[:1], V)
