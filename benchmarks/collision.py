"""The certified free motion of whole K-nets: its cost grows with the near pairs, not with all.

python benchmarks/collision.py [3 6 12]
"""

from __future__ import annotations

import math
import sys
import time

import numpy as np

from ddgfab.linkages import Mechanism, knet_mechanism
from ddgfab.linkages.lattice import Lattice
from ddgfab.nets.knet.dini_net import of_normals
from fabrication.linkage.bodies import bodies
from fabrication.linkage.detail import detail_linkage
from fabrication.linkage.settings import settings_for
from fabrication.motion.convex import ConvexPieces
from fabrication.motion.free_range import free_motion
from fabrication.motion.pairs import near_pairs

CLEARANCE = 0.4
BAR_MM = 55.0
SWEEP, DELTA = 1.2, 0.35
"""Normals turn by SWEEP [rad] along either line, and by DELTA at most along a bar."""


def mechanism_of(cells: int) -> Mechanism:
    """cells x cells Bennett isograms; the middle lines are straight and cross at right angles."""
    delta = min(DELTA, SWEEP / cells)
    deltas, turns, middle = np.full(cells, delta), np.zeros(cells - 1), cells // 2
    right = np.array([math.pi / 2])
    still = Lattice(
        (deltas,) * 2, (turns,) * 2, right, 1.0, (middle,) * 2, 0.0, (turns,) * 2, np.zeros(1)
    )
    points, normals = (
        values.reshape(cells + 1, cells + 1, 3) for values in still.place(np.zeros(1))
    )
    net = of_normals(points, normals, 1.0, (deltas,) * 2)
    return knet_mechanism(net, scale_mm=BAR_MM / math.sin(delta), anchor=(middle, middle))


def main(sizes: list[int]) -> None:
    """Run and print."""
    print(
        "cells  bars  pieces  all pairs  near pairs  range [deg]  examined  seconds  us/near pair"
    )
    for cells in sizes:
        mechanism = mechanism_of(cells)
        parts = bodies(detail_linkage(mechanism, settings_for()))
        pieces = ConvexPieces.build(mechanism, parts)
        frames = mechanism.bar_frames(mechanism.pose(mechanism.design))
        near = len(near_pairs(pieces, frames, np.full(len(pieces), CLEARANCE))[0])
        begin = time.perf_counter()
        motion = free_motion(mechanism, parts, CLEARANCE)
        seconds = time.perf_counter() - begin
        count = len(pieces)
        every = count * (count - 1) // 2
        print(
            f"{cells:2d}x{cells:<3d} {mechanism.n_bars:5d} {count:7d} {every:10d} "
            f"{near:11d} {math.degrees(motion.range):12.1f} {motion.examined:9d} {seconds:8.2f} "
            f"{1e6 * seconds / near:13.0f}"
        )


if __name__ == "__main__":
    main([int(word) for word in sys.argv[1:]] or [3, 6, 12])
