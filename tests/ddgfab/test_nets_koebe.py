"""Koebe polyhedra: invariants, printed numbers, uniqueness, packings, the variational problem."""

from __future__ import annotations

import numpy as np
import pytest
from koebe_cases import SOLIDS, random_hull

from ddgfab.errors import DegenerateError, InputError, MeshError
from ddgfab.mesh import Floats, Mesh, unit
from ddgfab.nets.koebe import koebe
from ddgfab.nets.koebe.centering import boost, centring
from ddgfab.nets.koebe.pattern import CirclePattern
from ddgfab.nets.koebe.polyhedron import KoebePolyhedron
from ddgfab.nets.koebe.solids import cube_cells, dual_solid, prism, triangle_cells


def gram(solid: KoebePolyhedron) -> Floats:
    """Products of vertices: what is left of a polyhedron without its rotation."""
    return np.asarray(solid.mesh.vertices @ solid.mesh.vertices.T)


@pytest.mark.parametrize("name", SOLIDS)
def test_edges_touch_the_sphere_and_circles_pack(name: str) -> None:
    solid = koebe(SOLIDS[name])
    mesh = solid.mesh
    found = solid.residuals()
    for condition in ("tangency", "planarity", "packing", "centring"):
        assert found[condition] < 1e-12, condition
    assert found["interior"] < 0
    assert np.einsum("fx,fx->f", mesh.face_normals, mesh.face_centers).min() > 0  # outside is out
    # |v|^2 - 1 = r_v^2, by the distances of vertices to contacts.
    for k in (0, 1):
        v = mesh.edges[:, k]
        away = np.linalg.norm(mesh.vertices[v] - solid.contacts, axis=1)
        assert np.abs(away - solid.radii[v]).max() < 1e-12
    assert np.abs((mesh.vertices**2).sum(axis=1) - 1 - solid.radii**2).max() < 1e-11
    # Both packings as circles: contacts lie on the circles of both vertices and both faces.
    for circles, ends in (
        (solid.vertex_circles, mesh.edges),
        (solid.face_circles, mesh.edge_faces),
    ):
        for k in (0, 1):
            arm = solid.contacts - circles.centers[ends[:, k]]
            assert np.abs(np.linalg.norm(arm, axis=1) - circles.radii[ends[:, k]]).max() < 1e-12
            assert np.abs(np.einsum("ex,ex->e", arm, circles.normals[ends[:, k]])).max() < 1e-12
    # Faces contain the contact points, so incircles of the s-isothermic net are the same circles.
    own = solid.net().incircles
    assert np.abs(own.centers - solid.face_circles.centers).max() < 1e-11
    assert np.abs(own.radii - solid.face_circles.radii).max() < 1e-11
    spheres = solid.vertex_spheres
    assert np.abs(spheres.centers - mesh.vertices).max() == 0
    assert np.abs(spheres.radii - solid.radii).max() == 0


def test_printed_numbers() -> None:
    """mathematics.md 7.1."""
    assert (
        np.abs(np.linalg.norm(koebe(SOLIDS["tetrahedron"]).mesh.vertices, axis=1) - 3**0.5).max()
        < 1e-14
    )
    assert (
        np.abs(np.linalg.norm(koebe(cube_cells(1)).mesh.vertices, axis=1) - 1.5**0.5).max() < 1e-14
    )
    for sides in (3, 4, 6, 20):
        lengths = koebe(prism(sides)).mesh.edge_lengths
        assert np.abs(lengths - 2 * np.sin(np.pi / sides)).max() < 1e-13
    split = np.linalg.norm(koebe(cube_cells(2)).mesh.vertices, axis=1)
    assert split.min() == pytest.approx(1.0253393527, abs=1e-10)
    assert split.max() == pytest.approx(1 / np.cos(np.pi / 8), abs=1e-13)
    # Platonic: circumradius over midradius of octahedron and icosahedron.
    octahedron = koebe(triangle_cells("octahedron", 1)).mesh.vertices
    assert np.abs(np.linalg.norm(octahedron, axis=1) - 2**0.5).max() < 1e-14
    golden = (1 + 5**0.5) / 2
    icosahedron = koebe(triangle_cells("icosahedron", 1)).mesh.vertices
    wanted = np.sqrt(golden * 5**0.5) / golden
    assert np.abs(np.linalg.norm(icosahedron, axis=1) - wanted).max() < 1e-13


