"""Measures, goals, node axes and evolutions under motions, scalings, reflections and relabelling.

The transforms have the same test in test_transforms_similarity.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from invariance_cases import (
    CATENOID,
    CIRCULAR,
    CORNERS,
    FIRST,
    IDENTITY,
    KPOINTS,
    MESHES,
    NEAR,
    PAIRS,
    PLANAR,
    PLANES,
    QUAD,
    SECOND,
    SYSTEM,
    THREE,
    relabelled,
)
from net_cases import catenoid_net, koebe_net, planar_net, skew_net
from similarity_cases import SIMILARITIES, Similarity

from ddgfab import measures, nets
from ddgfab.errors import DdgError
from ddgfab.grid import grid_mesh
from ddgfab.mesh import Floats, Mesh, unit
from ddgfab.nets.knet import skew_parallelogram
from ddgfab.nets.minimal import minimal_surface
from ddgfab.nets.sisothermic import SIsothermic
from ddgfab.support import support_structure
from ddgfab.transforms import christoffel_dual, gauss_image, invert, mesh_curvatures

# --- measures ------------------------------------------------------------------------------------
AXES = "axes"
MEASURES: dict[str, tuple[int, str, tuple[str, ...]]] = {
    # name: power of the scale, element, further arguments
    "planarity": (1, "face", ()),
    "planarity_percent": (0, "face", ()),
    "circular_defect": (0, "face", ()),
    "chebyshev_defect": (0, "face", ()),
    "oriented_areas": (2, "face", ()),
    "mixed_areas": (2, "face", ("vertices", "vertices")),
    "conical_defect": (0, "vertex", ()),
    "star_defect": (0, "vertex", ()),
    "lean": (0, "vertex", (AXES,)),
    "torsion": (0, "edge", (AXES,)),
    "dihedral_angles": (0, "edge", ()),
    "interior_angles": (0, "corner", ()),
    "isothermic_defect": (0, "vertex", ()),
    "translation_defect": (0, "face", ()),
}
TEXTS = {"inspect", "kind_names", "kind_words", "not_a_disk"}


def axes_of(mesh: Mesh, at: Similarity) -> Floats:
    """Axes that go with the mesh: fixed parts of normals and of a direction."""
    return unit(mesh.vertex_normals + at.vectors(np.array([0.3, -0.2, 0.1]), 0))


def measured(name: str, mesh: Mesh, at: Similarity) -> Floats:
    given = {"vertices": mesh.vertices, AXES: axes_of(mesh, at)}
    return np.asarray(getattr(measures, name)(mesh, *(given[a] for a in MEASURES[name][2])))


def ids(mesh: Mesh, element: str, vertices: Any) -> list[tuple[int, ...]]:
    """Names of the elements that do not depend on their order, from names of the vertices."""
    name = np.asarray(vertices)
    if element == "vertex":
        return [(int(v),) for v in name]
    if element == "edge":
        return [tuple(sorted(int(v) for v in name[edge])) for edge in mesh.edges]
    faces = [tuple(sorted(int(v) for v in name[face])) for face in mesh.faces]
    if element == "face":
        return faces
    return [(int(name[v]), *faces[f]) for v, f in zip(mesh.corners, mesh.corner_face, strict=True)]


def test_every_measure_is_looked_at() -> None:
    functions = {n for n in measures.__all__ if n not in ("Measure", "Report")}
    assert functions == set(MEASURES) | TEXTS


@pytest.mark.parametrize("at", SIMILARITIES, ids=lambda at: at.name)
@pytest.mark.parametrize("shape", MESHES)
def test_measures_under_similarities(shape: str, at: Similarity) -> None:
    mesh = MESHES[shape]
    image = at.mesh(mesh)
    here = np.arange(mesh.n_vertices)
    for name, (power, element, _) in MEASURES.items():
        plain, found = measured(name, mesh, IDENTITY), measured(name, image, at)
        wanted = dict(zip(ids(mesh, element, here), plain, strict=True))
        got = dict(zip(ids(image, element, here), found / at.scale**power, strict=True))
        assert got.keys() == wanted.keys()
        values = np.array([[wanted[k], got[k]] for k in wanted])
        # Angles of nearly straight or flat things react with the root of rounding at worst.
        limit = max(1e-9, 1e5 * at.rounding, 30.0 * np.sqrt(at.rounding) * (power == 0))
        limit *= max(1.0, float(np.abs(values[:, 0]).max()))
        assert np.abs(values[:, 0] - values[:, 1]).max() < limit, name
    assert measures.kind_names(image) == measures.kind_names(mesh)
    assert measures.not_a_disk(image) == measures.not_a_disk(mesh)


@pytest.mark.parametrize("shape", MESHES)
def test_measures_under_relabelling(shape: str) -> None:
    mesh = MESHES[shape]
    other, vertices, _ = relabelled(mesh)
    for name, (_, element, _) in MEASURES.items():
        plain, found = (measured(name, m, IDENTITY) for m in (mesh, other))
        wanted = dict(zip(ids(mesh, element, np.arange(mesh.n_vertices)), plain, strict=True))
        got = dict(zip(ids(other, element, vertices), found, strict=True))
        values = np.array([[wanted[k], got[k]] for k in wanted])
        assert np.abs(values[:, 0] - values[:, 1]).max() < 1e-7, name
    assert measures.kind_names(other) == measures.kind_names(mesh)
    assert measures.inspect(other).kinds == measures.inspect(mesh).kinds


def test_vertex_normals_are_weighted_by_area() -> None:
    """A vertex between a large and a small face: by area the large one counts as its area does."""
    for width in (0.1, 1.0, 7.0):
        corner = np.array([[0, 0, 0], [width, 0, 0], [0, 1, 0], [0, 0, 2.0]])
        mesh = Mesh.build(corner, [[0, 1, 2], [0, 2, 3], [0, 3, 1]])
        wanted = np.array([2.0, 2.0 * width, width])  # areas of the three faces, times two
        np.testing.assert_allclose(mesh.vertex_normals[0], wanted / np.linalg.norm(wanted))
    for shape in MESHES.values():  # second route: triangles of every face from its middle
        total = np.zeros_like(shape.vertices)
        for face in shape.faces:
            p = shape.vertices[face]
            area = sum(np.cross(p[i - 1] - p.mean(0), p[i] - p.mean(0)) for i in range(len(p)))
            total[face] += area
        np.testing.assert_allclose(shape.vertex_normals, unit(total), atol=1e-12)


# --- evolutions and constructions ----------------------------------------------------------------
Made = Callable[[Similarity], Any]
POINTS: dict[str, Made] = {
    "evolve_by_angles": lambda at: nets.evolve_by_angles(at(FIRST), at(SECOND), 1.5),
    "evolve_by_cross_ratio": lambda at: nets.evolve_by_cross_ratio(
        at(FIRST[:4]), at(SECOND[:4]), -1.2
    ),
    "evolve_conjugate": lambda at: nets.evolve_conjugate(at(FIRST), at(SECOND), 0.05, -0.03),
    "evolve_circular_by_angles": lambda at: nets.evolve_circular_by_angles(
        [at(line) for line in THREE], dict.fromkeys(PAIRS, 1.4)
    ),
    "evolve_isothermic": lambda at: nets.evolve_isothermic(
        at(CATENOID[:4, 0]), at(CATENOID[0, :4]), 1.0, -1.0
    ),
    "evolve_isothermic_nd": lambda at: nets.evolve_isothermic_nd(
        [at(line) for line in THREE], [1.0, -1.0, 2.5]
    ),
    "evolve_3d": lambda at: nets.evolve_3d(
        *(at(PLANES[pair]) for pair in PAIRS), tolerance=max(1e-8, 1e4 * at.rounding)
    ),
    "evolve_nd": lambda at: nets.evolve_nd(
        {pair: at(part) for pair, part in PLANES.items()}, tolerance=max(1e-8, 1e4 * at.rounding)
    ),
    "evolve_circular": lambda at: nets.evolve_circular(
        {pair: at(part) for pair, part in PLANES.items()}, tolerance=max(1e-8, 1e4 * at.rounding)
    ),
    "cube_point": lambda at: nets.cube_point(
        *(at(SYSTEM[c]) for c in CORNERS), tolerance=max(1e-8, 1e4 * at.rounding)
    ),
    "fourth_by_t": lambda at: nets.fourth_by_t(*map(at, QUAD), 0.4),
    "fourth_by_angle": lambda at: nets.fourth_by_angle(*map(at, QUAD), 1.2),
    "isothermic_point": lambda at: nets.isothermic_point(*map(at, QUAD), 1.0, -1.5),
    "circumcircle": lambda at: nets.circumcircle(*map(at, QUAD))[0],
    "circle_axes": lambda at: nets.circle_axes(at(CIRCULAR))[0],
    "skew_parallelogram": lambda at: (
        skew_parallelogram(
            *(at(x) for x in (KPOINTS[0, 0], KPOINTS[1, 0], KPOINTS[0, 1], KPOINTS[1, 1])),
            tolerance=max(1e-8, 10 * at.rounding),
        ).center
    ),
}


@pytest.mark.parametrize("at", SIMILARITIES, ids=lambda at: at.name)
@pytest.mark.parametrize("name", POINTS)
def test_constructions_commute_with_similarities(name: str, at: Similarity) -> None:
    plain, found = POINTS[name](IDENTITY), POINTS[name](at)
    size = max(1.0, float(np.abs(plain).max()))
    assert np.abs(found - at(plain)).max() < 1e6 * at.rounding * at.scale * size


VALUES: dict[str, Callable[[Floats], Any]] = {
    "planarity": nets.planarity,
    "circularity": nets.circularity,
    "cross_ratios": nets.cross_ratios,
    "interior_angles": nets.interior_angles,
    "angle_sum_defect": nets.angle_sum_defect,
    "coefficients": lambda x: np.stack(nets.coefficients(x)),
    "star_flatness": nets.star_flatness,
    "angle_balance": nets.angle_balance,
    "moutard gap": lambda x: nets.moutard_coefficients(np.diff(x, axis=0))[1],
}
SIGNED = {"planarity"}
"""A reflection changes the sign of what is measured along a normal."""


@pytest.mark.parametrize("at", SIMILARITIES, ids=lambda at: at.name)
@pytest.mark.parametrize("name", VALUES)
def test_values_of_nets_do_not_change(name: str, at: Similarity) -> None:
    for x in (skew_net() / 1000.0, PLANAR, CIRCULAR):
        plain, found = (np.asarray(VALUES[name](y)) for y in (x, at(x)))
        if name in SIGNED and at.mirrors:
            found = -found
        size = max(1.0, float(np.abs(plain).max()))
        assert np.abs(found - plain).max() < max(1e6 * at.rounding, 1e-9) * size


@pytest.mark.parametrize("at", NEAR, ids=lambda at: at.name)
def test_gauss_images_turn_with_the_mesh(at: Similarity) -> None:
    for shape in ("circular", "conical"):
        mesh = MESHES[shape]
        plain, found = gauss_image(mesh), gauss_image(at.mesh(mesh), tolerance=1e-4)
        assert np.abs(found - at.vectors(plain, 0)).max() < max(1e-6, 1e6 * at.rounding)


# --- kinds that inspect tells, and files of six digits -------------------------------------------
def six_digits(mesh: Mesh) -> Mesh:
    """The mesh as most files carry it."""
    size = float(np.abs(mesh.vertices).max())
    return mesh.with_vertices(np.round(mesh.vertices / size, 6) * size)


@pytest.mark.parametrize(
    ("mesh", "names", "not_names"),
    [
        (grid_mesh(koebe_net()), {"Koebe", "edge-offset", "isothermic"}, {"translation"}),
        (grid_mesh(catenoid_net()), {"edge-offset", "isothermic"}, {"Koebe", "translation"}),
        (MESHES["translation"], {"translation"}, {"Koebe", "edge-offset"}),
        (MESHES["circular"], {"circular"}, {"Koebe", "edge-offset", "translation"}),
        (grid_mesh(planar_net()), {"planar"}, {"edge-offset", "isothermic", "translation"}),
        (MESHES["K-net"], {"K-net"}, {"edge-offset", "isothermic", "translation"}),
    ],
    ids=["Koebe", "catenoid", "translation", "circular", "planar", "K-net"],
)
def test_kinds_of_nets(mesh: Mesh, names: set[str], not_names: set[str]) -> None:
    for given in (mesh, six_digits(mesh), relabelled(mesh)[0]):
        found = set(measures.kind_names(given))
        assert names <= found
        assert not not_names & found
    words = measures.inspect(mesh).kind
    assert ("Koebe net (edges touch" in words) == ("Koebe" in names)
    assert ("parallel to a Koebe net" in words) == (names >= {"edge-offset"} > names & {"Koebe"})
    assert ("; isothermic" in words) == ("isothermic" in measures.kind_names(mesh))


def test_an_isothermic_net_is_told_by_its_labels() -> None:
    """Second route: rank one of the cross-ratios over the whole grid."""
    shrunk = invert(catenoid_net(), (0.3, 4.0, 0.2), 3.0)
    assert nets.cross_ratio_labels(shrunk)[1] < 1e-12
    assert measures.isothermic_defect(grid_mesh(shrunk)).max() < 1e-10
    assert nets.cross_ratio_labels(CIRCULAR)[1] > 1e-3
    assert measures.isothermic_defect(grid_mesh(CIRCULAR)).max() > 1e-3


def test_a_tolerance_lets_six_digits_pass() -> None:
    koebe = six_digits(grid_mesh(koebe_net()))
    gauss = SIsothermic.of(koebe, 1e-4)
    with pytest.raises(DdgError, match="misses the unit sphere"):
        minimal_surface(gauss)
    exact = minimal_surface(SIsothermic.of(grid_mesh(koebe_net()), 1e-6), tolerance=1e-6)
    found = minimal_surface(gauss, tolerance=1e-4)
    assert np.abs(found.mesh.vertices - exact.mesh.vertices).max() < 1e-3
    catenoid = six_digits(grid_mesh(catenoid_net()))
    with pytest.raises(DdgError):
        christoffel_dual(catenoid.vertices.reshape(catenoid_net().shape))
    christoffel_dual(catenoid.vertices.reshape(catenoid_net().shape), tolerance=1e-4)
    corners = [np.round(KPOINTS[at], 6) for at in ((0, 0), (1, 0), (0, 1), (1, 1))]
    with pytest.raises(DdgError, match="no skew parallelogram"):
        skew_parallelogram(*corners)
    assert not skew_parallelogram(*corners, tolerance=1e-5).planar
    assert support_structure(koebe, "edge").torsion_free
    assert mesh_curvatures(catenoid, "edge", 1e-4).mean == pytest.approx(0.0, abs=1e-3)
