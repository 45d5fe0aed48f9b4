"""Parallel meshes along given axes, Ribaucour transforms, Gauss images, kites, K-nets of a
potential."""

from __future__ import annotations

import numpy as np
import pytest
from net_cases import (
    catenoid_net,
    circular_net,
    concyclic_defect,
    koebe_net,
    parallel_defect,
    planar_net,
)
from similarity_cases import SIMILARITIES, Similarity

from ddgfab.errors import DdgError, DegenerateError, InputError, MeshError
from ddgfab.grid import grid_mesh
from ddgfab.linkages import flex
from ddgfab.mesh import Floats, unit
from ddgfab.nets import (
    circular_residuals,
    circular_to_conical,
    conjugate_residuals,
    difference,
    dual,
    evolve_circular_by_angles,
    kite_net,
    label_edges,
    shift,
    stack_transforms,
    vertex_normals,
)
from ddgfab.nets.knet import (
    angle_coefficient,
    evolve_hirota,
    hirota_potential,
    knet,
    knet_from_potential,
    quad_angles,
)
from ddgfab.nets.sisothermic import SIsothermic
from ddgfab.support import propagate_axes, support_structure
from ddgfab.transforms import (
    combescure,
    gauss_image,
    invert,
    mesh_curvatures,
    nearest_parallel,
    parallel_along,
    ribaucour,
)


# --- parallel meshes along axes ------------------------------------------------------------------
def axes_of_a_parallel_mesh(x: Floats) -> Floats:
    """Unit axes along a Combescure transform with uneven factors: torsion-free, not normals."""
    other = combescure(
        x,
        1.0 + 0.1 * np.sin(np.arange(x.shape[0] - 1.0)),
        1.0 + 0.1 * np.cos(np.arange(x.shape[1] - 1.0)),
        x[0, 0] + [20.0, 40.0, 300.0],
    )
    return unit((other - x).reshape(-1, 3))


@pytest.mark.parametrize("at", SIMILARITIES, ids=lambda at: at.name)
def test_exact_axes_stay_as_they_are(at: Similarity) -> None:
    x = planar_net()
    axes = axes_of_a_parallel_mesh(x)
    mesh = at.mesh(grid_mesh(x))
    turned = at.vectors(axes, 0)
    rounding = 1e4 * at.rounding
    # Edges are about 300 long; distances are chosen of that size, against which rounding counts.
    found = nearest_parallel(mesh, mesh.vertices + 200.0 * at.scale * turned)
    got = unit(found.vertices - mesh.vertices)
    assert np.abs(got - turned).max() < max(1e-12, rounding)
    ways = [unit(m.edge_vectors) for m in (mesh, found)]
    assert np.abs(np.cross(*ways)).max() < max(1e-10, 1e2 * rounding)


def test_heights_along_axes_against_the_mesh_they_came_from() -> None:
    x = planar_net()
    other = combescure(x, np.linspace(0.9, 1.2, 5), np.linspace(1.1, 0.8, 4), x[0, 0] + [0, 0, 400])
    mesh, away = grid_mesh(x), (other - x).reshape(-1, 3)
    found = parallel_along(mesh, away, float(np.linalg.norm(away, axis=1).mean()))
    np.testing.assert_allclose(found.vertices, other.reshape(-1, 3), atol=1e-8)
    np.testing.assert_allclose(
        parallel_along(mesh, unit(away), -2.0).vertices - mesh.vertices,
        -2.0 * away / np.linalg.norm(away, axis=1).mean(),
        atol=1e-10,
    )


def test_torsion_free_axes_on_planar_meshes_have_one() -> None:
    """Axes from boundary data on a simply connected planar mesh integrate (10.4)."""
    x = planar_net()
    mesh = grid_mesh(x)
    axes = propagate_axes(x, [0.1, 0.2, 1.0], 0.1 * np.arange(1.0, 6.0), 0.2 * np.arange(4.0))
    found = parallel_along(mesh, axes.reshape(-1, 3), 100.0)
    assert np.abs(np.cross(unit(found.edge_vectors), unit(mesh.edge_vectors))).max() < 1e-9


def test_axes_without_a_parallel_mesh_are_refused_and_approximated() -> None:
    mesh = grid_mesh(planar_net())
    with pytest.raises(DegenerateError, match=r"edge \d+ \(\d+-\d+\) is off"):
        parallel_along(mesh, mesh.vertex_normals)
    near = nearest_parallel(mesh, mesh.vertices + mesh.vertex_normals)
    assert np.abs(np.cross(unit(near.edge_vectors), unit(mesh.edge_vectors))).max() < 1e-9
    with pytest.raises(DegenerateError, match=r"axis of vertex \d+ runs along edge"):
        parallel_along(mesh, np.broadcast_to(mesh.edge_vectors[0], mesh.vertices.shape))
    with pytest.raises(InputError, match="has no length"):
        parallel_along(mesh, np.zeros_like(mesh.vertices))
    with pytest.raises(InputError, match="positive"):
        nearest_parallel(mesh, mesh.vertices, np.zeros(mesh.n_vertices))


