"""Panels: joints measured in the world, square and mitred sides, offsets, limits, refusals."""

from __future__ import annotations

import math

import numpy as np
import pytest
from detailing_cases import Case, central, dome, grid, hexagons, placed, vertical

from ddgfab.errors import DetailError
from ddgfab.mesh import Floats, Mesh
from fabrication.gridshell.detailing.clearance import steel_heights
from fabrication.gridshell.detailing.frames import edge_frames
from fabrication.gridshell.detailing.gridshell import Gridshell
from fabrication.gridshell.detailing.panels import face_planes
from fabrication.gridshell.detailing.places import NO_GROUPS, Net
from fabrication.gridshell.detailing.sections import beam_sections
from fabrication.gridshell.pieces import Panel
from fabrication.solids.polygon import area, least_rectangle, turns


def side(panel: Panel, edge: int, outer: bool) -> Floats:
    """World end points of a panel's side at the inner or outer surface."""
    k = [s.edge for s in panel.sides].index(edge)
    polygon = panel.shape.outer if outer else panel.shape.inner
    ends = np.stack([polygon[k], polygon[(k + 1) % len(polygon)]])
    z = panel.shape.thickness if outer else 0.0
    return placed(panel.placement, np.column_stack([ends, [z, z]]))


def distances(shell: Gridshell, edge: int, face: int, outer: bool) -> Floats:
    """Distances of a side's ends from pi(e), positive into the face."""
    beam = shell.beams[edge]
    normal = beam.placement[:3, 1]
    if shell.mesh.edge_faces[edge, 0] != face:
        normal = -normal
    points = side(shell.panels[face], edge, outer)
    return (points - shell.mesh.vertices[beam.vertices[0]]) @ normal


def test_flat_grid_by_hand() -> None:
    shell = vertical(grid(2, 2)).detail(panel={"gap_mm": 20.0, "thickness_mm": 16.0})
    # Beams end at z = 0, nodes at 1; plus 3 mm -> 5 mm.
    assert shell.offset == 5.0
    for panel in shell.panels:
        corners = placed(panel.placement, np.column_stack([panel.shape.inner, np.zeros(4)]))
        low = shell.mesh.vertices[shell.mesh.face(panel.face)].min(axis=0)
        assert np.allclose(corners.min(axis=0) - low, [10, 10, 5])
        assert np.allclose(np.ptp(corners, axis=0), [1480, 1480, 0])
        assert np.array_equal(panel.shape.inner, panel.shape.outer)
        assert (panel.planarity_class, panel.planarity_percent) == ("flat", 0.0)


@pytest.mark.parametrize("edge", ["square", "mitred"])
@pytest.mark.parametrize("at", ["tightest", "inner", "outer"])
@pytest.mark.parametrize("make", [dome, lambda: central(hexagons().mesh, (0, 0, -5e3))])
def test_the_joint_is_the_gap_at_the_stated_level(edge: str, at: str, make: object) -> None:
    assert callable(make)
    shell = make().detail(panel={"edge": edge, "gap_at": at, "gap_mm": 14.0, "offset_mm": 30.0})
    for e, faces in enumerate(shell.mesh.edge_faces.tolist()):
        for face in faces:
            if face < 0:
                continue
            inner, outer = (distances(shell, e, face, level) for level in (False, True))
            if edge == "mitred":
                assert np.allclose(inner, 7) and np.allclose(outer, 7)  # noqa: PT018
            elif at == "tightest":
                assert np.minimum(inner, outer) == pytest.approx([7, 7], abs=1e-9)
            else:
                assert (inner if at == "inner" else outer) == pytest.approx([7, 7], abs=1e-9)


def test_mitred_sides_are_parallel_to_pi_and_square_ones_perpendicular() -> None:
    shell = dome().detail(panel={"edge": "mitred"})
    for panel in shell.panels:
        assert not np.allclose(panel.shape.inner, panel.shape.outer)
        for s in panel.sides:
            low, high = side(panel, s.edge, False), side(panel, s.edge, True)
            normal = np.cross(low[1] - low[0], high[0] - low[0])
            across = np.cross(normal, shell.beams[s.edge].placement[:3, 1])
            assert np.linalg.norm(across) < 1e-9 * np.linalg.norm(normal)
            assert np.linalg.norm(np.cross(low[1] - low[0], high[1] - high[0])) < 1e-3


