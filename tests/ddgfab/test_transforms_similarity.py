"""Every transform commutes with motions, reflections and scalings, at all scales and places."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import pytest
from net_cases import catenoid_net, circular_net, koebe_net, planar_net
from similarity_cases import SIMILARITIES, Similarity

from ddgfab.forms.rotational import rotational_net
from ddgfab.grid import grid_mesh
from ddgfab.mesh import Floats, Mesh, extent
from ddgfab.nets import (
    circular_to_conical,
    circularity,
    common_transform,
    conical_to_circular,
    dual,
    vertex_normals,
)
from ddgfab.nets.sisothermic import SIsothermic
from ddgfab.offsets import edge_offset, face_offset, vertex_offset
from ddgfab.support.propagate import propagate_axes
from ddgfab.transforms import (
    Moebius,
    christoffel_dual,
    combescure,
    darboux,
    darboux_common,
    darboux_dual,
    invert,
    invert_normals,
    nearest_parallel,
)

CIRCULAR = circular_net() / 1000.0
CONICAL = circular_to_conical(CIRCULAR)
PLANAR = planar_net() / 1000.0
ISOTHERMIC = catenoid_net()
CENTER = np.array([0.3, -0.2, 3.0])
NEAR = CENTER + np.array([0.0, 1e-6, 0.0])


class Case(NamedTuple):
    """A transform: its net, the function of the net's image and the similarity, and what it gives.

    power : 1 for points, 0 for unit vectors, -1 for vectors of a reciprocal length
    points : whether the results are points, which the shift moves too
    loss : rounding errors that the transform may add to those of its coordinates, as a factor
    """

    net: Floats
    apply: Callable[[Floats, Similarity], Floats]
    power: int = 1
    points: bool = True
    loss: float = 100.0


def on_mesh(function: Callable[[Mesh, Similarity], Mesh]) -> Callable[[Floats, Similarity], Floats]:
    """A transform of meshes as one of nets, with the same side outside in a reflection."""

    def apply(x: Floats, at: Similarity) -> Floats:
        mesh = grid_mesh(x)
        if at.mirrors:
            mesh = Mesh.build(mesh.vertices, [face[::-1] for face in mesh.faces])
        return function(mesh, at).vertices

    return apply


def inversion(at: Similarity, center: Floats, radius: float) -> Moebius:
    return Moebius.inversion(at(center), radius * at.scale)


def about(at: Similarity, center: Floats) -> Moebius:
    """A rotation about a point far from the origin."""
    axis = at.turn @ [[0, -1.0, 0], [1.0, 0, 0], [0, 0, 1.0]] @ at.turn.T
    p = at(center)
    return Moebius.similarity(axis, 1.7, p) @ Moebius.similarity(shift=-p)


def darboux_of(x: Floats, at: Similarity, mu: float, away: tuple[float, float, float]) -> Floats:
    return darboux(x, mu, x[0, 0] + at.vectors(np.array(away)))


FIRST, SECOND = np.linspace(0.5, 2.0, 5), np.linspace(1.0, -1.5, 4)


def parallel_pair(x: Floats, at: Similarity) -> tuple[Floats, Floats]:
    up, down = at.vectors(np.array([0.1, 0.2, 1.0])), at.vectors(np.array([0.3, -0.1, -0.8]))
    return combescure(x, FIRST, SECOND, x[0, 0] + up), combescure(
        x, SECOND[0] + FIRST, FIRST[:4], x[0, 0] + down
    )


def common_parallel(x: Floats, at: Similarity) -> Floats:
    a, b = parallel_pair(x, at)
    return common_transform(x, a, b, a[0, 0] + b[0, 0] - x[0, 0])


CASES = {
    "inversion": Case(CIRCULAR, lambda x, at: inversion(at, CENTER, 1.3)(x)),
    "invert": Case(CIRCULAR, lambda x, at: invert(x, at(CENTER), 1.3 * at.scale)),
    "normals of an inversion": Case(
        CIRCULAR,
        lambda x, at: inversion(at, CENTER, 1.3).normals(
            x, vertex_normals(x, at.vectors(np.array([0.1, 0.2, 1.0]), 0))
        ),
        0,
        False,
    ),
    "invert_normals": Case(
        CIRCULAR,
        lambda x, at: invert_normals(x, at.vectors(np.ones(3) / np.sqrt(3), 0), at(CENTER)),
        0,
        False,
    ),
    "two inversions": Case(
        CIRCULAR, lambda x, at: (inversion(at, -CENTER, 2.0) @ inversion(at, CENTER, 1.3))(x)
    ),
    "three inversions": Case(
        CIRCULAR,
        lambda x, at: (
            inversion(at, 3.0 * CENTER, 0.9)
            @ inversion(at, -CENTER, 2.0)
            @ inversion(at, CENTER, 1.3)
        )(x),
    ),
    "two inversions of nearly one center": Case(
        CIRCULAR, lambda x, at: (inversion(at, NEAR, 2.0) @ inversion(at, CENTER, 1.3))(x)
    ),
    "back from nearly one center": Case(
        CIRCULAR,
        lambda x, at: (inversion(at, NEAR, 2.0) @ inversion(at, CENTER, 1.3)).inverse()(x),
    ),
    "there and back": Case(
        CIRCULAR,
        lambda x, at: (lambda f: f.inverse()(f(x)))(
            inversion(at, -CENTER, 2.0) @ inversion(at, CENTER, 1.3)
        ),
    ),
    "reflection": Case(
        CIRCULAR,
        lambda x, at: Moebius.reflection(at(CENTER), at.vectors(np.array([1.0, -2.0, 2.0])))(x),
    ),
    "rotation about a point": Case(CIRCULAR, lambda x, at: about(at, CENTER)(x)),
    "rotation after an inversion": Case(
        CIRCULAR, lambda x, at: (about(at, CENTER) @ inversion(at, CENTER, 1.3))(x)
    ),
    "combescure": Case(PLANAR, lambda x, at: combescure(x, FIRST, SECOND)),
    "nearest_parallel": Case(
        PLANAR,
        on_mesh(
            lambda mesh, at: nearest_parallel(
                mesh,
                mesh.vertices
                + at.vectors(np.outer(np.sin(np.arange(mesh.n_vertices)), [1.0, 2.0, 3.0])),
            )
        ),
    ),
    "common_transform": Case(PLANAR, common_parallel, loss=1e3),
    "christoffel_dual": Case(ISOTHERMIC, lambda x, at: christoffel_dual(x), -1, False),
    "darboux": Case(ISOTHERMIC, lambda x, at: darboux_of(x, at, 2.5, (0.3, 0.2, 0.5))),
    "darboux_dual": Case(
        ISOTHERMIC,
        lambda x, at: darboux_dual(
            x, darboux_of(x, at, 2.5, (0.3, 0.2, 0.5)), christoffel_dual(x), 2.5
        ),
        -1,
        False,
    ),
    "darboux_common": Case(
        ISOTHERMIC,
        lambda x, at: darboux_common(
            x,
            darboux_of(x, at, 2.5, (0.3, 0.2, 0.5)),
            darboux_of(x, at, -3.0, (0.3, 0.2, -0.5)),
            2.5,
            -3.0,
        ),
    ),
    "vertex_normals": Case(
        CIRCULAR,
        lambda x, at: vertex_normals(x, at.vectors(np.array([0.1, 0.2, 1.0]))),
        0,
        False,
    ),
    "vertex_offset": Case(CIRCULAR, on_mesh(lambda m, at: vertex_offset(m, 0.1 * at.scale, 1e-6))),
    "face_offset": Case(
        CONICAL, on_mesh(lambda m, at: face_offset(m, 0.1 * at.scale, 1e-6)), loss=1e5
    ),
    "edge_offset": Case(koebe_net(), on_mesh(lambda m, at: edge_offset(m, 0.1 * at.scale, 1e-6))),
    "circular_to_conical": Case(CIRCULAR, lambda x, at: circular_to_conical(x), loss=1e3),
    "conical_to_circular": Case(CONICAL, lambda x, at: conical_to_circular(x), loss=1e3),
    "propagate_axes": Case(
        PLANAR,
        lambda x, at: propagate_axes(
            x, at.vectors(np.array([0.1, 0.2, 1.0])), 0.1 * FIRST, 0.1 * SECOND
        ),
        0,
        False,
    ),
    "s-isothermic dual": Case(
        koebe_net(),
        lambda x, at: dual(SIsothermic.of(grid_mesh(x), 1e-6), tolerance=1e-6).net.mesh.vertices,
        -1,
        False,
        1e3,
    ),
}


@pytest.mark.parametrize("at", SIMILARITIES, ids=lambda at: at.name)
@pytest.mark.parametrize("name", CASES)
def test_transforms_commute_with_similarities(name: str, at: Similarity) -> None:
    case = CASES[name]
    plain = case.apply(case.net, Similarity("identity", 1.0, np.eye(3), np.zeros(3)))
    wanted = at.vectors(plain, case.power) + (at.shift if case.points else 0.0)
    made = case.apply(at(case.net), at)
    size = extent(case.net) if case.points else 1.0
    size = (size if case.power > 0 else extent(plain)) * at.scale**case.power
    assert np.abs(made - wanted).max() <= case.loss * at.rounding * size


def test_inversions_at_building_scale_leave_nets_circular() -> None:
    """A rotational net in millimetres, 10 m wide, whose images once were 1 mm off."""
    z = np.linspace(0.0, 8e3, 9)
    meridian = np.stack([1e4 + 2e3 * np.sin(z / 3e3), z], axis=1)
    x = rotational_net(meridian, np.linspace(0.0, 1.5, 8))
    for size in (1.0, 10.0, 1e5):
        center, radius = size * np.array([3e3, 2e3, 5e4]), size * 2e4
        f = Moebius.inversion(center, radius)
        assert circularity(f(size * x)).max() < 1e-12
        assert np.abs(f(size * x) - invert(size * x, center, radius)).max() < 1e-12 * size * 1e4
