"""From a mechanism to the parts of its kit: links, pins, caps, spacers, coupon, with placements."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final

import numpy as np

from ddgfab.errors import DetailError
from ddgfab.linkages import Mechanism, Pose
from ddgfab.mesh import Floats, Ints
from fabrication.families import families
from fabrication.linkage.bodies import bodies
from fabrication.linkage.choose import Prefer, check_links, rank_levels
from fabrication.linkage.coupon import coupon_shape, pin_for_test
from fabrication.linkage.labels import label_for, short_number
from fabrication.linkage.levels import even_levels
from fabrication.linkage.pieces import ORDER, Fitting, Link, LinkagePiece, Loose, Pin
from fabrication.linkage.settings import LinkageSettings
from fabrication.linkage.shapes import Seat, heights_of, link_shapes, seats_of
from fabrication.motion.convex import ConvexPieces
from fabrication.motion.free_range import JOINT_CLEARANCE
from fabrication.motion.pairs import Rules
from fabrication.motion.proof import Search
from fabrication.parts.coupon import COUPON
from fabrication.parts.link import LINK, LinkShape
from fabrication.parts.pin import PIN
from fabrication.parts.ring import CAP, SPACER
from fabrication.solids.text import Label
from fabrication.specs import Check, Family, Kind, Placement

LINK_TOLERANCE: Final = 1e-6
"""Links are congruent within this [mm]: linkages with redundant bars allow no more."""

MOST_TRIED: Final = 12
"""How many choices of levels are tried before it is said that none keeps the parts apart."""

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
    notes : what a maker has to hear
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

        An instance of a family may be turned against its piece: its placement in the design pose
        tells how. The coupon and its pin are no part of the mechanism and are left out.
        """
        links = self.mechanism.bar_frames(pose)
        hinges = hinge_frames(self.mechanism, pose)
        placed: dict[str, Placement] = {link.mark: links[link.bar] for link in self.links}
        for piece in self.on_pins:
            placed[piece.mark] = hinges[piece.hinge] @ self._seat[piece.mark]
        return placed

    @cached_property
    def _seat(self) -> dict[str, Floats]:
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


def detail_linkage(
    mechanism: Mechanism,
    settings: LinkageSettings,
    levels: Ints | Iterable[Ints] | None = None,
    prefer: Prefer = "parts",
) -> Linkage:
    """Parts of a mechanism, in its design pose, in which they do not touch.

    Parameters
    ----------
    levels : (E, 2) of the bars' ends, taken as they are; or choices of them, or by default all that
        `fabrication.linkage.levels.even_levels` gives, of which the best that fits is taken
    prefer : what the best one is: "parts" for few part numbers, "range" for a large free range

    Raises
    ------
    DetailError
        A link that cannot be made: it is named with its pins, the value, the limit and what helps;
        or parts that touch in the design pose whatever the levels: they are named with their pins.
    """
    if isinstance(levels, np.ndarray):
        shapes = link_shapes(mechanism, heights_of(levels, settings), settings)
        check_links(mechanism, shapes)
        return _kit(mechanism, settings, levels)
    choices = even_levels(mechanism, settings.max_levels) if levels is None else levels
    first: Touch | None = None
    for choice in rank_levels(mechanism, settings, choices, prefer)[:MOST_TRIED]:
        linkage = _kit(mechanism, settings, choice.levels)
        touching = touching_parts(linkage)
        if not touching:
            return linkage
        first = first or touching[0]
    assert first is not None
    raise _no_levels(mechanism, first)


@dataclass(frozen=True)
class Touch:
    """Two parts that are too near each other: their marks, gap and limit [mm]."""

    marks: tuple[str, str]
    gap: float
    limit: float


def touching_parts(linkage: Linkage) -> tuple[Touch, ...]:
    """Parts too near each other in the design pose, worst first; then those on one pin whose
    distance never changes."""
    mechanism, solids = linkage.mechanism, bodies(linkage)
    pieces = ConvexPieces.build(mechanism, solids)
    rules = Rules.build(mechanism, solids, linkage.settings.axial_gap, JOINT_CLEARANCE)
    search = Search(mechanism, pieces, rules)
    return tuple(
        Touch((solids[pieces.body[k.a]].mark, solids[pieces.body[k.b]].mark), k.gap, k.limit)
        for k in search.too_near(mechanism.design) + search.standing()
    )


def _no_levels(mechanism: Mechanism, touch: Touch) -> DetailError:
    """What to say where no levels help: the parts and pins that meet."""

    def words(mark: str) -> str:
        if not mark.startswith("L"):
            return mark
        i, j = mechanism.bars[int(mark[2:])].tolist()
        return f"{mark} (on pins {PIN.mark_of(i)}, {PIN.mark_of(j)})"

    return DetailError(
        f"no levels keep all parts apart in the design pose: {words(touch.marks[0])} and "
        f"{words(touch.marks[1])} are {touch.gap:.3g} mm apart; limit {touch.limit:g} mm.\n"
        f"Take another design pose, longer or slimmer bars, or smaller eyes"
    )


def _kit(mechanism: Mechanism, settings: LinkageSettings, levels: Ints) -> Linkage:
    """All parts for given levels."""
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
    stacks = seats_of(mechanism, heights, settings)
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
    stacks: list[list[Seat]], frames: Floats, pose: Pose
) -> tuple[tuple[Pin, ...], tuple[Fitting, ...], tuple[tuple[StackItem, ...], ...]]:
    """Pins by hinge, then caps and spacers by hinge; and the stacks by mark."""
    pins: list[Pin] = []
    others: list[Fitting] = []
    items = []
    for hinge, stack in enumerate(stacks):
        row = []
        count = {CAP: 0, SPACER: 0}
        for seat in stack:
            if seat.bar is not None:
                mark = LINK.mark_of(seat.bar)
            elif seat.pin is not None:
                mark = PIN.mark_of(hinge)
            else:
                mark = f"{seat.kind.mark_of(hinge)}-{count[seat.kind]}"
                count[seat.kind] += 1
            row.append(StackItem(mark, seat.kind, seat.low, seat.high))
            motion = np.eye(4)
            motion[2, 3] = seat.low
            if seat.turned:
                motion[[1, 2], [1, 2]] = -1.0
                motion[2, 3] = seat.high
            placement = frames[hinge] @ motion
            if seat.pin is not None:
                pins.append(
                    Pin(mark, hinge, pose.points[hinge], pose.axes[hinge], seat.pin, placement)
                )
            elif seat.ring is not None:
                others.append(Fitting(mark, seat.kind, hinge, seat.ring, placement))
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
