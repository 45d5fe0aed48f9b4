"""Tongues between straps: the ends of thin flat bars are doubled by straps on their sides.

The tongue is a little thinner than the bar. Distances: EN 1993-1-8:2005, table 3.3; lengths of
welds 4.5.1. Rules of our own: how much thinner, and the thickness of a strap.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from ddgfab.errors import DetailError
from fabrication.gridshell.detailing.connections.tongue import STEP, BoltedTongue
from fabrication.gridshell.detailing.frames import beam_mark, node_mark
from fabrication.parts.beam import StrapEnd
from fabrication.parts.beam.slot import bar_sides
from fabrication.standards import plates
from fabrication.standards.fasteners import fasteners

if TYPE_CHECKING:
    from fabrication.gridshell.detailing.nodes.base import Joints
    from fabrication.specs import Profile

THINNER: Final = 2.0
"""A tongue is thinner than the bar by this [mm] at most: bolts draw the straps onto it."""

LAND: Final = 2.0
"""What is left of the side of the bar beyond the leg of a strap's weld [mm]."""

LEAST_STRAP: Final = 5.0
"""Least thickness of a strap [mm]; it is half as thick as the tongue or more."""

LEAST_LAP: Final = 5.0
"""Least length of a strap on the bar, in its thicknesses."""

SLACK: Final = 1e-9


@dataclass(frozen=True)
class DoubledTongue(BoltedTongue):
    """Two bolts through two straps and the tongue between them.

    given : thickness of the tongue [mm] that the project asks for; None: the thickest of stock
    weld : throat thickness of the welds between straps and bar [mm]
    """

    given: float | None = None
    weld: float = 0.0

    def thickness(self, profile: Profile) -> float:
        """Of the tongue [mm]: of stock, thinner than the bar by two clearances and up to 2 mm."""
        most = profile.width - 2.0 * self.clearance
        if self.given is not None:
            return self.given
        return max((t for t in plates() if t <= most + SLACK), default=most)

    def strap(self, profile: Profile) -> float:
        """Thickness of a strap [mm]."""
        least = max(0.5 * self.thickness(profile), LEAST_STRAP)
        return next(t for t in plates() if t >= least - SLACK)

    def half(self, profile: Profile) -> float:
        """From the middle of the bar to the outer side of a strap [mm]."""
        return 0.5 * profile.width + self.strap(profile)

    def gap(self, profile: Profile) -> float:
        """From strap to strap [mm]: the width of the bar."""
        return profile.width

    def arm_width(self, profile: Profile) -> float:
        """Straps are wider than the bar."""
        return 2.0 * self.half(profile)

    def height(self, profile: Profile) -> float:
        """Of a strap [mm]: its welds lie on the sides of the bar."""
        _, low, high = bar_sides(profile)
        free = high - low - 2.0 * (self.weld * math.sqrt(2.0) + LAND)
        return STEP * math.floor(free / STEP + SLACK)

    def cheeks(self, profile: Profile, reach: float) -> StrapEnd:
        """The straps; their welds are 30 mm and 6 throats long or more, beside their ends."""
        thick = self.strap(profile)
        lap = max(LEAST_LAP * thick, 30.0 + 2.0 * self.weld, 8.0 * self.weld)
        return StrapEnd(thick, self.height(profile), reach, STEP * math.ceil(lap / STEP - SLACK))

    def suits(self, profile: Profile) -> bool:
        """Whether tongue, straps and holes go with a flat bar."""
        return self._goes_between(profile) and 0.5 * self.height(profile) >= self.size.edge

    def _goes_between(self, profile: Profile) -> bool:
        """Whether the tongue is as thick as the width of a bar allows."""
        thick, most = self.thickness(profile), profile.width - 2.0 * self.clearance
        return profile.width - THINNER - SLACK <= thick <= most + SLACK

    def check_profile(self, joints: Joints) -> None:
        """Raise where tongue or straps do not go with the bar."""
        profile, arms = joints.profile, joints.arms
        where = f"node {node_mark(arms.node[0])}, beam {beam_mark(arms.edge[0])} (and all others): "
        thick, most = self.thickness(profile), profile.width - 2.0 * self.clearance
        if not self._goes_between(profile):
            near = sorted(plates(), key=lambda t: abs(t + THINNER - profile.width))[:2]
            bars = " or ".join(f'"FL {profile.depth:g}x{t + THINNER:g}"' for t in sorted(near))
            raise DetailError(
                f"{where}a tongue of {thick:g} mm between straps on {profile.name}, "
                f"{profile.width:g} mm wide: it must be {profile.width - THINNER:g} to {most:g} mm "
                f"thick\ntake [connection] plate_mm = {most:g}, which is cut to measure, or for "
                f"plate of stock [beam] profile = {bars}"
            )
        if 0.5 * self.height(profile) < self.size.edge:
            fits = [m.size for m in fasteners() if 0.5 * self.height(profile) >= m.edge]
            deep = 2.0 * (self.size.edge + self.weld * math.sqrt(2.0) + LAND) + STEP
            raise DetailError(
                f"{where}the holes for {self.size.size} are {0.5 * self.height(profile):.1f} mm "
                f"from the edge of straps on {profile.name}; at least {self.size.edge:.1f} mm, 1.2 "
                "hole diameters (EN 1993-1-8, table 3.3)\ntake "
                + (f'[connection] bolt = "{fits[-1]}" or ' if fits else "")
                + f'[beam] profile = "FL {STEP * math.ceil(deep / STEP):g}x{profile.width:g}"'
            )
