"""From a mechanism to the parts of its kit: links, pins, caps, spacers, coupon, with placements."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final

import numpy as np

from ddgfab.linkages import Mechanism, Pose
from ddgfab.mesh import Floats, Ints
from fabrication.families import families
from fabrication.linkage.coupon import coupon_shape, pin_for_test
from fabrication.linkage.labels import label_for, short_number
from fabrication.linkage.pieces import ORDER, Fitting, Link, LinkagePiece, Loose, Pin
from fabrication.linkage.settings import LinkageSettings
from fabrication.linkage.shapes import Slot, heights_of, link_shapes, slots_of
from fabrication.parts.coupon import COUPON
from fabrication.parts.link import LINK, LinkShape
from fabrication.parts.pin import PIN
from fabrication.parts.ring import CAP, SPACER
from fabrication.solids.text import Label
from fabrication.specs import Check, Family, Kind, Placement

LINK_TOLERANCE: Final = 1e-6
"""Links are congruent within this [mm]: linkages with redundant bars allow no more."""

ASIDE: Final = 20.0
"""How far [mm] below the linkage its coupon is shown."""


@dataclass(frozen=True)
class StackItem:
    """A piece on a pin, from `low` to `high` [mm] along the hinge's axis."""

    mark: str
    kind: Kind
    low: float
    high: float


@dataclass(frozen=True, eq=False)
class Linkage:
    """The parts of a mechanism in its design pose.

    Attributes
    ----------
    mechanism, settings : what they were made from
    links, pins : by bar, by hinge
    fittings : caps and spacers by hinge from below
    loose : the coupon and its test pin, or nothing
    families : their part numbers; the links' labels name them
    levels : (E, 2) of the bars' ends, from 0 along the axes
    heights : (E, 2) of the eyes' middles along their axes [mm]
    stacks : what is on each pin, from below, the pin itself first
    notes : remarks for who prints and assembles them, such as links without a label
    """

    mechanism: Mechanism
    settings: LinkageSettings
    links: tuple[Link, ...]
    pins: tuple[Pin, ...]
    fittings: tuple[Fitting, ...]
    loose: tuple[Loose, ...]
    families: tuple[Family, ...]
    levels: Ints
    heights: Floats
    stacks: tuple[tuple[StackItem, ...], ...]
    notes: tuple[str, ...]

    @property
    def pieces(self) -> tuple[LinkagePiece, ...]:
        """All pieces: links, pins, fittings, and what lies beside."""
        return (*self.links, *self.pins, *self.fittings, *self.loose)

    @property
    def on_pins(self) -> tuple[Pin | Fitting, ...]:
        """Pins, caps and spacers: what moves with a hinge."""
        return (*self.pins, *self.fittings)

    def placements_at(self, pose: Pose) -> dict[str, Placement]:
        """Placements (4, 4) of the mechanism's pieces in a pose, by mark, for their own shapes.

        An instance of a family may be turned against its piece: compare their placements in the
        design pose. The coupon and its pin are no part of the mechanism and are left out.
        """
        links = self.mechanism.bar_frames(pose)
        hinges = hinge_frames(self.mechanism, pose)
        placed: dict[str, Placement] = {link.mark: links[link.bar] for link in self.links}
        for piece in self.on_pins:
            placed[piece.mark] = hinges[piece.hinge] @ self._on_hinge[piece.mark]
        return placed

    @cached_property
    def _on_hinge(self) -> dict[str, Floats]:
        """Placement of pins and fittings in the frame of their hinge."""
        design = hinge_frames(self.mechanism, self.mechanism.pose(self.mechanism.design))
        return {
            piece.mark: np.linalg.inv(design[piece.hinge]) @ piece.placement
            for piece in self.on_pins
        }


def hinge_frames(mechanism: Mechanism, pose: Pose) -> Floats:
    """(V, 4, 4) frames of the hinges: origin x_v, z the axis, turning with the first bar there."""
    frames = np.zeros((mechanism.n_hinges, 4, 4))
    frames[:, 3, 3] = 1.0
    bars = mechanism.bar_frames(pose)
    seen = np.full(mechanism.n_hinges, -1)
    for bar in range(mechanism.n_bars - 1, -1, -1):
        seen[mechanism.bars[bar]] = bar
    x = bars[seen, :3, 0]
    z = pose.axes
    frames[:, :3, 0], frames[:, :3, 1], frames[:, :3, 2] = x, np.cross(z, x), z
    frames[:, :3, 3] = pose.points
    return frames


