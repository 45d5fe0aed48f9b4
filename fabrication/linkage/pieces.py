"""Pieces of a linkage: links, pins, the rings on them, and what lies beside the linkage.

Millimetres and radians. What is made of them is in `fabrication.parts`.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Final, TypeAlias

from ddgfab.mesh import Floats
from fabrication.parts.coupon import COUPON
from fabrication.parts.link import LINK, LinkShape
from fabrication.parts.pin import PIN, PinShape
from fabrication.parts.ring import CAP, SPACER, RingShape
from fabrication.specs import Check, Kind, Placement, Shape

ORDER: Final = (LINK, PIN, CAP, SPACER, COUPON)
"""Kinds of a kit in the order of their part numbers."""


@dataclass(frozen=True, eq=False)
class Link:
    """One bar of a linkage: bar id, its hinges and their pins' marks, strip and direction.

    levels : of its eyes in the stacks at its two hinges, counted from 0 against the axes
    """

    mark: str
    bar: int
    hinges: tuple[int, int]
    pins: tuple[str, str]
    strip: int
    direction: int
    levels: tuple[int, int]
    shape: LinkShape
    placement: Placement
    kind: Kind = field(default=LINK, init=False)
    checks: tuple[Check, ...] = ()


@dataclass(frozen=True, eq=False)
class Pin:
    """The pin of one hinge: hinge id, position [mm] and unit axis in the design pose."""

    mark: str
    hinge: int
    position: Floats
    axis: Floats
    shape: PinShape
    placement: Placement
    kind: Kind = field(default=PIN, init=False)
    checks: tuple[Check, ...] = ()


@dataclass(frozen=True, eq=False)
class Fitting:
    """A cap or spacer on the pin of a hinge."""

    mark: str
    kind: Kind
    hinge: int
    shape: RingShape
    placement: Placement
    checks: tuple[Check, ...] = ()


@dataclass(frozen=True, eq=False)
class Loose:
    """A part that lies beside the linkage and does not move with it: the coupon, its test pin."""

    mark: str
    kind: Kind
    shape: Shape
    placement: Placement
    checks: tuple[Check, ...] = ()


LinkagePiece: TypeAlias = Link | Pin | Fitting | Loose
