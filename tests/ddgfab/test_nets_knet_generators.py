"""K-nets by kind: equal bars and twists, tangent planes, closed forms, angles, bad input."""

from __future__ import annotations

import numpy as np
import pytest

from ddgfab.errors import DegenerateError, InputError
from ddgfab.forms.knet_sheets import band_mesh, crossing_lines, facing, levelled, ring_mesh
from ddgfab.forms.registry import ParameterError, find_generator, generate, kinds
from ddgfab.measures import star_defect, torsion
from ddgfab.mesh import Floats, Mesh
from ddgfab.nets.knet import knet_from_mesh, pseudosphere
from ddgfab.support.asymptotic import surface_normals

KINDS = ("amsler", "breather", "crab", "dini", "knet", "kuen", "pseudosphere")
OTHER: dict[str, dict[str, float]] = {
    "amsler": {"panels_along": 5, "panels_across": 4, "twist_deg": 6.0, "crossing_deg": 75.0},
    "breather": {"panels_along": 7, "rows": 8, "waves": 0.7, "bar_mm": 800.0},
    "crab": {"panels_around": 11, "rings": 5, "slope_deg": 80.0, "twist_deg": 18.0},
    "dini": {"panels_along": 9, "rows": 4, "pitch_deg": -20.0, "twist_deg": 12.0},
    "knet": {"panels_along": 6, "panels_across": 9, "twist_deg": 6.0, "across_twist_deg": 10.0},
    "kuen": {"panels_along": 9, "rows": 10, "first_row": 24},
    "pseudosphere": {"panels_around": 13, "rings": 6, "base_ring": 3, "bar_mm": 700.0},
}
TWIST = {"knet": 8.0, "amsler": 9.0, "breather": 9.0, "crab": 14.0, "kuen": 9.0, "dini": 10.0}


def unique(values: Floats, step: float) -> Floats:
    return np.unique(np.round(values / step)) * step


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("changed", [False, True])
def test_are_knets(kind: str, changed: bool) -> None:
    """All edges of a vertex in one plane; lengths r sin(delta) and torsions delta, r one number."""
    mesh = generate(kind, OTHER[kind] if changed else {})
    mesh.validate()
    assert np.degrees(star_defect(mesh).max()) < 1e-8
    delta = torsion(mesh, surface_normals(mesh))
    r = mesh.edge_lengths / np.sin(delta)
    assert np.ptp(r) < 1e-7 * r.mean()
    expected = 2 if kind == "dini" or (kind == "knet" and changed) else 1
    assert len(unique(mesh.edge_lengths, 1e-5)) == expected
    assert mesh.vertices[:, 2].min() == pytest.approx(0.0, abs=1e-9)
    assert np.abs(mesh.vertices[:, :2].mean(axis=0)).max() < 1e-6


@pytest.mark.parametrize("kind", ["amsler", "knet"])
def test_grids_are_recovered(kind: str) -> None:
    """The recovery of Cauchy data finds them again, with a defect of rounding."""
    mesh = generate(kind, OTHER[kind])
    net = knet_from_mesh(mesh)
    assert max(net.residuals().values()) < 1e-9
    assert sorted(net.shape, reverse=True)[0] * sorted(net.shape)[0] == mesh.n_vertices


@pytest.mark.parametrize("kind", KINDS)
def test_defaults_can_be_built(kind: str) -> None:
    """Neighbouring arms at least 25 deg apart everywhere, bars of 0.5 to 2 m."""
    mesh = generate(kind)
    assert np.degrees(mesh.corner_angles.min()) > 25.0
    assert np.degrees(mesh.corner_angles.max()) < 155.0
    assert mesh.edge_lengths.min() > 500.0
    assert mesh.edge_lengths.max() < 2000.0
    assert find_generator(kind).support == "normals"
    twist = np.degrees(torsion(mesh, surface_normals(mesh)).max())
    assert twist == pytest.approx(TWIST.get(kind, 180 / 18), abs=1e-7)


def test_kinds_are_listed() -> None:
    assert set(KINDS) <= set(kinds())
    for kind in KINDS:
        entry = find_generator(kind)
        assert len(entry.summary) < 100
        assert all(p.low <= p.default <= p.high for p in entry.parameters)


def test_pseudosphere_is_the_closed_form() -> None:
    """Every vertex on its ring: radius r sech(p L), height r (p sin(alpha) - tanh(p L))."""
    mesh = generate("pseudosphere", {"panels_around": 16, "rings": 5, "base_ring": 2})
    alpha = np.pi / 16
    r, step = 1200.0 / np.sin(alpha), np.log(np.tan(np.pi / 4 + alpha / 2))
    ring = 2 + np.repeat(np.arange(7), 16)
    assert np.hypot(*mesh.vertices[:, :2].T) == pytest.approx(r / np.cosh(ring * step), rel=1e-12)
    height = r * (ring * np.sin(alpha) - np.tanh(ring * step))
    assert mesh.vertices[:, 2] - mesh.vertices[0, 2] == pytest.approx(height - height[0], abs=1e-8)
    patch = pseudosphere((3, 3), alpha, offset=5.0, r=r).points
    lengths = np.linalg.norm(np.diff(patch, axis=0), axis=-1)
    assert mesh.edge_lengths == pytest.approx(np.full(mesh.n_edges, lengths[0, 0]), rel=1e-12)


