"""Profiles, bolts and materials from the data files."""

from __future__ import annotations

import math

import numpy as np
import pytest

from ddgfab.errors import ProjectError
from ddgfab.mesh import Floats
from fabrication.specs import Loop, Profile
from fabrication.standards import (
    density,
    lying,
    node_diameters,
    polygon,
    profile,
    stock_lengths,
    stock_size,
)
from fabrication.standards.data import table
from fabrication.standards.fasteners import fastener
from fabrication.standards.profiles import first_crossing, is_mirror, z_range


def loop_area(loop: Loop) -> float:
    """Shoelace of the corners plus the circular segments, by their own formula."""
    p, q = loop.points, np.roll(loop.points, -1, axis=0)
    total = 0.5 * float(np.sum(p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]))
    for a, b, bulge in zip(p, q, loop.bulges, strict=True):
        if bulge:
            turn = 4 * math.atan(bulge)
            radius = float(np.linalg.norm(b - a)) / (2 * math.sin(abs(turn) / 2))
            total += math.copysign(0.5 * radius**2 * (abs(turn) - math.sin(abs(turn))), turn)
    return total


def section_area(section: Profile) -> float:
    return sum(loop_area(loop) for loop in section.loops)


@pytest.mark.parametrize(
    ("name", "area"),
    [
        ("FL 60x8", 480.0),
        # RHS: outside minus inside, four corners lose (4 - pi) r^2; R = 2 t = 10, r = 5
        (
            "RHS 120x60x5",
            120 * 60 - (4 - math.pi) * 100 - (110 * 50 - (4 - math.pi) * 25),
        ),
        # t = 8 > 6: R = 2.5 t = 20, r = 12
        (
            "SHS 160x8",
            160**2 - (4 - math.pi) * 400 - (144**2 - (4 - math.pi) * 144),
        ),
        ("T 60x60x6", 60 * 6 + 54 * 6),
        # rolled: two root fillets add (1 - pi/4) r^2 each, r = t = 7
        ("T 60x60x7", 60 * 7 + 53 * 7 + 2 * (1 - math.pi / 4) * 49),
    ],
)
def test_areas_in_closed_form(name: str, area: float) -> None:
    assert section_area(profile(name)) == pytest.approx(area, rel=1e-12)


@pytest.mark.parametrize(
    "name", [name for rule in table("profiles").values() for name in rule["common"]]
)
def test_every_listed_profile_is_made_and_stands_below_its_datum(name: str) -> None:
    section = profile(name)
    assert section.name == name
    low, high = z_range(section)
    assert (low, high) == (-section.depth, 0.0)
    outside = section.loops[0].points
    assert np.ptp(outside[:, 0]) == pytest.approx(section.width)
    assert is_mirror(section, 1e-9)
    assert loop_area(section.loops[0]) > 0
    assert all(loop_area(loop) < 0 for loop in section.loops[1:])


def test_en_10219_mass_of_a_hollow_section() -> None:
    # EN 10219-2, table B.3: 100 x 60 x 5 has A = 14.4 cm2.
    assert section_area(profile("RHS 100x60x5")) == pytest.approx(1436.0, abs=5)


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("IPE 200", ["families: FL, RHS, SHS, T"]),
        ("FL 60", ["FL takes depth x width", "FL 60x8"]),
        ("RHS 40x20x8", ["do not fit", "RHS 40x20x2"]),
        ("FL 60x0", ["width 0 mm"]),
        ("RHS 12000x60x5", ["depth 12000 mm", "500"]),
        ("T 60x60x50", ["leaves no web"]),
        ("FL 60x8; import os", ["no profile"]),
        ("__import__('os')", ["no profile"]),
        ("", ["no profile"]),
        ("RHS 60x120", ["thickness missing", "near: RHS 120x60x4, RHS 120x60x5, RHS 120x60x6"]),
        ("RHS 50x100", ["thickness missing", "near: RHS 100x50x4, RHS 100x50x5"]),
        ("RHS 5x60x120", ["depth 5 mm", "near: RHS 120x60x5"]),
        ("RHS 0x1x40x3", ["near:"]),
        ("RHS " + "1x" * 36 + "5", ["near:"]),
        ("RHS 120 x 60 x 5 mm", ["near: RHS 120x60x5"]),
        ("rhs 120x60x5,0", ["near: RHS 120x60x5"]),
        ("RHS 120*60*5.5", ["near: RHS 120x60x5.5"]),
        ("FL 60", ["width missing", "near: FL 60x10, FL 60x8"]),
        ("Flat 60x8", ["near: FL 60x8"]),
        ("SHS 60x60x4", ["near: SHS 60x4"]),
        ("SHS 60x40x4", ["near: RHS 60x40x4"]),
        ("SHS 60", ["thickness missing", "near: SHS 60x3, SHS 60x4, SHS 60x5"]),
        ("T 60x60", ["thickness missing", "near: T 60x60x7"]),
        ("T 60", ["width and thickness missing", "near: T 60x60x7"]),
        ("RHS " + "1" * 5000 + "!", ["no profile"]),
    ],
)
def test_unknown_profiles_are_refused_with_near_ones(name: str, words: list[str]) -> None:
    with pytest.raises(ProjectError) as caught:
        profile(name)
    assert all(word in str(caught.value) for word in [*words, "near:"])


