"""Edges that meet at an acute angle: one of them goes, two faces become one.

No node can be made for arms so close. A line that runs nearly along the rim ends there in such a
corner; inside they come where lines converge, as directions that are hardly determined make them.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from ddgfab.mesh import Floats, Ints

ACUTE_DEG: Final = 32.0
"""Corners of faces that are sharper [deg] are opened."""


def without_slivers(points: Floats, faces: list[Ints]) -> list[Ints]:
    """Faces with acute corners merged with the neighbor along a side of the corner.

    Parameters
    ----------
    points : (n, 3)
    faces : ids counterclockwise
    """
    rings: list[list[int] | None] = [face.tolist() for face in faces]
    owner = {(a, b): k for k, ring in enumerate(rings) if ring for a, b in _sides(ring)}
    todo = list(range(len(rings)))
    while todo:
        k = todo.pop(0)
        ring = rings[k]
        if ring is None:
            continue
        for i, b in enumerate(ring):
            a, c = ring[i - 1], ring[(i + 1) % len(ring)]
            if _angle_deg(points, a, b, c) >= ACUTE_DEG:
                continue
            inner = [side for side in ((a, b), (b, c)) if side[::-1] in owner]
            merged = [
                (side, found)
                for side in inner
                if (found := _joined(ring, rings[owner[side[::-1]]], side)) is not None
            ]
            if not merged:
                continue
            side, found = min(merged, key=lambda pair: (len(pair[1]), -_length(points, pair[0])))
            other = owner[side[::-1]]
            rings[k], rings[other] = None, None
            del owner[side], owner[side[::-1]]
            rings.append(found)
            for pair in _sides(found):
                owner[pair] = len(rings) - 1
            todo.append(len(rings) - 1)
            break
    return [np.array(ring) for ring in rings if ring is not None]


def _sides(ring: list[int]) -> list[tuple[int, int]]:
    return list(zip(ring, ring[1:] + ring[:1], strict=True))


def _joined(ring: list[int], other: list[int] | None, side: tuple[int, int]) -> list[int] | None:
    """Two faces without the side that they share; None where they share more than that."""
    if other is None or len(set(ring) & set(other)) > 2:
        return None
    a, b = side
    i, j = ring.index(b), other.index(a)
    return ring[i:] + ring[:i] + (other[j:] + other[:j])[1:-1]


def _angle_deg(points: Floats, a: int, b: int, c: int) -> float:
    one, two = points[a] - points[b], points[c] - points[b]
    return float(np.degrees(np.arctan2(np.linalg.norm(np.cross(one, two)), one @ two)))


def _length(points: Floats, side: tuple[int, int]) -> float:
    return float(np.linalg.norm(points[side[0]] - points[side[1]]))