def test_towers_are_closed_and_rotational() -> None:
    for kind in ("crab", "pseudosphere"):
        mesh = generate(kind)
        assert len(mesh.boundary_loops) == 2
        count = {p.name: p.default for p in find_generator(kind).parameters}["panels_around"]
        turn = 2 * np.pi / count
        c, s = np.cos(turn), np.sin(turn)
        rings = mesh.vertices.reshape(-1, count, 3)
        turned = rings @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]).T
        assert np.abs(turned - np.roll(rings, -1, axis=1)).max() < 1e-8
        out = np.einsum("fx,fx->f", mesh.face_normals, mesh.face_centers * [1, 1, 0])
        assert out.min() > 0


def test_dini_goes_into_itself_by_a_screw() -> None:
    """One step along each direction is one rigid motion for all vertices; no motion if level."""
    mesh = generate("dini", {"panels_along": 6, "rows": 3})
    faces = np.array(mesh.faces)
    corners = mesh.vertices[faces]
    both = [corners[:, k] - corners[:, k + 2] for k in (0, 1)]
    k = int(np.argmin([np.ptp(np.linalg.norm(step, axis=1)) for step in both]))
    first, across = corners[:, k], corners[:, k + 2]
    middle = first.mean(axis=0), across.mean(axis=0)
    u, _, v = np.linalg.svd((first - middle[0]).T @ (across - middle[1]))
    turn = u @ np.diag([1, 1, np.sign(np.linalg.det(u @ v))]) @ v
    assert np.abs((first - middle[0]) @ turn + middle[1] - across).max() < 1e-7
    level = generate("dini", {"pitch_deg": 0.0, "twist_deg": 10.0, "panels_along": 20})
    assert np.ptp(level.edge_lengths) < 1e-8


def test_amsler_has_straight_lines_through_its_middle() -> None:
    points = crossing_lines((4, 3), 0.1, 1.1, 2.0)
    for line in (points[:, 3], points[4]):
        steps = np.diff(line, axis=0)
        assert np.abs(np.cross(steps[0], steps)).max() < 1e-14
    cosine = (points[5, 3] - points[4, 3]) @ (points[4, 4] - points[4, 3])
    assert cosine / (2.0 * np.sin(0.1)) ** 2 == pytest.approx(np.cos(1.1), abs=1e-13)


def test_sheets() -> None:
    grid = np.stack([*np.meshgrid(np.arange(6.0), np.arange(6.0), indexing="ij")], axis=-1)
    flat = np.concatenate([grid, 0 * grid[..., :1]], axis=-1)
    band = band_mesh(flat, (-2, 2), (0, 10))
    assert band.n_faces == 13  # five on the diagonal, four on either side of it
    assert band.n_vertices == 24
    with pytest.raises(InputError, match="no quad"):
        band_mesh(flat, (0, 1), (0, 10))
    down = facing(band, [0.0, 0.0, -1.0])
    assert down.face_normals[:, 2].max() < 0 < facing(down, [0.0, 0.0, 1.0]).face_normals[0, 2]
    tube = ring_mesh(np.ones(4), np.arange(4.0), 5)
    assert (tube.n_faces, len(tube.boundary_loops)) == (10, 2)
    turned = levelled(Mesh.build(flat.reshape(-1, 3)[:, [2, 0, 1]] * [1, 1, 3], [[0, 6, 7, 1]]))
    assert np.abs(turned.vertices[:, 2]).max() < 1e-12
    assert np.ptp(turned.vertices[:, 0]) > np.ptp(turned.vertices[:, 1])


def test_bad_input() -> None:
    with pytest.raises(ParameterError, match="twist_deg = 0 is beyond its limits"):
        generate("crab", {"twist_deg": 0.0})
    with pytest.raises(ParameterError, match="bars_mm is unknown; did you mean bar_mm"):
        generate("kuen", {"bars_mm": 3.0})
    with pytest.raises(DegenerateError, match=r"twist_deg = 20 is too little: 6 .* 30 deg or more"):
        generate("crab", {"panels_around": 6, "slope_deg": 90.0, "twist_deg": 20.0})
    with pytest.raises(DegenerateError, match=r"ring \d+ has radius .* cone point"):
        generate("crab", {"panels_around": 6, "slope_deg": 20.0, "twist_deg": 20.0})
    with pytest.raises(ParameterError, match=r"panels_along = 2\.5 must be a whole number"):
        generate("amsler", {"panels_along": 2.5})
