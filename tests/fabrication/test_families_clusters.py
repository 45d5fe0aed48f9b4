"""Clusters of pieces: those of comparing all with all, in nearly linear time."""

from __future__ import annotations

import time

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from ddgfab.mesh import Floats
from fabrication.families import _alone, cluster, families
from fabrication.gridshell.pieces import Panel
from fabrication.parts.panel import PanelShape
from fabrication.variants import key_of


def test_clustering_agrees_with_all_pairs() -> None:
    rng = np.random.default_rng(7)
    points = rng.uniform(0, 3, (300, 1, 2, 1)).round(1)  # many within 0.25 of each other
    found = cluster(points, 0.25)
    expected: list[int] = []
    for i in range(300):
        leaders = [
            k for k in dict.fromkeys(expected) if np.abs(points[k, 0] - points[i, 0]).max() <= 0.25
        ]
        expected.append(leaders[0] if leaders else i)
    assert found.leader.tolist() == expected


def test_growth_is_nearly_linear() -> None:
    def seconds(n: int) -> float:
        points = np.random.default_rng(1).uniform(0, 1000, (n, 4, 8, 1))
        begin = time.process_time()
        cluster(points, 0.1)
        return time.process_time() - begin

    seconds(500)
    few = min(seconds(2000) for _ in range(3))
    many = min(seconds(16000) for _ in range(2))
    assert many < 8 * 4 * few  # linear would be 8 times, quadratic 64 times


def test_pieces_far_from_all_others_are_known_before_the_search() -> None:
    """Two that one variant brings together are not; all others need no search."""
    places = 10.0 * np.arange(5.0)
    features = np.stack([places, places], axis=1)[:, :, None]
    features[3, 1] = places[1]  # turned round, the fourth is like the second
    assert _alone(features, 0.1).tolist() == [True, True, True, False, True]
    features[4] = features[0] + 0.01  # in the cell of the first
    assert _alone(features, 0.1).tolist() == [False, True, True, False, False]


def test_a_dimension_that_is_not_there_equals_none_that_is() -> None:
    assert key_of(None) not in {key_of(0.0), key_of(1.0)}
    assert key_of(None) < 0  # lengths and angles in keys are not
    assert key_of(1.0 + 1e-9) == key_of(1.0)


def greedy(points: Floats, tolerance: float) -> tuple[list[int], list[float]]:
    """Leaders and deviations by comparing every piece with every leader before it."""
    leaders: list[int] = []
    owner, off = [], []
    for k in range(len(points)):
        apart = np.linalg.norm(points[leaders] - points[k, 0], axis=-1).max(axis=-1).min(axis=-1)
        fits = np.flatnonzero(apart <= tolerance)
        if len(fits):
            owner.append(leaders[fits[0]])
            off.append(float(apart[fits[0]]))
        else:
            leaders.append(k)
            owner.append(k)
            off.append(0.0)
    return owner, off


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("scatter", [0.01, 0.04, 0.1])
def test_clusters_are_those_of_comparing_all_with_all(seed: int, scatter: float) -> None:
    """Few shapes, each turned and measured with errors: variants matter, and the tolerance does."""
    rng = np.random.default_rng(seed)
    shapes = rng.uniform(-500, 500, (9, 4, 2))
    shapes[5:] = shapes[:4] + rng.normal(0, 0.05, (4, 4, 2))
    pieces = shapes[rng.integers(0, 9, 300)]
    turns = rng.integers(0, 4, 300)
    pieces = np.stack([np.roll(p, k, axis=0) for p, k in zip(pieces, turns, strict=True)])
    pieces = pieces + rng.normal(0, scatter, pieces.shape)
    points = np.stack([np.roll(pieces, k, axis=1) for k in range(4)], axis=1)
    found = cluster(points, 0.1)
    owner, off = greedy(points, 0.1)
    assert found.leader.tolist() == owner
    assert np.allclose(found.deviation, off, atol=1e-5)
    for k, leader in enumerate(owner):
        apart = np.linalg.norm(points[leader, found.variant[k]] - points[k, 0], axis=-1).max()
        assert apart == pytest.approx(off[k], abs=1e-5)
    assert 5 <= len(set(owner)) < 300


def test_the_first_piece_of_a_number_stays_exactly_where_it_is() -> None:
    """Of 300 numbers in one key too: its frame is not turned there and back, which would round."""
    pieces = []
    for k in range(300):
        angle = 0.5 * np.pi * np.arange(4) + 0.1
        outline = (500.0 + k) * np.column_stack([np.cos(angle), np.sin(angle)])
        placement = np.eye(4)
        placement[:3, :3] = Rotation.random(random_state=k).as_matrix()
        placement[:3, 3] = [k, -3.3 * k, 1e4 / 3]
        shape = PanelShape(10.0, outline, outline)
        pieces.append(Panel(f"P-{k:04d}", k, 0.0, 0.0, "flat", (), shape, placement))
    for family, piece in zip(families(pieces, 0.02), pieces, strict=True):
        assert (family.instances[0].placement == piece.placement).all()
