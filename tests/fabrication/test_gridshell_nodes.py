"""Nodes: azimuths, radius rule, seats, heights, bolts, marks; every valence; every refusal."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest
from detailing_cases import Case, central, dome, fan, grid, hexagons, placed, vertical
from scipy.spatial.transform import Rotation

from ddgfab.errors import DetailError
from ddgfab.mesh import Mesh, unit
from fabrication.gridshell.detailing.arm_room import least_radii
from fabrication.parts.beam import fibre_ends
from fabrication.standards import node_diameters

NO_GLASS = {"kind": "none"}


def test_valence_four_by_hand() -> None:
    node = vertical(grid(2, 2)).detail().nodes[4]
    assert [math.degrees(arm.azimuth) for arm in node.arms] == pytest.approx([0, 90, 180, 270])
    assert [arm.elevation for arm in node.arms] == [0.0] * 4
    # End faces span z = -60..0; margins 5 and 0.5, rounded outwards to whole millimetres.
    assert (node.shape.z0, node.shape.z1) == (-65.0, 1.0)
    assert [seat.distance for seat in node.shape.seats] == [math.sqrt(400 - 16)] * 4
    assert node.shape.mark is not None
    assert node.shape.mark.x + node.shape.mark.diameter / 2 < node.shape.seats[0].distance


@pytest.mark.parametrize(
    ("case", "valence"),
    [(fan(k, True), k) for k in (3, 4, 5, 6)] + [(fan(k, False), k + 1) for k in (1, 2, 3, 5)],
)
def test_every_valence_inside_and_at_the_boundary(case: Case, valence: int) -> None:
    shell = case.detail(panel=NO_GLASS)
    node = shell.nodes[0]
    assert len(node.arms) == valence == len(node.shape.seats)
    assert {arm.edge for arm in node.arms} == set(case.mesh.star(0)[0].tolist())
    azimuths = [arm.azimuth for arm in node.arms]
    assert azimuths[0] == 0.0
    assert azimuths == sorted(azimuths)
    # Azimuths and elevations rebuild the direction of each edge.
    for arm in node.arms:
        other = next(v for v in case.mesh.edges[arm.edge] if v != 0)
        local = [
            math.cos(arm.azimuth) * math.cos(arm.elevation),
            math.sin(arm.azimuth) * math.cos(arm.elevation),
            math.sin(arm.elevation),
        ]
        direction = node.placement[:3, :3] @ local
        assert np.allclose(direction, unit(case.mesh.vertices[other] - case.mesh.vertices[0]))


def test_valence_three_net() -> None:
    case = hexagons()
    shell = case.detail(panel=NO_GLASS)
    inner = [n for n in shell.nodes if not case.mesh.boundary_vertex[n.vertex]]
    assert inner
    assert all(len(n.arms) == 3 for n in inner)


def test_a_hole_in_the_mesh_and_unused_vertices() -> None:
    ring = vertical(grid(3, 3, without=(4,))).detail()
    assert (len(ring.beams), len(ring.nodes), len(ring.panels)) == (24, 16, 8)
    assert sum(None in beam.panels for beam in ring.beams) == 12 + 4
    mesh = Mesh.build(np.vstack([grid(1, 1).vertices, [[9e3, 9e3, 9e3]]]), [[0, 2, 3, 1]])
    shell = vertical(mesh).detail()
    assert [node.vertex for node in shell.nodes] == [0, 1, 2, 3]


def test_arms_turn_counterclockwise_with_the_star() -> None:
    case = dome()
    for node in case.detail().nodes:
        assert [arm.edge for arm in node.arms] == case.mesh.star(node.vertex)[0].tolist()


@pytest.mark.parametrize("end", ["flat", "cope"])
@pytest.mark.parametrize("eccentricity", [0.0, -30.0])
def test_height_covers_all_end_faces_with_little_to_spare(end: str, eccentricity: float) -> None:
    shell = dome().detail(
        beam={"end": end, "profile": "RHS 100x50x4", "eccentricity_mm": eccentricity},
        panel=NO_GLASS,
    )
    beams = {beam.mark: beam for beam in shell.beams}
    for node in shell.nodes:
        heights = []
        for arm in node.arms:
            beam = beams[arm.beam]
            k = beam.vertices.index(node.vertex)
            x = fibre_ends(beam.shape)[k]
            z = np.tile([-100.0, 0.0], len(x) // 2)
            points = placed(beam.placement, np.column_stack([x, 0 * x, z]))
            heights += ((points - node.position) @ node.axis).tolist()
        # 5 mm below, 0.5 mm above, and at most one more for rounding to whole millimetres
        assert 5 - 1e-6 <= min(heights) - node.shape.z0 <= 6 + 1e-6
        assert 0.5 - 1e-6 <= node.shape.z1 - max(heights) <= 1.5 + 1e-6


def test_radius_is_where_two_arms_touch() -> None:
    # Second route: corners of two strips of width b at angle phi meet at distance r from the axis.
    case = fan(5, True)
    shell = case.detail(beam={"profile": "FL 80x30"}, node={"min_diameter_mm": 0}, panel=NO_GLASS)
    azimuths = [arm.azimuth for arm in shell.nodes[0].arms]
    best = 0.0
    for node in shell.nodes:
        azimuths = [arm.azimuth for arm in node.arms]
        for k, first in enumerate(azimuths):
            phi = (azimuths[(k + 1) % len(azimuths)] - first) % (2 * math.pi)
            if phi < math.pi:
                # left edge of the first strip meets the right edge of the second
                a = np.array([[1, 0], [0, 1.0]])
                left = (a @ [0, 15.0], a @ [1.0, 0])
                turned = np.array([[math.cos(phi), -math.sin(phi)], [math.sin(phi), math.cos(phi)]])
                right = (turned @ [0, -15.0], turned @ [1.0, 0])
                t = np.linalg.solve(np.column_stack([left[1], -right[1]]), right[0] - left[0])
                best = max(best, float(np.linalg.norm(left[0] + t[0] * left[1])))
    assert shell.size.needed == pytest.approx(best + 1.0)
    series = node_diameters("cylinder")
    assert 2 * shell.size.radius == min(d for d in series if d >= 2 * shell.size.needed)


def test_wide_gaps_need_only_half_the_width() -> None:
    from fabrication.gridshell.detailing.frames import arms_of, edge_frames

    case = vertical(grid(1, 1))
    arms = arms_of(case.mesh, case.axes, edge_frames(case.mesh, case.axes))
    needs = least_radii(arms, 20.0, 0.0)
    narrow = arms.gap < math.pi
    assert needs[narrow] == pytest.approx(10 / math.sin(math.pi / 4))
    assert needs[~narrow] == pytest.approx(10)


def test_diameter_from_a_given_series_and_least_diameter() -> None:
    case = vertical(grid(1, 1))
    assert case.detail(node={"series_mm": [90.0, 33.0, 51.0]}).size.radius == 25.5
    assert case.detail(node={"min_diameter_mm": 0}).size.radius == 10.0
    assert case.detail(node={"diameter_mm": 77.0}).size.radius == 38.5


def test_a_diameter_too_small_names_node_arms_and_angle() -> None:
    with pytest.raises(DetailError) as caught:
        vertical(grid(2, 2)).detail(beam={"profile": "RHS 120x60x5"}, node={"diameter_mm": 60})
    message = str(caught.value)
    # 2 (30 / sin 45 deg + 1) = 86.9 mm at 12 right angles; a half turn needs 2 (30 + 1) = 62 mm:
    # 24 arms in all, 5 named
    assert "node N-0000 has beams" in message
    assert "90.0 deg, which needs 86.9 mm" in message
    assert "and 19 more" in message
    assert "diameter_mm = 60 is too small" in message


def test_series_that_ends_too_early() -> None:
    with pytest.raises(DetailError, match=r"node N-0000 .* 90.0 deg, .*86.9 mm; the series ends"):
        vertical(grid(1, 1)).detail(
            beam={"profile": "RHS 120x60x5"}, node={"series_mm": [40.0, 60.0]}
        )


def skewed(degrees: float) -> Case:
    """One rhombus whose sharp angle is given."""
    a = math.radians(degrees)
    x = np.array([1500.0, 0.0, 0.0])
    y = 1500 * np.array([math.cos(a), math.sin(a), 0.0])
    return vertical(Mesh.build([0 * x, x, x + y, y], [[0, 1, 2, 3]]))


def test_arms_too_close_fail_a_check_and_are_named() -> None:
    shell = skewed(20.0).detail(panel=NO_GLASS)
    failed = [(mark, c.name, c.value) for mark, c in shell.failures()]
    assert failed == [
        ("N-0000", "least_angle_deg", pytest.approx(20)),
        ("N-0002", "least_angle_deg", pytest.approx(20)),
    ]
    assert len(shell.problems) == 1
    assert "B-0000 and B-0003 at N-0000 (20.0 deg)" in shell.problems[0]
    assert not list(skewed(26.0).detail(panel=NO_GLASS).failures())


def test_lean_beyond_the_limit_is_a_failing_check() -> None:
    mesh = grid(1, 1)
    tilt = math.radians(31)
    axes = np.tile([math.sin(tilt), 0.0, math.cos(tilt)], (4, 1))
    shell = Case(mesh, axes).detail(panel=NO_GLASS)
    failed = [(mark, c.name) for mark, c in shell.failures()]
    assert failed == [(f"N-000{k}", "lean_deg") for k in range(4)]
    assert not list(
        Case(mesh, axes).detail(panel=NO_GLASS, support={"lean_limit_deg": 32}).failures()
    )


def test_tube_walls_and_threads() -> None:
    shell = vertical(grid(2, 2)).detail(
        beam={"profile": "RHS 80x60x4"},
        node={"kind": "tube", "wall_mm": 30},
        connection={"kind": "stud"},
        panel=NO_GLASS,
    )
    shape = shell.nodes[4].shape
    assert shape.bore == shape.radius - 30
    assert shape.seats[0].distance - shape.bore >= 12  # a thread as long as its diameter
    assert [hole.depth for hole in shape.holes] == [None] * 4
    assert [hole.diameter for hole in shape.holes] == [10.2] * 4
    assert [hole.z for hole in shape.holes] == [-40.0] * 4


def test_blind_holes_do_not_meet() -> None:
    shell = vertical(grid(2, 2)).detail(
        beam={"profile": "FL 80x40"},
        connection={"kind": "stud"},
        panel=NO_GLASS,
    )
    shape = shell.nodes[4].shape
    for seat, hole in zip(shape.seats, shape.holes, strict=True):
        assert hole.depth is not None
        tip = seat.distance - hole.depth  # neighbours at 90 deg meet where the tip is d/2 away
        assert 12 + 3.5 <= hole.depth <= 18 + 3.5  # thread, and two pitches of run-out
        assert tip >= 10.2 / 2 + 3 - 1e-9


STAR = (0.0, 40.0, 115.0, 165.0, 245.0, 290.0)
"""Azimuths [deg] of beams around a node: narrow and wide gaps take turns."""


def star(azimuths: tuple[float, ...], *, mirrored: bool) -> Case:
    """Triangles round an apex; rim vertex k + 1 at azimuth k, or all reflected in y = 0."""
    angles = np.radians(azimuths)
    side = -1.0 if mirrored else 1.0
    ring = 1500.0 * np.stack([np.cos(angles), side * np.sin(angles), 0 * angles], axis=-1)
    count = len(azimuths)
    faces = [[0, 1 + k, 1 + (k + 1) % count] for k in range(count)]
    turned = [face[::-1] for face in faces] if mirrored else faces
    return vertical(Mesh.build(np.vstack([np.zeros((1, 3)), ring]), turned))


def depths_of(case: Case) -> tuple[dict[int, float], float]:
    """Depth [mm] of the apex's tapped hole towards each rim vertex, and its seats' distance."""
    shell = case.detail(
        beam={"profile": "FL 80x40"},
        connection={"kind": "stud"},
        panel=NO_GLASS,
    )
    node = shell.nodes[0]
    found = {}
    for arm, hole in zip(node.arms, node.shape.holes, strict=True):
        assert hole.depth is not None
        found[int(case.mesh.edges[arm.edge].max())] = hole.depth
    return found, node.shape.seats[0].distance


def test_blind_holes_heed_both_neighbours() -> None:
    """Two rays of width d at the angle phi leave each other at (d / 2) / tan(phi / 2)."""
    found, seat = depths_of(star(STAR, mirrored=False))
    gaps = [min((a - o) % 360, (o - a) % 360) for a in STAR for o in STAR if o != a]
    room = seat - 10.2 / 2 / math.tan(math.radians(min(gaps)) / 2) - 3.0
    assert set(found.values()) == {min(18.0 + 3.5, math.floor(2 * room) / 2)}


@pytest.mark.parametrize("mirrored", [False, True])
def test_both_beams_of_a_narrow_gap_are_named(mirrored: bool) -> None:
    """Gaps of 40 and 45 deg are too narrow for this thread, so two holes each are too shallow."""
    case = star(STAR, mirrored=mirrored)
    with pytest.raises(DetailError) as caught:
        case.detail(
            beam={"profile": "FL 80x40"},
            connection={"kind": "stud", "thread_mm": 40},
            node={"diameter_mm": 124},
            panel=NO_GLASS,
        )
    rows = re.findall(r"beam B-(\d+) can be ([\d.]+) mm deep", str(caught.value))
    rims = {int(case.mesh.edges[int(edge)].max()) - 1: depth for edge, depth in rows}
    assert rims == {0: "41.7", 1: "41.7", 4: "43.4", 5: "43.4"}


def test_a_reflected_node_has_the_same_holes() -> None:
    """A rule that looks to one side only makes another node of the mirror image."""
    mirrored, seat = depths_of(star(STAR, mirrored=True))
    found, same = depths_of(star(STAR, mirrored=False))
    assert mirrored == pytest.approx(found)
    assert seat == pytest.approx(same)


@pytest.mark.parametrize(
    ("sections", "words"),
    [
        (
            {
                "beam": {"profile": "FL 80x40"},
                "node": {"diameter_mm": 60},
                "connection": {"kind": "stud"},
            },
            ["N-0001: the hole for beam B-0002", "M12 needs 15.5", "diameter_mm = 65"],
        ),
        (
            {
                "beam": {"profile": "FL 80x40"},
                "node": {"kind": "tube", "wall_mm": 15, "diameter_mm": 88.9},
                "connection": {"kind": "stud"},
            },
            ["N-0000: the thread for beam B-0000 has", "M12 needs 12 mm", "wall_mm = 1"],
        ),
        ({"node": {"kind": "tube", "wall_mm": 30, "diameter_mm": 50}}, ["no bore left"]),
        (
            {
                "beam": {"profile": "FL 60x40"},
                "node": {"kind": "tube", "wall_mm": 4, "diameter_mm": 70},
            },
            ["of the wall of a tube"],
        ),
    ],
)
def test_nodes_that_cannot_be_made(sections: dict[str, object], words: list[str]) -> None:
    with pytest.raises(DetailError) as caught:
        vertical(grid(2, 2)).detail(**sections)
    assert all(word in str(caught.value) for word in words), str(caught.value)


def test_motions_of_the_whole_change_no_shape() -> None:
    case = dome()
    turn = Rotation.from_rotvec([0.3, -1.0, 0.7]).as_matrix()
    moved = Case(
        case.mesh.with_vertices(case.mesh.vertices @ turn.T + [1e3, -2e3, 5e2]), case.axes @ turn.T
    )
    for a, b in zip(case.detail().nodes, moved.detail().nodes, strict=True):
        assert a.shape.z0 == pytest.approx(b.shape.z0, abs=1e-6)
        assert [s.azimuth for s in a.shape.seats] == pytest.approx(
            [s.azimuth for s in b.shape.seats]
        )
        assert np.allclose(turn @ a.placement[:3, :3], b.placement[:3, :3])


def test_the_repr_says_it_in_one_line() -> None:
    text = repr(central(grid(1, 1), (0, 0, -5000.0)).detail())
    assert "4 beams FL 60x8" in text
    assert "4 nodes d 40 mm" in text
    assert "\n" not in text
