"""Weierstrass' formula: closed forms, curvature, normals and parameter lines by differences."""

from __future__ import annotations

import numpy as np
import pytest

from ddgfab.errors import DegenerateError, InputError
from ddgfab.mesh import Floats, unit
from ddgfab.surfaces import (
    Weierstrass,
    smooth_catenoid,
    smooth_enneper,
    smooth_scherk_tower,
    smooth_schwarz_p,
)

U, V = np.meshgrid(np.linspace(-0.8, 0.9, 6), np.linspace(-0.7, 1.1, 5), indexing="ij")
Z = U + 1j * V
STEP = 1e-4
SURFACES = {
    "enneper": (smooth_enneper(), Z),
    "catenoid": (smooth_catenoid(), Z),
    "scherk": (smooth_scherk_tower(), 0.5 * Z),
    "schwarz_p": (smooth_schwarz_p(), 0.25 * Z),
    "conjugate": (smooth_schwarz_p().conjugate(), 0.25 * Z),
    "associate": (smooth_enneper().conjugate(0.7), Z),
}


def derivatives(surface: Weierstrass, z: np.ndarray) -> tuple[Floats, ...]:
    """First and second derivatives of the points in u and v, by central differences."""
    p, q = STEP, 1j * STEP
    at = {(i, j): surface.points(z + i * p + j * q) for i in (-1, 0, 1) for j in (-1, 0, 1)}
    xu, xv = (at[1, 0] - at[-1, 0]) / (2 * STEP), (at[0, 1] - at[0, -1]) / (2 * STEP)
    xuu = (at[1, 0] - 2 * at[0, 0] + at[-1, 0]) / STEP**2
    xvv = (at[0, 1] - 2 * at[0, 0] + at[0, -1]) / STEP**2
    xuv = (at[1, 1] - at[1, -1] - at[-1, 1] + at[-1, -1]) / (4 * STEP**2)
    return xu, xv, xuu, xvv, xuv


def dot(a: Floats, b: Floats) -> Floats:
    return np.asarray(np.einsum("...x,...x->...", a, b))


@pytest.mark.parametrize("name", SURFACES)
def test_metric_normals_and_curvature(name: str) -> None:
    surface, z = SURFACES[name]
    xu, xv, xuu, xvv, xuv = derivatives(surface, z)
    stretch = surface.stretch(z)
    size = float(stretch.max())
    assert np.abs(dot(xu, xv)).max() < 1e-6 * size**2  # conformal
    assert np.abs(np.sqrt(dot(xu, xu)) - stretch).max() < 1e-6 * size
    assert np.abs(np.sqrt(dot(xv, xv)) - stretch).max() < 1e-6 * size
    n = unit(np.cross(xu, xv))
    given = surface.normals(z)
    assert np.abs(np.abs(dot(n, given)) - 1).max() < 1e-9
    assert np.abs(np.linalg.norm(given, axis=-1) - 1).max() < 1e-14
    first, second, mixed = dot(xuu, n), dot(xvv, n), dot(xuv, n)
    assert np.abs(first + second).max() < 1e-5 * np.abs(first).max()  # H = 0
    curvature = (first * second - mixed**2) / stretch**4
    assert np.abs(curvature / surface.curvatures(z) - 1).max() < 1e-4
    # f g' real: curvature lines, M = 0; imaginary: asymptotic lines, L = N = 0.
    turn = np.arctan2(mixed, first)
    sine = np.abs(surface.line_defect(z))
    assert np.abs(np.abs(np.sin(turn)) - sine).max() < 1e-4


def test_closed_forms() -> None:
    """mathematics.md 5.3."""
    wanted = 0.5 * np.stack([U - U**3 / 3 + U * V**2, -V + V**3 / 3 - U**2 * V, U**2 - V**2], -1)
    assert np.abs(smooth_enneper().points(Z) - wanted).max() < 1e-15
    assert np.abs(smooth_enneper().net(U[:, 0], V[0]) - wanted).max() < 1e-15
    assert smooth_enneper().curvatures(0.0) == -16.0
    wanted = np.stack([1 - np.cosh(U) * np.cos(V), -np.cosh(U) * np.sin(V), U], -1)
    assert np.abs(smooth_catenoid().points(Z) - wanted).max() < 1e-14
    assert np.abs(smooth_catenoid().line_defect(Z)).max() < 1e-15
    # The conjugate of the catenoid is a helicoid: tan v is y / x or so on horizontal rulings.
    x, y, z = np.moveaxis(smooth_catenoid().conjugate().points(Z), -1, 0)
    ruled = [np.abs(x * np.cos(z) + s * y * np.sin(z)).max() for s in (1, -1)]
    assert min(ruled) < 1e-13


@pytest.mark.parametrize("angle", [0.4, np.pi / 2, 2.0])
def test_members_turn_about_the_normal_as_discrete_ones_do(angle: float) -> None:
    """mathematics.md 7.7: dx goes to cos(angle) dx + sin(angle) n x dx; by differences."""
    surface = smooth_catenoid()
    other, n = surface.conjugate(angle), surface.normals(Z)
    for step in (STEP, 1j * STEP):
        dx, moved = (s.points(Z + step) - s.points(Z - step) for s in (surface, other))
        wanted = np.cos(angle) * dx + np.sin(angle) * np.cross(n, dx)
        assert np.abs(moved - wanted).max() < 1e-7 * STEP


def test_scherk_tower_and_its_conjugate() -> None:
    z = 0.9 * np.sqrt(np.linspace(0.01, 1, 30)) * np.exp(1j * np.arange(30))
    x, y, height = smooth_scherk_tower().conjugate().points(z).T
    # Doubly periodic: cos x e^h = cos y, up to the signs of the coordinates.
    assert min(np.abs(np.cos(x) * np.exp(s * height) - np.cos(y)).max() for s in (1, -1)) < 1e-12
    rim = smooth_scherk_tower().points(np.exp(1j * np.array([0.3, 1.2, 2.0, 4.0])))
    assert np.abs(np.abs(rim[:, 2]) - 0.5 * np.pi).max() < 1e-9
    assert np.abs(smooth_scherk_tower().normals(np.exp(0.4j))[2]) < 1e-15


def test_refusals() -> None:
    pole = Weierstrass(lambda z: 1.0 / (z - 0.5), lambda z: z, np.ones_like)
    assert np.isfinite(pole.points([0.4, 0.3j])).all()
    for bad in (1.0, 0.5):
        with pytest.raises(DegenerateError, match=rf"from 0.0 to \({bad:g}\+0j\) does not settle"):
            pole.points([0.2, bad])
    with pytest.raises(DegenerateError, match="branch point"):
        smooth_schwarz_p().points((7 - 4 * 3**0.5) ** 0.25 * np.exp(0.25j * np.pi))
    with pytest.raises(InputError, match="lists of numbers"):
        smooth_enneper().net(U, V[0])
