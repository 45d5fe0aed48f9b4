"""Compound cuts: beams whose flat ends are inclined both ways, exact from spec to STEP."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from parts_table import FLAT, FREE, HOLES, RHS, T_BAR, beam

from ddgfab.errors import DetailError
from fabrication.formats.base import Header, Material, Provenance
from fabrication.formats.registry import find
from fabrication.job.part import Shop, make_part, read_back
from fabrication.parts.beam import BEAM, BeamShape, CrossHole, EndCut, fibre_ends
from fabrication.parts.beam.congruence import beam_variants
from fabrication.solids import boundary_of, properties_of, second_volume_of, volume_of
from fabrication.specs import Family, Profile


def skew(
    profile: Profile, first: float, second: float, holes: tuple[CrossHole, ...] = ()
) -> BeamShape:
    shape = beam(profile, holes=holes)
    return replace(
        shape, start=replace(shape.start, skew=first), end=replace(shape.end, skew=second)
    )


SHAPES = {
    "bar": skew(FLAT, 0.4, -0.2),
    "bar holes": skew(FLAT, 0.4, 0.25, HOLES),
    "rhs": skew(RHS, -0.3, 0.45),
    "rhs holes": skew(RHS, 0.1, 0.1, HOLES),
    "tee": skew(T_BAR, 0.0, 0.5),
    "free": skew(FREE, 0.2, -0.6),
}


@pytest.mark.parametrize("name", SHAPES)
def test_boundary_is_exact(name: str) -> None:
    shape = SHAPES[name]
    boundary = boundary_of(shape)
    assert boundary is not None
    boundary.validate()
    assert boundary.surface_distance().max() < 1e-9
    assert volume_of(shape) == pytest.approx(second_volume_of(shape), rel=1e-12)
    # Both end faces lie in their planes x = cut.x + slope z + skew y.
    points = boundary.points
    for cut, side in ((shape.start, 1.0), (shape.end, -1.0)):
        beyond = points[:, 0] - (cut.x + cut.slope * points[:, 2] + cut.skew * points[:, 1])
        assert (side * beyond).min() == pytest.approx(0.0, abs=1e-9)
        assert (np.abs(beyond) < 1e-9).sum() == sum(len(o.points) for o in shape.profile.loops)


def test_volume_by_hand() -> None:
    # A bar symmetric about its axis keeps its volume under any inclination of its ends.
    assert volume_of(SHAPES["bar"]) == pytest.approx(8 * 60 * (1170 - 62), rel=1e-13)
    shape = replace(SHAPES["bar"], profile=replace(FLAT, loops=T_BAR.loops))
    lever = 8 * 72 * -24.0 + 80 * 8 * 16.0  # first moment of the T about y; about z it is 0
    taper = shape.end.slope - shape.start.slope
    area = 8 * 72 + 80 * 8
    assert volume_of(shape) == pytest.approx(area * (1170 - 62) + taper * lever, rel=1e-13)


def test_a_skew_end_is_the_mirror_image_of_its_opposite() -> None:
    one, two = SHAPES["rhs"], skew(RHS, 0.3, -0.45)
    a, b = properties_of(one), properties_of(two)
    assert (a.volume, a.area) == pytest.approx((b.volume, b.area))
    assert a.centroid == pytest.approx((b.centroid[0], -b.centroid[1], b.centroid[2]))


@pytest.mark.slow
@pytest.mark.parametrize("name", SHAPES)
def test_part_passes_every_check_and_reads_back(name: str, tmp_path: Path) -> None:
    formats = (find("step"), find("stl"))
    for format in formats:
        (tmp_path / "parts" / format.name).mkdir(parents=True)
    shop = Shop(tmp_path, formats, Provenance("skew", Header("", "", "skew")), 0.05)
    family = Family("BP-001", BEAM, SHAPES[name], (), 0.0)
    made = make_part(family, Material("Steel", 7850.0), shop)
    assert [check for check in made.checks if not check.passed] == []
    found, _ = read_back([made.part], shop)
    assert len(found["BP-001"]) > 3
    assert [check for check in found["BP-001"] if not check.passed] == []


def turned(shape: BeamShape) -> BeamShape:
    """The same beam turned end for end about z: x and y change sign."""

    def cut(c: EndCut) -> EndCut:
        return EndCut(-c.x, -c.slope, c.radius, c.skew)

    holes = tuple(replace(h, x=-h.x) for h in reversed(shape.holes))
    return BeamShape(shape.profile, cut(shape.end), cut(shape.start), holes)


def test_congruent_when_turned_end_for_end_but_not_when_mirrored() -> None:
    shape = SHAPES["bar"]
    other, mirror = turned(shape), skew(FLAT, -0.4, 0.2)
    assert shape.key() == other.key() == mirror.key()
    assert shape.key() != beam(FLAT).key()
    points = beam_variants([shape, other, mirror]).points
    own, back = points[0]
    assert np.abs(points[1][0] - back).max() < 1e-12
    assert np.abs(points[1][1] - own).max() < 1e-12
    assert min(np.abs(points[2][0] - v).max() for v in (own, back)) > 1.0


def test_fibres_are_the_corners() -> None:
    shape = SHAPES["bar"]
    start, end = fibre_ends(shape)
    assert shape.is_skew
    want = [62 + 0.12 * z + 0.4 * y for y in (-4, 4) for z in (-30, 30)]
    assert start == pytest.approx(want)
    assert end == pytest.approx([1170 - 0.3 * z - 0.2 * y for y in (-4, 4) for z in (-30, 30)])


def test_what_cannot_be_made() -> None:
    shape = SHAPES["bar"]
    coped = replace(shape, start=replace(shape.start, radius=30.0))
    with pytest.raises(DetailError, match=r'start is coped but skew by 0\.4.*"flat"'):
        boundary_of(coped)
    short = replace(shape, end=EndCut(90.0, -0.3, None, -7.0))
    with pytest.raises(DetailError, match="the two cuts cross"):
        boundary_of(short)
    near = replace(shape, holes=(CrossHole(68.0, 0.0, 9.0),))
    with pytest.raises(DetailError, match=r"the hole of 9 mm .* from the cut at the start"):
        boundary_of(near)


def test_skew_is_measured_across_the_cut() -> None:
    """The end face's area is that of the profile over the cosine of its inclination."""
    boundary = boundary_of(SHAPES["rhs"])
    assert boundary is not None
    flat = properties_of(beam(RHS, slopes=(0.0, 0.0)))
    both = [
        replace(SHAPES["rhs"], start=EndCut(62.0, 0.0), end=EndCut(1170.0, 0.0, None, k))
        for k in (0.0, 0.45)
    ]
    areas = [properties_of(shape).area for shape in both]
    section = flat.volume / (1170 - 62)
    # The sides keep their area: an odd inclination takes on one side what it adds on the other.
    assert areas[1] - areas[0] == pytest.approx(section * (math.hypot(1, 0.45) - 1), rel=1e-9)
