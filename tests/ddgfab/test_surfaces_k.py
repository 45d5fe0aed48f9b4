"""Smooth K-surfaces: the properties of 5.5, closed forms against each other, Amsler's numbers."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from ddgfab.curvature import gauss_curvature, metric_of
from ddgfab.errors import InputError
from ddgfab.mesh import Floats
from ddgfab.surfaces import (
    KSurface,
    amsler,
    amsler_angle,
    breather,
    breather_angle,
    breather_lines,
    dini,
    dini_lines,
    kuen,
    kuen_lines,
    pseudosphere,
    pseudosphere_lines,
    rotational_lines,
    soliton,
    surface_of,
)

TAU, SIGMA = 0.8, 1.1
U, V = np.linspace(-1.0, 1.3, 7)[:, None], np.linspace(-0.9, 1.2, 6)

SURFACES: dict[str, Callable[[Floats, Floats], KSurface]] = {
    "pseudosphere": pseudosphere,
    "dini": lambda u, v: dini(u, v, SIGMA, 0.6),
    "breather": lambda u, v: breather(u, v, TAU, 0.7 + 0.3j),
    "kuen": lambda u, v: kuen(u, v, 0.4),
}


def dot(a: Floats, b: Floats) -> Floats:
    return np.asarray(np.einsum("...i,...i->...", a, b))


def distances(points: Floats) -> Floats:
    flat = np.asarray(points).reshape(-1, 3)
    return np.asarray(np.linalg.norm(flat[:, None] - flat, axis=-1))


def slopes(surface: Callable[[Floats, Floats], KSurface]) -> list[Floats]:
    """x_u, x_v, n_u, n_v by central differences of fourth order."""
    h = 1e-3

    def along(step: Floats, name: str) -> Floats:
        at = [
            getattr(surface(U + k * h * step[0], V + k * h * step[1]), name) for k in (-2, -1, 1, 2)
        ]
        return np.asarray((at[0] - 8 * at[1] + 8 * at[2] - at[3]) / (12 * h))

    e = np.eye(2)
    return [along(e[k], name) for name in ("points", "normals") for k in (0, 1)]


@pytest.mark.parametrize("name", SURFACES)
def test_unit_speed_asymptotic_lines(name: str) -> None:
    """mathematics.md 5.5: E = G = 1, L = N = 0, |n_k| = 1, torsion +-1, K = -1, on all four."""
    x_u, x_v, n_u, n_v = slopes(SURFACES[name])
    n = SURFACES[name](U, V).normals
    assert np.abs(dot(n, n) - 1.0).max() < 1e-13
    assert np.abs(dot(x_u, x_u) - 1.0).max() < 1e-9
    assert np.abs(dot(x_v, x_v) - 1.0).max() < 1e-9
    assert np.abs(dot(x_u, n)).max() < 1e-9
    assert np.abs(dot(x_v, n)).max() < 1e-9
    assert np.abs(dot(x_u, n_u)).max() < 1e-9  # L = 0
    assert np.abs(dot(x_v, n_v)).max() < 1e-9  # N = 0
    assert np.abs(x_u - np.cross(n, n_u)).max() < 1e-9  # torsion +1 at unit speed
    assert np.abs(x_v + np.cross(n, n_v)).max() < 1e-9  # torsion -1
    determinant = dot(n, np.cross(n_u, n_v))
    assert np.abs(determinant + dot(n, np.cross(x_u, x_v))).max() < 1e-9  # K = -1


def test_transform_of_the_line() -> None:
    """mathematics.md 5.5: |x' - x| = sin sigma, tangent at both ends, <n, n'> = cos sigma."""
    surface, theta = dini(U, V, SIGMA, 0.6), U + V
    line = np.stack([0 * theta, 0 * theta, U - V], axis=-1)
    normal = np.stack([np.cos(theta), np.sin(theta), 0 * theta], axis=-1)
    step = surface.points - line
    assert np.abs(np.linalg.norm(step, axis=-1) - np.sin(SIGMA)).max() < 1e-14
    assert np.abs(dot(step, normal)).max() < 1e-14
    assert np.abs(dot(step, surface.normals)).max() < 1e-14
    assert np.abs(dot(normal, surface.normals) - np.cos(SIGMA)).max() < 1e-14


def test_closed_forms_agree_up_to_a_motion() -> None:
    """Transforms in asymptotic parameters against 3.15: equal distances of all pairs of points."""
    pulse, s = np.tanh(TAU), np.tan(0.5 * SIGMA)
    pairs = [
        (pseudosphere(U, V).points, pseudosphere_lines(V - U, U + V)),
        (dini(U, V, SIGMA).points, dini_lines(V / s - U * s, -U - V, SIGMA)),
        (kuen(U, V).points, kuen_lines(U + V, 2 * np.arctan(np.exp(V - U)))),
        (breather(U, V, TAU).points, breather_lines(U - V, U + V, np.sqrt(1 - pulse**2))),
    ]
    for got, want in pairs:
        assert np.abs(distances(got) - distances(want)).max() < 1e-13


def test_kuen_is_the_limit_of_breathers() -> None:
    """|breather - Kuen| falls with tau^2."""
    want = kuen(U, V).points
    apart = [np.abs(breather(U, V, tau).points - want).max() for tau in (0.1, 0.05, 0.025)]
    assert np.log2(apart[0] / apart[1]) == pytest.approx(2.0, abs=0.05)
    assert np.log2(apart[1] / apart[2]) == pytest.approx(2.0, abs=0.05)


@pytest.mark.parametrize(
    ("surface", "low", "high"),
    [
        (pseudosphere_lines, (0.6, 0.0), (2.0, 3.0)),
        (lambda u, v: dini_lines(u, v, SIGMA), (0.6, 0.0), (2.0, 3.0)),
        (kuen_lines, (1.8, 1.2), (3.5, 1.9)),
        (lambda u, v: breather_lines(u, v, 0.4), (0.5, 2.0), (1.0, 2.4)),
        (lambda u, v: rotational_lines(u, v, 0.7), (-0.8, 0.0), (0.9, 3.0)),
    ],
)
def test_brioschi_finds_curvature_minus_one(
    surface: Callable[[Floats, Floats], Floats], low: tuple[float, ...], high: tuple[float, ...]
) -> None:
    u, v = np.linspace(low[0], high[0], 6)[:, None], np.linspace(low[1], high[1], 5)
    curvature = gauss_curvature(metric_of(surface), u, v, 0.01)
    assert np.abs(curvature + 1.0).max() < 1e-6


def test_surface_of_a_soliton_is_the_pseudosphere() -> None:
    """phi = 4 atan e^(u + v) gives the pseudosphere turned by a quarter: parameters (u, -v)."""

    def solution(u: Floats, v: Floats) -> tuple[Floats, Floats, Floats]:
        sech = 2.0 / np.cosh(u + v)
        return soliton(u, v, 1.0), sech, sech

    u, v = np.linspace(-1.0, 0.6, 6), np.linspace(-0.8, 0.9, 5)
    got = surface_of(solution, u, v)
    want = pseudosphere_lines(u[:, None] + v, u[:, None] - v)
    assert np.abs(distances(got.points) - distances(want)).max() < 1e-10
    assert np.abs(np.linalg.norm(got.normals, axis=-1) - 1).max() < 1e-10


def test_surface_of_a_breather_is_the_breather() -> None:
    rate = 0.6

    def solution(u: Floats, v: Floats) -> tuple[Floats, Floats, Floats]:
        pulse, p, q = np.sqrt(1 - rate**2), u + v, u - v
        wave = rate / pulse * np.sin(pulse * q) / np.cosh(rate * p)
        outer = 4.0 / (1.0 + wave**2)
        by_p = -rate * np.tanh(rate * p) * wave
        by_q = rate * np.cos(pulse * q) / np.cosh(rate * p)
        return breather_angle(u, v, rate), outer * (by_p + by_q), outer * (by_p - by_q)

    u, v = np.linspace(-1.0, 0.6, 6), np.linspace(-0.8, 0.9, 5)
    got = surface_of(solution, u, v)
    want = breather_lines(u[:, None] + v, u[:, None] - v, rate)
    assert np.abs(distances(got.points) - distances(want)).max() < 1e-10


def test_amsler_numbers_and_series() -> None:
    """mathematics.md 3.14, and the equation r f'' + f' = sin f on both sides of 0."""
    f, _ = amsler_angle([0.25, 1.0], np.pi / 3)
    assert np.abs(f - [1.269963844788, 1.983241599173]).max() < 2e-12
    h = 1e-3
    for r in (-2.0, -0.5, 0.5, 3.0):
        _, slope = amsler_angle(r + h * np.array([-2, -1, 1, 2]), np.pi / 3)
        bend = (slope[0] - 8 * slope[1] + 8 * slope[2] - slope[3]) / (12 * h)
        here, own = amsler_angle(r, np.pi / 3)
        assert r * bend + own == pytest.approx(np.sin(here), abs=1e-9)
    assert amsler_angle(0.0, 1.0)[0] == 1.0


