"""What makes two shapes congruent: discrete keys, and characteristic points in canonical frames."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from functools import lru_cache
from typing import Final, cast

import numpy as np

from ddgfab.mesh import Floats
from fabrication.linkshapes import linkage_key
from fabrication.specs import BeamShape, EndCut, NodeShape, PanelShape, Piece, Profile, Shape
from fabrication.standards.profiles import is_mirror, z_range
from fabrication.variants import DECIMALS, Variants, key_of

SYMMETRY: Final = 1e-6
"""A profile is symmetric when its mirror image agrees within this [mm]."""

ROUND: Final = 1e-3
"""Below this part of a polygon's size its first Fourier coefficient gives no direction."""


def shape_key(shape: Shape) -> Hashable:
    """What must agree exactly for two shapes to be congruent, however they are turned."""
    if isinstance(shape, BeamShape):
        ends = (key_of(shape.start.radius), key_of(shape.end.radius))
        holes = tuple((key_of(hole.z), key_of(hole.diameter)) for hole in shape.holes)
        return ("beam", _profile_key(shape.profile), ends, holes, is_skew(shape))
    if isinstance(shape, PanelShape):
        same = np.array_equal(shape.inner, shape.outer)
        return (
            "panel",
            len(shape.inner),
            same,
            key_of(shape.thickness),
            key_of(shape.corner_radius),
        )
    if not isinstance(shape, NodeShape):
        return linkage_key(shape)
    mark = shape.mark and (
        key_of(shape.mark.x),
        key_of(shape.mark.diameter),
        key_of(shape.mark.depth),
    )
    seats = tuple(sorted((key_of(s.distance), key_of(s.width)) for s in shape.seats))
    drilled = tuple(sorted(key_of(hole.diameter) for hole in shape.holes))
    return ("node", key_of(shape.radius), key_of(shape.bore), mark, seats, drilled)


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


def is_skew(shape: BeamShape) -> bool:
    """Whether a cut of the beam is a compound angle; its ends are flat then."""
    return shape.start.skew != 0.0 or shape.end.skew != 0.0


def fibre_ends(shape: BeamShape) -> tuple[Floats, Floats]:
    """x [mm] of both ends at the characteristic fibres: bottom and top, for coped ends in the
    middle and at the sides of the profile; for skew cuts at its four corners, right side first."""
    z = np.array(z_range(shape.profile))
    half = 0.5 * shape.profile.width

    def end(cut: EndCut, towards: float) -> Floats:
        middle = cut.x + cut.slope * z
        if is_skew(shape):
            return np.concatenate([middle - cut.skew * half, middle + cut.skew * half])
        if cut.radius is None:
            return middle
        sagitta = cut.radius - (cut.radius**2 - 0.25 * shape.profile.width**2) ** 0.5
        return np.concatenate([middle, middle + towards * sagitta * np.hypot(1.0, cut.slope)])

    return end(shape.start, -1.0), end(shape.end, 1.0)


def beam_variants(pieces: Sequence[Piece]) -> Variants:
    """Beams of one key: as they are, and turned end for end where nothing tells the ends apart."""
    shapes = [cast(BeamShape, piece.shape) for piece in pieces]
    ends = [fibre_ends(shape) for shape in shapes]
    start = np.array([pair[0] for pair in ends])
    end = np.array([pair[1] for pair in ends])
    holes = np.array([[hole.x for hole in shape.holes] for shape in shapes])
    middle = 0.5 * (start.mean(axis=1) + end.mean(axis=1))[:, None]
    points = np.hstack([start - middle, end - middle, holes - middle])[:, None, :, None]
    turn, shift = np.zeros((len(shapes), 1)), np.zeros((len(shapes), 1, 3))
    shift[:, 0, 0] = middle[:, 0]
    first = shapes[0]
    row = [(hole.z, hole.diameter) for hole in first.holes]
    if _symmetric(first.profile) and first.start.radius == first.end.radius and row == row[::-1]:
        if is_skew(first):  # what was on the right comes to the left
            start, end = np.roll(start, 2, axis=1), np.roll(end, 2, axis=1)
        back = np.hstack([middle - end, middle - start, middle - holes[:, ::-1]])
        points = np.concatenate([points, back[:, None, :, None]], axis=1)
        turn = np.concatenate([turn, turn + np.pi], axis=1)
        shift = np.concatenate([shift, shift], axis=1)
    return Variants.about_z(points, turn, shift)


