"""Kits in parts: places, gaps and pins in every pose, numbers, every check through the shop."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations, pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from linkage_cases import kit
from scipy.spatial import cKDTree
from test_linkage_levels import box, loop, net

from ddgfab.errors import DetailError
from ddgfab.linkages import Mechanism, knet_mechanism
from ddgfab.nets.knet import amsler
from fabrication.checks.mesh import to_manifold
from fabrication.families import families
from fabrication.formats.base import Header, Material, Provenance
from fabrication.formats.registry import find
from fabrication.job.part import Shop, make_part, read_back
from fabrication.linkage.detail import detail_linkage, touching_parts
from fabrication.linkage.facing import facings
from fabrication.linkage.labels import short_number
from fabrication.linkage.levels import slanted_levels
from fabrication.linkage.links import Linkage, hinge_frames
from fabrication.linkage.pieces import Fitting, Link, Pin
from fabrication.linkage.settings import settings_for
from fabrication.parts.link import LINK, LinkShape
from fabrication.parts.pin import PinShape
from fabrication.parts.ring import SPACER, RingShape
from fabrication.solids import boundary_of, mesh_of
from fabrication.solids.text import Label


def angles(mechanism: Mechanism, count: int) -> np.ndarray:
    low, high = mechanism.limits
    return low + (high - low) * (np.arange(count) + 0.5) / count


KITS = {
    "loop": lambda: kit(),
    "loop printed": lambda: kit(pin="printed", printer_key="sls"),
    "net": lambda: kit(net(2, 2)),
    "wide net": lambda: kit(
        knet_mechanism(amsler([0.3, 0.5], [0.4, 0.35, 0.3], 1.7), scale_mm=200)
    ),
}


@pytest.fixture(scope="module", params=KITS)
def made(request: pytest.FixtureRequest) -> Linkage:
    return KITS[request.param]()


def test_eyes_pins_and_fittings_are_coaxial_in_every_pose(made: Linkage) -> None:
    mechanism = made.mechanism
    shapes = {piece.mark: piece for piece in made.pieces}
    for t in angles(mechanism, 25):
        pose = mechanism.pose(t)
        for mark, at in made.placements_at(pose).items():
            piece = shapes[mark]
            assert np.abs(at[:3, :3] @ at[:3, :3].T - np.eye(3)).max() < 1e-12
            assert np.linalg.det(at[:3, :3]) > 0
            if isinstance(piece, Link):
                boundary = boundary_of(piece.shape)
                assert boundary is not None
                bore = boundary.face_radius == piece.shape.bores[0] / 2
                places = boundary.face_origin[bore] @ at[:3, :3].T + at[:3, 3]
                axes = boundary.face_axis[bore] @ at[:3, :3].T
                hinges = np.repeat(piece.hinges, 2)
                away = places - pose.points[hinges]
                off = np.cross(away, pose.axes[hinges])
                assert np.abs(off).max() < 1e-6
                assert np.abs(np.cross(axes, pose.axes[hinges])).max() < 1e-9
            else:
                assert isinstance(piece, Pin | Fitting)
                axis = pose.axes[piece.hinge]
                away = at[:3, 3] - pose.points[piece.hinge]
                assert np.abs(np.cross(away, axis)).max() < 1e-9
                assert np.abs(np.cross(at[:3, 2], axis)).max() < 1e-12


def test_stacks_keep_the_gap_and_pins_hold_them(made: Linkage) -> None:
    """From meshes in place: what is on a pin is in the order said, with the gap between."""
    mechanism, settings = made.mechanism, made.settings
    pose = mechanism.pose(mechanism.design)
    placed = made.placements_at(pose)
    shapes = {piece.mark: piece.shape for piece in made.pieces}

    def span(mark: str, hinge: int) -> tuple[float, float]:
        shape, at = shapes[mark], placed[mark]
        points = mesh_of(shape).vertices @ at[:3, :3].T + at[:3, 3]
        along = (points - pose.points[hinge]) @ pose.axes[hinge]
        radial = np.linalg.norm(
            points - pose.points[hinge] - np.outer(along, pose.axes[hinge]), axis=1
        )
        here = radial < settings.eye_diameter / 2 + 1e-6
        return float(along[here].min()), float(along[here].max())

    for hinge, stack in enumerate(made.stacks):
        pin, *rest = stack
        assert pin.mark == f"H-{hinge:04d}"
        assert {item.mark for item in rest if item.kind == LINK} == {
            f"L-{bar:04d}" for bar in np.flatnonzero((mechanism.bars == hinge).any(axis=1))
        }
        spans = [span(item.mark, hinge) for item in rest]
        for item, (low, high) in zip(rest, spans, strict=True):
            assert (low, high) == pytest.approx((item.low, item.high), abs=1e-9)
        for (_, below), (above, _) in pairwise(spans):
            assert above - below == pytest.approx(settings.axial_gap, abs=1e-9)
        low, high = span(pin.mark, hinge)
        shape = shapes[pin.mark]
        assert isinstance(shape, PinShape)
        assert spans[-1][1] - high == pytest.approx(settings.cap_floor)  # it reaches the cap's end
        if settings.pin == "metal":
            assert low - spans[0][0] == pytest.approx(settings.cap_floor)
        else:
            assert spans[0][0] - low == pytest.approx(settings.head_height + settings.axial_gap)
            assert shape.head_diameter > settings.bore


def test_nothing_overlaps_in_the_design_pose(made: Linkage) -> None:
    """By manifold3d on the parts' own meshes, every pair of pieces; pins and bores turn freely."""
    placed = made.placements_at(made.mechanism.pose(made.mechanism.design))
    parts = {
        piece.mark: to_manifold(mesh_of(piece.shape)).transform(placed[piece.mark][:3])
        for piece in made.pieces
        if piece.mark in placed
    }
    for one, two in combinations(parts, 2):
        common = (parts[one] ^ parts[two]).volume()
        assert common < 1e-6, (one, two, common)
    assert touching_parts(made) == ()


