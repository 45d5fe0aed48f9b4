"""Plates: what is cut from a sheet, as the outlines of its two faces."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, Protocol, runtime_checkable

import numpy as np

from fabrication.boundary import Boundary
from fabrication.solids.prism import frame_along, prism, seen_loops
from fabrication.solids.section import section_area
from fabrication.specs import Loop

FLAT: Final = 0.5
"""A plate is thinner than this part of its least width."""

PARALLEL: Final = 1e-10
"""Two faces are parallel when their angle is below this [rad]."""


@dataclass(frozen=True, eq=False)
class Plate:
    """A plate between two parallel faces.

    Attributes
    ----------
    thickness : between its faces [mm]
    loops : of the larger face, or of both where they are the same: the outer one counterclockwise,
        holes clockwise, seen from outside onto the face that is named last
    other : of the other face where its outline is another one (bevelled sides)
    count : how many of them the part is made of
    rest : volume [mm3] of the part that is not theirs
    up : direction of the part's z axis in the plane of the outlines, which is outwards for beams;
        None where it is another one
    """

    thickness: float
    loops: tuple[Loop, ...]
    other: tuple[Loop, ...] = ()
    count: int = 1
    rest: float = 0.0
    up: tuple[float, float] | None = None


@dataclass(frozen=True, order=True)
class Blank:
    """A rectangle of plate that a piece of a part is cut from [mm].

    use : what the piece is
    width, height : smaller and larger side of the least rectangle round it
    """

    use: str
    thickness: float
    width: float
    height: float


@runtime_checkable
class FromPlate(Protocol):
    """A shape with pieces that are cut from plate."""

    def blanks(self) -> Sequence[Blank]:
        """What each of them is cut from."""
        ...


@runtime_checkable
class OfPlates(Protocol):
    """A shape that is made of equal plates, and more."""

    def plate(self) -> Plate:
        """One of its plates."""
        ...


def plate(boundary: Boundary, *, bevelled: bool = False) -> Plate | None:
    """The boundary as a plate, or None where it is none.

    Parameters
    ----------
    bevelled : whether its sides may be inclined
    """
    swept = prism(boundary, "shortest")
    if swept is not None and swept.low.straight and swept.high.straight:
        width = float(np.ptp(swept.loops[0].points, axis=0).min())
        u, v = (float(swept.frame[2, k]) for k in (0, 1))
        up = (u, v) if math.hypot(u, v) > 1.0 - 1e-9 else None
        return Plate(swept.length, swept.loops, up=up) if swept.length < FLAT * width else None
    return _bevelled(boundary) if bevelled else None


def _bevelled(boundary: Boundary) -> Plate | None:
    """A plate whose sides are inclined: its two faces are those that no side is parallel to."""
    flat = np.flatnonzero(~boundary.face_cylinder)
    normals = boundary.face_axis[flat]
    cosine = normals @ normals.T
    pairs = [(i, j) for i, j in zip(*np.nonzero(np.triu(cosine < PARALLEL - 1.0)), strict=True)]
    found = []
    for i, j in pairs:
        if normals[j][np.argmax(np.abs(normals[j]) > 0.5)] < 0.0:  # as a prism's frame is chosen
            i, j = j, i
        frame = frame_along(normals[j])
        both = [seen_loops(boundary, int(face), frame) for face in (flat[j], flat[i])]
        if both[0] is None or both[1] is None:
            continue
        mirrored = tuple(_turned(loop) for loop in both[1])
        height = normals[j] @ (boundary.face_origin[flat[j]] - boundary.face_origin[flat[i]])
        areas = (section_area(both[0]), section_area(mirrored))
        loops, other = (both[0], mirrored) if areas[0] >= areas[1] else (mirrored, both[0])
        found.append((min(areas), Plate(float(height), loops, other)))
    if not found:
        return None
    largest = max(found, key=lambda one: one[0])[1]
    width = float(np.ptp(largest.loops[0].points, axis=0).min())
    return largest if 0.0 < largest.thickness < FLAT * width else None


def _turned(loop: Loop) -> Loop:
    """The same curve the other way round."""
    return Loop(loop.points[::-1].copy(), -np.roll(loop.bulges[::-1], -1))
