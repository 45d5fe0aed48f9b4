"""Moebius transformations: a group, and what they keep (circles, spheres, angles, cross-ratios)."""

from __future__ import annotations

import numpy as np
import pytest
from net_cases import circular_net, concyclic_defect, skew_net
from scipy.spatial.transform import Rotation

from ddgfab.errors import DegenerateError, InputError
from ddgfab.mesh import Floats, unit
from ddgfab.nets import circularity, vertex_normals
from ddgfab.nets.axes import normals_closure
from ddgfab.transforms import Moebius

RNG = np.random.default_rng(11)
TURN = Rotation.from_rotvec([0.3, -0.8, 0.5]).as_matrix()
MAPS = {
    "similarity": Moebius.similarity(TURN, 1.7, (3.0, -2.0, 1.0)),
    "inversion": Moebius.inversion((-2.0, 0.5, 1.5), 2.5),
    "reflection": Moebius.reflection((1.0, 2.0, 0.0), (1.0, -2.0, 2.0)),
    "general": Moebius.inversion((4.0, 1.0, 2.0), 1.3)
    @ Moebius.similarity(TURN, 0.6)
    @ Moebius.inversion((-2.0, 3.0, 0.5), 2.0),
}
POINTS = RNG.normal(size=(40, 3))


@pytest.fixture(params=sorted(MAPS))
def moebius(request: pytest.FixtureRequest) -> Moebius:
    return MAPS[request.param]


def cross_ratio(a: Floats, b: Floats, c: Floats, d: Floats) -> float:
    """|a - b| |c - d| / (|b - c| |d - a|), the absolute cross-ratio of four points."""
    ab, bc, cd, da = (np.linalg.norm(p - q) for p, q in ((a, b), (b, c), (c, d), (d, a)))
    return float(ab * cd / (bc * da))


def test_composition_and_inverse(moebius: Moebius) -> None:
    for name, other in MAPS.items():
        both = moebius @ other
        assert np.abs(both(POINTS) - moebius(other(POINTS))).max() < 1e-9, name
    assert np.abs(moebius.inverse()(moebius(POINTS)) - POINTS).max() < 1e-9
    assert np.abs((moebius @ moebius.inverse())(POINTS) - POINTS).max() < 1e-9
    assert (moebius @ moebius.inverse()).pole is None


def test_two_inversions_with_one_center_are_a_scaling() -> None:
    """J with radius 2 then 6 about one center: factor (6 / 2)^2."""
    both = Moebius.inversion((1, 1, 1), 6.0) @ Moebius.inversion((1, 1, 1), 2.0)
    assert both.pole is None
    assert np.abs(both(POINTS) - (9 * (POINTS - 1) + 1)).max() < 1e-12
    twice = Moebius.reflection((0, 0, 1), (0, 1, 1)) @ Moebius.reflection((0, 0, 1), (0, 1, 1))
    assert np.abs(twice(POINTS) - POINTS).max() < 1e-14


def test_absolute_cross_ratios_of_any_four_points_are_kept(moebius: Moebius) -> None:
    image = moebius(POINTS)
    for k in range(0, 36, 4):
        before = cross_ratio(*POINTS[k : k + 4])
        assert cross_ratio(*image[k : k + 4]) == pytest.approx(before, rel=1e-10)


def test_angles_are_kept_and_orientation_told_by_the_determinant(moebius: Moebius) -> None:
    """The differential, by central differences, is a rotation or reflection times a factor."""
    step = 1e-5
    for point in POINTS[:5]:
        columns = [
            (moebius(point + step * e) - moebius(point - step * e)) / (2 * step) for e in np.eye(3)
        ]
        jacobian = np.stack(columns, axis=1)
        square = jacobian.T @ jacobian
        factor = np.trace(square) / 3
        assert np.abs(square / factor - np.eye(3)).max() < 1e-6


def test_spheres_go_to_spheres(moebius: Moebius) -> None:
    sphere = np.array([0.5, 0.2, -0.4]) + 0.8 * unit(POINTS)
    image = moebius(sphere)
    # |y|^2 - 2 <y, c> = r^2 - |c|^2 is linear in (c, r^2 - |c|^2).
    rows = np.concatenate([2 * image, np.ones((len(image), 1))], axis=1)
    right = np.sum(image**2, axis=1)
    solution = np.linalg.lstsq(rows, right, rcond=None)[0]
    assert np.abs(rows @ solution - right).max() < 1e-10


def test_circular_nets_stay_circular_with_their_normals(moebius: Moebius) -> None:
    x = circular_net() / 1000.0
    n = vertex_normals(x, (0.1, 0.2, 1.0))
    y = moebius(x)
    assert circularity(y).max() < 1e-11
    assert concyclic_defect(y) < 1e-11
    m = moebius.normals(x, n)
    assert np.abs(np.linalg.norm(m, axis=-1) - 1).max() < 1e-13
    assert np.abs(m - vertex_normals(y, m[0, 0])).max() < 1e-10
    assert normals_closure(y, m) < 1e-11
    # And nets that are not circular do not become so.
    assert circularity(moebius(skew_net() / 1000.0)).max() > 1e-3


def test_mistakes_are_refused() -> None:
    with pytest.raises(DegenerateError, match=r"point \(1,\)"):
        MAPS["inversion"]([[0.0, 0, 0], [-2.0, 0.5, 1.5]])
    with pytest.raises(InputError, match="orthogonal"):
        Moebius.similarity(2 * np.eye(3))
    with pytest.raises(InputError, match="scale -1"):
        Moebius.similarity(scale=-1)
    with pytest.raises(InputError, match="radius 0"):
        Moebius.inversion((0, 0, 0), 0.0)
    with pytest.raises(InputError, match="needs a length"):
        Moebius.reflection((0, 0, 0), (0, 0, 0))
    assert "pole" in repr(MAPS["general"])
    assert "similarity, scale 1.7" in repr(MAPS["similarity"])