# --- Ribaucour transforms ------------------------------------------------------------------------
FIRST, SECOND = np.linspace(0.3, 0.6, 7), np.linspace(0.7, 0.4, 5)


@pytest.mark.parametrize("at", SIMILARITIES, ids=lambda at: at.name)
def test_ribaucour_pairs_are_layers_of_a_circular_net(at: Similarity) -> None:
    x = circular_net()
    start = x[0, 0] + [30.0, -50.0, 400.0]
    plain = ribaucour(x, start, [FIRST, SECOND])
    made = ribaucour(at(x), at(start), [FIRST, SECOND])
    size = float(np.ptp(x, axis=(0, 1)).max())
    assert np.abs(made - at(plain)).max() < 1e6 * at.rounding * at.scale * size
    if at.name in ("motion", "reflection", "scale 0.7"):
        assert concyclic_defect(made) < 1e-9
        pair = stack_transforms([at(x), made])
        assert circular_residuals(pair)["circularity"] < 1e-9
        ends = pair[:-1, :, 0], pair[1:, :, 0], pair[1:, :, 1], pair[:-1, :, 1]
        for row in range(x.shape[1]):  # vertical quads by the second route too
            strip = np.stack([pair[:, row, 0], pair[:, row, 1]], axis=1)
            assert concyclic_defect(strip) < 1e-9
        assert len(ends) == 4


def test_ribaucour_of_known_pairs() -> None:
    """An inversion's image is a Ribaucour transform, and so is a vertex offset: both come back."""
    x = circular_net()
    center = np.array([500.0, 300.0, -4000.0])
    offset = x + 120.0 * vertex_normals(x, np.array([0.1, 0.3, 1.0]))
    for wanted in (invert(x, center, 3800.0), offset):
        ratios = []
        for k in (0, 1):
            line, other = (np.moveaxis(net, k, 0)[:, 0] for net in (x, wanted))
            sides = zip(line, line[1:], other, other[1:], strict=False)
            ratios.append([t_of(*side) for side in sides])
        found = ribaucour(x, wanted[0, 0], ratios)
        np.testing.assert_allclose(found, wanted, atol=1e-6)


def t_of(x: Floats, x1: Floats, x2: Floats, x12: Floats) -> float:
    """inv(x12 - x) = (1 - t) inv(x1 - x) + t inv(x2 - x), solved for t after inverting twice."""
    a, b, c = (v / (v @ v) for v in (x1 - x, x2 - x, x12 - x))
    # x12 - x = inv((1 - t) a + t b), so c = (1 - t) a + t b.
    return float((c - a) @ (b - a) / ((b - a) @ (b - a)))


def test_ribaucour_in_three_directions_and_refusals() -> None:
    box = evolve_circular_by_angles_box()
    made = ribaucour(box, box[0, 0, 0] + [0.2, 0.3, -1.5], [0.4, 0.5, 0.6])
    assert made.shape == box.shape
    assert circular_residuals(stack_transforms([box, made]))["circularity"] < 1e-8
    x = circular_net()
    with pytest.raises(DegenerateError, match="not circular"):
        ribaucour(planar_net(7, 5), [0.0, 0.0, 9.0], [0.4, 0.5])
    with pytest.raises(InputError, match="directions of ratios"):
        ribaucour(x, x[0, 0] + 1.0, [0.4])
    with pytest.raises(InputError, match=r"direction 1 .* \(5,\) needed"):
        ribaucour(x, x[0, 0] + 1.0, [0.4, [0.4, 0.5]])
    with pytest.raises(DegenerateError):
        ribaucour(x, x[0, 0], [0.4, 0.5])


def evolve_circular_by_angles_box() -> Floats:
    rng = np.random.default_rng(3)
    steps = [e + 0.1 * rng.normal(size=(3, 3)) for e in np.eye(3)]
    axes = [np.cumsum(np.vstack([np.zeros(3), step]), axis=0) for step in steps]
    angles = {pair: np.full((3, 3), 1.5) for pair in ((0, 1), (0, 2), (1, 2))}
    return evolve_circular_by_angles(axes, angles)


