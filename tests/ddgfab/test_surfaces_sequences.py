"""Sequences of transforms of smooth surfaces, and nets that tend to them: orders asserted."""

from __future__ import annotations

import numpy as np
import pytest
from test_surfaces_limits import net_of_soliton, one_soliton, orders

from ddgfab.errors import DdgError
from ddgfab.mesh import Floats
from ddgfab.nets import stack_transforms, vertex_normals
from ddgfab.surfaces import (
    baecklund_angle,
    baecklund_sequence,
    ellipsoid_patch,
    sine_gordon_defect,
    smooth_darboux,
    smooth_isothermic_residuals,
)
from ddgfab.transforms import baecklund, darboux

SIGMAS, STARTS = (1.1, 0.7, 2.0), (0.7, 1.3, -0.4)


def test_every_sheet_is_a_k_surface_at_constant_distance() -> None:
    at = np.linspace(0.0, 0.5, 101)
    found = baecklund_sequence(one_soliton, at, at, SIGMAS, STARTS)
    assert found.points.shape == (101, 101, 4, 3)
    np.testing.assert_allclose(
        found.angles[1], baecklund_angle(one_soliton, np.tan(0.55), at, at, 0.7), atol=1e-9
    )
    h = at[1]
    inner = (slice(1, -1), slice(1, -1))
    for k, sheet in enumerate(found.sheets):
        x, n = sheet.points, sheet.normals
        du, dv = (np.gradient(x, h, axis=axis)[inner] for axis in (0, 1))
        for tangent in (du, dv):  # unit-speed, perpendicular to the normal, to second order
            assert np.abs(np.linalg.norm(tangent, axis=-1) - 1).max() < 3e-3
            assert np.abs(np.einsum("ijk,ijk->ij", tangent, n[inner])).max() < 3e-3
        cosine = np.einsum("ijk,ijk->ij", du, dv)
        assert np.abs(cosine - np.cos(found.angles[k][inner])).max() < 3e-3
        assert np.abs(sine_gordon_defect(found.angles[k], at, at)).max() < 3e-3
    for k, sigma in enumerate(SIGMAS):
        one, two = found.sheets[k : k + 2]
        away = two.points - one.points
        assert np.abs(np.linalg.norm(away, axis=-1) - np.sin(sigma)).max() < 1e-11
        for sheet in (one, two):
            assert np.abs(np.einsum("ijk,ijk->ij", away, sheet.normals)).max() < 1e-11
        product = np.einsum("ijk,ijk->ij", one.normals, two.normals)
        assert np.abs(product - np.cos(sigma)).max() < 1e-11


def test_transforms_of_k_nets_tend_to_the_smooth_ones_with_order_two() -> None:
    """Discrete in u, v and the sequence, against smooth in u, v: two sheets of one sequence."""
    sigmas, starts = (1.1, 2.0), (0.7, -0.4)
    errors = []
    for n in (8, 16, 32):
        at = np.arange(n + 1) / n
        smooth = baecklund_sequence(one_soliton, at, at, sigmas, starts)
        net, worst = net_of_soliton(n), 0.0
        for k, sigma in enumerate(sigmas):
            wanted = smooth.sheets[k + 1]
            away = wanted.points[0, 0] - smooth.sheets[k].points[0, 0]
            # From the same direction at the first point: in the tangent plane of the net there.
            normal = net.normals[0, 0]
            away = away - (away @ normal) * normal
            edge = net.points[1, 0] - net.points[0, 0]
            psi = np.arctan2(normal @ np.cross(edge, away), edge @ away) - np.pi
            net = baecklund(net, sigma, psi)
            worst = max(worst, float(np.abs(net.points - wanted.points).max()))
        errors.append(worst)
    assert orders(errors) == pytest.approx([2.0, 2.0], abs=0.3)


def isothermic(u: Floats, v: Floats) -> Floats:
    """A plane after an inversion, shifted: every square grid in it is isothermic with 1 and -1."""
    w = np.stack([u + 0.4, v + 0.5, 0.3 + 0.0 * u], axis=-1)
    return w / np.sum(w * w, axis=-1, keepdims=True)


START = np.array([0.9, 0.4, 1.3])


def test_smooth_darboux_transforms_are_isothermic_and_undone() -> None:
    at = np.linspace(0.0, 0.4, 9)
    mu = 0.8
    y = smooth_darboux(isothermic, at, at, mu, START)
    fine = np.linspace(0.0, 0.4, 41)
    z = smooth_darboux(isothermic, fine, fine, mu, START)
    np.testing.assert_allclose(z[::5, ::5], y, atol=1e-9)
    other = smooth_darboux(lambda u, v: isothermic(v, u), at, at, -mu, START)
    np.testing.assert_allclose(other.swapaxes(0, 1), y, atol=1e-8)  # the other path
    h = fine[1]
    du, dv = (np.gradient(z, h, axis=k)[1:-1, 1:-1] for k in (0, 1))
    lengths = [np.linalg.norm(d, axis=-1) for d in (du, dv)]
    assert np.abs(lengths[0] / lengths[1] - 1).max() < 5e-3
    assert np.abs(np.einsum("ijk,ijk->ij", du, dv) / lengths[0] / lengths[1]).max() < 5e-3
    assert max(smooth_isothermic_residuals(isothermic, at, at).values()) < 1e-7


def test_discrete_darboux_transforms_tend_to_the_smooth_one_with_order_two() -> None:
    mu, errors = 0.8, []
    for n in (4, 8, 16):
        at = 0.4 * np.arange(n + 1) / n
        x = isothermic(*np.meshgrid(at, at, indexing="ij"))
        smooth = smooth_darboux(isothermic, at, at, mu, START)
        labels = [np.ones(n), -np.ones(n)]
        found = darboux(x, -1.0 / (mu * at[1] ** 2), START, labels=labels)
        errors.append(float(np.abs(found - smooth).max()))
    assert orders(errors) == pytest.approx([2.0, 2.0], abs=0.1)


def test_parallel_circular_nets_tend_to_the_parallel_surface_with_order_two() -> None:
    """Ellipsoid by lines of curvature: the net's vertex offset against that of the surface."""
    errors = []
    for n in (8, 16, 32):
        u, v = np.linspace(5.0, 7.0, n + 1), np.linspace(1.8, 3.0, n + 1)
        x = ellipsoid_patch(u[:, None], v[None])
        normal = x / np.array([9.0, 4.0, 1.0])
        normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
        sheets = stack_transforms([x, x + 0.3 * vertex_normals(x, normal[0, 0])])
        errors.append(float(np.abs(sheets[:, :, 1] - (x + 0.3 * normal)).max()))
    assert orders(errors) == pytest.approx([2.0, 2.0], abs=0.2)


def test_refusals() -> None:
    at = np.linspace(0, 0.4, 5)
    with pytest.raises(DdgError, match="as many"):
        baecklund_sequence(one_soliton, at, at, [1.0], [0.1, 0.2])
    with pytest.raises(DdgError, match="between 0 and pi"):
        baecklund_sequence(one_soliton, at, at, [4.0], [0.1])
    with pytest.raises(DdgError, match="mu other than 0"):
        smooth_darboux(isothermic, at, at, 0.0, START)
    with pytest.raises(DdgError, match="lies on the surface"):
        smooth_darboux(isothermic, at, at, 1.0, isothermic(*np.zeros((2, 1)))[0])
