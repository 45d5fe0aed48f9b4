"""What the sheets of small round parts and of coupons show."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from fabrication.boundary import Vec
from fabrication.drawings.lengths import Length
from fabrication.drawings.notes import Note
from fabrication.drawings.running import Running
from fabrication.drawings.views import Drawing, Measure, View

if TYPE_CHECKING:
    from fabrication.parts.coupon import CouponShape
    from fabrication.parts.pin import PinShape
    from fabrication.parts.ring import RingShape

X: Final[Vec] = (1.0, 0.0, 0.0)
Y: Final[Vec] = (0.0, 1.0, 0.0)
Z: Final[Vec] = (0.0, 0.0, 1.0)


def across(name: str, diameter: float, z: float, side: str) -> Length:
    """A diameter as the distance of both outlines."""
    r = 0.5 * diameter
    return Length(name, (-r, 0.0, z), (r, 0.0, z), "across", side, "Ø")  # type: ignore[arg-type]


def pin_drawing(shape: PinShape) -> Drawing:
    """A pin upright, and from above."""
    r, low = 0.5 * shape.diameter, -shape.head_height
    front: list[Measure] = [
        Length("length_mm", (r, 0.0, 0.0), (r, 0.0, shape.length), "up", "right"),
        across("diameter_mm", shape.diameter, shape.length, "above"),
    ]
    if shape.head_height > 0.0:
        far = 0.5 * shape.head_diameter
        front.append(Length("head_height_mm", (-far, 0.0, low), (-far, 0.0, 0.0), "up", "left"))
        front.append(across("head_diameter_mm", shape.head_diameter, low, "below"))
    return Drawing((View("front", X, Z, tuple(front)), View("from above", X, Y, row=-1)))


def ring_drawing(shape: RingShape) -> Drawing:
    """A ring or cap upright, and its bore from below."""
    r = 0.5 * shape.diameter
    front: list[Measure] = [
        Length("height_mm", (r, 0.0, 0.0), (r, 0.0, shape.height), "up", "right"),
        across("diameter_mm", shape.diameter, shape.height, "above"),
        across("bore_mm", shape.bore, 0.0, "below"),
    ]
    if shape.floor:
        floor = (-r, 0.0, shape.height - shape.floor), (-r, 0.0, shape.height)
        front.append(Length("floor_mm", *floor, "up", "left"))
    return Drawing(
        (View("front", X, Z, tuple(front)), View("from below", X, (0.0, -1.0, 0.0), row=1))
    )


def coupon_drawing(shape: CouponShape) -> Drawing:
    """The plate with its row of bores."""
    from fabrication.parts.coupon import bore_row, coupon_size

    length, width = coupon_size(shape)
    x, y, t = 0.5 * length, 0.5 * width, shape.thickness
    row = bore_row(shape)
    above: list[Measure] = [
        Length("length_mm", (-x, -y, t), (x, -y, t), "across", "below"),
        Length("width_mm", (x, -y, t), (x, y, t), "up", "right"),
        Running((-x, y, t), tuple(("bore", (a, b, t)) for a, b in row), "across", "above"),
        Length("bore_up_mm", (-x, -y, t), (-x, row[0][1], t), "up", "left"),
    ]
    for (a, b), bore in zip(row, shape.bores, strict=True):
        edges = (a, b - 0.5 * bore, t), (a, b + 0.5 * bore, t)
        above.append(Note(f"Ø{bore:g}", edges[0], "bore_mm", bore, (0.3, -1.0, 0.0), across=edges))
    front = Length("height_mm", (x, -y, 0.0), (x, -y, t), "up", "right")
    return Drawing((View("front", X, Z, (front,)), View("from above", X, Y, tuple(above), row=-1)))
