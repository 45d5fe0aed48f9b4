"""Beam profiles from designations such as "RHS 120x60x5", or from free polygons.

The datum is the top center: z runs from -depth to 0, y from -width / 2 to width / 2.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from functools import cache
from typing import Any, Final

import numpy as np

from ddgfab.errors import ProjectError, clipped
from ddgfab.mesh import Floats
from fabrication.specs import Loop, Profile
from fabrication.standards.data import table
from fabrication.standards.neighbours import missing_sizes, near_profiles, written

QUARTER: Final = math.tan(math.pi / 8)  # bulge of a quarter circle
DESIGNATION: Final = re.compile(r"([A-Za-z]+) ?(\d+(?:\.\d+)?(?:x\d+(?:\.\d+)?)*)")
LEAST_SIDE: Final = 0.1
"""A side of a free polygon shorter than this [mm] is taken for a slip."""


WIDEST: Final = 1e4
"""No corner of a free polygon is farther out [mm]."""


@cache
def profile(designation: str) -> Profile:
    """Profile of a designation: FL depth x width, RHS and T depth x width x thickness, SHS.

    Raises
    ------
    ProjectError
        Not a designation, an unknown family, or dimensions that make no section; near ones listed.
    """
    families = table("profiles")
    match = DESIGNATION.fullmatch(designation.strip())
    if match is None or match[1].upper() not in families:
        raise _unknown(designation, f"families: {', '.join(families)}")
    family = match[1].upper()
    rule = families[family]
    numbers = [float(text) for text in match[2].split("x")]
    if len(numbers) != len(rule["dimensions"]):
        missing = missing_sizes(family, numbers)
        raise _unknown(
            designation, f"{family} takes {' x '.join(rule['dimensions'])} in mm{missing}"
        )
    for label, value in zip(rule["dimensions"], numbers, strict=True):
        low = 1.0 if label == "thickness" else float(rule["minimum"])
        if not low <= value <= rule["maximum"]:
            raise _unknown(
                designation, f"{label} {value:g} mm is not in {low:g}..{rule['maximum']:g} mm"
            )
    name = written(family, numbers)
    if family == "FL":
        return Profile(
            name, (_rectangle(numbers[0], numbers[1], 0.0, 0.0),), numbers[1], numbers[0]
        )
    if family == "T":
        return _tee(name, numbers[0], numbers[1], numbers[2], rolled=name in rule["rolled"])
    if family == "SHS":
        numbers = [numbers[0], *numbers]
    return _hollow(name, numbers[0], numbers[1], numbers[2], families["RHS"]["corner"])


def polygon(points: Sequence[Sequence[float]], name: str = "polygon") -> Profile:
    """Profile of a free polygon of (y, z) corners [mm], used as given; either orientation.

    Raises
    ------
    ProjectError
        Fewer than three corners, a side shorter than 0.1 mm, or sides that cross.
    """
    if len(points) < 3 or any(len(point) != 2 for point in points):
        raise ProjectError("a profile polygon needs at least three corners [y, z] in mm")
    corners = np.array(points, dtype=np.float64)
    if not np.isfinite(corners).all():
        raise ProjectError("a profile polygon has a coordinate that is not finite")
    if not (np.abs(corners) <= WIDEST).all():
        raise ProjectError(f"a corner of the profile lies beyond {WIDEST:g} mm")
    ahead = np.roll(corners, -1, axis=0)
    short = np.linalg.norm(ahead - corners, axis=1) < LEAST_SIDE
    if short.any():
        raise ProjectError(
            f"side {int(short.argmax())} of the profile polygon is shorter than {LEAST_SIDE} mm"
        )
    crossing = first_crossing(corners)
    if crossing is not None:
        raise ProjectError(f"sides {crossing[0]} and {crossing[1]} of the profile polygon cross")
    if float(np.sum(corners[:, 0] * ahead[:, 1] - corners[:, 1] * ahead[:, 0])) < 0:
        corners = corners[::-1].copy()
    spread = np.ptp(corners, axis=0)
    width = 2 * float(np.abs(corners[:, 0]).max())  # of the strip about y = 0 that it needs
    return Profile(name, (Loop(corners, np.zeros(len(corners))),), width, float(spread[1]))


def stock_lengths(section: Profile) -> tuple[tuple[float, ...], str] | None:
    """Lengths [mm] in which a profile is usually delivered, and the source; None of free polygons.

    A longer piece has to be spliced or made to order.
    """
    rule = table("profiles").get(section.name.partition(" ")[0])
    return None if rule is None else (tuple(map(float, rule["stock"])), str(rule["stock_source"]))


def lying(section: Profile) -> str:
    """Where a flat bar or hollow section lies on its side, as text, and which one stands.

    Others give an empty text: what lies is not a question of theirs.
    """
    family = section.name.partition(" ")[0]
    if family not in ("FL", "RHS") or section.width <= section.depth:
        return ""
    sizes = section.name.partition(" ")[2].split("x")
    upright = f"{family} {'x'.join([sizes[1], sizes[0], *sizes[2:]])}"
    return (
        f"{section.name} lies on its side: {section.depth:g} mm deep and {section.width:g} mm "
        f"wide, as the depth comes first; {upright} stands upright"
    )


def first_crossing(corners: Floats) -> tuple[int, int] | None:
    """Two sides of a closed (n, 2) polygon that meet although they are not neighbours, or None."""
    n = len(corners)
    ahead = np.roll(corners, -1, axis=0)

    def side(p: Floats, q: Floats, r: Floats) -> float:
        return float((q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]))

    for i in range(n):
        for j in range(i + 2, n - (i == 0)):
            a, b, c, d = corners[i], ahead[i], corners[j], ahead[j]
            if side(a, b, c) * side(a, b, d) <= 0 and side(c, d, a) * side(c, d, b) <= 0:
                return i, j
    return None


def z_range(section: Profile) -> tuple[float, float]:
    """Lowest and highest z [mm] of a profile whose outer extremes are corners or lines."""
    z = section.loops[0].points[:, 1]
    return float(z.min()), float(z.max())


def is_mirror(section: Profile, tolerance: float) -> bool:
    """Whether y -> -y maps the profile to itself, corners compared within tolerance [mm]."""
    for loop in section.loops:
        mirrored = loop.points[::-1] * [-1.0, 1.0]
        bulges = np.roll(loop.bulges[::-1], -1)
        if not any(
            np.abs(np.roll(mirrored, k, axis=0) - loop.points).max() <= tolerance
            and np.abs(np.roll(bulges, k) - loop.bulges).max() <= tolerance
            for k in range(len(mirrored))
        ):
            return False
    return True


def _unknown(designation: str, why: str) -> ProjectError:
    near = ", ".join(near_profiles(designation, _is_profile))
    return ProjectError(f'there is no profile "{clipped(designation)}": {why}; near: {near}')


def _is_profile(designation: str) -> bool:
    try:
        profile(designation)
    except ProjectError:
        return False
    return True


def _rectangle(depth: float, width: float, inset: float, radius: float) -> Loop:
    """Rectangle below the datum, moved in by inset on all sides, counterclockwise."""
    y, top, bottom = width / 2 - inset, 0.0 - inset, inset - depth
    if radius <= 0:
        points = [(-y, bottom), (y, bottom), (y, top), (-y, top)]
        return Loop(np.array(points), np.zeros(4))
    r = radius
    points = [
        (-y + r, bottom), (y - r, bottom), (y, bottom + r), (y, top - r),
        (y - r, top), (-y + r, top), (-y, top - r), (-y, bottom + r),
    ]  # fmt: skip
    return Loop(np.array(points), np.array([0.0, QUARTER] * 4))


def _hollow(
    name: str, depth: float, width: float, thickness: float, corners: Sequence[dict[str, Any]]
) -> Profile:
    factors = [rule["factor"] for rule in corners if thickness <= rule["up_to"]]
    outside = factors[0] * thickness if factors else math.inf
    if 2 * outside >= min(depth, width):
        raise _unknown(
            name, f"two corners of radius {outside:g} mm do not fit in {min(depth, width):g} mm"
        )
    hole = _rectangle(depth, width, thickness, outside - thickness)
    inner = Loop(hole.points[::-1].copy(), 0.0 - np.roll(hole.bulges[::-1], -1))
    return Profile(name, (_rectangle(depth, width, 0.0, outside), inner), width, depth)


def _tee(name: str, depth: float, width: float, thickness: float, rolled: bool) -> Profile:
    root = thickness if rolled else 0.0
    y, web, t = width / 2, thickness / 2, thickness
    if 2 * t >= min(depth, width) or web + root >= y or t + root >= depth:
        raise _unknown(name, f"thickness {t:g} mm leaves no web or flange")
    points = [(-web, -depth), (web, -depth), (web, -t - root)]
    bulges = [0.0, 0.0, -QUARTER if root else 0.0]
    if root:
        points.append((web + root, -t))
        bulges.append(0.0)
    points += [(y, -t), (y, 0.0), (-y, 0.0), (-y, -t)]
    bulges += [0.0] * 4
    if root:
        points += [(-web - root, -t), (-web, -t - root)]
        bulges[-1:] = [0.0, -QUARTER, 0.0]
    else:
        points.append((-web, -t))
        bulges.append(0.0)
    return Profile(name, (Loop(np.array(points), np.array(bulges)),), width, depth)