# --- Gauss images --------------------------------------------------------------------------------
def test_gauss_images_touch_the_sphere_by_their_kind() -> None:
    circular = grid_mesh(circular_net())
    image = gauss_image(circular)
    assert np.abs(np.linalg.norm(image, axis=1) - 1).max() < 1e-9
    conical = grid_mesh(circular_to_conical(circular_net()))
    image = gauss_image(conical, "face")
    height = np.einsum(
        "cx,cx->c", image[conical.corners], conical.face_normals[conical.corner_face]
    )
    assert np.abs(height - 1).max() < 1e-6
    edge = grid_mesh(catenoid_net())
    image = gauss_image(edge, "edge")
    middle = 0.5 * image[edge.edges].sum(axis=1)
    along = unit(edge.edge_vectors)
    assert np.abs(np.linalg.norm(np.cross(middle, along), axis=1) - 1).max() < 1e-9
    planar = grid_mesh(planar_net())
    assert parallel_defect(planar_net(), gauss_image(planar).reshape(planar_net().shape)) < 1e-6


def test_curvatures_of_a_mesh_alone() -> None:
    """A net on a sphere of radius 2.5: H = -1 / R, K = 1 / R^2; a catenoid has H = 0."""
    u, v = np.meshgrid(np.linspace(0.4, 1.2, 6), np.linspace(0, 1, 5), indexing="ij")
    x = 2.5 * np.stack([np.sin(u) * np.cos(v), np.sin(u) * np.sin(v), np.cos(u)], axis=-1)
    found = mesh_curvatures(grid_mesh(x))
    np.testing.assert_allclose(found.mean, -0.4, atol=1e-9)
    np.testing.assert_allclose(found.gauss, 0.16, atol=1e-9)
    for ring in (np.linspace(0, 2, 7), np.array([0.0, 0.2, 0.5, 1.1, 1.2])):
        z = np.array([0.0, 0.3, 1.0, 1.2])
        y = np.stack(
            [*(np.broadcast_to(2 * f(ring)[:, None], (len(ring), 4)) for f in (np.cos, np.sin)),
             np.broadcast_to(z, (len(ring), 4))], axis=-1,
        )  # fmt: skip
        found = mesh_curvatures(grid_mesh(y))
        np.testing.assert_allclose(found.mean, -0.25, atol=1e-9)
        np.testing.assert_allclose(found.gauss, 0.0, atol=1e-9)
    catenoid = grid_mesh(catenoid_net())
    assert np.abs(mesh_curvatures(catenoid, "edge").mean).max() < 1e-9
    assert (mesh_curvatures(catenoid, "edge").gauss < 0).all()


def test_curvatures_tend_to_those_of_a_torus_with_order_two() -> None:
    """R = 2, r = 1: K = cos(t) / (2 + cos(t)), H = -(1 + cos(t) / (2 + cos(t))) / 2."""
    errors = []
    for n in (8, 16, 32):
        t, p = np.linspace(-0.6, 0.9, n + 1), np.linspace(0, 1.3, n + 1)
        x = np.stack(
            [np.outer(np.cos(p), 2 + np.cos(t)), np.outer(np.sin(p), 2 + np.cos(t)),
             np.broadcast_to(np.sin(t), (n + 1, n + 1))], axis=-1,
        )  # fmt: skip
        found = mesh_curvatures(grid_mesh(x))
        middle = 0.5 * (t[1:] + t[:-1])
        k = np.cos(middle) / (2 + np.cos(middle))
        gauss, mean = (v.reshape(n, n) for v in (found.gauss, found.mean))
        errors.append(max(np.abs(gauss - k).max(), np.abs(mean + (1 + k) / 2).max()))
    orders = np.log2(np.divide(errors[:-1], errors[1:]))
    assert orders == pytest.approx([2.0, 2.0], abs=0.25)


def test_gauss_image_refusals() -> None:
    planar = grid_mesh(planar_net())
    with pytest.raises(DegenerateError, match="not circular"):
        gauss_image(planar, "vertex")
    with pytest.raises(DegenerateError, match=r"not parallel to a Koebe net|cone of"):
        gauss_image(planar, "edge")
    with pytest.raises(InputError, match="unknown kind"):
        gauss_image(planar, "corner")  # type: ignore[arg-type]
    skew = planar.with_vertices(planar.vertices + np.outer(np.sin(np.arange(30.0)), [0, 0, 50]))
    with pytest.raises(MeshError, match="from planar"):
        gauss_image(skew)


