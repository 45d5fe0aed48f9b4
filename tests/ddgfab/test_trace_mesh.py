"""Networks as meshes: areas, faces, orders, conjugate families."""

from __future__ import annotations

import numpy as np
import pytest
from surface_cases import ellipsoid_cap, exact_ellipsoid, graph

from ddgfab.errors import DegenerateError, InputError
from ddgfab.grid import grid_mesh
from ddgfab.measures import circular_defect, planarity_percent
from ddgfab.surfaces.analytic import named_surface
from ddgfab.surfaces.fit import fit_mesh
from ddgfab.surfaces.sampled import interpolated
from ddgfab.trace import (
    ConjugateField,
    PrincipalField,
    network_mesh,
    place,
    placing,
    plane_sections,
    turned,
)
from ddgfab.trace.alignment import alignment
from ddgfab.trace.field import sines


def traced(surface, spacing, other=None):
    return network_mesh(place(PrincipalField(surface), (spacing, other or spacing)))


def roof(x, y):
    return 0.12 * np.sin(1.5 * x + 0.3) - 0.22 * y**2 + 0.08 * x * y + 0.05 * y**3


@pytest.mark.parametrize("spacing", [0.31, 0.2, 0.13])
def test_cells_cover_the_trim(spacing: float) -> None:
    hexagon = [(np.cos(t) * 0.9, np.sin(t) * 0.8) for t in np.arange(0.2, 6.2, 0.3)]
    hole = [(0.25, 0.0), (0.0, 0.3), (-0.3, 0.0), (0.0, -0.25)]
    for loops in (None, [hexagon], [hexagon, hole]):
        found = traced(graph(roof, trim=loops), spacing)
        assert found.area_error < 1e-10
        assert len(found.mesh.boundary_loops) == (1 if loops is None else len(loops))


def test_vertices_lie_on_the_surface_and_corners_are_kept() -> None:
    surface = graph(roof)
    found = traced(surface, 0.2)
    x, y, z = found.mesh.vertices.T
    assert np.abs(z - roof(x, y)).max() < 1e-7
    assert np.abs(found.mesh.vertices - surface.points(found.uv)).max() == 0
    corners = found.uv[found.tag == 2]
    assert np.allclose(sorted(map(tuple, corners)), [(-1, -1), (-1, 1), (1, -1), (1, 1)])
    rim = found.tag > 0
    assert (found.mesh.boundary_vertex == rim).all()
    assert (np.abs(np.abs(found.uv[rim]).max(axis=1) - 1) < 1e-12).all()


def test_without_umbilics_all_inner_faces_are_quads() -> None:
    found = traced(named_surface("wave-roof"), 1500.0)
    assert (found.mesh.face_sizes[found.inner_faces] == 4).all()
    assert len(found.inner_faces) > 100


def test_one_hexagon_round_a_star() -> None:
    found = traced(named_surface("monkey-saddle"), 1500.0)
    sizes = found.mesh.face_sizes[found.inner_faces]
    assert np.bincount(sizes).tolist()[4:] == [len(sizes) - 1, 0, 1]


def test_ellipsoid_with_two_umbilics_has_quads_away_from_them() -> None:
    surface = ellipsoid_cap()
    network = place(PrincipalField(surface), (0.35, 0.35))
    found = network_mesh(network)
    assert [umbilic.index for umbilic in network.umbilics] == [0.5, 0.5]
    assert found.area_error < 1e-10
    inner = found.inner_faces
    odd = inner[found.mesh.face_sizes[inner] != 4]
    places = np.array([umbilic.x for umbilic in network.umbilics])
    for center in found.mesh.face_centers[odd]:
        assert np.linalg.norm(places - center, axis=1).min() < 0.35
    assert len(odd) <= 2
    assert len(inner) > 50


def test_planarity_falls_with_the_third_power() -> None:
    surface = named_surface("wave-roof")
    means = []
    for spacing in (3000.0, 1500.0, 750.0):
        found = traced(surface, spacing)
        percent = planarity_percent(found.mesh)[found.inner_faces]
        means.append(percent.mean() * spacing)  # a distance
    assert means[0] / means[1] > 5
    assert means[1] / means[2] > 5


