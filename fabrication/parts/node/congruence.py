"""What makes two nodes congruent: seats and holes at the same azimuths from some arm."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from ddgfab.mesh import Floats
from fabrication.variants import Variants, key_of

if TYPE_CHECKING:
    from fabrication.parts.node.shape import NodeShape


def node_key(shape: NodeShape) -> Hashable:
    """What must agree exactly for two nodes to be congruent."""
    mark = shape.mark and (
        key_of(shape.mark.x),
        key_of(shape.mark.diameter),
        key_of(shape.mark.depth),
    )
    seats = tuple(sorted((key_of(s.distance), key_of(s.width)) for s in shape.seats))
    drilled = tuple(sorted((key_of(h.diameter), key_of(h.across)) for h in shape.holes))
    return (key_of(shape.radius), key_of(shape.bore), mark, seats, drilled)


def node_variants(shapes: Sequence[NodeShape]) -> Variants:
    """Nodes of one key, beginning at each of their arms; the height from the bottom counts.

    A node without seats and holes is the same however its arms lie: its mark alone says where
    azimuth 0 is. Seats and holes must belong to the same arms to be turned.
    """
    first = shapes[0]
    n, count = len(shapes), len(first.seats) or len(first.holes)
    each = len(first.holes) // count if count else 0  # holes of an arm follow each other
    height = np.array([[shape.z1 - shape.z0] for shape in shapes])
    seats = np.array([[seat.azimuth for seat in shape.seats] for shape in shapes])
    holes = np.array([[hole.azimuth for hole in shape.holes] for shape in shapes])
    levels = np.array([[hole.z - shape.z0 for hole in shape.holes] for shape in shapes])
    across = np.array([[hole.across for hole in shape.holes] for shape in shapes])
    depths = np.array([[key_of(hole.depth) for hole in shape.holes] for shape in shapes])
    turnable = len(first.seats) in (0, count) and len(first.holes) == each * count
    points, turns = [], []
    for k in range(count if turnable and count else 1):
        start = (seats if seats.size else holes)[:, k] if turnable and count else np.zeros(n)
        back = -k * each
        around = np.roll(seats, -k, axis=1) - start[:, None]
        drilled = np.roll(holes, back, axis=1) - start[:, None]
        aside = np.arctan2(np.roll(across, back, axis=1), first.radius)
        parts = [
            _ring(0 * height, 0 * height, height),
            _ring(first.radius, around, 0 * around),
            _ring(first.radius, around, height + 0 * around),
            _ring(first.radius / np.cos(aside), drilled + aside, np.roll(levels, back, axis=1)),
            _ring(0 * drilled, drilled, np.roll(depths, back, axis=1)),
        ]
        points.append(np.concatenate(parts, axis=1))
        turns.append(start)
    shift = np.zeros((n, len(turns), 3))
    shift[:, :, 2] = np.array([[shape.z0] for shape in shapes])
    return Variants.about_z(np.stack(points, axis=1), np.stack(turns, axis=1), shift)


def _ring(radius: float | Floats, azimuth: Floats, z: Floats) -> Floats:
    """(N, k, 3) points in cylinder coordinates, each coordinate (N, k) or one number."""
    return np.stack([radius * np.cos(azimuth), radius * np.sin(azimuth), z], axis=-1)
