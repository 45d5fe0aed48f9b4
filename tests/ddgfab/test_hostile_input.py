"""K-nets, isothermic and Koebe nets, linkages, curvatures: finite results or an error of ours.

Every argument of a valid call is replaced in turn by numbers that are not finite, zero, huge or
tiny, and by arrays of wrong shapes. What comes back is finite, or a `DdgError` was raised.
"""

from __future__ import annotations

import dataclasses
import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest

from ddgfab import nets
from ddgfab.curvature import (
    MetricJet,
    brioschi,
    cotangent_laplacian,
    gauss_curvature,
    knet_curvature,
    metric_of,
    minimize_area,
    net_curvature,
    skew_curvature,
    steiner_curvatures,
    triangulate,
)
from ddgfab.errors import DdgError
from ddgfab.linkages import Pose, bennett, flex, mobility
from ddgfab.mesh import Floats, Mesh
from ddgfab.nets import knet, koebe, minimal, sisothermic
from ddgfab.nets.koebe import solids as koebe_solids
from ddgfab.surfaces.isothermic import smooth_dual, smooth_isothermic_residuals
from ddgfab.transforms import (
    baecklund,
    baecklund_from,
    baecklund_lattice,
    christoffel,
    christoffel_dual,
    darboux,
    darboux_common,
    darboux_dual,
)

KNET = knet.knet([np.full(4, 0.3), np.full(3, 0.4)], [np.full(3, 0.1), np.full(2, -0.2)], 1.2)
BOX = knet.knet([[0.3, 0.2], [0.4], [0.5]], [[0.1], [], []], [1.2, 0.7])


def isothermic() -> Floats:
    """A plane square grid after an inversion."""
    u, v = np.meshgrid(0.2 * np.arange(-2, 3) + 0.3, 0.2 * np.arange(-2, 2) + 0.2, indexing="ij")
    w = np.stack([u, v], axis=-1)
    square = np.sum(w * w, axis=-1, keepdims=True)
    return np.concatenate([w / square, 0.3 + 0.0 * square], axis=-1)


ISO = isothermic()
FIRST, SECOND = darboux(ISO, 3.0, [0.5, 0.2, 0.9]), darboux(ISO, -2.5, [0.1, 0.9, 0.2])
SOLID = koebe_solids.cube_cells(2)
KOEBE = koebe.koebe(SOLID)
PART = KOEBE.net(np.arange(20, 24))
MINIMAL = minimal.minimal_surface(PART)
CRAB = knet.crab_net(6, 0.5, 1.0, 5)
BENNETT = bennett(100.0, 0.5, beta=1.2)
POSE = BENNETT.pose(1.0)
TRIANGLES = triangulate(MINIMAL.mesh)


def sphere(u: Floats, v: Floats) -> Floats:
    return np.stack([np.cos(v) / np.cosh(u), np.sin(v) / np.cosh(u), np.tanh(u)], axis=-1)


def saddle(u: Any, v: Any) -> Any:
    return np.stack([u, v, u * v], axis=-1)