def test_amsler_surface_holds_two_lines() -> None:
    start = np.pi / 3
    surface = amsler(np.linspace(-1.0, 1.5, 6), np.linspace(-1.2, 1.2, 7), start)
    across = surface.points[2] - surface.points[2, 0]  # u = 0
    along = surface.points[:, 3] - surface.points[0, 3]  # v = 0
    for line in (across, along):
        steps = np.diff(line, axis=0)
        assert np.abs(np.cross(steps[0], steps)).max() < 1e-10
    cosine = dot(across[-1], along[-1]) / 2.4 / 2.5
    assert cosine == pytest.approx(np.cos(start), abs=1e-10)


def test_bad_input() -> None:
    with pytest.raises(InputError, match=r"sigma = 3\.5"):
        dini(0.0, 0.0, 3.5)
    with pytest.raises(InputError, match="tau = 0"):
        breather(0.0, 0.0, 0.0)
    with pytest.raises(InputError, match="between 0 and pi"):
        amsler([0.0, 1.0], [0.0, 1.0], 3.2)
    with pytest.raises(InputError, match="v does not increase at step 0"):
        amsler([0.0, 1.0], [0.0, 0.0], 1.0)
    with pytest.raises(InputError, match="finite"):
        kuen(np.nan, 0.0)
    with pytest.raises(InputError, match="rate of a breather"):
        breather_lines(0.0, 0.0, 1.5)
    with pytest.raises(InputError, match=r"u = -1\.5 is beyond the rim at 0\.88137"):
        rotational_lines([0.2, -1.5], 0.0, 1.0)
    with pytest.raises(InputError, match="the waist is 0"):
        rotational_lines(0.0, 0.0, 0.0)
    with pytest.raises(InputError, match="sigma = 0"):
        dini_lines(0.0, 0.0, 0.0)
