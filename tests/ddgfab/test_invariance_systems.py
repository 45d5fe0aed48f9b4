"""Nets of three directions, T-nets, Koebe polyhedra and axes under similarities and relabelling."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from invariance_cases import CIRCULAR, CORNERS, IDENTITY, KPOINTS, MESHES, NEAR, PLANES, relabelled
from koebe_cases import SOLIDS
from net_cases import koebe_net, planar_net
from similarity_cases import SIMILARITIES, TURN, Similarity

from ddgfab import nets
from ddgfab.grid import grid_mesh
from ddgfab.mesh import Floats, Mesh
from ddgfab.nets import circular_to_conical
from ddgfab.nets.koebe import koebe
from ddgfab.support.asymptotic import surface_normals
from ddgfab.support.edge import edge_axes
from ddgfab.support.even import even_lean
from ddgfab.support.exact import cone_axes, reflected_axes, smoothest_normals
from ddgfab.support.parallel import parallel_axes
from ddgfab.support.triangles import central


def moutard_system() -> Any:
    """A T-net of three directions: mean values with coefficients of the star-triangle map."""
    lines = [
        np.array([[1, 0.1, 0.2], [1.1, 0.9, 0.1], [0.4, 1.2, 0.3]]),
        np.array([[1, 0.1, 0.2], [0.9, 0.2, 1.1], [0.2, 0.1, 1.3]]),
        np.array([[1, 0.1, 0.2], [0.3, 0.8, 0.9], [-0.4, 0.9, 0.8]]),
    ]
    values = {(0, 1): 0.6, (0, 2): -0.7, (1, 2): 0.8}
    return {(k, m): nets.evolve_moutard(lines[k], lines[m], a) for (k, m), a in values.items()}


FIELDS = moutard_system()
TNET = nets.evolve_tnet(FIELDS, verify=True)


LINEAR = [at for at in SIMILARITIES if not at.shift.any()] + [
    Similarity("turn and mirror", 3.0, TURN @ np.diag([1.0, -1.0, 1.0]), np.zeros(3))
]
"""T-nets are fields of vectors: the equation holds under linear maps, not under shifts."""

FIELD_MAKERS: dict[str, Callable[[Similarity], Any]] = {
    "evolve_moutard": lambda at: nets.evolve_moutard(
        at.vectors(FIELDS[0, 1][:, 0]), at.vectors(FIELDS[0, 1][0]), 0.6
    ),
    "evolve_tnet": lambda at: nets.evolve_tnet({k: at.vectors(f) for k, f in FIELDS.items()}),
    "moutard_cube": lambda at: nets.moutard_cube(*(at.vectors(TNET[c]) for c in CORNERS)),
}


@pytest.mark.parametrize("at", LINEAR, ids=lambda at: at.name)
@pytest.mark.parametrize("name", FIELD_MAKERS)
def test_fields_commute_with_linear_similarities(name: str, at: Similarity) -> None:
    plain, found = FIELD_MAKERS[name](IDENTITY), FIELD_MAKERS[name](at)
    assert np.abs(found - at.vectors(plain)).max() < 1e-11 * at.scale * np.abs(plain).max()
    points = nets.anet_from_moutard(found) if name != "moutard_cube" else None
    if points is not None:  # areas: x goes with the square, and turns over in a reflection
        side = -1.0 if at.mirrors else 1.0
        wanted = side * at.vectors(nets.anet_from_moutard(plain), 2)
        assert np.abs(points - wanted).max() < 1e-10 * max(np.abs(wanted).max(), 1e-300)


@pytest.mark.parametrize("order", [(1, 0, 2), (2, 1, 0), (1, 2, 0)])
def test_nets_of_three_directions_do_not_depend_on_their_order(order: tuple[int, ...]) -> None:
    place = {axis: new for new, axis in enumerate(order)}

    def turned(surfaces: Any) -> dict[tuple[int, int], Floats]:
        out = {}
        for (k, m), part in surfaces.items():
            a, b = place[k], place[m]
            out[min(a, b), max(a, b)] = part if a < b else part.swapaxes(0, 1)
        return out

    for make, surfaces in ((nets.evolve_nd, PLANES), (nets.evolve_tnet, FIELDS)):
        plain, found = make(surfaces), make(turned(surfaces))
        assert np.abs(found - plain.transpose(*order, 3)).max() < 1e-10 * np.abs(plain).max()


def test_lelieuvre_fields_under_similarities() -> None:
    for at in NEAR:
        field, found = nets.lelieuvre(KPOINTS), nets.lelieuvre(at(KPOINTS), tolerance=1e-6)
        # |L|^2 has the size of an edge: the field goes with the root of the scale, and the
        # length at the first vertex, which is given, shares it out between even and odd vertices.
        size = np.linalg.norm(field, axis=-1, keepdims=True)
        other = np.linalg.norm(found, axis=-1, keepdims=True)
        lines = at.vectors(field / size, 0)
        assert np.abs(np.linalg.norm(np.cross(lines, found / other), axis=-1)).max() < 1e-6
        back = nets.anet_from_moutard(found, at(KPOINTS[0, 0]), tolerance=1e-6)
        assert np.abs(back - at(KPOINTS)).max() < 1e-6 * at.scale


@pytest.mark.parametrize("name", ["icosahedron", "pillow", "polyhedron"])
def test_koebe_polyhedra_under_relabelling_and_reflection(name: str) -> None:
    """Unique up to rotations and reflections: all distances between vertices are the same."""
    solid = SOLIDS[name]

    def distances(mesh: Mesh) -> Floats:
        x = mesh.vertices
        return np.asarray(np.linalg.norm(x[:, None] - x[None], axis=-1))

    plain = koebe(solid)
    other, vertices, _ = relabelled(solid)
    found = koebe(other)
    wanted = distances(plain.mesh)[np.ix_(vertices, vertices)]
    assert np.abs(distances(found.mesh) - wanted).max() < 1e-8 * wanted.max()
    for at in NEAR:  # of a mesh the faces alone count, and their sense
        image = koebe(at.mesh(solid))
        assert np.abs(distances(image.mesh) - distances(plain.mesh)).max() < 1e-8 * wanted.max()
        turned = image.aligned(at.vectors(solid.vertices, 0))
        wanted_points = at.vectors(plain.aligned(solid.vertices).mesh.vertices, 0)
        assert np.abs(turned.mesh.vertices - wanted_points).max() < 1e-6


AXES_MAKERS: dict[str, tuple[Mesh, Callable[[Mesh], Any]]] = {
    "reflected_axes": (MESHES["circular"], reflected_axes),
    "smoothest_normals": (MESHES["circular"], smoothest_normals),
    "cone_axes": (MESHES["conical"], cone_axes),
    "edge_axes": (grid_mesh(koebe_net()), lambda mesh: edge_axes(mesh, 1e-6)),
    "parallel_axes": (grid_mesh(planar_net() / 1000.0), parallel_axes),
    "surface_normals": (MESHES["K-net"], surface_normals),
    "central": (MESHES["skew"], lambda mesh: central(mesh).axes),
    "even_lean": (MESHES["skew"], lambda mesh: even_lean(mesh).axes),
}


@pytest.mark.parametrize("name", AXES_MAKERS)
def test_constructions_of_axes_under_similarities_and_relabelling(name: str) -> None:
    mesh, make = AXES_MAKERS[name]
    plain = make(mesh)
    for at in NEAR:
        found = make(at.mesh(mesh))
        error = np.abs(found - at.vectors(plain, 0)).max()
        assert error < max(1e-6, 1e5 * at.rounding), (at.name, error)
    other, vertices, _ = relabelled(mesh)
    assert np.abs(make(other) - plain[vertices]).max() < 1e-6


@pytest.mark.parametrize("at", NEAR, ids=lambda at: at.name)
def test_axes_of_circles_and_cones_under_similarities(at: Similarity) -> None:
    limit = max(1e-8, 1e5 * at.rounding)
    side = -1.0 if at.mirrors else 1.0  # normals by the vector product turn over
    centers, directions = nets.circle_axes(CIRCULAR)
    moved, turned = nets.circle_axes(at(CIRCULAR))
    assert np.abs(moved - at(centers)).max() < limit * at.scale * 10
    assert np.abs(turned - side * at.vectors(directions, 0)).max() < limit
    meet, infinite = nets.axis_intersections(centers, directions)
    there, away = nets.axis_intersections(moved, turned)
    assert np.array_equal(infinite, away)
    size = np.abs(meet - centers[:, :-1]).max()
    assert np.abs(there - at(meet)).max() < 100 * limit * at.scale * size
    normals = nets.vertex_normals(CIRCULAR, [0.1, 0.2, 1.0])
    found = nets.vertex_normals(at(CIRCULAR), at.vectors(np.array([0.1, 0.2, 1.0]), 0))
    assert np.abs(found - at.vectors(normals, 0)).max() < limit
    assert nets.normals_closure(at(CIRCULAR), found) < limit
    conical = circular_to_conical(CIRCULAR)
    cones = nets.cone_offsets(conical)
    there = nets.cone_offsets(at(conical))
    assert np.abs(there - side * at.vectors(cones, 0)).max() < limit
    best = nets.best_normal(CIRCULAR)
    assert np.abs(nets.best_normal(at(CIRCULAR)) - side * at.vectors(best, 0)).max() < limit