def test_panes_lie_above_their_faces_and_clear_the_steel() -> None:
    case = dome()
    for profile in ("FL 60x8", "RHS 120x60x5"):
        shell = case.detail(beam={"profile": profile})
        assert shell.offset % 5 == 0
        highest = -math.inf
        for panel in shell.panels:
            center = panel.placement[:3, 3]
            normal = panel.placement[:3, 2]
            expected = case.mesh.face_centers[panel.face] + shell.offset * normal
            assert np.allclose(center, expected)
            assert normal @ case.mesh.face_normals[panel.face] > 0.99
            for s, vertex in zip(panel.sides, case.mesh.face(panel.face), strict=True):
                beam = shell.beams[s.edge]
                sign = 1 if case.mesh.edge_faces[s.edge, 0] == panel.face else -1
                half = sign * beam.shape.profile.width / 2
                ends = np.array([[0, half, 0], [beam.length_axis, half, 0]])
                points = placed(beam.placement, ends)
                node = shell.nodes[vertex]
                ring = 2 * math.pi * np.arange(720) / 720
                r = node.shape.radius
                rim = np.column_stack(
                    [r * np.cos(ring), r * np.sin(ring), 0 * ring + node.shape.z1]
                )
                points = np.vstack([points, placed(node.placement, rim)])
                highest = max(highest, float(((points - center) @ normal).max()))
        # 3 mm are kept, and the next lower multiple of 5 mm would not keep them
        assert -8 - 1e-2 < highest <= -3 + 1e-9


def test_steel_includes_the_near_flank_of_wide_beams() -> None:
    # Nodes shrunk to nothing: what is left are the top edges of the beams on the face's side.
    case = dome()
    shell = case.detail(beam={"profile": "FL 60x40"})
    frames, planes = edge_frames(case.mesh, case.axes), face_planes(case.mesh)
    heights = steel_heights(
        case.mesh,
        case.axes,
        planes,
        frames,
        np.full(case.mesh.n_vertices, -1e3),
        np.zeros(case.mesh.n_vertices),
        beam_sections(Net(case.mesh, NO_GROUPS, shell.project.ground), shell.project),
        shell.project,
    )
    for panel in shell.panels:
        tops = []
        for s in panel.sides:
            beam = shell.beams[s.edge]
            half = 20.0 if case.mesh.edge_faces[s.edge, 0] == panel.face else -20.0
            points = placed(beam.placement, np.array([[0, half, 0], [beam.length_axis, half, 0]]))
            tops += ((points - planes.origin[panel.face]) @ planes.z[panel.face]).tolist()
        assert heights[panel.face] == pytest.approx(max(tops))
        assert max(tops) > 0.1


def test_offset_is_capped_and_said() -> None:
    case = dome()
    shell = case.detail(beam={"eccentricity_mm": 100.0})
    assert shell.offset == 60.0
    assert "P-" in shell.problems[0]
    assert "60 mm is taken" in shell.problems[0]
    assert case.detail(panel={"offset_mm": 87.5}).offset == 87.5


def test_dihedral_of_a_ridge() -> None:
    # Two squares that fall by 30 deg each from a common edge: 60 deg, convex from above.
    c, s = 1500 * math.cos(math.pi / 6), 1500 * math.sin(math.pi / 6)
    ridge = [[-c, 0, -s], [0, 0, 0], [c, 0, -s], [-c, 1500, -s], [0, 1500, 0], [c, 1500, -s]]
    mesh = Mesh.build(ridge, [[0, 1, 4, 3], [1, 2, 5, 4]])
    for sign, points in ((1, mesh), (-1, mesh.with_vertices(mesh.vertices * [1, 1, -1]))):
        shell = vertical(points).detail(panel={"offset_mm": 30})
        inner = [s for p in shell.panels for s in p.sides if s.neighbour is not None]
        assert [s.dihedral for s in inner] == pytest.approx([sign * math.pi / 3] * 2)
        assert {s.neighbour for s in inner} == {"P-0000", "P-0001"}