def test_metal_pin_turns_in_its_bores(made: Linkage) -> None:
    for family in made.families:
        if isinstance(family.shape, LinkShape):
            assert family.shape.bores == (made.settings.bore,) * 2
    settings = made.settings
    assert settings.bore - settings.pin_diameter == pytest.approx(2 * settings.clearance)


def test_every_piece_has_one_number_and_links_carry_it(made: Linkage) -> None:
    marks = [instance.mark for family in made.families for instance in family.instances]
    assert sorted(marks) == sorted(piece.mark for piece in made.pieces)
    assert len(set(marks)) == len(marks)
    for family in made.families:
        assert family.deviation < 1e-6
        if isinstance(family.shape, LinkShape):
            assert family.shape.label is not None
            assert family.shape.label.text == short_number(family.number)


def test_instances_fill_the_space_of_their_pieces(made: Linkage) -> None:
    """Also where a turned part serves: the corners of the exact boundaries coincide."""
    own = {piece.mark: piece for piece in made.pieces}
    turned = 0
    for family in made.families:
        for instance in family.instances:
            piece = own[instance.mark]
            places = []
            for shape, at in (
                (family.shape, instance.placement),
                (piece.shape, piece.placement),
            ):
                boundary = boundary_of(_bare(shape))
                assert boundary is not None
                places.append(cKDTree(boundary.points @ at[:3, :3].T + at[:3, 3]))
            turned += int(not np.allclose(instance.placement, piece.placement))
            for one, two in (places, places[::-1]):
                assert one.query(two.data)[0].max() < 1e-9
    equal = made.mechanism.kind == "knet" and len(np.unique(made.mechanism.lengths.round(9))) == 1
    assert (turned > 0) == equal  # strips of one length on opposite levels share a number


def shapes_of(*links: LinkShape) -> list[Link]:
    nothing = np.eye(4)
    return [
        Link(f"L-{k:04d}", k, (0, 1), ("", ""), 0, 0, (0, 0), shape, nothing)
        for k, shape in enumerate(links)
    ]


def test_which_links_are_congruent() -> None:
    """Turned over, end for end, and both; not mirrored, not with only the bores exchanged."""
    base = LinkShape(80.0, 0.6, 3.2, -9.6, 10.0, 6.0, (3.4, 3.4), 5.0, 5.0, 1.0)
    same = [
        base,
        replace(base, start=-3.2, end=9.6),
        replace(base, start=-9.6, end=3.2),
        replace(base, start=9.6, end=-3.2),
        replace(base, label=Label("L7", 0.5, 0.5)),
    ]
    assert [len(f.instances) for f in families(shapes_of(*same), 1e-6)] == [5]
    others = [
        replace(base, twist=-0.6),
        replace(base, start=3.2, end=9.6),
        replace(base, length=80.001),
        replace(base, twist=0.6001),
        replace(base, bar_width=4.0),
        replace(base, bores=(3.4, 4.4)),
    ]
    for other in others:
        assert len(families(shapes_of(base, other), 1e-6)) == 2, other
    stepped = replace(base, bores=(3.4, 4.4))
    back = replace(stepped, bores=(4.4, 3.4), start=stepped.end, end=stepped.start)
    assert len(families(shapes_of(stepped, back), 1e-6)) == 1
    assert len(families(shapes_of(stepped, replace(back, start=3.2, end=-9.6)), 1e-6)) == 2


def _bare(shape: Any) -> Any:
    return replace(shape, label=None) if isinstance(shape, LinkShape) else shape


def test_equal_strips_of_a_net_take_two_links() -> None:
    found = kit(net(3, 3))
    links = [family for family in found.families if family.role == "link"]
    assert [len(family.instances) for family in links] == [12, 12]
    hands = [np.sign(family.shape.twist) for family in links]
    assert hands == [1.0, -1.0] or hands == [-1.0, 1.0]


