"""Acute corners are opened by merging two faces."""

from __future__ import annotations

import numpy as np

from ddgfab.surfaces.analytic import named_surface
from ddgfab.surfaces.sampled import interpolated
from ddgfab.trace import PrincipalField, network_mesh, place, trace
from ddgfab.trace.slivers import ACUTE_DEG, without_slivers


def test_a_sliver_is_merged_with_its_neighbor() -> None:
    points = np.array([[0, 0, 0], [4, 0, 0], [4, 0.5, 0], [4, 3, 0], [0, 3, 0.0]])
    faces = [np.array([0, 1, 2]), np.array([0, 2, 3, 4])]
    (merged,) = without_slivers(points, faces)
    assert sorted(merged.tolist()) == [0, 1, 2, 3, 4]
    start = merged.tolist().index(0)
    assert np.roll(merged, -start).tolist() == [0, 1, 2, 3, 4]


def test_blunt_corners_stay() -> None:
    points = np.array([[0, 0, 0], [4, 0, 0], [4, 2.6, 0], [4, 6, 0], [0, 6, 0.0]])
    faces = [np.array([0, 1, 2]), np.array([0, 2, 3, 4])]  # 33 deg at the first vertex
    assert len(without_slivers(points, faces)) == 2


def test_a_fan_inside_is_opened() -> None:
    """Seven edges that converge at one vertex, 10 deg apart, as lines do near umbilics."""
    angle = np.radians(np.arange(-30, 31, 10))
    rim = np.stack([4 * np.cos(angle), 4 * np.sin(angle), 0 * angle], axis=1)
    points = np.concatenate([np.zeros((1, 3)), rim])
    found = without_slivers(points, [np.array([0, k, k + 1]) for k in range(1, 7)])
    assert 1 <= len(found) < 3
    for ring in found:
        corners = ring.tolist()
        i = corners.index(0)
        a, b = points[corners[i - 1]], points[corners[(i + 1) % len(corners)]]
        assert np.degrees(np.arccos(a @ b / 16)) > (29.0 if len(found) > 1 else ACUTE_DEG)


def test_lines_that_converge_make_no_acute_corners() -> None:
    """Directions of this roof are hardly determined along a valley: 8 deg between edges before."""
    valley = interpolated(
        lambda x, y: np.stack(
            [
                x,
                y,
                2400 * np.sin(np.pi * x / 18e3) + 1500 * np.sin(np.pi * y / 12e3) + x * y / 15e4,
            ],
            axis=-1,
        ),
        (0.0, 18e3, 0.0, 12e3),
        (41, 37),
    )
    mesh = trace(valley, 1300.0).mesh
    assert np.degrees(mesh.corner_angles).min() > ACUTE_DEG - 1e-9


def test_a_traced_net_has_no_acute_edge_at_its_rim() -> None:
    for name in ("wave-roof", "monkey-saddle", "dome"):
        mesh = network_mesh(place(PrincipalField(named_surface(name)), (1500.0, 1500.0))).mesh
        rim = mesh.boundary_vertex[mesh.corners]
        assert np.degrees(mesh.corner_angles[rim]).min() > ACUTE_DEG - 1e-9
