"""Pins, rings, caps and coupons: closed forms, sizes, and what does not fit."""

from __future__ import annotations

import math

import numpy as np
import pytest

from ddgfab.errors import DetailError
from fabrication.parts.coupon import MARGIN, CouponShape, bore_row, coupon_size
from fabrication.parts.pin import PinShape
from fabrication.parts.ring import RingShape
from fabrication.solids import boundary_of, mesh_of, properties_of, volume_of
from fabrication.solids.text import Label, label_size
from fabrication.specs import Shape


def test_pin_by_hand() -> None:
    # pi/4 (4^2 20 + 8^2 2) = 112 pi; the centroid is (16 20 10 - 64 2 1) / 448 above the head.
    pin = PinShape(4.0, 20.0, 8.0, 2.0)
    assert volume_of(pin) == pytest.approx(112 * math.pi)
    assert properties_of(pin).centroid == pytest.approx((0, 0, (3200 - 128) / 448))
    bounds = mesh_of(pin).vertices
    assert bounds[:, 2].min() == -2.0
    assert bounds[:, 2].max() == 20.0


def test_cap_by_hand() -> None:
    # pi/4 (6^2 5 - 3^2 4): the floor of 1 mm is not bored.
    cap = RingShape(6.0, 3.0, 5.0, 1.0)
    assert volume_of(cap) == pytest.approx(math.pi / 4 * (180 - 36))
    ring = RingShape(6.0, 3.0, 5.0)
    assert volume_of(ring) == pytest.approx(math.pi / 4 * (180 - 45))
    # Closed above: the middle of the upper face is solid.
    assert properties_of(cap).centroid[2] > properties_of(ring).centroid[2]


def test_coupon_by_hand() -> None:
    labels = (Label("10", 0.5, 0.6), Label("20", 0.5, 0.6))
    coupon = CouponShape((3.2, 3.4), 8.0, 14.0, 6.0, labels)
    # "10" has 8 + 12 dots, "20" 11 + 12, of 0.25 mm2 each and 0.6 mm deep.
    area = 16 * 14 - math.pi / 4 * (3.2**2 + 3.4**2)
    assert volume_of(coupon) == pytest.approx(6 * area - (20 + 23) * 0.25 * 0.6)
    assert coupon_size(coupon) == (16.0, 14.0)
    boundary = boundary_of(coupon)
    assert boundary is not None
    assert sorted(set(boundary.face_radius[boundary.face_cylinder])) == [1.6, 1.7]


def test_coupon_bores_stay_off_labels_and_borders() -> None:
    labels = tuple(Label(text, 0.6, 0.6) for text in ("10", "15", "20"))
    coupon = CouponShape((3.2, 3.3, 3.4), 8.0, 12.0, 6.0, labels)
    vertices = mesh_of(coupon).vertices
    letters = vertices[np.isclose(vertices[:, 2], 6.0 - 0.6)]
    for (x, y), bore in zip(bore_row(coupon), coupon.bores, strict=True):
        assert y + bore / 2 < 6.0
        assert abs(x) + bore / 2 < 12.0
        away = np.linalg.norm(letters[:, :2] - (x, y), axis=1)
        assert away.min() > bore / 2 + 0.5
    # Each label is in the middle under its bore, at the margin from the border.
    for (x, _), label in zip(bore_row(coupon), labels, strict=True):
        own = letters[np.abs(letters[:, 0] - x) < 4.0]
        low, high = own.min(axis=0), own.max(axis=0)
        size = label_size(label)
        assert (low[0] + high[0]) / 2 == pytest.approx(x)
        assert (low[1], high[1]) == pytest.approx((MARGIN - 6.0, MARGIN - 6.0 + size[1]))


@pytest.mark.parametrize(
    ("shape", "words"),
    [
        (PinShape(0.0, 10.0), "0 mm"),
        (PinShape(3.0, -1.0), "-1 mm"),
        (PinShape(4.0, 10.0, 4.0, 2.0), "no wider"),
        (RingShape(3.0, 3.0, 5.0), "no wall"),
        (RingShape(6.0, 3.0, 1.0, 1.0), "no bore"),
        (CouponShape((), 8.0, 12.0, 6.0), "bores"),
        (CouponShape((3.2, 7.0), 8.0, 12.0, 6.0), "7 mm"),
        (CouponShape((3.2,), 8.0, 4.0, 6.0), "make it 4.8 mm wide"),
        (CouponShape((3.2, 3.4), 8.0, 12.0, 6.0, (Label("10", 0.5, 0.5),)), "1 labels for 2"),
        (CouponShape((3.2,), 5.0, 14.0, 6.0, (Label("1068", 0.6, 0.5),)), '"1068"'),
    ],
)
def test_what_does_not_fit_is_said(shape: Shape, words: str) -> None:
    with pytest.raises(DetailError) as error:
        boundary_of(shape)
    assert words in str(error.value)