def panel_variants(pieces: Sequence[Piece]) -> Variants:
    """Panels of one key, beginning at each of their corners.

    The frame's direction is that of the first Fourier coefficient of the corners, which depends on
    all corners alike and turns with the polygon.
    """
    shapes = [cast(PanelShape, piece.shape) for piece in pieces]
    inner = np.array([shape.inner for shape in shapes]) @ [1.0, 1j]
    outer = np.array([shape.outer for shape in shapes]) @ [1.0, 1j]
    count = inner.shape[1]
    centre = inner.mean(axis=1)
    inner, outer = inner - centre[:, None], outer - centre[:, None]
    wave = np.exp(-2j * np.pi * np.arange(count) / count)
    first = inner @ wave
    doubtful = bool((np.abs(first) < ROUND * np.abs(inner).sum(axis=1)).any())
    square = np.array_equal(shapes[0].inner, shapes[0].outer)
    points, turns = [], []
    for k in range(count):
        own = np.roll(inner, -k, axis=1)
        turned = own[:, 1] - own[:, 0] if doubtful else first * wave[k].conj()
        turned = turned / np.abs(turned)
        corners = own if square else np.hstack([own, np.roll(outer, -k, axis=1)])
        corners = corners * turned.conj()[:, None]
        points.append(np.stack([corners.real, corners.imag], axis=-1))
        turns.append(np.angle(turned))
    shift = np.zeros((len(shapes), count, 3))
    shift[:, :, 0], shift[:, :, 1] = centre.real[:, None], centre.imag[:, None]
    return Variants.about_z(np.stack(points, axis=1), np.stack(turns, axis=1), shift)


def node_variants(pieces: Sequence[Piece]) -> Variants:
    """Nodes of one key, beginning at each of their arms; the height from the bottom counts.

    A node without seats and holes is the same however its arms lie: its mark alone says where
    azimuth 0 is. Seats and holes must belong to the same arms to be turned.
    """
    shapes = [cast(NodeShape, piece.shape) for piece in pieces]
    first = shapes[0]
    n, count = len(shapes), max(len(first.seats), len(first.holes))
    height = np.array([[shape.z1 - shape.z0] for shape in shapes])
    seats = np.array([[seat.azimuth for seat in shape.seats] for shape in shapes])
    holes = np.array([[hole.azimuth for hole in shape.holes] for shape in shapes])
    levels = np.array([[hole.z - shape.z0 for hole in shape.holes] for shape in shapes])
    depths = np.array([[key_of(hole.depth) for hole in shape.holes] for shape in shapes])
    turnable = len(first.seats) in (0, count) and len(first.holes) in (0, count)
    points, turns = [], []
    for k in range(count if turnable and count else 1):
        start = (seats if seats.size else holes)[:, k] if turnable and count else np.zeros(n)
        around = np.roll(seats, -k, axis=1) - start[:, None]
        drilled = np.roll(holes, -k, axis=1) - start[:, None]
        parts = [
            _ring(0 * height, 0 * height, height),
            _ring(first.radius, around, 0 * around),
            _ring(first.radius, around, height + 0 * around),
            _ring(first.radius, drilled, np.roll(levels, -k, axis=1)),
            _ring(0 * drilled, drilled, np.roll(depths, -k, axis=1)),
        ]
        points.append(np.concatenate(parts, axis=1))
        turns.append(start)
    shift = np.zeros((n, len(turns), 3))
    shift[:, :, 2] = np.array([[shape.z0] for shape in shapes])
    return Variants.about_z(np.stack(points, axis=1), np.stack(turns, axis=1), shift)


def _ring(radius: float | Floats, azimuth: Floats, z: Floats) -> Floats:
    """(N, k, 3) points in cylinder coordinates, each coordinate (N, k) or one number."""
    return np.stack([radius * np.cos(azimuth), radius * np.sin(azimuth), z], axis=-1)