def test_links_of_other_length_twist_or_level_are_other_parts() -> None:
    links = list(kit().links)
    assert len(families(links, 1e-6)) == 2
    levels = next(iter(slanted_levels(loop())))
    found = detail_linkage(loop(), settings_for(), levels)
    assert {tuple(sorted(piece.levels)) for piece in found.links} <= {
        (0, 0), (0, 1), (1, 1),
    }  # fmt: skip


def test_spacers_fill_empty_levels() -> None:
    levels = np.array([[0, 0], [0, 0], [3, 3], [3, 3]])
    found = detail_linkage(loop(), settings_for(), levels)
    rings = [p for p in found.fittings if p.kind == SPACER]
    # Levels 1 and 2 are empty: two eyes and the gap between them.
    assert len(rings) == 4
    assert all(isinstance(p.shape, RingShape) for p in rings)
    assert {round(p.shape.height, 9) for p in rings} == {12.4}
    assert [item.kind.role for item in found.stacks[0]] == [
        "pin", "cap", "link", "spacer", "link", "cap",
    ]  # fmt: skip


def test_hinge_frames_turn_with_a_bar_of_the_hinge() -> None:
    mechanism = net(2, 1)
    pose = mechanism.pose(mechanism.design)
    frames = hinge_frames(mechanism, pose)
    assert np.abs(frames[:, :3, 2] - pose.axes).max() < 1e-12
    assert np.abs(np.einsum("vji,vjk->vik", frames, frames)[:, :3, :3] - np.eye(3)).max() < 1e-9


def test_parts_that_touch_whatever_the_levels_are_named() -> None:
    mechanism = knet_mechanism(amsler([0.05, 0.05], [0.05, 0.05], 0.2), scale_mm=300)
    with pytest.raises(DetailError) as error:
        kit(mechanism)
    assert "no levels keep all parts apart" in str(error.value)
    assert "on pins H-" in str(error.value)
    assert len(str(error.value).splitlines()) <= 3


# --- through the shop ----------------------------------------------------------------------------
@pytest.mark.slow
@pytest.mark.parametrize("name", ["loop", "loop printed", "wide net"])
def test_every_part_passes_every_check_of_solid_mesh_and_files(name: str, tmp_path: Path) -> None:
    formats = (find("step"), find("stl"))
    for format in formats:
        (tmp_path / "parts" / format.name).mkdir(parents=True)
    shop = Shop(tmp_path, formats, Provenance("kit", Header()), 0.05)
    for family in KITS[name]().families:
        made = make_part(family, Material("PLA", 1240.0), shop)
        checks = (*made.checks, *read_back([made.part], shop)[0][family.number])
        assert all(check.passed for check in checks), [c for c in checks if not c.passed]


def test_a_cube_takes_three_levels() -> None:
    mechanism = box()
    levels = mechanism.directions[:, None].repeat(2, axis=1)
    found = detail_linkage(mechanism, settings_for(), levels)
    assert {len([i for i in stack if i.kind == LINK]) for stack in found.stacks} == {3}
    assert not any(p.kind == SPACER for p in found.pieces)


def test_labels_tell_how_links_go_on_their_pins(made: Linkage) -> None:
    """From the meshes in place: on which side of the bar the letters are, and towards which end."""
    pose = made.mechanism.pose(made.mechanism.design)
    hinges = {piece.mark: piece.hinges for piece in made.links}
    found = facings(made)
    assert set(found) == set(hinges)
    for family in made.families:
        if not isinstance(family.shape, LinkShape):
            continue
        corners = {tuple(p) for p in mesh_of(_bare(family.shape)).vertices.round(6).tolist()}
        points = mesh_of(family.shape).vertices
        letters = points[[tuple(p) not in corners for p in points.round(6).tolist()]]
        for instance in family.instances:
            i, j = hinges[instance.mark]
            facing = found[instance.mark]
            turn, at = instance.placement[:3, :3], instance.placement[:3, 3]
            middle = (letters @ turn.T + at).mean(axis=0)
            # Where the bar's middle line is, as seen along the mean of both axes.
            heights = made.heights[int(instance.mark[2:])]
            bar = 0.5 * (pose.points[[i, j]] + heights[:, None] * pose.axes[[i, j]]).sum(axis=0)
            above = (middle - bar) @ (pose.axes[i] + pose.axes[j])
            assert (above > 0) == facing.up
            # L is read first: letters beside each other begin with it, stacked ones have it on top.
            label = family.shape.label
            assert label is not None
            start = at
            assert facing.towards == (i if np.linalg.norm(pose.points[i] - start) > 1e-6 else j)
    if any(len(f.instances) > 6 for f in made.families if f.role == "link"):
        assert {facing.up for facing in found.values()} == {True, False}