def test_defect_of_opposite_angles_falls_with_the_second_power() -> None:
    """Cells between curvature lines lie on circles up to the square of the spacing."""
    surface = named_surface("wave-roof")
    means = []
    for spacing in (3000.0, 1500.0, 750.0):
        found = traced(surface, spacing)
        means.append(float(circular_defect(found.mesh)[found.inner_faces].mean()))
    assert np.log2(np.array(means[:-1]) / means[1:]) == pytest.approx([2.0, 2.0], abs=0.1)


def test_spacing_is_kept() -> None:
    found = traced(named_surface("wave-roof"), 1000.0)
    inner = ~found.mesh.boundary_edge
    ratio = found.mesh.edge_lengths[inner] / 1000
    low, middle, high = np.percentile(ratio, [5, 50, 95])
    assert low > 0.55
    assert 0.85 < middle < 1.1
    assert high < 1.4


def test_a_motion_moves_the_net_and_scale_scales_it() -> None:
    turn = np.array([[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]])

    def point(u, v):
        return np.stack([u, v, roof(u, v)], axis=-1)

    box = (-1.0, 1.0, -1.0, 1.0)
    one = traced(interpolated(point, box, (60, 50)), 0.25).mesh
    moved = interpolated(lambda u, v: 7 * point(u, v) @ turn.T + [3, -2, 5], box, (60, 50))
    two = traced(moved, 1.75).mesh
    assert one.n_faces == two.n_faces
    assert np.abs(7 * one.vertices @ turn.T + [3, -2, 5] - two.vertices).max() < 1e-6


def test_conjugate_lines_of_the_ellipsoid_lie_in_planes() -> None:
    """Diametral planes: the curves conjugate to plane sections with normal m pass through the
    diameter (9 m1, 4 m2, m3)."""
    surface, normal = ellipsoid_cap((120, 110)), np.array([0.3, 1.0, 0.2])
    diameter = normal * [9, 4, 1]
    skew = []
    for spacing in (0.4, 0.2):
        network = place(ConjugateField(surface, plane_sections(normal)), (spacing, spacing))
        for line in network.lines[0]:
            assert np.ptp(line.x @ normal) < 4e-6
        for line in network.lines[1]:
            across = np.linalg.svd(np.vstack([line.x, diameter]))[2][2]
            assert np.abs(line.x @ across).max() < 6e-7
        found = network_mesh(network)
        inner = found.inner_faces
        quads = inner[found.mesh.face_sizes[inner] == 4]
        assert len(quads) > 30
        skew.append(planarity_percent(found.mesh)[quads].max() / 100)
    # planar before any optimization; what is left is the error of the steps along the lines
    assert skew[0] < 1.2e-7
    assert skew[1] < 5e-8


@pytest.mark.slow
def test_conjugate_cells_are_planar_as_steps_become_fine(monkeypatch: pytest.MonkeyPatch) -> None:
    """What the cells lack of planar is the error of the steps: order 4, to 2e-10 and less."""
    normal = np.array([0.3, 1.0, 0.2])
    diameter, left = normal * [9, 4, 1], []
    for step in (1 / 8, 1 / 32):
        monkeypatch.setattr(placing, "_STEP", step)
        network = place(ConjugateField(exact_ellipsoid(), plane_sections(normal)), (0.6, 0.6))
        found = network_mesh(network)
        inner = found.inner_faces
        quads = inner[found.mesh.face_sizes[inner] == 4]
        assert len(quads) > 10
        left.append(planarity_percent(found.mesh)[quads].max() / 100)
    assert left[1] < 2e-10
    assert left[0] / left[1] > 4**3.5
    for line in network.lines[1]:  # of the last one
        across = np.linalg.svd(np.vstack([line.x, diameter]))[2][2]
        assert np.abs(line.x @ across).max() < 2e-9
    sine = sines(network.field, exact_ellipsoid().jets(found.uv))
    assert np.degrees(np.arcsin(sine.min())) > 45


def test_translation_surface_has_its_conjugate_lines() -> None:
    surface = graph(lambda x, y: 0.3 * x**2 + 0.2 * y**3 + 0.4 * y**2)
    network = place(ConjugateField(surface, plane_sections([0, 1, 0])), (0.2, 0.2))
    for line in network.lines[1]:
        assert np.ptp(line.x[:, 0]) < 2e-13


