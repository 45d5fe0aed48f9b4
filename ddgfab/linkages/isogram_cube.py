"""The 12-bar cube: the elementary cell of a 3-dimensional K-net, six Bennett isograms at once.

Source: Bobenko, Suris, Discrete Differential Geometry, 4.2; mathematics.md 3.4, 4.3.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ddgfab.arguments import checked
from ddgfab.errors import InputError
from ddgfab.linkages.assemble import assemble
from ddgfab.linkages.grid import Grid
from ddgfab.linkages.lattice import Lattice
from ddgfab.linkages.lengths import positive_length, proper_twist, same_ratio
from ddgfab.linkages.mechanism import Mechanism
from ddgfab.mesh import Floats

CUBE_EQUAL = 1e-9
"""Twists of two directions (one hand) closer than this [rad] make isograms that only fold."""


@checked
def cube(
    lengths: Sequence[float],
    twists: Sequence[float],
    *,
    corners: tuple[float, float],
    rates: tuple[float, float] = (1.0, 0.0),
    reach: float = np.pi,
) -> Mechanism:
    """12 bars on 8 hinges: lengths and twists of the three directions, four equal bars in each.

    Hinge ids are 4 u_0 + 2 u_1 + u_2 for the corner u of the cube; bars 0-3 run in direction 0,
    4-7 in direction 1, 8-11 in direction 2. Two degrees of freedom: the angles at hinge 0 from bar
    0 (direction 0) to bars 4 and 8 (directions 1 and 2). Along the path they are
    corners + rates (t - design); the driving angle t is, of the three angles at hinge 0, the one
    that changes fastest, and rates are scaled so that its rate is 1.

    Parameters
    ----------
    lengths : three lengths [mm]
    twists : three twists of one hand [rad], in (0, pi), all different; lengths / sin(twists) agree
        to 1e-9. A twist of the other hand is one of pi - twist
    corners : angles [rad] at hinge 0 in the design pose
    rates : how they change; (1, 0) locks bar 8 to bar 0, (1, -1) opens both evenly from bar 0
    reach : the limits are this [rad] to either side of the design

    Raises
    ------
    InputError
        Lengths, twists or ratios that make no linkage, two equal twists (isograms between these
        directions only fold), rates that are both zero.

    Source: mathematics.md 4.3 (mobility 2).
    """
    sizes = [positive_length(v, f"length {k}") for k, v in enumerate(lengths)]
    angles = [proper_twist(v, f"twist {k}") for k, v in enumerate(twists)]
    if len(sizes) != 3 or len(angles) != 3:
        raise InputError(f"a cube has 3 lengths and 3 twists, not {len(sizes)} and {len(angles)}")
    r = sizes[0] / np.sin(angles[0])
    for k in (1, 2):
        same_ratio(sizes[0], angles[0], sizes[k], angles[k], ("direction 0", f"direction {k}"))
        for j in range(k):
            if abs(angles[j] - angles[k]) < CUBE_EQUAL:
                raise InputError(
                    f"twists {j} and {k} are both {np.degrees(angles[k]):g} deg: their isograms "
                    "only fold; take twists that differ (180 deg minus one of them is the other "
                    "hand)"
                )
    fastest, speed = _driver(rates)
    pair = ((0, 4), (0, 8), (4, 8))[fastest]
    start = (corners[0], corners[1], corners[1] - corners[0])[fastest]
    # The K-net's twists are +delta_0 and -delta_k; -(pi - twist) is twist.
    deltas = (angles[0], np.pi - angles[1], np.pi - angles[2])
    none = np.zeros(0)
    lattice = Lattice(
        tuple(np.array([delta]) for delta in deltas),
        (none,) * 3,
        np.asarray(corners, dtype=np.float64),
        r,
        (0, 0, 0),
        float(start),
        (none,) * 3,
        np.asarray(rates, dtype=np.float64) / speed,
    )
    words = [_rate_words(0, rates[0] / speed, 4), _rate_words(0, rates[1] / speed, 8)]
    return assemble(
        "cube",
        lattice,
        Grid.build(lattice.shape),
        design=lattice.design,
        limits=(float(start) - reach, float(start) + reach),
        driver=f"angle at hinge 0 from bar {pair[0]} to bar {pair[1]}",
        path="; ".join(words),
    )


def _driver(rates: Sequence[float]) -> tuple[int, float]:
    """Which of the angles 01, 02, 12 changes fastest, and its signed rate."""
    first, second = map(float, rates)
    all_rates: Floats = np.array([first, second, second - first])
    if not np.isfinite(all_rates).all() or not np.abs(all_rates).max() > 0:
        raise InputError(f"rates {first:g}, {second:g}: one of them at least must not be zero")
    fastest = int(np.abs(all_rates).argmax())
    return fastest, float(all_rates[fastest])


def _rate_words(i: int, rate: float, j: int) -> str:
    if rate == 0:
        return f"the angle from bar {i} to bar {j} is locked"
    return f"the angle from bar {i} to bar {j} turns at {rate:+g} of the driving angle"