CALLS: dict[str, tuple[Callable[..., Any], dict[str, Any]]] = {
    "star_flatness": (nets.star_flatness, {"points": KNET.points}),
    "tangent_normals": (nets.tangent_normals, {"points": KNET.points}),
    "lelieuvre": (nets.lelieuvre, {"points": KNET.points}),
    "anet_from_moutard": (nets.anet_from_moutard, {"field": KNET.m, "origin": np.zeros(3)}),
    "moutard_coefficients": (nets.moutard_coefficients, {"field": KNET.m}),
    "evolve_moutard": (
        nets.evolve_moutard,
        {"first": KNET.m[:, 0], "second": KNET.m[0], "coefficients": np.full((4, 3), 0.7)},
    ),
    "star_triangle": (nets.star_triangle, {"a12": 0.3, "a23": 0.5, "a31": -0.7}),
    "evolve_tnet": (
        lambda a, b, c: nets.evolve_tnet({(0, 1): a, (0, 2): b, (1, 2): c}),
        {"a": BOX.m[:, :, 0], "b": BOX.m[:, 0], "c": BOX.m[0]},
    ),
    "spherical_fourth": (
        knet.spherical_fourth,
        {"m": KNET.m[0, 0], "m_i": KNET.m[1, 0], "m_j": KNET.m[0, 1]},
    ),
    "evolve_spherical": (
        lambda a, b: knet.evolve_spherical([a, b]),
        {"a": KNET.m[:, 0], "b": KNET.m[0]},
    ),
    "knet": (
        lambda delta, turn, corner, r, normal, edge: knet.knet(
            [delta, [0.4, 0.3]], [turn, [0.2]], corner, r=r, normal=normal, edge=edge
        ),
        {
            "delta": np.full(4, 0.3),
            "turn": np.full(3, 0.1),
            "corner": 1.2,
            "r": 1.0,
            "normal": np.array([0.0, 0.0, 1.0]),
            "edge": np.array([1.0, 0.0, 0.0]),
        },
    ),
    "skew_parallelogram": (
        knet.skew_parallelogram,
        {
            "x": KNET.points[0, 0],
            "x1": KNET.points[1, 0],
            "x2": KNET.points[0, 1],
            "x12": KNET.points[1, 1],
        },
    ),
    "chi_of_phi": (knet.chi_of_phi, {"phi": np.array([0.3, 1.0]), "k": np.array([0.1, 0.2])}),
    "hirota_residual": (
        knet.hirota_residual,
        {"h": np.sin(np.arange(20.0)).reshape(4, 5), "k": np.full((3, 4), 0.1)},
    ),
    "evolve_hirota": (
        knet.evolve_hirota,
        {
            "first": np.array([0.1, 0.5, 0.3]),
            "second": np.array([0.1, 0.4]),
            "k": np.full((2, 1), 0.1),
        },
    ),
    "recover_knet": (knet.recover_knet, {"source": KNET.points}),
    "dini": (
        knet.dini,
        {"alphas": np.full(4, 0.3), "betas": np.full(3, 0.4), "sigma": 1.2, "t0": 0.7},
    ),
    "pseudosphere": (knet.pseudosphere, {"cells": (4, 3), "alpha": 0.3, "offset": 0.2, "r": 1.0}),
    "breather": (
        knet.breather,
        {"alphas": np.full(4, 0.3), "betas": np.full(3, 0.4), "tau": 0.8},
    ),
    "crab_net": (knet.crab_net, {"n_fold": 6, "delta": 0.5, "theta0": 1.0, "rings": 5, "r": 1.0}),
    "string_forces": (lambda t: knet.string_forces(CRAB, t), {"t": np.ones(4)}),
    "baecklund": (lambda sigma, psi: baecklund(KNET, sigma, psi), {"sigma": 1.2, "psi": 0.4}),
    "baecklund_from": (lambda n: baecklund_from(KNET, n), {"n": np.array([0.6, 0.0, 0.8])}),
    "baecklund_lattice": (
        lambda s, p: baecklund_lattice(KNET, s, p),
        {"s": np.array([1.2, 0.7]), "p": np.array([0.3, 1.0])},
    ),
    "isothermic_point": (
        nets.isothermic_point,
        {"x": ISO[0, 0], "x1": ISO[1, 0], "x2": ISO[0, 1], "alpha1": 1.0, "alpha2": -1.0},
    ),
    "isothermic_residuals": (nets.isothermic_residuals, {"points": ISO}),
    "evolve_isothermic": (
        nets.evolve_isothermic,
        {"first": ISO[:, 0], "second": ISO[0], "alpha1": np.ones(4), "alpha2": -np.ones(3)},
    ),
    "christoffel_dual": (christoffel_dual, {"points": ISO}),
    "integrate": (
        lambda a, b: christoffel.integrate([a, b]),
        {"a": np.diff(ISO, axis=0), "b": np.diff(ISO, axis=1)},
    ),
    "darboux": (darboux, {"points": ISO, "mu": 3.0, "start": np.array([0.5, 0.2, 0.9])}),
    "darboux_common": (
        darboux_common,
        {"points": ISO, "first": FIRST, "second": SECOND, "mu1": 3.0, "mu2": -2.5},
    ),
    "darboux_dual": (
        darboux_dual,
        {"points": ISO, "transform": FIRST, "dual": christoffel_dual(ISO), "mu": 3.0},
    ),
    "koebe_vertex": (
        koebe.koebe_vertex,
        {"centers": np.array([[0.1, 0.2], [0.3, 0.1]]), "radii": np.array([0.1, 0.2])},
    ),
    "enneper": (minimal.enneper, {"cells": (2, 3), "half_step": 0.2}),
    "helicoid": (minimal.helicoid, {"around": 6, "rings": (-1, 2), "columns": 4}),
    "scherk": (minimal.scherk, {"cells": 4, "storeys": 2}),
    "schwarz_p": (minimal.schwarz_p, {"cells": 3}),
    "dual_face": (nets.dual_face, {"points": PART.mesh.vertices[PART.mesh.faces[0]]}),
    "dual": (lambda labels: nets.dual(PART, labels).net, {"labels": MINIMAL.labels}),
    "minimal_surface": (
        lambda angle, labels, scale: minimal.minimal_surface(
            PART, angle=angle, labels=labels, scale=scale
        ),
        {"angle": 0.3, "labels": MINIMAL.labels, "scale": 1.0},
    ),
    "offset": (MINIMAL.offset, {"distance": 0.3}),
    "scaled": (MINIMAL.scaled, {"factor": 2.0}),
    "sisothermic_of": (
        lambda v: nets.SIsothermic.of(MINIMAL.mesh.with_vertices(v)),
        {"v": MINIMAL.mesh.vertices},
    ),
    "sisothermic_integrate": (
        lambda e: sisothermic.integrate(MINIMAL.mesh, e),
        {"e": MINIMAL.mesh.edge_vectors},
    ),
    "turned": (KOEBE.turned, {"rotation": np.eye(3)}),
    "aligned": (KOEBE.aligned, {"vertices": SOLID.vertices}),
    "koebe": (lambda i: koebe.koebe(SOLID, infinity=i), {"i": 3}),
    "piece": (lambda faces: KOEBE.net(faces), {"faces": np.array([0, 1])}),
    "steiner_curvatures": (
        lambda g: steiner_curvatures(MINIMAL.mesh, g),
        {"g": PART.mesh.vertices},
    ),
    "skew_curvature": (skew_curvature, {"points": KNET.points, "normals": KNET.normals}),
    "knet_curvature": (knet_curvature, {"delta1": 0.3, "delta2": np.array([0.4]), "r": 1.0}),
    "cotangent_laplacian": (
        lambda v: cotangent_laplacian(TRIANGLES, v).toarray(),
        {"v": TRIANGLES.vertices},
    ),
    "minimize_area": (
        lambda v: minimize_area(TRIANGLES.with_vertices(v), throw=False),
        {"v": TRIANGLES.vertices},
    ),
    "net_curvature": (
        net_curvature,
        {"points": saddle(*np.mgrid[0:1:6j, 0:1:5j]), "du": 0.1, "dv": 0.1},
    ),
    "gauss_curvature": (
        lambda u, v, step: gauss_curvature(metric_of(saddle), u, v, step),
        {"u": np.array([0.1, 0.2]), "v": 0.3, "step": 0.02},
    ),
    "smooth_dual": (
        lambda u, v, step: smooth_dual(sphere, u, v, step=step),
        {"u": np.linspace(0, 1, 4), "v": np.linspace(0, 1, 3), "step": 1e-3},
    ),
    "smooth_isothermic_residuals": (
        lambda u, v, step: smooth_isothermic_residuals(sphere, u, v, step=step),
        {"u": np.linspace(0, 1, 3), "v": np.linspace(0, 1, 3), "step": 1e-3},
    ),
    "flex": (
        lambda a, b, corner: flex(KNET, [a, b], corner),
        {"a": np.zeros(3), "b": np.zeros(2), "corner": 0.1},
    ),
    "mobility": (
        lambda bars, points, axes: mobility(bars, Pose(points, axes)),
        {"bars": BENNETT.bars, "points": POSE.points, "axes": POSE.axes},
    ),
    "bennett": (bennett, {"a": 100.0, "alpha": 0.5, "beta": 1.2}),
}


