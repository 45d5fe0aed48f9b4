"""Shapes of a linkage's links, pins, caps and spacers for given levels."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ddgfab.linkages import Mechanism
from ddgfab.mesh import Floats, Ints
from fabrication.linkage.levels import bars_at
from fabrication.linkage.settings import LinkageSettings
from fabrication.parts.link import LINK, LinkShape
from fabrication.parts.pin import PIN, PinShape
from fabrication.parts.ring import CAP, SPACER, RingShape
from fabrication.specs import Kind


def heights_of(levels: Ints, settings: LinkageSettings) -> Floats:
    """(E, 2) where the middles of the eyes are along their axes [mm]; the levels lie about 0."""
    return np.asarray((levels - 0.5 * (levels.min() + levels.max())) * settings.pitch)


def link_shapes(
    mechanism: Mechanism, heights: Floats, settings: LinkageSettings
) -> list[LinkShape]:
    """The link of each bar, without labels."""
    return [
        LinkShape(
            length=length,
            twist=twist,
            start=start,
            end=end,
            eye_diameter=settings.eye_diameter,
            eye_height=settings.eye_height,
            bores=(settings.bore, settings.bore),
            bar_width=settings.bar_width,
            bar_height=settings.bar_height,
            bevel=settings.bevel,
        )
        for length, twist, (start, end) in zip(
            mechanism.lengths.tolist(), mechanism.twists.tolist(), heights.tolist(), strict=True
        )
    ]


@dataclass(frozen=True)
class Slot:
    """A place on a pin from `low` to `high` [mm along the hinge's axis], and its part's kind.

    bar : of a link, else None
    pin : the shape of a pin, else None
    ring : the shape of a cap or spacer, else None
    turned : whether the part's z runs against the axis
    """

    kind: Kind
    low: float
    high: float
    bar: int | None = None
    pin: PinShape | None = None
    ring: RingShape | None = None
    turned: bool = False


def slots_of(mechanism: Mechanism, heights: Floats, settings: LinkageSettings) -> list[list[Slot]]:
    """For each hinge its pin first, then from below what is on it: caps, links, spacers.

    Everything on a pin has the axial gap to its neighbours; spacers fill levels that are empty in
    between. A printed pin's head is below all.
    """
    s = settings
    half = s.eye_height / 2.0
    cap = RingShape(s.cap_diameter, s.pin_diameter + 2.0 * s.press, s.cap_grip + s.cap_floor,
                    s.cap_floor)  # fmt: skip
    stacks = []
    for hinge, bars in enumerate(bars_at(mechanism)):
        ends = mechanism.bars[bars] == hinge
        at = sorted(zip(heights[bars][ends].tolist(), bars, strict=True))
        low, high = at[0][0] - half - s.axial_gap, at[-1][0] + half + s.axial_gap
        stack: list[Slot] = []
        if s.pin == "metal":
            length = high - low + 2.0 * s.cap_grip
            pin = PinShape(s.pin_diameter, length)
            stack.append(Slot(PIN, low - s.cap_grip, high + s.cap_grip, pin=pin))
            stack.append(Slot(CAP, low - cap.height, low, ring=cap, turned=True))
        else:
            pin = PinShape(s.pin_diameter, high - low + s.cap_grip, s.cap_diameter, s.head_height)
            stack.append(Slot(PIN, low, high + s.cap_grip, pin=pin))
        below = at[0][0]
        for place, bar in at:
            foot, top = below + half + s.axial_gap, place - half - s.axial_gap
            if top - foot > s.axial_gap:
                ring = RingShape(s.eye_diameter, s.bore, top - foot)
                stack.append(Slot(SPACER, foot, top, ring=ring))
            stack.append(Slot(LINK, place - half, place + half, bar=bar))
            below = place
        stack.append(Slot(CAP, high, high + cap.height, ring=cap))
        stacks.append(stack)
    return stacks
