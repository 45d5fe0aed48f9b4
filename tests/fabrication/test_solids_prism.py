"""Prisms: what they are made of gives the part's volume again; what is none is refused."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fabrication.boundary import Boundary
from fabrication.parts.beam import BeamShape, CrossHole, EndCut
from fabrication.parts.panel import PanelShape
from fabrication.solids import boundary_of
from fabrication.solids.integrals import properties
from fabrication.solids.prism import Prism, prism
from fabrication.solids.section import GAUSS_NODES, integrate, section_area
from fabrication.standards.profiles import profile as section

SQUARE = np.array([[0.0, 0.0], [900.0, 0.0], [900.0, 700.0], [0.0, 700.0]])


def beam(profile: str, start: float, end: float, *holes: CrossHole) -> Boundary:
    cuts = EndCut(40.0, start, None), EndCut(1300.0, end, None)
    made = boundary_of(BeamShape(section(profile), *cuts, holes))
    assert made is not None
    return made


def pane(radius: float) -> Boundary:
    made = boundary_of(PanelShape(12.0, SQUARE, SQUARE, radius))
    assert made is not None
    return made


def volume(swept: Prism) -> float:
    """Of the section times the height between the caps, integrated."""
    low, high = swept.low, swept.high
    area = section_area(swept.loops)
    moment_u = integrate(swept.loops, lambda u, v: 0.5 * u * u, GAUSS_NODES)
    moment_v = integrate(swept.loops, lambda u, v: u * v, GAUSS_NODES)
    slope = np.subtract(high.slope, low.slope)
    return float((high.height - low.height) * area + slope @ (moment_u, moment_v))


@pytest.mark.parametrize("profile", ["FL 80x10", "RHS 100x50x4", "T 80x80x9"])
@pytest.mark.parametrize("slopes", [(0.0, 0.0), (0.2, -0.35), (0.0, 0.1)])
def test_a_mitred_bar_is_its_section_between_two_planes(
    profile: str, slopes: tuple[float, float]
) -> None:
    boundary = beam(profile, *slopes)
    swept = prism(boundary)
    assert swept is not None
    assert volume(swept) == pytest.approx(properties(boundary).volume, rel=1e-12)
    along = boundary.points @ swept.frame[:3, 2]
    assert swept.span == pytest.approx((along.min(), along.max()), abs=1e-9)
    assert np.linalg.det(swept.frame) == pytest.approx(1.0)
    areas = [section_area([loop]) for loop in swept.loops]
    assert areas[0] > 0.0
    assert all(area < 0.0 for area in areas[1:])
    assert (swept.low.straight, swept.high.straight) == tuple(s == 0.0 for s in slopes)


def test_turned_and_shifted_it_is_the_same_prism() -> None:
    boundary = beam("RHS 100x50x4", 0.2, -0.3)
    rigid = np.eye(4)
    rigid[:3, :3] = Rotation.from_rotvec([0.3, -1.1, 2.0]).as_matrix()
    rigid[:3, 3] = 5e3, -2e3, 7e3
    one, two = prism(boundary), prism(boundary.transformed(rigid))
    assert one is not None
    assert two is not None
    assert two.length == pytest.approx(one.length, abs=1e-8)
    assert volume(two) == pytest.approx(volume(one), rel=1e-10)


def test_a_pane_with_square_sides_is_one_through_its_thickness() -> None:
    for radius in (0.0, 8.0):
        swept = prism(pane(radius), "shortest")
        assert swept is not None
        assert swept.length == pytest.approx(12.0)
        exact = 900.0 * 700.0 - (4.0 - math.pi) * radius**2
        assert section_area(swept.loops) == pytest.approx(exact, rel=1e-12)


def test_a_box_is_one_in_three_ways() -> None:
    box = pane(0.0)
    longest, shortest = prism(box, "longest"), prism(box, "shortest")
    assert longest is not None
    assert shortest is not None
    assert (longest.length, shortest.length) == pytest.approx((900.0, 12.0))


def test_a_flat_bar_with_holes_is_one_through_its_thickness() -> None:
    boundary = beam("FL 80x10", 0.2, -0.1, CrossHole(300.0, -40.0, 13.0))
    swept = prism(boundary)
    assert swept is not None
    assert (swept.length, len(swept.loops)) == (pytest.approx(10.0), 2)
    assert volume(swept) == pytest.approx(properties(boundary).volume, rel=1e-12)


def test_what_has_faces_of_other_kinds_is_none() -> None:
    assert prism(beam("RHS 100x50x4", 0.0, 0.0, CrossHole(300.0, -40.0, 13.0))) is None
    skew = np.array([[0.0, 0.0], [900.0, 0.0], [850.0, 720.0], [20.0, 650.0]])
    middle = skew.mean(axis=0)
    mitred = boundary_of(PanelShape(12.0, (skew - middle) * 0.98 + middle, skew, 0.0))
    assert mitred is not None
    assert prism(mitred) is None
    coped = boundary_of(
        BeamShape(section("FL 80x10"), EndCut(40.0, 0.1, 45.0), EndCut(1300.0, 0.0, None))
    )
    assert coped is not None
    assert prism(coped) is None
