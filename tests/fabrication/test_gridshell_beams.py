"""Beams: hand-derived lengths and mitres, cuts measured in the world against the nodes."""

from __future__ import annotations

import math

import numpy as np
import pytest
from detailing_cases import Case, central, dome, fan, grid, hexagons, placed, vertical

from ddgfab.errors import DetailError
from ddgfab.mesh import Floats
from fabrication.gridshell.detailing.gridshell import Gridshell
from fabrication.gridshell.pieces import Beam
from fabrication.parts.beam import fibre_ends
from fabrication.standards.profiles import z_range

CASES = {
    "dome": dome,
    "hexagons": hexagons,
    "fan": lambda: fan(6, True),
    "open": lambda: fan(3, False),
}


def end_face(beam: Beam, end: int) -> Floats:
    """Four corners (world) of the bounding rectangle of a flat end."""
    cut = (beam.shape.start, beam.shape.end)[end]
    half = beam.shape.profile.width / 2
    corners = [
        (cut.x + cut.slope * z, y, z) for z in z_range(beam.shape.profile) for y in (-half, half)
    ]
    return placed(beam.placement, np.array(corners))


def arms(shell: Gridshell) -> list[tuple[Beam, int, int, int]]:
    """(beam, end, index of the node, index of its arm) for all arms."""
    by_vertex = {node.vertex: k for k, node in enumerate(shell.nodes)}
    found = []
    for beam in shell.beams:
        for end in (0, 1):
            node = by_vertex[beam.vertices[end]]
            marks = [arm.beam for arm in shell.nodes[node].arms]
            found.append((beam, end, node, marks.index(beam.mark)))
    return found


def test_flat_grid_by_hand() -> None:
    # R = 20 (least of the series from 40 mm), seat at sqrt(400 - 16), clearance 0.5.
    shell = vertical(grid(2, 2)).detail()
    cut = math.sqrt(400 - 16) + 0.5
    for beam in shell.beams:
        assert beam.shape.start.x == 0.0  # the part begins at its cut
        assert beam.shape.end.x == pytest.approx(1500 - 2 * cut, abs=1e-9)
        assert beam.offsets == pytest.approx((cut, cut), abs=1e-12)
        away = beam.placement[:3, 3] - shell.mesh.vertices[beam.vertices[0]]
        assert away == pytest.approx(cut * beam.placement[:3, 0], abs=1e-9)
        assert (beam.shape.start.slope, beam.shape.end.slope, beam.torsion) == (0.0, 0.0, 0.0)
        assert np.allclose(beam.placement[:3, 2], [0, 0, 1])
    assert [beam.mark for beam in shell.beams] == [f"B-{k:04d}" for k in range(12)]


def test_known_mitre() -> None:
    # Center 5000 below the corner (0, 0): the axis at (1500, 0) leans by atan(1500 / 5000).
    shell = central(grid(1, 1), (0.0, 0.0, -5000.0)).detail()
    beam = next(b for b in shell.beams if set(b.vertices) == {0, 2})
    assert beam.vertices == (0, 2)
    assert beam.shape.start.slope == pytest.approx(0, abs=1e-15)
    assert beam.shape.end.slope == pytest.approx(0.3, abs=1e-12)
    distance = shell.size.cut * math.hypot(1, 0.3)  # across the cut -> along the beam
    assert beam.shape.end.x == pytest.approx(1500 - shell.size.cut - distance, abs=1e-9)
    assert beam.offsets == pytest.approx((shell.size.cut, distance), abs=1e-9)


def test_profile_hangs_at_the_eccentricity() -> None:
    shell = central(grid(1, 1), (0.0, 0.0, -5000.0)).detail(beam={"eccentricity_mm": -12.0})
    for beam in shell.beams:
        start = shell.mesh.vertices[beam.vertices[0]]
        # on a line parallel to the edge, from the cut at the node axis' own distance
        away = beam.placement[:3, 3] - start
        assert away @ beam.placement[:3, 2] == pytest.approx(-12)
        assert away @ beam.placement[:3, 1] == pytest.approx(0, abs=1e-9)
        along = beam.shape.start.slope * -12 + beam.offsets[0]
        assert away @ beam.placement[:3, 0] == pytest.approx(along)


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("eccentricity", [0.0, 35.0])
def test_flat_ends_lie_on_a_plane_parallel_to_their_seat(name: str, eccentricity: float) -> None:
    shell = CASES[name]().detail(beam={"eccentricity_mm": eccentricity}, panel={"kind": "none"})
    for beam, end, node, arm in arms(shell):
        seat = shell.nodes[node].shape.seats[arm]
        frame = shell.nodes[node].placement[:3, :3]
        normal = frame @ [math.cos(seat.azimuth), math.sin(seat.azimuth), 0.0]
        face = end_face(beam, end) - shell.nodes[node].position
        assert face @ normal == pytest.approx(seat.distance + 0.5, abs=1e-9)
        # ... centered on the seat, whose width is the profile's
        across = face @ np.cross(shell.nodes[node].axis, normal)
        assert np.abs(across) == pytest.approx(seat.width / 2, abs=1e-6)
        # one mitre, no compound angle: the cut is perpendicular to pi(e)
        assert abs(normal @ beam.placement[:3, 1]) < 1e-9


