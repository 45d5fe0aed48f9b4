"""Curvature for reports: spheres and cylinders by both ways, scale, side, and what has none."""

from __future__ import annotations

import numpy as np
import pytest

from ddgfab.forms.registry import generate
from ddgfab.grid import grid_mesh
from ddgfab.io.place import flipped
from ddgfab.mesh import Mesh
from ddgfab.transforms import curvature_range as module
from ddgfab.transforms.curvature_range import curvature_range

R = 5000.0


def sphere(m: int = 24) -> Mesh:
    """Part of a sphere of radius R in circles of latitude, looking outward."""
    u, v = np.meshgrid(np.linspace(0.4, 2.2, m), np.linspace(-0.6, 0.7, m), indexing="ij")
    points = np.stack([np.cos(u) * np.cos(v), np.sin(u) * np.cos(v), np.sin(v)], axis=-1)
    return grid_mesh(points * R)


def cylinder(m: int = 24) -> Mesh:
    u, v = np.meshgrid(np.linspace(0.4, 2.6, m), np.linspace(0, 2, m), indexing="ij")
    return grid_mesh(np.stack([np.cos(u), v, -np.sin(u)], axis=-1) * R)


def test_a_circular_net_on_a_sphere_is_exact() -> None:
    found = curvature_range(sphere())
    assert found is not None
    assert "circular" in found.way
    assert np.allclose(np.array(found.mean) * R, -1, atol=1e-6)
    assert np.allclose(np.array(found.gauss) * R**2, 1, atol=1e-6)


@pytest.mark.parametrize(("mesh", "gauss"), [(sphere(), 1.0), (cylinder(), 0.0)])
def test_both_ways_agree(mesh: Mesh, gauss: float, monkeypatch: pytest.MonkeyPatch) -> None:
    exact = curvature_range(mesh)
    monkeypatch.setattr(module, "KINDS", ())
    found = curvature_range(mesh)
    assert exact is not None
    assert found is not None
    assert "cotangents" in found.way
    assert np.allclose(exact.mean, found.mean, rtol=0.02, atol=0.01 / R)
    assert np.allclose(np.array(found.gauss) * R**2, gauss, atol=0.02)


def test_it_goes_with_size_and_side() -> None:
    rough = generate("conical")
    one = curvature_range(rough)
    half = curvature_range(rough.scaled(2.0))
    other = curvature_range(flipped(rough))
    assert one is not None
    assert half is not None
    assert other is not None
    assert np.allclose(np.array(half.mean) * 2, one.mean)
    assert np.allclose(np.array(half.gauss) * 4, one.gauss)
    assert np.allclose(other.mean, -np.array(one.mean)[::-1], rtol=1e-6)
    assert np.allclose(other.gauss, one.gauss, rtol=1e-6)


def test_a_single_face_has_none_and_lines_are_by_metres() -> None:
    quad = Mesh.build([[0, 0, 0], [1, 0, 0], [1, 1, 0.3], [0, 1, 0]], [[0, 1, 2, 3]])
    assert curvature_range(quad) is None
    found = curvature_range(sphere())
    assert found is not None
    (title, text), (_, gauss) = found.lines()
    assert title == "mean curvature H"
    assert text.startswith("-0.2 to -0.2, mean -0.2 1/m; ")
    assert gauss.startswith("0.04 to 0.04, mean 0.04 1/m2; ")
