"""Levels: bars on a pin differ, strips stay together, what cannot be is said with its pins."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from ddgfab.errors import DetailError
from ddgfab.linkages import Mechanism, bennett, cube, knet_mechanism
from ddgfab.nets.knet import amsler
from fabrication.linkage.choose import rank_levels
from fabrication.linkage.levels import (
    bar_coloring,
    bars_at,
    coloring,
    even_levels,
    neighbours_of,
    slanted_levels,
)
from fabrication.linkage.settings import settings_for


def loop() -> Mechanism:
    return bennett(100.0, np.radians(40.0), beta=np.radians(70.0))


def box() -> Mechanism:
    twists = np.radians([30.0, 45.0, 80.0])
    return cube(tuple(200.0 * np.sin(twists)), tuple(twists), corners=(1.5, 1.5))


def net(m: int, n: int) -> Mechanism:
    return knet_mechanism(
        amsler(np.full(m, np.pi / 8), np.full(n, np.pi / 8), np.pi / 2), scale_mm=150
    )


def graph(bars: list[tuple[int, int]], strips: list[int] | None = None) -> Mechanism:
    """Only what levels look at: which bars are on which hinges."""
    array = np.array(bars)
    known = {
        "bars": array,
        "n_bars": len(bars),
        "n_hinges": int(array.max()) + 1,
        "strips": np.arange(len(bars)) if strips is None else np.array(strips),
    }
    return cast(Mechanism, SimpleNamespace(**known))


def differ_at_pins(mechanism: Mechanism, levels: Any) -> bool:
    """Whether no two bars on a pin have one level, from the definition."""
    for hinge in range(mechanism.n_hinges):
        here = levels[mechanism.bars == hinge]
        if len(set(here.tolist())) < len(here):
            return False
    return True


@pytest.mark.parametrize(
    ("mechanism", "levels"),
    [(loop(), 2), (box(), 3), (net(1, 1), 2), (net(2, 1), 3), (net(2, 2), 4), (net(4, 3), 4)],
    ids=str,
)
def test_even_levels_keep_bars_apart_and_strips_together(mechanism: Mechanism, levels: int) -> None:
    found = list(even_levels(mechanism, 6))
    assert len({choice.tobytes() for choice in found}) == len(found) > 0
    most = max(len(bars) for bars in bars_at(mechanism))
    assert levels == most  # never more levels than the fullest pin has bars
    for choice in found:
        assert differ_at_pins(mechanism, choice)
        assert set(choice.ravel().tolist()) == set(range(levels))
        assert (choice[:, 0] == choice[:, 1]).all()
        for strip in np.unique(mechanism.strips):
            assert len(np.unique(choice[mechanism.strips == strip])) == 1


def test_orders_are_all_there_but_for_turning_over() -> None:
    # Four levels in 4! orders, two of which are one turned over; likewise 3! and 2!.
    assert [len(list(even_levels(m, 6))) for m in (net(2, 2), box(), loop())] == [12, 3, 1]


def test_every_choice_of_two_levels_of_a_loop() -> None:
    found = list(slanted_levels(loop()))
    assert len({choice.tobytes() for choice in found}) == len(found) == 8  # 2^4 / turned over
    assert all(differ_at_pins(loop(), choice) for choice in found)
    assert list(slanted_levels(net(2, 2))) == []


def test_too_few_levels_name_the_pin() -> None:
    with pytest.raises(DetailError, match=r"H-0004: 4 bars share this pin, and there are 3 levels"):
        list(even_levels(net(2, 2), 3))


def test_an_odd_loop_takes_a_level_more() -> None:
    # Three bars in a triangle: every two share a pin, each pin has two bars. Koenig does not hold.
    triangle = graph([(0, 1), (1, 2), (2, 0)])
    (first, *_) = even_levels(triangle, 6)
    assert differ_at_pins(triangle, first)
    assert first.max() == 2
    with pytest.raises(DetailError, match="no assignment of 2 levels"):
        list(even_levels(triangle, 2))


def test_strips_that_meet_themselves_fall_apart_into_bars() -> None:
    ring = graph([(k, (k + 1) % 6) for k in range(6)], [0] * 6)
    assert neighbours_of(ring, np.zeros(6, dtype=np.int64)) == [{0}]
    (first, *_) = even_levels(ring, 6)
    assert differ_at_pins(ring, first)
    assert set(first.ravel().tolist()) == {0, 1}


def test_coloring_backtracks_and_gives_up() -> None:
    # A wheel with five spokes needs four colors, its rim three.
    wheel = [{1, 4, 5}, {0, 2, 5}, {1, 3, 5}, {2, 4, 5}, {3, 0, 5}, {0, 1, 2, 3, 4}]
    assert coloring(wheel, 3, range(6)) is None
    found = coloring(wheel, 4, range(6))
    assert found is not None
    assert all(found[a] != found[b] for a, others in enumerate(wheel) for b in others)


@pytest.mark.parametrize("seed", range(20))
def test_chains_color_every_bipartite_linkage(seed: int) -> None:
    """Koenig: as many colors as the fullest pin has bars, whatever the order of the bars."""
    random = np.random.default_rng(seed)
    pairs = {(int(i), int(j)) for i, j in random.integers(0, 12, (60, 2))}
    bars = [(i, 12 + j) for i, j in pairs]
    bars = [bars[k] for k in random.permutation(len(bars))]
    mechanism = graph(bars)
    most = max(map(len, bars_at(mechanism)))
    found = bar_coloring(mechanism, most)
    assert found is not None
    levels = np.stack([found, found], axis=1)
    assert differ_at_pins(mechanism, levels)
    assert bar_coloring(mechanism, most - 1) is None


# --- ranking -------------------------------------------------------------------------------------
def test_equal_strips_take_two_part_numbers() -> None:
    """Levels 0, 3 for one direction and 1, 2 for the other: turned over they are congruent."""
    mechanism = net(3, 3)
    ranked = rank_levels(mechanism, settings_for(), even_levels(mechanism, 6))
    best = ranked[0]
    assert best.numbers == 2
    sets = [set(best.levels[mechanism.directions == d].ravel().tolist()) for d in (0, 1)]
    assert sorted(sets, key=min) == [{0, 3}, {1, 2}]
    assert [c.numbers for c in ranked] == sorted(c.numbers for c in ranked)
    wide = rank_levels(mechanism, settings_for(), even_levels(mechanism, 6), "range")
    assert wide[0].range >= best.range


def test_wider_eyes_and_bars_shrink_the_range() -> None:
    mechanism = loop()
    ranges = [
        rank_levels(mechanism, settings_for(**given), even_levels(mechanism, 6))[0].range
        for given in (
            {"bar_width": 3.0, "bar_height": 3.0},
            {},
            {"eye_diameter": 24.0, "eye_height": 16.0, "bar_width": 12.0, "bar_height": 12.0},
        )
    ]
    assert ranges[0] >= ranges[1] > ranges[2] > 0


def test_links_that_cannot_be_made_are_named_with_their_pins() -> None:
    mechanism = loop()
    settings = settings_for(bar_height=6.5)
    with pytest.raises(DetailError, match=r"L-0000 from pin H-0000 to H-0002: the bar reaches"):
        rank_levels(mechanism, settings, even_levels(mechanism, 6))
