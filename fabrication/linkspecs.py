"""Shapes of a linkage's parts as plain numbers: link, pin, ring, coupon, and the label on them.

`fabrication.specs` takes them into `Shape`, and holds the pieces. Millimetres and radians.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Label:
    """A short text of square dots on a flat face; see `fabrication.solids.text`.

    text : what is written; the glyphs that exist are those of `fabrication.solids.text`
    unit : side of a dot [mm]: the width of a stroke, and of the gaps within a letter
    depth : how deep the text is engraved [mm]; negative: how far it stands out
    stacked : letters stand one below the other along the bar instead of beside each other
    """

    text: str
    unit: float
    depth: float
    stacked: bool = False


@dataclass(frozen=True)
class LinkShape:
    """A bar with a round eye at each end, bored along the two hinge axes.

    Frame: origin on the axis of the start hinge, which is z; x towards the end hinge, whose axis
    passes through (length, 0, 0) in the direction (0, -sin twist, cos twist). Both axes are
    perpendicular to x.

    length : distance [mm] of the hinge axes, along their common perpendicular
    twist : signed angle [rad] between the axes about x, at most a half turn
    start, end : where the middle of each eye is along its own axis [mm]
    eye_diameter, eye_height : of both eyes [mm]; the height is along the axis
    bores : diameters [mm] at start and end
    bar_width, bar_height : of the bar's rectangular section [mm]; its height stands along the mean
        of the two axes
    bevel : what is taken off the section's corners [mm], at 45 degrees; 0 for sharp ones
    label : on the upper side of the bar, in its middle; never tells two parts apart
    """

    length: float
    twist: float
    start: float
    end: float
    eye_diameter: float
    eye_height: float
    bores: tuple[float, float]
    bar_width: float
    bar_height: float
    bevel: float = 0.0
    label: Label | None = None


@dataclass(frozen=True)
class PinShape:
    """A round pin along z, from z = 0 to its length; its head, if any, is below z = 0.

    Without a head (0 mm) it is a length of metal rod.
    """

    diameter: float
    length: float
    head_diameter: float = 0.0
    head_height: float = 0.0


@dataclass(frozen=True)
class RingShape:
    """A ring about z, from z = 0 to height; a floor closes its upper end and makes it a cap.

    floor : thickness [mm] of the closed end, 0 for a ring that is open at both ends
    """

    diameter: float
    bore: float
    height: float
    floor: float = 0.0


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
