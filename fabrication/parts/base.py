"""Base plates: a square plate on the ground, and a round post from it up to a node.

The post is upright and cut at its top in a single mitre, square to the axis of the node, to whose
bottom it is welded; anchors go through the plate.
"""

from __future__ import annotations

import math
from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, Self

import numpy as np

from ddgfab.errors import DetailError
from fabrication.boundary import Boundary, Vec
from fabrication.solids.builder import BoundaryBuilder, Coedges
from fabrication.solids.plate import Blank, Plate
from fabrication.solids.section import segments
from fabrication.solids.sweep import End, walls
from fabrication.specs import Kind, Loop
from fabrication.variants import Variants, key_of

if TYPE_CHECKING:
    from fabrication.drawings.views import Drawing

BASE: Final = Kind(
    role="base",
    mark="G",
    prefix="GP",
    title="Base plates",
    color=(0.45, 0.47, 0.50),
    finish="matte",
)

QUARTERS: Final = 4
"""Turns that bring a square plate upon itself."""


@dataclass(frozen=True, eq=False)
class BaseShape:
    """A plate from z = -thickness to 0, and a post from the middle of its top [mm].

    width, thickness : of the plate, whose sides are parallel to x and y
    spread : of the four anchor holes from the middle, in x and y
    diameter : of these holes
    radius, length : of the post; the length is that of its axis
    lean, azimuth : of the normal of its end [rad]: from z, and about z from x
    """

    width: float
    thickness: float
    spread: float
    diameter: float
    radius: float
    length: float
    lean: float
    azimuth: float

    @property
    def places(self) -> list[tuple[float, float]]:
        """The middles of the anchor holes, counterclockwise from that in +x, +y."""
        c = self.spread
        return [(c, c), (-c, c), (-c, -c), (c, -c)]

    @property
    def edge(self) -> float:
        """From the middle of a hole to the sides of the plate."""
        return 0.5 * self.width - self.spread

    @property
    def from_post(self) -> float:
        """From the middle of a hole to the post."""
        return math.sqrt(2.0) * self.spread - self.radius

    def key(self) -> Hashable:
        """Sizes of plate, holes and post."""
        sizes = (self.width, self.thickness, self.spread, self.diameter, self.radius)
        return tuple(map(key_of, sizes))

    @classmethod
    def variants(cls, shapes: Sequence[Self]) -> Variants:
        """In quarter turns; the length of the post and the plane of its end count."""
        n = len(shapes)
        height = np.array([shape.length for shape in shapes])
        fall = np.array([shape.radius * math.tan(shape.lean) for shape in shapes])
        azimuth = np.array([shape.azimuth for shape in shapes])
        turn = np.tile(0.5 * np.pi * np.arange(QUARTERS), (n, 1))
        around = azimuth[:, None] - turn
        rim = [fall[:, None] * np.cos(around), fall[:, None] * np.sin(around)]
        tops = np.stack([*rim, np.broadcast_to(height[:, None], around.shape)], axis=-1)
        return Variants.about_z(tops[:, :, None], turn, np.zeros((n, QUARTERS, 3)))

    def geometry(self) -> Boundary:
        """Exact boundary.

        Raises
        ------
        DetailError
            Holes that leave the plate or run into the post, a post that ends in the plate.
        """
        return base_boundary(self)

    def second_volume(self) -> float:
        """Plate less its holes, and the post: its mitre gives on one side what it takes."""
        holes = len(self.places) * 0.25 * math.pi * self.diameter**2
        return self.thickness * (self.width**2 - holes) + self._post()

    def _post(self) -> float:
        return math.pi * self.radius**2 * self.length

    def plate(self) -> Plate:
        """The plate as it is cut, from above."""
        r, turns = 0.5 * self.diameter, np.array([-1.0, -1.0])
        holes = [Loop(np.array([(x + r, y), (x - r, y)]), turns) for x, y in self.places]
        outline = Loop(np.array(_corners(self)), np.zeros(4))
        return Plate(self.thickness, (outline, *holes), rest=self._post())

    def blanks(self) -> list[Blank]:
        """The plate."""
        return [Blank("base plate", self.thickness, self.width, self.width)]

    def bars(self) -> list[tuple[str, float]]:
        """The round bar of the post, and the length to saw, over all [mm]."""
        over_all = self.length + self.radius * math.tan(self.lean)
        return [(f"round {2 * self.radius:g}", over_all)]

    def drawing(self, about: Mapping[str, Any]) -> Drawing:
        """What its sheet shows."""
        from fabrication.parts.base_drawing import base_drawing

        return base_drawing(self)

    def dimensions(self) -> dict[str, Any]:
        """Plate, holes and post."""
        return {
            "plate_width_mm": self.width,
            "plate_mm": self.thickness,
            "anchor_hole_mm": self.diameter,
            "anchors_apart_mm": 2.0 * self.spread,
            "post_diameter_mm": 2.0 * self.radius,
            "post_length_mm": self.length,
            "post_mitre_deg": math.degrees(self.lean),
            "post_azimuth_deg": math.degrees(self.azimuth) % 360.0 if self.lean else 0.0,
        }


