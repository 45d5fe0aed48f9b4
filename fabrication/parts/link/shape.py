"""Links: a bar with an eye at each end; the record, and what it is to the rest of the package."""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, Self

import numpy as np

from fabrication.boundary import Boundary
from fabrication.parts.link.boundary import link_boundary
from fabrication.parts.link.congruence import link_key, link_variants
from fabrication.parts.link.volume import link_volume
from fabrication.solids.text import Label
from fabrication.specs import Kind
from fabrication.variants import Variants

if TYPE_CHECKING:
    from fabrication.drawings.views import Drawing

LINK: Final = Kind(
    role="link",
    mark="L",
    prefix="LP",
    title="Links",
    color=(0.20, 0.45, 0.70),
)


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
    label : on the upper side of the bar, in its middle; never distinguishes two parts
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

    @property
    def hand(self) -> str:
        """Hand "right" where the far axis is turned counterclockwise as it is seen coming near."""
        return "right" if self.twist > 0 else "left"

    def key(self) -> Hashable:
        """Bores, eyes and the bar's section; never the label's text."""
        return link_key(self)

    @classmethod
    def variants(cls, shapes: Sequence[Self]) -> Variants:
        """Turned in the four ways that keep length and twist."""
        return link_variants(shapes)

    def geometry(self) -> Boundary:
        """Always exact."""
        return link_boundary(self)

    def second_volume(self) -> float:
        """Eyes less bores, and the bar's length integrated over its section."""
        return link_volume(self)

    def drawing(self, about: Mapping[str, Any]) -> Drawing:
        """What its sheet shows."""
        from fabrication.parts.link.drawing import link_drawing

        return link_drawing(self)

    def dimensions(self) -> dict[str, Any]:
        """Length, twist and hand; eyes, bore at the start, and the label."""
        return {
            "length_mm": self.length,
            "twist_deg": float(np.degrees(self.twist)),
            "hand": self.hand,
            "diameter_mm": self.eye_diameter,
            "bore_mm": self.bores[0],
            "height_mm": self.eye_height,
            "label": self.label.text if self.label else None,
        }
