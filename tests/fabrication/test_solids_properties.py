"""Volume, area, centroid: by the divergence theorem, and by a second route from the shape."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from parts_table import BEAMS, CUT, EXACT, FLAT, NODES, PANELS, beam
from scipy.integrate import quad
from scipy.spatial.transform import Rotation

from fabrication.parts.beam import BeamShape, EndCut
from fabrication.parts.node import NodeShape, RadialHole
from fabrication.parts.panel import PanelShape
from fabrication.solids import boundary_of, properties_of, second_volume_of, volume_of
from fabrication.solids.integrals import properties
from fabrication.solids.section import section_area
from fabrication.specs import Loop, Shape


def scaled(shape: Shape, f: float) -> Shape:
    """The shape f times as large."""
    if isinstance(shape, PanelShape):
        return PanelShape(shape.thickness * f, shape.inner * f, shape.outer * f,
                          shape.corner_radius * f)  # fmt: skip
    if isinstance(shape, NodeShape):
        seats = tuple(replace(s, distance=s.distance * f, width=s.width * f) for s in shape.seats)
        holes = tuple(
            replace(
                h,
                z=h.z * f,
                diameter=h.diameter * f,
                depth=None if h.depth is None else h.depth * f,
            )
            for h in shape.holes
        )
        mark = shape.mark and replace(
            shape.mark, x=shape.mark.x * f, diameter=shape.mark.diameter * f,
            depth=shape.mark.depth * f,
        )  # fmt: skip
        return NodeShape(
            shape.radius * f, shape.bore * f, shape.z0 * f, shape.z1 * f, seats, holes, mark
        )
    profile = replace(
        shape.profile, loops=tuple(Loop(o.points * f, o.bulges) for o in shape.profile.loops)
    )

    def cut(c: EndCut) -> EndCut:
        return EndCut(c.x * f, c.slope, None if c.radius is None else c.radius * f)

    holes_across = tuple(
        replace(h, x=h.x * f, z=h.z * f, diameter=h.diameter * f) for h in shape.holes
    )
    return BeamShape(profile, cut(shape.start), cut(shape.end), holes_across)


@pytest.mark.parametrize("name", EXACT)
def test_two_routes_to_the_volume_agree(name: str) -> None:
    shape = EXACT[name][0]
    assert volume_of(shape) == pytest.approx(second_volume_of(shape), rel=1e-11)


@pytest.mark.parametrize("bore", [30.0, 50.0])
def test_holes_through_the_wall_of_a_tube(bore: float) -> None:
    """Slices along the tube's axis: 2 sqrt(r^2 - y^2) (sqrt(R^2 - y^2) - sqrt(b^2 - y^2))."""
    r, outer = 7.0, 60.0
    holes = (RadialHole(0.3, 2.0, 2 * r, None), RadialHole(2.4, -9.0, 2 * r, None))
    tube = NodeShape(outer, bore, -40.0, 45.0)
    taken = second_volume_of(tube) - second_volume_of(replace(tube, holes=holes))

    def slice_of(y: float) -> float:
        wall = math.sqrt(outer**2 - y**2) - math.sqrt(bore**2 - y**2)
        return 2.0 * math.sqrt(r**2 - y**2) * wall

    assert taken == pytest.approx(2.0 * quad(slice_of, -r, r)[0], rel=1e-8)
    assert second_volume_of(tube) == pytest.approx(math.pi * (outer**2 - bore**2) * 85.0)


@pytest.mark.parametrize("name", EXACT)
def test_rigid_motions_change_nothing(name: str) -> None:
    boundary = boundary_of(EXACT[name][0])
    assert boundary is not None
    placement = np.eye(4)
    placement[:3, :3] = Rotation.from_rotvec([0.4, -1.1, 2.0]).as_matrix()
    placement[:3, 3] = [12e3, -40e3, 7e3]
    here, there = properties(boundary), properties(boundary.transformed(placement))
    assert there.volume == pytest.approx(here.volume, rel=1e-10)
    assert there.area == pytest.approx(here.area, rel=1e-11)
    moved = placement[:3, :3] @ here.centroid + placement[:3, 3]
    assert np.allclose(there.centroid, moved, atol=1e-6)
    boundary.transformed(placement).validate()


@pytest.mark.parametrize("factor", [0.1, 25.4])
@pytest.mark.parametrize("name", ["tee coped", "rhs holes", "valence 5 holes", "quad mitred round"])
def test_scales(name: str, factor: float) -> None:
    shape = EXACT[name][0]
    here, there = properties_of(shape), properties_of(scaled(shape, factor))
    assert there.volume == pytest.approx(here.volume * factor**3, rel=1e-11)
    assert there.area == pytest.approx(here.area * factor**2, rel=1e-11)
    assert np.allclose(there.centroid, np.array(here.centroid) * factor, rtol=1e-9, atol=1e-8)


def test_square_bar_by_hand() -> None:
    # 8 x 60 x 1108 from x = 62 to 1170.
    found = properties_of(BEAMS["bar square"][0])
    assert found.volume == pytest.approx(8 * 60 * 1108, rel=1e-14)
    assert found.area == pytest.approx(2 * (8 * 60 + 8 * 1108 + 60 * 1108), rel=1e-14)
    assert found.centroid == pytest.approx((616.0, 0.0, 0.0), abs=1e-10)