@pytest.mark.parametrize("name", CASES)
def test_coped_ends_keep_the_clearance_from_the_cylinder(name: str) -> None:
    shell = CASES[name]().detail(
        beam={"end": "cope", "profile": "RHS 80x40x4"}, panel={"kind": "none"}
    )
    assert not any(node.shape.seats for node in shell.nodes)
    for beam, end, node, _ in arms(shell):
        cut = (beam.shape.start, beam.shape.end)[end]
        assert cut.radius == shell.size.radius + 0.5
        # the cylinder's axis, `radius` beyond x across the cut, is the node's axis
        sign = 1 if end == 0 else -1
        point = placed(
            beam.placement,
            np.array([[cut.x - sign * cut.radius * math.hypot(1, cut.slope), 0.0, 0.0]]),
        )[0]
        away = point - shell.nodes[node].position
        assert np.linalg.norm(np.cross(away, shell.nodes[node].axis)) < 1e-8


def test_coped_overall_length_holds_the_horns() -> None:
    shape = (
        vertical(grid(1, 1)).detail(beam={"end": "cope", "profile": "RHS 80x40x4"}).beams[0].shape
    )
    start, end = fibre_ends(shape)
    radius = shape.start.radius
    assert radius is not None
    horn = math.sqrt(radius**2 - 20**2)  # nearest to the node's middle plane, at y = 20
    assert end.max() - start.min() == pytest.approx(1500 - 2 * horn)


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("end", ["flat", "cope"])
def test_neighbouring_arms_do_not_meet(name: str, end: str) -> None:
    shell = CASES[name]().detail(
        beam={"end": end, "profile": "FL 80x30"},
        panel={"kind": "none"},
        node={"min_diameter_mm": 0},
    )
    found = {(node, arm): (beam, k) for beam, k, node, arm in arms(shell)}
    compared = 0
    for n, node in enumerate(shell.nodes):
        count = len(node.arms)
        for a in range(count):
            first, second = node.arms[a].azimuth, node.arms[(a + 1) % count].azimuth
            gap = (second - first) % (2 * math.pi)
            if gap >= math.pi:
                continue
            middle = first + gap / 2
            wall = node.placement[:3, :3] @ [-math.sin(middle), math.cos(middle), 0.0]
            for arm, side in ((a, -1), ((a + 1) % count, 1)):
                beam, k = found[n, arm]
                corners = np.vstack([end_face(beam, 0), end_face(beam, 1)])
                if end == "cope":  # horns reach beyond the flat corner by the sagitta
                    axis = beam.placement[:3, 0] * (1 if k == 0 else -1)
                    radius = shell.size.cut
                    reach = radius - math.sqrt(radius**2 - 15**2)
                    corners = np.vstack([corners, end_face(beam, k) - 1.1 * reach * axis])
                assert (side * ((corners - node.position) @ wall)).min() > 0
            compared += 1
    assert compared > 3


def test_topology_and_torsion_of_the_mesh() -> None:
    case = dome()
    shell = case.detail()
    for beam in shell.beams:
        left, right = case.mesh.edge_faces[beam.edge]
        assert beam.panels[0] == f"P-{left:04d}"
        assert beam.panels[1] == (f"P-{right:04d}" if right >= 0 else None)
        assert beam.nodes == tuple(f"N-{v:04d}" for v in case.mesh.edges[beam.edge])
        assert beam.torsion < 1e-9
        toward = case.mesh.face_centers[left] - case.mesh.vertices[beam.vertices[0]]
        assert toward @ beam.placement[:3, 1] > 0  # y points into the left face


def test_torsion_beyond_the_limit_is_a_failing_check() -> None:
    mesh = grid(1, 1)
    axes = vertical(mesh).axes.copy()
    axes[0] = [0.0, math.sin(math.radians(2)), math.cos(math.radians(2))]
    shell = Case(mesh, axes).detail()
    failed = {mark for mark, check in shell.failures() if check.name == "torsion_deg"}
    # Only the edge along x from vertex 0 twists; along y the axis stays in the edge's plane.
    assert failed == {b.mark for b in shell.beams if set(b.vertices) == {0, 2}}
    assert next(b for b in shell.beams if b.mark in failed).torsion == pytest.approx(
        math.radians(2)
    )


def test_beams_too_short_are_named() -> None:
    with pytest.raises(DetailError) as caught:
        vertical(grid(2, 2, side=120.0)).detail()
    message = str(caught.value)
    assert "B-0000 between nodes N-0000 and N-0003 (edge 120.0 mm)" in message
    assert "and 7 more" in message
    assert "100 mm" in message


def test_axis_along_an_edge_is_refused() -> None:
    mesh = grid(1, 1)
    axes = vertical(mesh).axes.copy()
    axes[0] = [math.sin(math.radians(80)), 0.0, math.cos(math.radians(80))]
    with pytest.raises(DetailError, match=r"B-\d+ meets .* N-0000 at 80.0 deg"):
        Case(mesh, axes).detail()


def test_axes_of_another_mesh_are_refused() -> None:
    with pytest.raises(DetailError, match="shape"):
        Case(grid(1, 1), vertical(grid(2, 1)).axes).detail()