def test_every_near_profile_is_one() -> None:
    for name in ("RHS 60x120", "RHS 33x77", "FL 61", "T 1", "SHS 900x900x90", "RHS 40x20x8", "x"):
        with pytest.raises(ProjectError) as caught:
            profile(name)
        near = str(caught.value).split("near: ")[1].split(", ")
        assert near
        assert all(profile(other).name == other for other in near)


def test_what_lies_on_its_side_is_said_with_what_stands() -> None:
    assert "RHS 120x60x5 stands upright" in lying(profile("RHS 60x120x5"))
    assert "60 mm deep and 120 mm wide" in lying(profile("RHS 60x120x5"))
    assert "FL 60x8 stands upright" in lying(profile("FL 8x60"))
    for name in ("RHS 120x60x5", "FL 60x8", "SHS 60x4", "T 60x80x7"):
        assert lying(profile(name)) == ""
    assert lying(polygon([[-50, 0], [50, 0], [50, -10], [-50, -10]])) == ""


def test_polygon_is_turned_counterclockwise_and_kept() -> None:
    corners = [[-10, 0], [10, 0], [5, -40], [-5, -40]]  # clockwise
    section = polygon(corners)
    assert loop_area(section.loops[0]) == pytest.approx((20 + 10) / 2 * 40)
    assert {tuple(p) for p in section.loops[0].points} == {tuple(map(float, c)) for c in corners}
    assert (section.width, section.depth) == (20.0, 40.0)
    assert is_mirror(section, 1e-9)
    assert not is_mirror(polygon([[0, 0], [10, 0], [5, -40]]), 1e-9)


def test_polygon_width_is_the_strip_about_the_middle_plane() -> None:
    assert polygon([[0, 0], [10, 0], [5, -40]]).width == 20.0


@pytest.mark.parametrize(
    ("corners", "word"),
    [
        ([[0, 0], [1, 0]], "three corners"),
        ([[0, 0], [10, 10], [10, 0], [0, 10]], "cross"),
        ([[0, 0], [10, 0], [10, 0.01], [0, 10]], "shorter"),
        ([[0, 0], [10, 0], [math.nan, 4]], "not finite"),
    ],
)
def test_bad_polygons(corners: list[list[float]], word: str) -> None:
    with pytest.raises(ProjectError, match=word):
        polygon(corners)


def test_crossing_is_found_where_it_is() -> None:
    bow: Floats = np.array([[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 2.0]])
    assert first_crossing(bow) == (0, 2)
    assert first_crossing(bow[[0, 2, 1, 3]]) is None


def test_every_family_has_stock_lengths_with_a_source() -> None:
    for family, size in (("FL", "60x8"), ("RHS", "60x40x3"), ("SHS", "60x4"), ("T", "60x60x7")):
        found = stock_lengths(profile(f"{family} {size}"))
        assert found is not None
        lengths, source = found
        assert list(lengths) == sorted(lengths)
        assert 6000.0 in lengths  # what wholesalers have
        assert len(source) > 40
    assert stock_lengths(polygon([[-10, 0], [10, 0], [0, 10]])) is None


@pytest.mark.parametrize(
    ("size", "spacing", "end", "edge"),
    [("M8", 40, 80, 24), ("M12", 60, 84, 36), ("M16", 80, 112, 48), ("M20", 100, 140, 60)],
)
def test_bolts_in_timber(size: str, spacing: float, end: float, edge: float) -> None:
    """EN 1995-1-1, table 8.4 along the grain, as handbooks tabulate it: a1, a3,t and a4,c."""
    needs = fastener(size).in_timber
    assert (needs.spacing, needs.end, needs.edge) == (spacing, end, edge)
    inside, outside, thickness = fastener(size).wide
    assert fastener(size).diameter < inside <= fastener(size).hole < outside
    assert outside >= needs.washer[0]
    assert thickness >= needs.washer[1]


def test_bolts_nodes_and_materials() -> None:
    assert (fastener("M12").diameter, fastener("M12").hole) == (12.0, 13.5)  # ISO 273, medium
    with pytest.raises(ProjectError, match="M12"):
        fastener("M13")
    assert list(node_diameters("tube")) == sorted(node_diameters("tube"))
    assert density("steel") == 7850.0
    assert stock_size() == (3210.0, 6000.0)