# --- kites ---------------------------------------------------------------------------------------
@pytest.mark.parametrize("net", [koebe_net(), catenoid_net()])
def test_kites_have_right_angles_and_cross_ratio_minus_one(net: Floats) -> None:
    kites = kite_net(SIsothermic.of(grid_mesh(net), 1e-6))
    x = kites.vertices[np.array([face.tolist() for face in kites.faces])]
    vertex, one, center, two = np.moveaxis(x, 1, 0)
    for contact in (one, two):
        assert np.abs(np.einsum("fx,fx->f", vertex - contact, center - contact)).max() < 1e-10
    for tip in (vertex, center):
        a, b = (np.linalg.norm(tip - c, axis=1) for c in (one, two))
        np.testing.assert_allclose(a, b, rtol=1e-10)
    assert kites.n_faces == len(grid_mesh(net).corners)


def test_the_dual_of_the_kites_is_the_kite_net_of_the_dual() -> None:
    """Equation (18) on kites: s Delta x / |Delta x|^2 closes, and gives the dual's kites."""
    net = SIsothermic.of(grid_mesh(koebe_net()), 1e-6)
    kites, mesh = kite_net(net), net.mesh
    wanted = kite_net(dual(net, tolerance=1e-6).net)
    labels = label_edges(mesh)
    start, end = kites.edges.T
    first, after = mesh.n_vertices, mesh.n_vertices + mesh.n_edges
    contact = np.where((start >= first) & (start < after), start, end)
    other = start + end - contact
    sign = np.where(other < mesh.n_vertices, 1.0, -1.0) * labels[contact - mesh.n_vertices]
    step = kites.edge_vectors
    step = sign[:, None] * step / np.einsum("ex,ex->e", step, step)[:, None]
    made = wanted.vertices[end] - wanted.vertices[start]
    factor = np.sign(np.einsum("ex,ex->", made, step))
    np.testing.assert_allclose(made, factor * step, atol=1e-7)


# --- K-nets of a potential -----------------------------------------------------------------------
def test_a_k_net_comes_back_from_its_potential() -> None:
    net = knet([[0.3, 0.35, 0.4, 0.2], [0.25, 0.3, 0.5]], [[0.1, -0.2, 0.3], [0.2, 0.15]], 1.2)
    for start in ((0.0, 0.0), (0.4, -0.7)):
        h = hirota_potential(net, start)
        found = knet_from_potential(h, net.deltas)
        np.testing.assert_allclose(found.points, net.points, atol=1e-12)
    flexed = flex(net, [np.full(3, 0.1), np.full(2, -0.1)], 0.2)
    again = knet_from_potential(hirota_potential(flexed), net.deltas, r=2.0)
    np.testing.assert_allclose(again.points, 2.0 * flexed.points, atol=1e-12)


def test_solutions_of_hirotas_equation_are_k_nets() -> None:
    deltas = [np.full(5, 0.4), np.full(4, 0.3)]
    k = angle_coefficient(*deltas)
    h = evolve_hirota(np.linspace(1.0, 2.0, 6), np.linspace(1.0, 0.5, 5), k)
    net = knet_from_potential(h, deltas)
    assert max(net.residuals().values()) < 1e-12
    phi = quad_angles(net)[0]
    wanted = 0.5 * (h[1:, :-1] + h[:-1, 1:])
    assert np.abs(np.remainder(phi - wanted + np.pi, 2 * np.pi) - np.pi).max() < 1e-12
    with pytest.raises(InputError, match=r"not a solution .* in quad \(\d, \d\)"):
        knet_from_potential(h + 0.1 * np.arange(5.0) ** 2, deltas)
    with pytest.raises(DdgError):
        knet_from_potential(h, deltas[:1])


# --- shifts and differences ----------------------------------------------------------------------
def test_shifts_and_differences_obey_the_product_rule() -> None:
    rng = np.random.default_rng(0)
    a, b = rng.normal(size=(2, 5, 4, 3))
    for k in (0, 1):
        want = shift(a, k) * difference(b, k) + difference(a, k) * shift(b, k, -1)
        np.testing.assert_allclose(difference(a * b, k), want, atol=1e-14)
        assert difference(a, k, periodic=True).shape == a.shape
        np.testing.assert_allclose(difference(a, k, periodic=True).sum(axis=k), 0, atol=1e-13)
    np.testing.assert_allclose(difference(difference(a, 0), 1), difference(difference(a, 1), 0))
    with pytest.raises(InputError, match="cannot be shifted"):
        shift(a, 0, 5)


def test_parallel_mesh_along_exact_axes_is_a_layer_of_a_conjugate_net() -> None:
    x = circular_net()
    mesh = grid_mesh(x)
    axes = support_structure(mesh, "offset").axes
    y = parallel_along(mesh, axes, 100.0).vertices.reshape(x.shape)
    assert max(conjugate_residuals(stack_transforms([x, y])).values()) < 1e-8
