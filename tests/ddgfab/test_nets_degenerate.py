"""Whatever comes in, nets and their measures give finite numbers or an error: never a NaN."""

from __future__ import annotations

import warnings
from collections import Counter
from collections.abc import Callable

import numpy as np
import pytest

from ddgfab.errors import DegenerateError
from ddgfab.mesh import Floats
from ddgfab.nets import axes, circular, conjugate, crossratio, cubes, miquel

Values = Floats | tuple[Floats, ...]
RNG = np.random.default_rng


def lattice_points(rng: np.random.Generator, *shape: int) -> Floats:
    """Points with small whole coordinates, often coinciding or on a line; sometimes far scales."""
    x = rng.integers(-2, 3, size=(*shape, 3)).astype(np.float64)
    if rng.random() < 0.2:
        x *= 10.0 ** rng.choice([-30, -8, 0, 8, 30], size=(*shape, 1))
    return x


def lines(rng: np.random.Generator) -> tuple[Floats, Floats]:
    first, second = lattice_points(rng, 4), lattice_points(rng, 3)
    second[0] = first[0]
    return first, second


def pick(rng: np.random.Generator, *values: float, shape: tuple[int, ...] = (3, 2)) -> Floats:
    return rng.choice(values, size=shape)


TASKS: dict[str, Callable[[np.random.Generator], Values]] = {
    "planarity": lambda g: conjugate.planarity(lattice_points(g, 3, 3)),
    "planarity_flagged": lambda g: conjugate.planarity_flagged(
        lattice_points(g, 3, 3) * g.integers(0, 2)
    ),
    "coefficients": lambda g: conjugate.coefficients(lattice_points(g, 3, 2)),
    "evolve_conjugate": lambda g: conjugate.evolve_conjugate(
        *lines(g), pick(g, -1, 1, 0.5, 0, 1e30), 0.3
    ),
    "circularity": lambda g: circular.circularity(lattice_points(g, 3, 2)),
    "interior_angles": lambda g: circular.interior_angles(lattice_points(g, 3, 2)),
    "angle_sum_defect": lambda g: circular.angle_sum_defect(lattice_points(g, 3, 3)),
    "evolve_by_angles": lambda g: circular.evolve_by_angles(
        *lines(g), pick(g, 0, np.pi / 4, np.pi / 2, 1.3, 2)
    ),
    "evolve_by_cross_ratio": lambda g: circular.evolve_by_cross_ratio(
        *lines(g), pick(g, -1, -2, 3, -0.5, 1, 0, 1e30) if g.random() < 0.3 else -1.0
    ),
    "cross_ratios": lambda g: crossratio.cross_ratios(lattice_points(g, 3, 3)),
    "circle_axes": lambda g: axes.circle_axes(lattice_points(g, 3, 2)),
    "axis_intersections": lambda g: axes.axis_intersections(
        *axes.circle_axes(lattice_points(g, 2, 3))
    )[0],
    "vertex_normals": lambda g: axes.vertex_normals(lattice_points(g, 5, 5), [1, 2, 2]),
    "phi": lambda g: cubes.phi(pick(g, -1, -0.5, 1, 0.5, 0, 0.2, -0.3, shape=(3, 3))),
    "phi_inverse": lambda g: cubes.phi_inverse(pick(g, -1, -0.5, 0.5, 0, 0.2, shape=(3, 3))),
    "miquel_point": lambda g: miquel.miquel_point(*quads(g)),
    "sphere_defect": lambda g: miquel.sphere_defect(lattice_points(g, 2, 2, 2)),
}


def quads(rng: np.random.Generator) -> list[Floats]:
    x, x1, x2, x3 = (lattice_points(rng) for _ in range(4))
    t = rng.choice([0.5, 0.3, -1.0, 0.0], size=3)
    fourth = circular.fourth_by_t
    return [
        x,
        x1,
        x2,
        x3,
        fourth(x, x1, x2, t[0]),
        fourth(x, x1, x3, t[1]),
        fourth(x, x2, x3, t[2]),
    ]


@pytest.mark.parametrize("name", TASKS)
def test_finite_numbers_or_an_error(name: str) -> None:
    seen: Counter[bool] = Counter()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for seed in range(150):
            try:
                values = TASKS[name](RNG(seed))
            except DegenerateError:
                seen[False] += 1
                continue
            for array in values if isinstance(values, tuple) else (values,):
                assert np.isfinite(array).all(), seed
            seen[True] += 1
    assert min(seen[True], seen[False]) > 0  # both ways were taken