@pytest.mark.parametrize("name", ["cells", "hull", "polyhedron"])
def test_unique_whatever_edge_is_at_infinity_and_however_it_is_numbered(name: str) -> None:
    mesh = SOLIDS[name]
    one = koebe(mesh)
    for edge in (0, mesh.n_edges // 2, mesh.n_edges - 1):
        assert np.abs(gram(koebe(mesh, infinity=edge)) - gram(one)).max() < 1e-10
    order = np.random.default_rng(1).permutation(mesh.n_vertices)
    faces = [np.roll(order[face], k) for k, face in enumerate(mesh.faces)]
    again = gram(koebe(faces))[np.ix_(order, order)]
    assert np.abs(again - gram(one)).max() < 1e-10


@pytest.mark.parametrize("name", ["prism", "hull", "goldberg", "pillow"])
def test_the_dual_polyhedron_has_the_same_contacts(name: str) -> None:
    """Second route: the Koebe polyhedron of the dual graph is the polar one."""
    mesh = SOLIDS[name]
    one, two = koebe(mesh), koebe(dual_solid(mesh))
    poles = one.face_vectors[:, :3] / one.face_vectors[:, 3:]
    assert np.abs(gram(two) - poles @ poles.T).max() < 1e-10


def test_mean_of_vertices_is_not_the_center_in_general() -> None:
    solid = koebe(random_hull(12, 5))
    assert np.linalg.norm(solid.contacts.mean(axis=0)) < 1e-13
    assert np.linalg.norm(solid.mesh.vertices.mean(axis=0)) > 1e-3


def test_aligned_turns_without_a_change_of_shape() -> None:
    rough = SOLIDS["cells"]
    solid = koebe(rough).aligned(rough.vertices)
    assert solid.residuals()["tangency"] < 1e-13
    # Symmetric under the symmetries of the cube, so vertices mirror onto vertices.
    for flip in np.eye(3):
        image = solid.mesh.vertices * (1 - 2 * flip)
        apart = np.linalg.norm(image[:, None] - solid.mesh.vertices[None], axis=2)
        assert apart.min(axis=1).max() < 1e-12
    assert np.abs(solid.face_circles.normals[0] - solid.mesh.face_normals[0]).max() < 1e-11
    with pytest.raises(InputError, match="orthogonal"):
        solid.turned(2 * np.eye(3))
    with pytest.raises(InputError, match="shape"):
        solid.aligned(rough.vertices[1:])


# --- the variational problem -------------------------------------------------------------------
def test_gradient_and_hessian_are_those_of_the_functional() -> None:
    mesh = SOLIDS["polyhedron"]
    pattern = CirclePattern(mesh, 5)
    rng = np.random.default_rng(4)
    rho = 0.3 * rng.normal(size=pattern.count)
    step = 1e-5
    slope, matrix = pattern.gradient(rho), pattern.hessian(rho).toarray()
    assert np.abs(slope[pattern.lines]).max() == 0
    for _ in range(4):
        way = np.where(pattern.lines, 0.0, rng.normal(size=pattern.count))
        plus, minus = rho + step * way, rho - step * way
        rise = (pattern.functional(plus) - pattern.functional(minus)) / (2 * step)
        assert rise == pytest.approx(slope @ way, rel=1e-8)
        turn = (pattern.gradient(plus) - pattern.gradient(minus)) / (2 * step)
        assert np.abs(turn - matrix @ way).max() < 1e-8
    # Convex: a Laplacian, whose only null vectors are the constants and the lines.
    free = np.flatnonzero(~pattern.lines)
    values = np.linalg.eigvalsh(matrix[np.ix_(free, free)])
    assert abs(values[0]) < 1e-12
    assert values[1] > 1e-3
    assert np.abs(matrix.sum(axis=0)).max() < 1e-13
    # Scaling all circles changes nothing: the angles are sums to the right total.
    assert abs(slope.sum()) < 1e-10


def test_newton_takes_few_steps_and_ends_at_rounding() -> None:
    for mesh in SOLIDS.values():
        history = koebe(mesh).history
        assert len(history) < 12
        assert history[-1] < 1e-11
    wide = koebe(prism(400))  # neighbours of very different size
    assert wide.residuals()["tangency"] < 1e-12


def test_boosts_are_lorentz_transformations_that_center() -> None:
    rng = np.random.default_rng(2)
    t = unit(rng.normal(size=(50, 3)) + np.array([2.0, 0.0, 1.0]))
    cone = np.concatenate([t, np.ones((50, 1))], axis=1) * rng.uniform(0.5, 2.0, (50, 1))
    metric = np.diag([1.0, 1.0, 1.0, -1.0])
    matrix, left = centring(cone)
    assert np.abs(matrix.T @ metric @ matrix - metric).max() < 1e-12
    moved = cone @ matrix.T
    assert np.abs((moved[:, :3] / moved[:, 3:]).mean(axis=0)).max() < 1e-13
    assert left < 1e-13
    # The formula of mathematics.md 7.1 for one point.
    w = np.array([0.3, -0.2, 0.5])
    size, point = float(np.linalg.norm(w)), t[7]
    e = w / size
    gamma = 1 / np.sqrt(1 - size**2)
    across = point - (point @ e) * e
    wanted = (across + gamma * (point @ e - size) * e) / (gamma * (1 - point @ w))
    image = boost(w) @ [*point, 1.0]
    assert np.abs(image[:3] / image[3] - wanted).max() < 1e-14
    most = np.array([[0.0, 0.0, 1.0, 1.0]] * 5 + [[1.0, 0.0, 0.0, 1.0]])
    with pytest.raises(DegenerateError, match="cannot be centered"):
        centring(most)


def tower(sides: int, levels: int) -> list[list[int]]:
    """Prisms on top of each other."""
    ids = np.arange(sides * (levels + 1)).reshape(levels + 1, sides)
    after = np.roll(ids, -1, axis=1)
    walls = np.stack([ids[:-1], after[:-1], after[1:], ids[1:]], axis=-1).reshape(-1, 4)
    return [ids[0, ::-1].tolist(), ids[-1].tolist(), *walls.tolist()]


def test_long_thin_polyhedra_keep_their_digits_or_are_refused() -> None:
    """Circles shrink towards the ends by a factor in each level: here to 4e-8 of the sphere."""
    long = koebe(tower(4, 20))
    assert long.radii.min() < 1e-7
    assert long.residuals()["tangency"] < 1e-14
    assert koebe(tower(30, 60)).residuals()["tangency"] < 1e-14
    for levels in (40, 300):
        with pytest.raises(DegenerateError, match="too long and thin"):
            koebe(tower(4, levels))


def test_vertices_of_high_degree() -> None:
    """A pyramid over a 2000-gon: one circle touches 2000 others."""
    pyramid = [list(range(2000))[::-1], *([i, (i + 1) % 2000, 2000] for i in range(2000))]
    solid = koebe(pyramid)
    assert solid.residuals()["tangency"] < 1e-12
    assert np.ptp(solid.radii[:2000]) < 1e-12


# --- bad input ---------------------------------------------------------------------------------
def theta(parts: int) -> list[list[int]]:
    """Two poles joined by paths of two inner vertices: every pair of faces meets at both poles."""
    faces = []
    for k in range(parts):
        a, b = 2 + 2 * k, 2 + 2 * ((k + 1) % parts)
        faces.append([0, a, a + 1, 1, b + 1, b])
    return faces


@pytest.mark.parametrize(
    ("faces", "words"),
    [
        ([[0, 1, 2], [0, 3, 1], [1, 3, 2]], "not a sphere: 3 edges have one face only"),
        (
            [
                [0, 1, 2],
                [0, 3, 1],
                [1, 3, 2],
                [2, 3, 0],
                [4, 5, 6],
                [4, 7, 5],
                [5, 7, 6],
                [6, 7, 4],
            ],
            r"disconnected: 2 separate surfaces \(faces 0, 4",
        ),
        ([[0, 1, 2], [0, 2, 1]], "4 vertices and faces or more"),
        ([[0, 1, 2, 3], [3, 2, 1, 0]], "4 vertices and faces or more"),
        (theta(5), "not 3-connected: vertices 0 and 1 are a cut pair"),
        ([[0, 1, 3], [1, 2, 3], [2, 0, 3], [0, 2, 4], [2, 1, 4], [1, 0, 4]], None),
        ([[0, 1, 5, 3], [1, 2, 3, 5], [2, 0, 3], [0, 2, 4], [2, 1, 4], [1, 0, 4]], "cut pair"),
        ([[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0, 4, 0]], "repeats|cut vertex|same way"),
    ],
)
def test_what_is_no_polyhedron_is_refused_by_name(
    faces: list[list[int]], words: str | None
) -> None:
    if words is None:
        assert koebe(faces).residuals()["tangency"] < 1e-12
        return
    with pytest.raises(MeshError, match=words):
        koebe(faces)


def test_the_cut_pair_is_named() -> None:
    """Two octahedra glued along an edge: the ends of that edge cut the graph."""
    with pytest.raises(MeshError, match=r"vertices 1 and 3 are a cut pair \(faces 0 and 1 meet"):
        # Edge 0-1 and 0-3 only at vertex 0: the square 0 1 2 3 has a corner of two edges.
        koebe([[0, 1, 4, 3], [0, 3, 5, 1], [1, 2, 4], [2, 3, 4], [1, 5, 2], [2, 5, 3]])
    with pytest.raises(MeshError, match="vertices 0 and 1 are a cut pair"):
        koebe(theta(4))


def test_a_handle_is_named() -> None:
    ids = np.arange(9).reshape(3, 3)
    a, b = np.roll(ids, -1, axis=0), np.roll(ids, -1, axis=1)
    c = np.roll(a, -1, axis=1)
    torus = np.stack([ids, a, c, b], axis=-1).reshape(-1, 4)
    with pytest.raises(MeshError, match=r"= 0, 2 needed \(it has 1 handles"):
        koebe(torus)
    with pytest.raises(MeshError, match="belongs to no face"):
        koebe(Mesh.build(np.zeros((9, 3)), SOLIDS["cube"].faces))
    with pytest.raises(InputError, match="the polyhedron has 6 edges"):
        koebe(SOLIDS["tetrahedron"], infinity=6)


def test_connectivity_agrees_with_a_search_through_all_pairs() -> None:
    """Second route: take out every pair of vertices and count what is left."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    from ddgfab.nets.koebe.checks import check_polyhedron

    def three_connected(mesh: Mesh) -> bool:
        for i in range(mesh.n_vertices):
            for j in range(i):
                keep = np.setdiff1d(np.arange(mesh.n_vertices), [i, j])
                edges = mesh.edges[~np.isin(mesh.edges, [i, j]).any(axis=1)]
                own = np.searchsorted(keep, edges)
                graph = coo_array((np.ones(len(own)), tuple(own.T)), shape=(len(keep),) * 2)
                if connected_components(graph, directed=False)[0] > 1:
                    return False
        return True

    rng = np.random.default_rng(6)
    seen = [0, 0]
    for trial in range(60):
        mesh = merged(random_hull(int(rng.integers(6, 11)), trial), rng)
        try:
            check_polyhedron(mesh)
        except MeshError:
            found = False
        else:
            found = True
        assert found == three_connected(mesh), trial
        seen[found] += 1
    assert min(seen) > 5


def merged(mesh: Mesh, rng: np.random.Generator) -> Mesh:
    """The mesh with some edges taken out, as long as no vertex is visited twice by a face."""
    faces = {k: face.tolist() for k, face in enumerate(mesh.faces)}
    for _ in range(int(rng.integers(0, 7))):
        f, g = (int(k) for k in rng.choice(list(faces), 2, replace=False))
        shared = set(faces[f]) & set(faces[g])
        if len(shared) != 2:
            continue
        a, b = shared
        one, two = faces[f], faces[g]
        i, j = one.index(a), one.index(b)
        if (i + 1) % len(one) != j:
            a, b, i, j = b, a, j, i
        if (i + 1) % len(one) != j or (two.index(b) + 1) % len(two) != two.index(a):
            continue
        rest = two[two.index(a) :] + two[: two.index(a)]
        faces[f] = one[j:] + one[:j] + rest[1:-1]
        del faces[g]
    return Mesh.build(mesh.vertices, list(faces.values()))