def _corners(shape: BaseShape) -> list[tuple[float, float]]:
    h = 0.5 * shape.width
    return [(-h, -h), (h, -h), (h, h), (-h, h)]


def base_boundary(shape: BaseShape) -> Boundary:
    """Exact boundary of a base plate with its post; see `BaseShape.geometry`."""
    _check(shape)
    builder = BoundaryBuilder()
    t, radius = shape.thickness, 0.5 * shape.diameter
    corners = _corners(shape)
    low = [builder.point((x, y, -t)) for x, y in corners]
    high = [builder.point((x, y, 0.0)) for x, y in corners]
    count = len(corners)
    for k in range(count):
        j = (k + 1) % count
        (x0, y0), (x1, y1) = corners[k], corners[j]
        normal: Vec = ((y1 - y0) / shape.width, (x0 - x1) / shape.width, 0.0)
        around = [
            builder.line(low[k], low[j]),
            builder.line(low[j], high[j]),
            builder.line(high[j], high[k]),
            builder.line(high[k], low[k]),
        ]
        builder.plane(normal, [around])
    unders: list[Coedges] = [[builder.line(low[-k], low[-k - 1]) for k in range(count)]]
    tops: list[Coedges] = [[builder.line(high[k], high[(k + 1) % count]) for k in range(count)]]
    for x, y in shape.places:
        near, far = builder.round_hole((x, y, -t), (x, y, 0.0), (1.0, 0.0, 0.0), radius)
        unders.append(near)
        tops.append(far)
    cos, sin, r = math.cos(shape.azimuth), math.sin(shape.azimuth), shape.radius

    def frame(u: float, v: float, w: float) -> Vec:
        """v towards where the end falls."""
        return (u * sin + v * cos, v * sin - u * cos, w)

    circle = segments(Loop(np.array([(r, 0.0), (-r, 0.0)]), np.array([1.0, 1.0])))
    end = End(shape.length, -math.tan(shape.lean), None, 1.0)
    foot, head = walls(builder, frame, circle, End(0.0, 0.0, None, -1.0), end, {})
    tops.append(foot)
    builder.plane((0.0, 0.0, -1.0), unders)
    builder.plane((0.0, 0.0, 1.0), tops)
    end.face(builder, frame, [head])
    return builder.build()


def _check(shape: BaseShape) -> None:
    radius = 0.5 * shape.diameter
    if shape.edge <= radius or shape.from_post <= radius or shape.spread <= radius:
        raise DetailError(
            f"the anchor holes of {shape.diameter:.6g} mm are {shape.edge:.6g} mm from the edge of "
            f"the base plate and {shape.from_post:.6g} mm from the post: both must be more than "
            f"their radius, {radius:.6g} mm"
        )
    short = shape.length - shape.radius * math.tan(shape.lean)
    if short <= 0.0:
        raise DetailError(
            f"a post of {2.0 * shape.radius:.6g} mm with a mitre of "
            f"{math.degrees(shape.lean):.4g} deg is {short:.6g} mm long on its short side: it does "
            "not stand on its plate"
        )
