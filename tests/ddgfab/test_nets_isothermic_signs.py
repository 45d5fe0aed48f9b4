"""Isothermic nets whose labels have both signs, and in four directions."""

from __future__ import annotations

import numpy as np
import pytest
from isothermic_cases import EXACT, catenoid, random_lines, same_up_to_translation

from ddgfab.errors import DegenerateError, InputError
from ddgfab.nets import evolve_isothermic_nd, stack_transforms
from ddgfab.nets.isothermic import (
    cross_ratio_labels,
    evolve_isothermic,
    isothermic_point,
    isothermic_residuals,
)
from ddgfab.transforms import christoffel_dual, darboux

# --- labels of both signs ------------------------------------------------------------------------
MIXED = ([1.0, 2.0, -3.0, 1.5], [-1.0, -2.0, 0.7])


def mixed_net(labels: tuple[list[float], ...] = MIXED) -> np.ndarray:
    first, second = random_lines(4, 6)
    lines = first[: len(labels[0]) + 1], second[: len(labels[1]) + 1]
    return evolve_isothermic(*lines, *labels, growth_limit=np.inf)


def gauge(labels: tuple[np.ndarray, ...], wanted: list[list[float]]) -> float:
    """Greatest deviation of labels from those wanted, up to one factor."""
    factor = wanted[0][0] / labels[0][0]
    return max(
        float(np.abs(factor * own / given - 1.0).max())
        for own, given in zip(labels, wanted, strict=True)
    )


@pytest.mark.parametrize("reverse", [(), (0,), (1,), (0, 1)])
@pytest.mark.parametrize("swap", [False, True])
def test_labels_of_both_signs_are_found(reverse: tuple[int, ...], swap: bool) -> None:
    x, wanted = mixed_net(), [list(part) for part in MIXED]
    for axis in reverse:
        x, wanted[axis] = np.flip(x, axis), wanted[axis][::-1]
    if swap:
        x, wanted = np.swapaxes(x, 0, 1), wanted[::-1]
    labels, defect = cross_ratio_labels(x)
    assert defect < 1e-9
    assert gauge(labels, wanted) < 1e-9
    assert np.log(np.abs(labels[0])).sum() == pytest.approx(0.0, abs=1e-9)


def test_duals_and_darboux_transforms_of_mixed_signs() -> None:
    x = mixed_net()
    star = christoffel_dual(x)
    assert gauge(cross_ratio_labels(star)[0], list(MIXED)) < 1e-8
    # The dual of the dual is the net, scaled by the labels' gauge.
    back = christoffel_dual(star, cross_ratio_labels(x)[0])
    assert same_up_to_translation(back, x) < 1e-8
    labels, _ = cross_ratio_labels(x)
    sheets = [x]
    for mu, away in ((2.3, [0.2, 0.1, 0.4]), (-3.4, [0.3, -0.1, 0.3])):
        sheets.append(darboux(sheets[-1], mu, sheets[-1][0, 0] + away))
    z = stack_transforms(sheets)
    assert (
        gauge(cross_ratio_labels(z)[0], [*(part.tolist() for part in labels), [2.3, -3.4]]) < 1e-7
    )
    assert isothermic_residuals(z)["circularity"] < 1e-8


def test_darboux_sequence_of_a_curve() -> None:
    """A strip of two transforms with parameters 2 and -3: signs change across the sequence."""
    x = catenoid(4, 5)
    first = darboux(x, 2.0, x[0, 0] + [0.1, 0.2, 0.3])
    second = darboux(first, -3.0, first[0, 0] + [0.2, -0.1, 0.2])
    rows = np.stack([x[:, 0], first[:, 0], second[:, 0]], axis=1)
    labels, defect = cross_ratio_labels(rows)
    assert defect < EXACT
    assert np.sign(labels[1]).tolist() == [1.0, -1.0]
    assert christoffel_dual(rows).shape == rows.shape


def test_signs_that_no_labels_give_are_refused() -> None:
    """A circular net with one quad of the other sign: no isothermic net."""
    x = catenoid(4, 5)
    x[-1, -1] = isothermic_point(x[-2, -2], x[-1, -2], x[-2, -1], 1.0, 0.4)
    defect = cross_ratio_labels(x)[1]
    assert defect > 1.0
    with pytest.raises(InputError, match="not isothermic"):
        christoffel_dual(x)


def test_evolution_in_four_directions() -> None:
    rng = np.random.default_rng(8)
    labels = [[1.0, -2.0], [-1.5, 0.6], [3.0, 2.2], [-4.0]]
    lines = [
        np.concatenate(
            [np.zeros((1, 3)), np.cumsum(step + 0.2 * rng.normal(size=(len(own), 3)), 0)]
        )
        for own, step in zip(labels, np.eye(4)[:, :3] + 0.3, strict=True)
    ]
    x = evolve_isothermic_nd(lines, labels, growth_limit=np.inf)
    assert x.shape == (3, 3, 3, 2, 3)
    assert max(isothermic_residuals(x).values()) < 1e-9
    assert gauge(cross_ratio_labels(x)[0], labels) < 1e-9
    for k, line in enumerate(lines):
        assert np.abs(np.moveaxis(x, k, 0)[(slice(None), 0, 0, 0)] - line).max() < EXACT
    # Consistency: another order of the directions is the same net.
    order = [2, 0, 3, 1]
    other = evolve_isothermic_nd(
        [lines[k] for k in order], [labels[k] for k in order], growth_limit=np.inf
    )
    assert np.abs(np.transpose(x, (*order, 4)) - other).max() < 1e-9
    # In five dimensions too.
    wide = [np.pad(line, ((0, 0), (0, 2))) + np.arange(len(line))[:, None] * 0.1 for line in lines]
    y = evolve_isothermic_nd(wide, labels, growth_limit=np.inf)
    assert y.shape == (3, 3, 3, 2, 5)
    with pytest.raises(DegenerateError, match="mu = 1 is the label of edge 0 of direction 0"):
        evolve_isothermic_nd(lines[:3], [*labels[:2], [1.0, 2.2]], growth_limit=np.inf)
    with pytest.raises(InputError, match="polyline 2 starts"):
        evolve_isothermic_nd([*lines[:2], lines[2] + 1.0], labels[:3], growth_limit=np.inf)


def test_few_digits_need_a_tolerance() -> None:
    x = np.round(catenoid(), 6)
    with pytest.raises(InputError, match="limit 1e-08"):
        christoffel_dual(x)
    exact = christoffel_dual(catenoid())
    assert same_up_to_translation(christoffel_dual(x, tolerance=1e-4), exact) < 1e-4
    near = darboux(x, 2.5, x[0, 0] + 0.3, tolerance=1e-4)
    assert np.abs(near - darboux(catenoid(), 2.5, catenoid()[0, 0] + 0.3)).max() < 1e-3
