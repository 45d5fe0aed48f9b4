"""Pieces that move: placements in some poses, as an animation of glTF."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from ddgfab.mesh import Floats
from fabrication.formats.glb.frame import converted_motion

SECONDS: Final = 8.0
"""From one end of the range to the other and back."""


@dataclass(frozen=True, eq=False)
class Movement:
    """name : of the animation; placements : (T, 4, 4) [mm] by mark, from one end to the other."""

    name: str
    placements: Mapping[str, Floats]


def key_times(poses: int) -> NDArray[np.float32]:
    """Times [s] of the poses there and back; the last one is the first again."""
    return np.linspace(0.0, SECONDS, max(2 * poses - 1, 2)).astype("<f4")


def there_and_back(placements: Floats) -> Floats:
    """The poses of an animation that can be repeated without a jump."""
    return np.concatenate([placements, placements[-2::-1]])


def keys(placements: Floats) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Translations (T, 3) [m] and unit quaternions (T, 4) as x, y, z, w, y up, without jumps."""
    moved = converted_motion(placements)
    turns = quaternions(moved[:, :3, :3])
    flips = np.where(np.einsum("ti,ti->t", turns[1:], turns[:-1]) < 0.0, -1.0, 1.0)
    turns[1:] *= np.cumprod(flips)[:, None]
    return moved[:, :3, 3].astype("<f4"), turns.astype("<f4")


def quaternions(turns: Floats) -> Floats:
    """(T, 4) unit quaternions x, y, z, w of rotations (T, 3, 3); w is not negative.

    The largest of the four squares is taken first (Shepperd 1978), so that none is lost to
    rounding.
    """
    trace = np.einsum("tii->t", turns)
    squares = np.column_stack([*(2.0 * np.einsum("tii->ti", turns) - trace[:, None]).T, trace])
    largest = squares.argmax(axis=1)
    a, b, c = (0, 1, 2), (1, 2, 0), (2, 0, 1)
    skew = turns[:, c, b] - turns[:, b, c]  # 4 w times x, y, z
    symmetric = turns[:, b, c] + turns[:, c, b]  # 4 y z, 4 z x, 4 x y
    out = np.empty((len(turns), 4))
    for k in a:
        row = np.empty((len(turns), 4))
        row[:, k] = 1.0 + squares[:, k]
        row[:, b[k]], row[:, c[k]] = symmetric[:, c[k]], symmetric[:, b[k]]
        row[:, 3] = skew[:, k]
        out[largest == k] = row[largest == k]
    row = np.column_stack([skew, 1.0 + trace])
    out[largest == 3] = row[largest == 3]
    out *= np.where(out[:, 3] < 0.0, -1.0, 1.0)[:, None]
    return np.asarray(out / np.linalg.norm(out, axis=1)[:, None])


def animation(name: str, nodes: list[int], first: int) -> dict[str, Any]:
    """An animation of nodes: accessor `first` has the times, two for each node follow it."""
    samplers, channels = [], []
    for k, node in enumerate(nodes):
        for j, path in enumerate(("translation", "rotation")):
            channels.append({"sampler": 2 * k + j, "target": {"node": node, "path": path}})
            samplers.append({"input": first, "output": first + 1 + 2 * k + j})
    return {"name": name, "samplers": samplers, "channels": channels}
