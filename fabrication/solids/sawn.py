"""Bars that are sawn from a profile: what saws and drills are told."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np

from fabrication.solids.section import section_area, segments
from fabrication.specs import Loop, Profile


@dataclass(frozen=True, eq=False)
class SawnBar:
    """A profile between two plane cuts that are inclined in its plane y = 0 only [mm].

    Attributes
    ----------
    profile : y across, z up
    start, end : (x, slope) of the planes x + slope z
    holes : (x, z, diameter) of holes through the whole bar along y
    volume : [mm3]
    """

    profile: Profile
    start: tuple[float, float]
    end: tuple[float, float]
    holes: tuple[tuple[float, float, float], ...]
    volume: float


@dataclass(frozen=True)
class Section:
    """What a profile measures [mm, mm2].

    code : B for flat bars, M for hollow sections, T for tees
    low : z of its lower edge
    flange, web : thickness of flange and web; of hollow sections the wall, of flat bars the width
    radius : of the outer corners, of tees between web and flange; 0 where they are sharp
    area, outline : of the cross-section, and the length of its outer line
    """

    code: str
    low: float
    flange: float
    web: float
    radius: float
    area: float
    outline: float


@runtime_checkable
class OfBar(Protocol):
    """A shape that may be a sawn bar, alone or with more joined to it."""

    def sawn(self) -> SawnBar | None:
        """The bar; None where it needs more than a saw and a drill."""
        ...


def section_of(profile: Profile) -> Section | None:
    """The measures of a flat bar, hollow section or tee; None for another outline."""
    outer, *inner = profile.loops
    low, high = float(outer.points[:, 1].min()), float(outer.points[:, 1].max())
    area, outline = section_area(profile.loops), _length(outer)
    arcs = [s.radius for s in segments(outer) if s.turn]
    radius = max(arcs, default=0.0)
    if len(inner) == 1:
        wall = float(0.5 * (profile.width - np.ptp(inner[0].points[:, 0])))
        return Section("M", low, wall, wall, radius, area, outline)
    if inner:
        return None
    if math.isclose(area, profile.width * profile.depth, rel_tol=1e-9):
        return Section("B", low, profile.width, profile.width, 0.0, area, outline)
    half = np.abs(outer.points[:, 0])
    wide = outer.points[half > 0.5 * profile.width * (1.0 - 1e-9), 1]
    tips = outer.points[outer.points[:, 1] < low + 1e-9, 0]
    if len(wide) == 4 and abs(wide.max() - high) < 1e-9 and len(tips) == 2:
        flange, web = float(np.ptp(wide)), float(np.ptp(tips))
        return Section("T", low, flange, web, radius, area, outline)
    return None


def _length(loop: Loop) -> float:
    """Length of a loop of lines and arcs."""
    return sum(
        s.radius * abs(s.turn) if s.turn else math.hypot(s.u1 - s.u0, s.v1 - s.v0)
        for s in segments(loop)
    )
