"""Acute corners at the rim are opened by merging two faces."""

from __future__ import annotations

import numpy as np

from ddgfab.surfaces.analytic import named_surface
from ddgfab.trace import PrincipalField, network_mesh, place
from ddgfab.trace.slivers import ACUTE_DEG, without_slivers


def test_a_sliver_is_merged_with_its_neighbor() -> None:
    points = np.array([[0, 0, 0], [4, 0, 0], [4, 0.5, 0], [4, 3, 0], [0, 3, 0.0]])
    faces = [np.array([0, 1, 2]), np.array([0, 2, 3, 4])]
    (merged,) = without_slivers(points, np.ones(5, dtype=int), faces)
    assert sorted(merged.tolist()) == [0, 1, 2, 3, 4]
    start = merged.tolist().index(0)
    assert np.roll(merged, -start).tolist() == [0, 1, 2, 3, 4]


def test_inner_corners_stay() -> None:
    points = np.array([[0, 0, 0], [4, 0, 0], [4, 0.5, 0], [4, 3, 0], [0, 3, 0.0]])
    faces = [np.array([0, 1, 2]), np.array([0, 2, 3, 4])]
    assert len(without_slivers(points, np.zeros(5, dtype=int), faces)) == 2


def test_a_traced_net_has_no_acute_edge_at_its_rim() -> None:
    for name in ("wave-roof", "monkey-saddle", "dome"):
        mesh = network_mesh(place(PrincipalField(named_surface(name)), (1500.0, 1500.0))).mesh
        rim = mesh.boundary_vertex[mesh.corners]
        assert np.degrees(mesh.corner_angles[rim]).min() > ACUTE_DEG - 1e-9
