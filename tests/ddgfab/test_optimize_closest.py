"""Nearest points of triangles and segments: against all shapes, one after the other."""

from __future__ import annotations

import numpy as np
import pytest

from ddgfab.mesh import Floats
from ddgfab.optimize.terms.closest import SegmentTree, TriangleTree


def shapes(corners: int, seed: int = 0) -> Floats:
    """Shapes of radii from 1e-4 to 10 in a box of side 2, some thin, some points."""
    rng = np.random.default_rng(seed)
    size = 10.0 ** rng.uniform(-4, 1, (90, 1, 1))
    found = rng.uniform(-1, 1, (90, 1, 3)) + size * rng.normal(size=(90, corners, 3))
    if corners == 3:
        found[:20, 2] = 0.3 * found[:20, 0] + 0.7 * found[:20, 1]
    found[20:30] = found[20:30, :1]
    return np.asarray(found)


def segment_distance(point: Floats, start: Floats, end: Floats) -> float:
    """By golden section along the segment, which knows nothing of projections."""
    low, high = 0.0, 1.0
    part = (np.sqrt(5) - 1) / 2
    for _ in range(50):
        one, two = high - part * (high - low), low + part * (high - low)
        first, second = (np.linalg.norm(point - start - t * (end - start)) for t in (one, two))
        low, high = (low, two) if first < second else (one, high)
    return float(np.linalg.norm(point - start - low * (end - start)))


def triangle_distance(point: Floats, triangle: Floats) -> float:
    """By the normal where the foot is inside, by the sides otherwise."""
    a, b, c = triangle
    sides = min(segment_distance(point, *pair) for pair in ((a, b), (b, c), (c, a)))
    normal = np.cross(b - a, c - a)
    if np.linalg.norm(normal) < 1e-9 * np.linalg.norm(b - a) * np.linalg.norm(c - a) + 1e-300:
        return sides
    normal /= np.linalg.norm(normal)
    foot = point - ((point - a) @ normal) * normal
    turns = [np.cross(q - p, foot - p) @ normal for p, q in ((a, b), (b, c), (c, a))]
    return abs(float((point - a) @ normal)) if min(turns) >= 0 else sides


@pytest.mark.parametrize("corners", [2, 3])
def test_no_other_shape_is_nearer(corners: int) -> None:
    given = shapes(corners)
    tree = (SegmentTree if corners == 2 else TriangleTree)(given)
    points = np.random.default_rng(1).uniform(-2, 2, (12, 3))
    foot, shape = tree.nearest(points)
    away = np.linalg.norm(foot - points, axis=1)
    for k, point in enumerate(points):
        if corners == 2:
            every = [segment_distance(point, *one) for one in given]
        else:
            every = [triangle_distance(point, one) for one in given]
        assert away[k] == pytest.approx(min(every), abs=1e-7)
        assert every[shape[k]] == pytest.approx(min(every), abs=1e-7)


def test_points_of_the_shapes_are_their_own_feet() -> None:
    given = shapes(3)[30:]
    part = np.random.default_rng(2).dirichlet((1, 1, 1), len(given))
    points = np.einsum("nk,nkx->nx", part, given)
    foot, _ = TriangleTree(given).nearest(points)
    np.testing.assert_allclose(foot, points, atol=1e-12)


def test_place_and_unit_do_not_matter() -> None:
    given, points = shapes(3), np.random.default_rng(3).uniform(-2, 2, (50, 3))
    foot, _ = TriangleTree(given).nearest(points)
    moved, _ = TriangleTree(1e3 * given + 1e5).nearest(1e3 * points + 1e5)
    np.testing.assert_allclose((moved - 1e5) / 1e3, foot, atol=1e-9)