def test_planarity_classes_and_limits() -> None:
    # One corner of a 1500 mm square lifted by h: the diagonals pass each other at about h/2,
    # over their length 2121 mm; the corners lie h/4 from the best plane.
    def lifted(h: float, **sections: object) -> Gridshell:
        mesh = grid(1, 1)
        v = mesh.vertices.copy()
        v[3, 2] = h
        return vertical(mesh.with_vertices(v)).detail(**sections)

    flat = lifted(8.0)
    panel = flat.panels[0]
    assert panel.planarity_percent == pytest.approx(100 * 4 / 2121.3, rel=1e-3)
    assert panel.planarity_mm == pytest.approx(2.0, rel=1e-3)
    assert (panel.planarity_class, list(flat.failures())) == ("flat", [])
    bent = lifted(40.0)
    assert bent.panels[0].planarity_class == "cold-bend"
    assert [(m, c.name) for m, c in bent.failures()] == [("P-0000", "planarity_percent")]
    assert "1 panels are not flat, 1 of them for cold bending" in bent.problems[0]
    assert "P-0000 0.94 % is 10.0 mm from its plane, a corner lift of 40.0 mm" in bent.problems[0]
    assert flat.problems == ()
    assert not list(lifted(40.0, checks={"accept": "cold-bend"}).failures())
    assert lifted(45.0).panels[0].planarity_class == "reject"
    assert list(lifted(45.0, checks={"accept": "cold-bend"}).failures())
    strict = lifted(8.0, checks={"planarity_mm": 1.5})
    assert [c.name for _, c in strict.failures()] == ["planarity_mm"]
    assert not list(lifted(45.0, panel={"kind": "none"}).failures())


def test_size_limit_by_the_least_rectangle() -> None:
    case = vertical(grid(1, 1, side=3000.0))
    assert not list(case.detail().failures())
    failed = list(case.detail(panel={"max_size_mm": [2980.0, 6000.0]}).failures())
    assert [(m, c.name, c.value) for m, c in failed] == [("P-0000", "size_mm", "2988.0 x 2988.0")]


def test_no_panels_on_request() -> None:
    shell = vertical(grid(2, 1)).detail(panel={"kind": "none"})
    assert shell.panels == ()
    assert all(beam.panels == (None, None) for beam in shell.beams)


@pytest.mark.parametrize(
    ("panel", "words"),
    [
        ({"gap_mm": 1500.0}, ["P-0000", "1500 mm", "edge 0", "P-0001", "P-0002"]),
        ({"gap_mm": 4000.0}, ["P-0000", "leaves nothing"]),
        ({"corner_radius_mm": 744.0}, ["P-0000", "radius 744 mm", "1488.0"]),
        ({"corner_radius_mm": 2000.0}, ["P-0000"]),
    ],
)
def test_panes_that_vanish(panel: dict[str, object], words: list[str]) -> None:
    with pytest.raises(DetailError) as caught:
        vertical(grid(3, 1)).detail(panel=panel)
    assert all(word in str(caught.value) for word in words), str(caught.value)


def test_corner_radius_that_fits() -> None:
    shell = vertical(grid(1, 1)).detail(panel={"corner_radius_mm": 743.0})
    assert shell.panels[0].shape.corner_radius == 743.0


def straight(second_axis: float) -> Case:
    """A rectangle with a fifth corner in the middle of a side, whose axis is tilted across it."""
    mesh = Mesh.build(
        [[0, 0, 0], [1000, 0, 0], [2000, 0, 0], [2000, 1000, 0], [0, 1000, 0]], [[0, 1, 2, 3, 4]]
    )
    axes = vertical(mesh).axes.copy()
    axes[1] = [0, math.sin(second_axis), math.cos(second_axis)]
    axes[2] = [0, math.sin(2 * second_axis), math.cos(2 * second_axis)]
    return Case(mesh, axes)


def test_straight_corners() -> None:
    polygon = straight(0.0).detail().panels[0].shape.inner
    assert polygon[1] == pytest.approx((polygon[0] + polygon[2]) / 2)
    with pytest.raises(DetailError, match="straight corner at vertex 1"):
        straight(0.02).detail(panel={"offset_mm": 30.0})


def test_outline_helpers() -> None:
    angle = 0.4
    turn = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
    box = np.array([[0, 0], [30, 0], [30, 20], [0, 20.0]]) @ turn.T
    assert least_rectangle(box) == pytest.approx([20, 30])
    assert area(box) == pytest.approx(600)
    assert area(box, 5.0) == pytest.approx(600 - (4 - math.pi) * 25)
    assert turns(box) == pytest.approx([math.pi / 2] * 4)
    ell = np.array([[0, 0], [20, 0], [20, 10], [10, 10], [10, 20], [0, 20.0]])
    assert area(ell) == pytest.approx(300)
    # five convex corners give, one reflex corner takes back
    assert area(ell, 2.0) == pytest.approx(300 - 4 * (4 - math.pi))
    assert least_rectangle(np.stack([box, box + 5])).shape == (2, 2)
