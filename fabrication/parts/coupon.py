"""The clearance coupon: a bar with a row of bores of graded diameters."""

from __future__ import annotations

import math
from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, Self

from ddgfab.errors import DetailError
from fabrication.boundary import Boundary, Vec
from fabrication.solids.builder import BoundaryBuilder, Coedges
from fabrication.solids.text import Label, label_size, label_volume, write_label
from fabrication.specs import Kind
from fabrication.variants import Variants, key_of

if TYPE_CHECKING:
    from fabrication.drawings.views import Drawing

COUPON: Final = Kind(
    role="coupon",
    mark="T",
    prefix="TP",
    title="Coupons",
    color=(0.55, 0.70, 0.40),
)

MARGIN: Final = 0.8
"""Least distance [mm] between a label, its bore and the border of the plate."""


@dataclass(frozen=True)
class CouponShape:
    """A bar with a row of bores of graded diameters, to find the clearance a printer needs.

    Frame: the plate lies on z = 0 with its middle at the origin, the row runs along x, its bores
    at equal distances `pitch` [mm].

    bores : diameters [mm] in order
    width, thickness : of the plate [mm]
    labels : one for each bore, on the upper side beside it towards -y
    """

    bores: tuple[float, ...]
    pitch: float
    width: float
    thickness: float
    labels: tuple[Label, ...] = ()

    def key(self) -> Hashable:
        """All dimensions, and the labels."""
        return (
            *map(key_of, (self.pitch, self.width, self.thickness, *self.bores)),
            self.labels,
        )

    @classmethod
    def variants(cls, shapes: Sequence[Self]) -> Variants:
        """Those of one key are equal."""
        return Variants.equal(len(shapes))

    def geometry(self) -> Boundary:
        """Always exact."""
        return coupon_boundary(self)

    def second_volume(self) -> float:
        """Plate less bores and labels."""
        return coupon_volume(self)

    def drawing(self, about: Mapping[str, Any]) -> Drawing:
        """What its sheet shows."""
        from fabrication.parts.turned_drawing import coupon_drawing

        return coupon_drawing(self)

    def dimensions(self) -> dict[str, Any]:
        """Thickness."""
        return {"height_mm": self.thickness}


def coupon_size(shape: CouponShape) -> tuple[float, float]:
    """Length and width [mm] of the plate."""
    return shape.pitch * len(shape.bores), shape.width


def bore_row(shape: CouponShape) -> list[tuple[float, float]]:
    """Centers of the bores: in the middle of what the labels leave of the width."""
    tall = _tall(shape)
    up = 0.5 * (tall + MARGIN) if tall else 0.0
    first = -0.5 * shape.pitch * (len(shape.bores) - 1)
    return [(first + k * shape.pitch, up) for k in range(len(shape.bores))]


def _tall(shape: CouponShape) -> float:
    """Height [mm] of the labels, 0 without."""
    return max((label_size(label)[1] for label in shape.labels), default=0.0)


def _check(shape: CouponShape) -> None:
    if not shape.bores or shape.thickness <= 0.0 or min(shape.bores) <= 0.0:
        raise DetailError("a coupon needs bores and a thickness")
    if shape.labels and len(shape.labels) != len(shape.bores):
        raise DetailError(f"{len(shape.labels)} labels for {len(shape.bores)} bores of a coupon")
    widest = max(shape.bores)
    tall = _tall(shape)
    needed = tall + widest + (3 if tall else 2) * MARGIN
    if widest + 2.0 * MARGIN > shape.pitch or needed > shape.width:
        raise DetailError(
            f"bores of {widest:.6g} mm with labels {tall:.6g} mm high do not fit a coupon "
            f"{shape.width:.6g} mm wide at {shape.pitch:.6g} mm: make it {needed:.6g} mm wide"
        )
    for label in shape.labels:
        if label_size(label)[0] + 2.0 * MARGIN > shape.pitch or label.depth >= shape.thickness:
            raise DetailError(f'the label "{label.text}" does not fit the coupon')


def coupon_boundary(shape: CouponShape) -> Boundary:
    """Exact boundary of a coupon.

    Raises
    ------
    DetailError
        Bores or labels do not fit.
    """
    _check(shape)
    builder = BoundaryBuilder()
    length, width = coupon_size(shape)
    x, y, t = length / 2.0, width / 2.0, shape.thickness
    outline = [(-x, -y), (x, -y), (x, y), (-x, y)]
    low = [builder.point((px, py, 0.0)) for px, py in outline]
    high = [builder.point((px, py, t)) for px, py in outline]
    lower: list[Coedges] = [[builder.line(low[k], low[k - 1]) for k in (0, 3, 2, 1)]]
    upper: list[Coedges] = [[builder.line(high[k - 1], high[k]) for k in range(4)]]
    normals: list[Vec] = [(0.0, -1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (-1.0, 0.0, 0.0)]
    for k, normal in enumerate(normals):
        j = (k + 1) % 4
        side = [
            builder.line(low[k], low[j]),
            builder.line(low[j], high[j]),
            builder.line(high[j], high[k]),
            builder.line(high[k], low[k]),
        ]
        builder.plane(normal, [side])
    for (cx, cy), bore in zip(bore_row(shape), shape.bores, strict=True):
        near, far = builder.round_hole((cx, cy, 0.0), (cx, cy, t), (1.0, 0.0, 0.0), bore / 2.0)
        lower.append(near)
        upper.append(far)
    for (cx, _), label in zip(bore_row(shape), shape.labels, strict=False):
        middle = (cx, MARGIN + 0.5 * label_size(label)[1] - y, t)
        upper += write_label(builder, label, middle, (1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
    builder.plane((0.0, 0.0, -1.0), lower)
    builder.plane((0.0, 0.0, 1.0), upper)
    return builder.build()


def coupon_volume(shape: CouponShape) -> float:
    """Volume [mm3] of a coupon, from its numbers."""
    length, width = coupon_size(shape)
    area = length * width - 0.25 * math.pi * sum(bore**2 for bore in shape.bores)
    return area * shape.thickness - sum(label_volume(label) for label in shape.labels)