def linkage_at(mechanism: Mechanism, settings: LinkageSettings, levels: Ints) -> Linkage:
    """All parts of a mechanism in its design pose, for given levels (E, 2) of the bars' ends.

    Raises
    ------
    DetailError
        A link that cannot be made: it is named with its pins, the value and the limit.
    """
    heights = heights_of(levels, settings)
    shapes = link_shapes(mechanism, heights, settings)
    pose = mechanism.pose(mechanism.design)
    links = _links(mechanism, levels, shapes, pose)
    numbers = {
        instance.mark: family.number
        for family in families(links, LINK_TOLERANCE)
        for instance in family.instances
    }
    notes: list[str] = []
    links = [_labelled(link, numbers[link.mark], settings, notes) for link in links]
    stacks = slots_of(mechanism, heights, settings)
    pins, fittings, items = _fittings(stacks, hinge_frames(mechanism, pose), pose)
    loose = _coupon(settings, pose) if settings.coupon else ()
    pieces: list[LinkagePiece] = [*links, *pins, *fittings, *loose]
    return Linkage(
        mechanism,
        settings,
        tuple(links),
        pins,
        fittings,
        loose,
        families(sorted(pieces, key=lambda piece: ORDER.index(piece.kind)), LINK_TOLERANCE),
        levels,
        heights,
        items,
        tuple(dict.fromkeys(notes)),
    )


def _links(mechanism: Mechanism, levels: Ints, shapes: list[LinkShape], pose: Pose) -> list[Link]:
    frames = mechanism.bar_frames(pose)
    links = []
    for bar, (i, j) in enumerate(mechanism.bars.tolist()):
        links.append(
            Link(
                mark=LINK.mark_of(bar),
                bar=bar,
                hinges=(i, j),
                pins=(PIN.mark_of(i), PIN.mark_of(j)),
                strip=int(mechanism.strips[bar]),
                direction=int(mechanism.directions[bar]),
                levels=(int(levels[bar, 0]), int(levels[bar, 1])),
                shape=shapes[bar],
                placement=frames[bar],
            )
        )
    return links


def _labelled(link: Link, number: str, settings: LinkageSettings, notes: list[str]) -> Link:
    """The link with its part number on it, where there is room, and its checks."""
    label = label_for(link.shape, short_number(number), settings)
    link = replace(link, checks=link_checks(link.shape, label, settings))
    if label is None:
        if settings.label != "none":
            notes.append(f"{number} has no label: its bar is too small for legible letters")
        return link
    return replace(link, shape=replace(link.shape, label=label))


def link_checks(
    shape: LinkShape, label: Label | None, settings: LinkageSettings
) -> tuple[Check, ...]:
    """What is left of a link where it is thinnest, and its letters, against the printer's limits.

    Checks "wall_mm" (around the bores), "bar_mm" (across the bar, under an engraved label),
    "stroke_mm" (of the letters, if there are any).
    """
    printer = settings.printer
    wall = 0.5 * (shape.eye_diameter - max(shape.bores))
    cut = max(0.0, label.depth) if label is not None else 0.0
    bar = min(shape.bar_width, shape.bar_height - cut)
    checks = [
        Check("wall_mm", wall >= printer.wall, wall, printer.wall),
        Check("bar_mm", bar >= printer.wall, bar, printer.wall),
    ]
    if label is not None:
        fine = label.unit >= printer.stroke
        checks.append(Check("stroke_mm", fine, label.unit, printer.stroke))
    return tuple(checks)


def _fittings(
    stacks: list[list[Slot]], frames: Floats, pose: Pose
) -> tuple[tuple[Pin, ...], tuple[Fitting, ...], tuple[tuple[StackItem, ...], ...]]:
    """Pins by hinge, then caps and spacers by hinge; and the stacks by mark."""
    pins: list[Pin] = []
    others: list[Fitting] = []
    items = []
    for hinge, stack in enumerate(stacks):
        row = []
        count = {CAP: 0, SPACER: 0}
        for slot in stack:
            if slot.bar is not None:
                mark = LINK.mark_of(slot.bar)
            elif slot.pin is not None:
                mark = PIN.mark_of(hinge)
            else:
                mark = f"{slot.kind.mark_of(hinge)}-{count[slot.kind]}"
                count[slot.kind] += 1
            row.append(StackItem(mark, slot.kind, slot.low, slot.high))
            motion = np.eye(4)
            motion[2, 3] = slot.low
            if slot.turned:
                motion[[1, 2], [1, 2]] = -1.0
                motion[2, 3] = slot.high
            placement = frames[hinge] @ motion
            if slot.pin is not None:
                pins.append(
                    Pin(mark, hinge, pose.points[hinge], pose.axes[hinge], slot.pin, placement)
                )
            elif slot.ring is not None:
                others.append(Fitting(mark, slot.kind, hinge, slot.ring, placement))
        items.append(tuple(row))
    return tuple(pins), tuple(others), tuple(items)


def _coupon(settings: LinkageSettings, pose: Pose) -> tuple[Loose, ...]:
    """The coupon and its test pin, below the linkage."""
    low = pose.points.min(axis=0)
    place = np.eye(4)
    place[:3, 3] = low - ASIDE - np.array([0.0, 0.0, settings.eye_height])
    beside = place.copy()
    beside[1, 3] -= ASIDE
    return (
        Loose(COUPON.mark_of(0), COUPON, coupon_shape(settings), place),
        Loose(COUPON.mark_of(1), PIN, pin_for_test(settings), beside),
    )
