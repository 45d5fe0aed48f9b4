"""Families: rotated copies found and placed, mirrored ones not, tolerance and noise respected."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from detailing_cases import dome, fan, grid, placed, vertical
from family_pieces import beam, marks, node, panel

from ddgfab.mesh import Floats
from fabrication.families import families
from fabrication.gridshell.pieces import Node
from fabrication.parts.beam import BeamShape, EndCut, fibre_ends
from fabrication.parts.node import NodeShape, RadialHole
from fabrication.parts.panel import PanelShape, panel_variants
from fabrication.specs import Family, Piece
from fabrication.standards import polygon
from fabrication.standards.profiles import z_range


def rotated(points: Floats, angle: float, shift: tuple[float, float] = (0.0, 0.0)) -> Floats:
    c, s = math.cos(angle), math.sin(angle)
    return points @ np.array([[c, s], [-s, c]]) + shift


TRAPEZE = np.array([[0, 0], [900, 0], [700, 500], [100, 620.0]])


def points_of(piece: Piece, shape: object) -> Floats:
    """Characteristic points of a shape, unordered comparison is the caller's."""
    if isinstance(shape, PanelShape):
        n = len(shape.inner)
        return np.vstack(
            [
                np.column_stack([shape.inner, np.zeros(n)]),
                np.column_stack([shape.outer, np.full(n, shape.thickness)]),
            ]
        )
    if isinstance(shape, BeamShape):
        start, end = fibre_ends(shape)
        z = np.tile(z_range(shape.profile), len(start) // 2)
        w = shape.profile.width / 2
        return np.vstack(
            [np.column_stack([x, 0 * x + y, z]) for x in (start, end) for y in (-w, w)]
        )
    assert isinstance(shape, NodeShape)
    rows = [
        [shape.radius * math.cos(s.azimuth), shape.radius * math.sin(s.azimuth), z]
        for s in shape.seats
        for z in (shape.z0, shape.z1)
    ]
    return np.array([*rows, [0, 0, shape.z0], [0, 0, shape.z1]])


def check_placements(pieces: tuple[Piece, ...], found: tuple[Family, ...], slack: float) -> int:
    """Family shapes, placed, cover the pieces' own points; returns how many were turned."""
    by_mark = {piece.mark: piece for piece in pieces}
    turned = 0
    for family in found:
        for instance in family.instances:
            piece = by_mark[instance.mark]
            own = placed(piece.placement, points_of(piece, piece.shape))
            theirs = placed(instance.placement, points_of(piece, family.shape))
            apart = np.linalg.norm(own[:, None] - theirs[None], axis=2)
            assert max(apart.min(axis=0).max(), apart.min(axis=1).max()) <= family.deviation + slack
            rotation = instance.placement[:3, :3]
            assert np.allclose(rotation @ rotation.T, np.eye(3), atol=1e-12)
            assert np.linalg.det(rotation) > 0
            turned += not np.allclose(rotation, piece.placement[:3, :3], atol=1e-3)
    return turned


def test_rotated_and_relabelled_panels_are_one_family() -> None:
    outer = TRAPEZE * 1.01
    pieces = tuple(
        panel(
            k,
            np.roll(rotated(TRAPEZE, 0.7 * k, (k, -3.0 * k)), k, axis=0),
            np.roll(rotated(outer, 0.7 * k, (k, -3.0 * k)), k, axis=0),
        )
        for k in range(6)
    )
    found = families(pieces)
    assert marks(found) == [[p.mark for p in pieces]]
    assert found[0].number == "PP-001"
    assert found[0].shape is pieces[0].shape
    assert found[0].deviation < 1e-9
    assert check_placements(pieces, found, 1e-8) == 5


def test_mirrored_panels_are_another_family() -> None:
    mirrored = (TRAPEZE * [-1, 1])[::-1]
    assert len(families([panel(0, TRAPEZE), panel(1, mirrored)])) == 2
    kite = np.array([[0, -300], [400, 0], [0, 500], [-400, 0.0]])  # its own mirror image
    assert len(families([panel(0, kite), panel(1, (kite * [-1, 1])[::-1])])) == 1


def test_thickness_sides_and_corners_tell_panels_apart() -> None:
    square = [panel(0, TRAPEZE), panel(1, TRAPEZE, thickness=12.0), panel(2, TRAPEZE[:3])]
    mitred = panel(3, TRAPEZE, TRAPEZE * 1.001)
    assert len(families([*square, mitred])) == 4


def test_a_polygon_without_first_coefficient_still_has_a_frame() -> None:
    # Equilateral up to the first Fourier coefficient: three-fold symmetric with six corners.
    angle = 2 * np.pi * np.arange(6) / 6
    star = np.stack([np.cos(angle), np.sin(angle)], axis=1) * np.tile([500.0, 300.0], 3)[:, None]
    pieces = (panel(0, star), panel(1, np.roll(rotated(star, 1.0), 1, axis=0)))
    assert len(families(pieces)) == 1
    bow = np.array([[0, 0], [10, 0], [10, 10], [0, 10.0]])
    one = panel_variants([panel(0, bow[[0, 2, 1, 3]]).shape])  # crossing: coefficient zero
    assert np.isfinite(one.points).all()


def test_beams_turn_end_for_end_only_with_a_symmetric_profile() -> None:
    a, b = EndCut(20.0, -0.1), EndCut(1480.0, 0.05)
    back = (EndCut(20.0, -0.05), EndCut(1480.0, 0.1))
    pieces = (beam(0, a, b), beam(1, *back))
    found = families(pieces)
    assert marks(found) == [["B-0000", "B-0001"]]
    assert check_placements(pieces, found, 1e-8) == 1
    skew = polygon([[0, 0], [20, 0], [5, -40]])
    lopsided = [replace(p, shape=replace(p.shape, profile=skew)) for p in pieces]
    assert len(families(lopsided)) == 2


def test_upside_down_beams_are_another_family() -> None:
    pieces = [
        beam(0, EndCut(20, -0.1), EndCut(900, 0.1)),
        beam(1, EndCut(20, 0.1), EndCut(900, -0.1)),
    ]
    assert len(families(pieces)) == 2


def test_profiles_and_cut_radii_must_agree() -> None:
    flat = beam(0, EndCut(20, 0.0), EndCut(900, 0.0))
    coped = beam(1, EndCut(20, 0.0, 30.0), EndCut(900, 0.0, 30.0))
    other = beam(2, EndCut(20, 0.0), EndCut(900, 0.0), "FL 60x10")
    assert len(families([flat, coped, other])) == 3


def test_nodes_turn_about_their_axis_and_slide_along_it() -> None:
    azimuths = [0.0, 1.3, 2.9, 4.4]
    # The same gaps 1.3, 1.6, 1.5, 1.883 counted from the second arm, 7 mm lower.
    gaps = np.diff([*azimuths, 2 * math.pi])
    later = [0.0, *np.cumsum(np.roll(gaps, -1))[:-1].tolist()]
    pieces = (node(0, azimuths), node(1, later, z0=-67.0))
    found = families(pieces)
    assert marks(found) == [["N-0000", "N-0001"]]
    assert check_placements(pieces, found, 1e-8) == 1
    mirrored = node(2, [0.0, *np.cumsum(gaps[::-1])[:-1].tolist()])
    assert len(families([pieces[0], mirrored])) == 2
    assert len(families([pieces[0], node(3, azimuths, radius=20.5)])) == 2


@pytest.mark.parametrize("what", ["z", "depth"])
def test_heights_and_depths_of_holes_go_round_with_the_arms(what: str) -> None:
    """A node counted from another arm is the same; with two holes exchanged it is another."""
    azimuths = [0.0, 1.3, 2.9, 4.4]
    values = [5.0, 7.0, 8.5, 12.0]

    def drilled(number: int, first: int, at: list[float]) -> Node:
        piece = node(number, [azimuths[(first + k) % 4] - azimuths[first] for k in range(4)])
        hole = RadialHole(0.0, -20.0, 4.0, 6.0)
        holes = tuple(
            replace(
                hole, azimuth=seat.azimuth, **{what: at[(first + k) % 4] - 20.0 * (what == "z")}
            )
            for k, seat in enumerate(piece.shape.seats)
        )
        return replace(piece, shape=replace(piece.shape, holes=holes))

    same = [drilled(k, k, values) for k in range(4)]
    found = families(same)
    assert marks(found) == [["N-0000", "N-0001", "N-0002", "N-0003"]]
    assert check_placements(same, found, 1e-8) == 3
    assert len(families([same[0], drilled(4, 0, [7.0, 5.0, 8.5, 12.0])])) == 2


@pytest.mark.parametrize("make", ["panel", "beam", "node"])
def test_tolerance(make: str) -> None:
    def piece(k: int, d: float) -> Piece:
        if make == "panel":
            corners = TRAPEZE.copy()
            corners[2] += [d, 0]
            return panel(k, corners)
        if make == "beam":
            return beam(k, EndCut(20, 0.0), EndCut(900 + d, 0.2))
        return node(k, [0.0, 1.3 + d / 20.0, 3.0])

    assert len(families([piece(0, 0.0), piece(1, 0.06)], 0.1)) == 1
    assert len(families([piece(0, 0.0), piece(1, 0.3)], 0.1)) == 2
    assert len(families([piece(0, 0.0), piece(1, 0.06)], 0.001)) == 2
    assert len(families([piece(0, 0.0), piece(1, 0.0)], 0.0)) == 1
    close = families([piece(0, 0.0), piece(1, 0.06)], 0.1)[0]
    assert 0.02 < close.deviation <= 0.1


@pytest.mark.parametrize(("part", "together"), [(0.999, True), (1.001, False)])
@pytest.mark.parametrize("tolerance", [0.1, 0.02])
def test_just_inside_and_just_outside_the_tolerance(
    tolerance: float, part: float, together: bool
) -> None:
    """Distances are Euclidean, and no more than the tolerance."""
    off = part * tolerance

    def rectangle(wide: float) -> Floats:
        x, y = 450.0 + wide, 250.0
        return np.array([[-x, -y], [x, -y], [x, y], [-x, y]])

    # Every corner moves by `off`, along a diagonal of the frame in which panels are compared: in
    # either coordinate there the distance is only 0.71 of it.
    panels = families([panel(0, rectangle(0.0)), panel(1, rectangle(off))], tolerance)
    assert (len(panels) == 1) == together
    # Both ends of a beam move by `off`, away from its middle.
    beams = [beam(k, EndCut(20.0 - d, 0.0), EndCut(900.0 + d, 0.0)) for k, d in enumerate((0, off))]
    assert (len(families(beams, tolerance)) == 1) == together
    # The land of a node is higher by `off`.
    high = replace(node(1, [0.0, 2.0]).shape, z1=5.0 + off)
    nodes = [node(0, [0.0, 2.0]), replace(node(1, [0.0, 2.0]), shape=high)]
    assert (len(families(nodes, tolerance)) == 1) == together
    if together:
        assert panels[0].deviation == pytest.approx(off)


def test_deviation_is_measured_on_the_corners() -> None:
    found = families(
        [beam(0, EndCut(20, 0.0), EndCut(900, 0.0)), beam(1, EndCut(20, 0.0), EndCut(900.1, 0.0))]
    )
    assert found[0].deviation == pytest.approx(0.05)  # shared between both ends


@pytest.mark.parametrize("end", ["flat", "cope"])
def test_whole_structures(end: str) -> None:
    shell = dome().detail(beam={"end": end}, panel={"edge": "mitred"})
    found = families(shell.pieces)
    named = [i.mark for f in found for i in f.instances]
    assert sorted(named) == sorted(piece.mark for piece in shell.pieces)
    assert len({f.number for f in found}) == len(found)
    assert max(f.deviation for f in found) <= 0.1
    check_placements(shell.pieces, found, 1e-6)


def test_symmetric_structures_have_few_families() -> None:
    # A grid of squares: one beam, one panel; nodes at corners, sides and inside.
    shell = vertical(grid(5, 4)).detail()
    found = families(shell.pieces)
    assert [f.number for f in found] == ["BP-001", "NP-001", "NP-002", "NP-003", "PP-001"]
    assert [len(f.instances) for f in found] == [49, 4, 14, 12, 20]
    check_placements(shell.pieces, found, 1e-6)
    # Six equal triangles: spokes and rim beams, apex and rim nodes, one panel.
    fan_shell = fan(6, True).detail(panel={"offset_mm": 40.0})
    roles = [f.role for f in families(fan_shell.pieces)]
    assert roles == ["beam", "beam", "node", "node", "panel"]


def test_noise_changes_nothing() -> None:
    case = dome()
    shell = case.detail()
    rng = np.random.default_rng(3)
    noisy = replace(
        case, mesh=case.mesh.with_vertices(case.mesh.vertices + rng.normal(0, 1e-12, (42, 3)))
    )
    assert marks(families(shell.pieces)) == marks(families(noisy.detail().pieces))
    squares = vertical(grid(4, 4))
    shaken = squares.mesh.vertices + rng.normal(0, 1e-12, (25, 3))
    first = families(squares.detail().pieces)
    second = families(replace(squares, mesh=squares.mesh.with_vertices(shaken)).detail().pieces)
    assert marks(first) == marks(second)
    for a, b in zip(first, second, strict=True):
        for i, j in zip(a.instances, b.instances, strict=True):
            assert np.allclose(i.placement, j.placement, atol=1e-9)