def numbers(value: float) -> Iterator[Any]:
    # Sizes stay such that a count of cells among them is refused or small.
    yield from (np.nan, np.inf, -np.inf, 0, -1, 0.5, np.pi)
    if isinstance(value, float):
        yield from (1e6, 1e-6, 1e200, 1e-200)


def arrays(value: Any) -> Iterator[Any]:
    whole = np.asarray(value)
    given = whole.astype(np.float64)
    for place in (0, -1):
        for number in (np.nan, np.inf, 1e200, 1e6):
            changed = given.copy()
            changed.flat[place] = number
            yield changed
    yield from (given * s for s in (1e6, 1e-6, 1e100, 1e200, 1e-100, 1e-200, 0.0))
    yield from (whole[:0], whole[:1], whole.T, whole.reshape(-1), whole[None], whole[..., :-1])
    yield np.concatenate([whole, whole])
    yield np.repeat(whole[:1], len(whole), axis=0)


def hostile(value: Any) -> Iterator[Any]:
    if isinstance(value, np.ndarray):
        yield from arrays(value)
    elif isinstance(value, tuple):
        for i, part in enumerate(value):
            yield from ((*value[:i], other, *value[i + 1 :]) for other in numbers(part))
    else:
        yield from numbers(value)


def all_finite(found: Any) -> bool:
    if isinstance(found, Mesh):
        return bool(np.isfinite(found.vertices).all())
    if dataclasses.is_dataclass(found):
        return all(all_finite(getattr(found, f.name)) for f in dataclasses.fields(found))
    if isinstance(found, dict):
        return all(map(all_finite, found.values()))
    if isinstance(found, (tuple, list)):
        return all(map(all_finite, found))
    if isinstance(found, str):
        return True
    return bool(np.isfinite(found).all())


@pytest.mark.parametrize("name", CALLS)
def test_finite_or_an_error_of_ours(name: str) -> None:
    call, valid = CALLS[name]
    assert all_finite(call(**valid))
    seen: Counter[bool] = Counter()
    for argument, value in valid.items():
        for other in hostile(value):
            try:
                # Overflow on the way to an error is not a harm.
                with warnings.catch_warnings():
                    warnings.simplefilter("ignore")
                    found = call(**{**valid, argument: other})
            except DdgError:
                seen[False] += 1
            else:
                assert all_finite(found), (argument, other)
                seen[True] += 1
    assert seen[False] > 0


def test_a_metric_that_is_not_finite_is_refused() -> None:
    one, zero = np.ones(2), np.zeros(2)
    far = np.array([0.0, np.inf])
    jet = MetricJet(one, zero, one, zero, zero, zero, zero, zero, zero, far, zero, zero)
    with pytest.raises(DdgError, match=r"\(1,\)"):
        brioschi(jet)