def test_tube_by_hand() -> None:
    shape = NodeShape(60.0, 50.0, -40.0, 45.0)
    found = properties_of(shape)
    assert found.volume == pytest.approx(math.pi * (60**2 - 50**2) * 85, rel=1e-14)
    assert found.area == pytest.approx(
        2 * math.pi * (60**2 - 50**2) + 2 * math.pi * (60 + 50) * 85, rel=1e-14
    )
    assert found.centroid == pytest.approx((0.0, 0.0, 2.5), abs=1e-10)


def test_square_cope_by_hand() -> None:
    # Along the middle the cope touches x; at |y| it adds r - sqrt(r^2 - y^2) of length:
    # over a width 2 c that is 2 c r - (c sqrt(r^2 - c^2) + r^2 asin(c / r)).
    def more(r: float, c: float = 4.0) -> float:
        return 2 * c * r - (c * math.sqrt(r * r - c * c) + r * r * math.asin(c / r))

    expected = 60.0 * (8.0 * 1108.0 + more(50.0) + more(60.0))
    assert volume_of(BEAMS["bar coped square"][0]) == pytest.approx(expected, rel=1e-12)


def test_slope_of_a_centered_profile_leaves_the_volume() -> None:
    # The cut turns about the y axis through the profile's centroid: what is lost above is
    # gained below.
    one, two = (beam(FLAT, slopes=slopes) for slopes in ((0.0, 0.0), (0.4, 0.7)))
    assert volume_of(one) == pytest.approx(volume_of(two), rel=1e-13)


def test_rounding_a_square_corner_takes_known_area() -> None:
    # (1 - pi/4) r^2 a corner of a rectangle.
    rectangle = np.array([(0.0, 0.0), (900.0, 0.0), (900.0, 500.0), (0.0, 500.0)])
    whole = 900.0 * 500.0 * 10.0
    rounded = PanelShape(10.0, rectangle, rectangle, 30.0)
    expected = whole - 4 * (1 - math.pi / 4) * 30.0**2 * 10.0
    assert volume_of(rounded) == pytest.approx(expected, rel=1e-13)


def test_holes_only_take_material() -> None:
    bare = replace(NODES["valence 4 holes"][0], holes=(), mark=None)
    drilled = NODES["valence 4 holes"][0]
    taken = sum(math.pi * h.diameter**2 / 4 * (h.depth or 0.0) for h in drilled.holes)
    assert drilled.mark is not None
    taken += math.pi * drilled.mark.diameter**2 / 4 * drilled.mark.depth
    assert volume_of(bare) - volume_of(drilled) == pytest.approx(taken, rel=1e-9)
    # Every blind hole adds its wall; the disc it takes comes back as its bottom.
    walls = sum(math.pi * h.diameter * (h.depth or 0.0) for h in drilled.holes)
    walls += math.pi * drilled.mark.diameter * drilled.mark.depth
    assert properties_of(drilled).area - properties_of(bare).area == pytest.approx(walls, rel=1e-9)


def test_section_area_of_a_rounded_tube() -> None:
    # Rectangle less (4 - pi) r^2, outside and inside.
    profile = BEAMS["rhs mitred"][0].profile
    outside = 60 * 120 - (4 - math.pi) * 10**2
    inside = 50 * 110 - (4 - math.pi) * 5**2
    assert section_area(profile.loops) == pytest.approx(outside - inside, rel=1e-13)


@pytest.mark.parametrize("name", CUT)
def test_volumes_without_boundary_lie_between_bounds(name: str) -> None:
    shape = CUT[name][0]
    if isinstance(shape, BeamShape):
        # A coped end is longer than the flat cut through x, and shorter than one at the axis.
        def flat(reach: float) -> float:
            cuts = [
                EndCut(c.x + sign * reach * (c.radius or 0.0) * math.hypot(1, c.slope), c.slope)
                for c, sign in ((shape.start, -1.0), (shape.end, 1.0))
            ]
            return volume_of(replace(shape, start=cuts[0], end=cuts[1]))

        assert flat(0.0) < volume_of(shape) < flat(1.0)
        return
    assert isinstance(shape, NodeShape)
    bare = volume_of(replace(shape, holes=()))
    depths = [h.depth or shape.radius - shape.bore for h in shape.holes]
    taken = [math.pi * h.diameter**2 / 4 * d for h, d in zip(shape.holes, depths, strict=True)]
    assert bare - 1.1 * sum(taken) < volume_of(shape) < bare - 0.8 * sum(taken)


def test_panel_table_covers_reflex_and_straight_corners() -> None:
    boundary = boundary_of(PANELS["reflex round"][0])
    assert boundary is not None
    assert sorted(set(boundary.face_sign[boundary.face_cylinder].tolist())) == [-1.0, 1.0]
    straight = boundary_of(PANELS["corner in line"][0])
    assert straight is not None
    assert straight.face_cylinder.sum() == 3
