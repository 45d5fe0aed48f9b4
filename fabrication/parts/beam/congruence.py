"""What makes two beams congruent: profile, cuts and holes; turned end for end where that fits."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from functools import lru_cache
from typing import TYPE_CHECKING, Final

import numpy as np

from ddgfab.mesh import Floats
from fabrication.parts.beam.end_plate import plate_key
from fabrication.specs import Profile
from fabrication.standards.profiles import is_mirror, z_range
from fabrication.variants import DECIMALS, Variants, key_of

if TYPE_CHECKING:
    from fabrication.parts.beam.shape import BeamShape, EndCut

SYMMETRY: Final = 1e-6
"""A profile is symmetric when its mirror image agrees within this [mm]."""


def beam_key(shape: BeamShape) -> Hashable:
    """What must agree exactly for two beams to be congruent."""
    ends = (key_of(shape.start.radius), key_of(shape.end.radius))
    holes = tuple((key_of(hole.z), key_of(hole.diameter)) for hole in shape.holes)
    studs = (_stud_key(shape.start), _stud_key(shape.end))
    return (_profile_key(shape.profile), ends, holes, studs, shape.is_skew)


def _stud_key(cut: EndCut) -> Hashable:
    stud, slot = cut.stud, cut.slot
    if cut.comb is not None:
        return cut.comb.key()
    if cut.straps is not None:
        return cut.straps.key()
    if cut.plate is not None:
        return plate_key(cut.plate)
    if slot is not None:
        return (key_of(slot.width), key_of(slot.depth))
    if stud is None:
        return None
    sizes = (stud.z, stud.diameter, stud.plate, stud.length, stud.height, stud.corner)
    return tuple(map(key_of, sizes))


def _levels(shape: BeamShape) -> tuple[float, float]:
    """Heights [mm] along the cuts by which ends may differ within a tolerance."""
    start, end = shape.start.comb, shape.end.comb
    return (0.0 if start is None else start.offset), (0.0 if end is None else end.offset)


@lru_cache(maxsize=64)
def _profile_key(profile: Profile) -> Hashable:
    loops: tuple[bytes, ...] = tuple(
        np.round(np.column_stack([loop.points, loop.bulges]), DECIMALS).tobytes()
        for loop in profile.loops
    )
    return profile.name, loops


@lru_cache(maxsize=64)
def _symmetric(profile: Profile) -> bool:
    return is_mirror(profile, SYMMETRY)


def fibre_ends(shape: BeamShape) -> tuple[Floats, Floats]:
    """x [mm] of both ends at the characteristic fibres of the profile.

    These are its bottom and top, for coped ends in the middle and at the sides, for skew cuts its
    four corners, right side first.
    """
    z = np.array(z_range(shape.profile))
    half = 0.5 * shape.profile.width

    def end(cut: EndCut, towards: float) -> Floats:
        middle = cut.x + cut.slope * z
        if shape.is_skew:
            return np.concatenate([middle - cut.skew * half, middle + cut.skew * half])
        if cut.radius is None:
            return middle
        sagitta = cut.radius - (cut.radius**2 - 0.25 * shape.profile.width**2) ** 0.5
        return np.concatenate([middle, middle + towards * sagitta * np.hypot(1.0, cut.slope)])

    return end(shape.start, -1.0), end(shape.end, 1.0)


def beam_variants(shapes: Sequence[BeamShape]) -> Variants:
    """Beams of one key: as they are, and turned end for end where their ends are alike."""
    ends = [fibre_ends(shape) for shape in shapes]
    start = np.array([pair[0] for pair in ends])
    end = np.array([pair[1] for pair in ends])
    holes = np.array([[hole.x for hole in shape.holes] for shape in shapes])
    middle = 0.5 * (start.mean(axis=1) + end.mean(axis=1))[:, None]
    levels = np.array([_levels(shape) for shape in shapes])
    points = np.hstack([start - middle, end - middle, holes - middle, levels])[:, None, :, None]
    turn, shift = np.zeros((len(shapes), 1)), np.zeros((len(shapes), 1, 3))
    shift[:, 0, 0] = middle[:, 0]
    first = shapes[0]
    row = [(hole.z, hole.diameter) for hole in first.holes]
    alike = first.start.radius == first.end.radius and row == row[::-1]
    if alike and _symmetric(first.profile) and _stud_key(first.start) == _stud_key(first.end):
        if first.is_skew:  # what was on the right comes to the left
            start, end = np.roll(start, 2, axis=1), np.roll(end, 2, axis=1)
        back = np.hstack([middle - end, middle - start, middle - holes[:, ::-1], levels[:, ::-1]])
        points = np.concatenate([points, back[:, None, :, None]], axis=1)
        turn = np.concatenate([turn, turn + np.pi], axis=1)
        shift = np.concatenate([shift, shift], axis=1)
    return Variants.about_z(points, turn, shift)