def test_asymptotic_family_is_refused() -> None:
    surface = graph(lambda x, y: x * y)
    with pytest.raises(DegenerateError, match=r"families meet at 0\.0 deg at u"):
        place(ConjugateField(surface, plane_sections([0, 1, 0])), (0.2, 0.2))


@pytest.mark.parametrize("field", [PrincipalField, lambda s: ConjugateField(s, turned(0.3))])
def test_planes_are_refused(field) -> None:
    with pytest.raises(DegenerateError, match=r"is plane \(curvature times size below 1e-06\)"):
        place(field(graph(lambda x, y: 0.1 * x + 0 * y)), (0.2, 0.2))


@pytest.mark.parametrize("spacing", [0.0, -1.0, 50.0, 1e-5, np.nan])
def test_useless_spacing_is_refused(spacing: float) -> None:
    with pytest.raises(InputError, match="spacing"):
        place(PrincipalField(graph(roof)), (spacing, spacing))


def test_unreached_hole_is_refused() -> None:
    hole = [(0.02, 0.05), (0.0, 0.07), (-0.02, 0.05), (0.0, 0.03)]
    square = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
    with pytest.raises(DegenerateError, match="no line reaches a hole"):
        traced(graph(lambda x, y: x**2 - y**2, trim=[square, hole]), 0.39)


def test_lines_run_through_points_that_are_given() -> None:
    surface = named_surface("wave-roof")
    points = surface.points(np.array([[2100.0, 900.0], [-7300.0, -3100.0]]))
    network = place(PrincipalField(surface), (1500.0, 1500.0), points)
    for lines in network.lines:
        for point, (line, steps) in zip(points, [(k, lines) for k in (0, 1)], strict=True):
            assert np.linalg.norm(steps[line].x - point, axis=1).min() < 1e-6
    found = network_mesh(network)
    gaps = np.linalg.norm(found.mesh.vertices[:, None] - points, axis=2).min(axis=0)
    assert gaps.max() < 1e-3  # both families meet in each of the points
    with pytest.raises(InputError, match=r"point 0 of through .* lies .* from the surface"):
        place(PrincipalField(surface), (1500.0, 1500.0), [[0.0, 0.0, 9e3]])
    with pytest.raises(InputError, match="through has shape"):
        place(PrincipalField(surface), (1500.0, 1500.0), [0.0, 0.0, 9e3])


def test_net_turned_from_principal_is_conjugate() -> None:
    """Angles of the edges by another route: second derivatives at the centers of the faces."""
    surface = named_surface("dome")
    field = ConjugateField(surface, turned(np.radians(12)))
    found = network_mesh(place(field, (1500.0, 1500.0)))
    edges = alignment(found.mesh, surface)
    assert edges.conjugate_deg is not None
    assert edges.conjugate_deg[2] < 0.2
    assert edges.principal_deg is not None
    assert edges.principal_deg[0] > 5


def test_scan_with_noise_keeps_its_cells_at_the_rim() -> None:
    """Noise turns the last steps of lines along the rim; the cells there keep their order."""
    rng = np.random.default_rng(1)
    u, v = np.meshgrid(np.linspace(-10, 10, 60), np.linspace(-7, 7, 50), indexing="ij")
    jitter = 0.3 * rng.uniform(-0.3, 0.3, (2, *u.shape))
    jitter[:, [0, -1]] = 0
    jitter[:, :, [0, -1]] = 0
    u, v = u + jitter[0], v + jitter[1]
    z = 2.6 * (1 - 0.7 * (v / 7) ** 2 - 0.3 * (u / 10) ** 2) + 0.2 * np.sin(u / 4)
    points = np.stack([u, v, z], axis=-1) + 2e-3 * rng.normal(size=(*u.shape, 3))
    surface = fit_mesh(grid_mesh(points)).surface
    for spacing in (1.3, 1.4, 1.5, 1.6):
        found = traced(surface, spacing)
        assert found.area_error < 1e-10
        assert (found.mesh.face_sizes[found.inner_faces] == 4).all()
