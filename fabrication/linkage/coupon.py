"""The clearance coupon of a kit: bores around its pin, each with another clearance."""

from __future__ import annotations

from fabrication.linkage.settings import LinkageSettings
from fabrication.parts.coupon import MARGIN, CouponShape
from fabrication.parts.pin import PinShape
from fabrication.solids.text import ROWS, Label, text_size

HANDLE = 12.0
"""How far [mm] the test pin stands out of the coupon, to be turned by."""


def coupon_shape(settings: LinkageSettings) -> CouponShape:
    """A plate as thick as an eye with one bore for each clearance of the printer's preset.

    The bores are labelled in hundredths of a millimetre a side.
    """
    clearances = settings.printer.coupon
    bores = tuple(settings.pin_diameter + 2.0 * clearance for clearance in clearances)
    unit = max(settings.printer.stroke, 0.6)
    depth = min(settings.label_depth, settings.eye_height / 4.0)
    texts = [f"{round(100 * clearance):02d}" for clearance in clearances]
    labels = tuple(Label(text, unit, depth) for text in texts)
    if settings.label == "none":
        labels = ()
    wall = max(settings.printer.wall, 0.5 * (settings.eye_diameter - settings.bore))
    tall = ROWS * unit + MARGIN if labels else 0.0
    wide = max(text_size(text)[0] for text in texts) * unit + 2.0 * MARGIN
    pitch = max(max(bores) + max(wall, 2.0 * MARGIN), wide)
    return CouponShape(
        bores, pitch, max(bores) + 2.0 * max(wall, MARGIN) + tall, settings.eye_height, labels
    )


def pin_for_test(settings: LinkageSettings) -> PinShape:
    """The pin that is tried in the coupon; printed ones with their head."""
    length = settings.eye_height + HANDLE
    if settings.pin == "metal":
        return PinShape(settings.pin_diameter, length)
    return PinShape(settings.pin_diameter, length, settings.cap_diameter, settings.head_height)
