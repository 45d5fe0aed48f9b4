"""Closed rotational K-nets as mechanisms: baskets of 2 N bars a level that open symmetrically.

Source: mathematics.md 3.13, 4.5, 11.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ddgfab.arguments import checked
from ddgfab.errors import DegenerateError, InputError
from ddgfab.linkages.assemble import assemble, crossings
from ddgfab.linkages.cauchy import Numbers
from ddgfab.linkages.crab_rates import crab_bounds
from ddgfab.linkages.grid import Grid
from ddgfab.linkages.mechanism import Bounds, Mechanism
from ddgfab.mesh import Floats, Ints
from ddgfab.nets.knet.crab import CrabNet

END_ROOM = 1e-6
"""How far [rad] the limits stay inside the angles at which the second ring ceases to exist."""

RATIO_ROOM = 1e-9
"""sin(delta) / sin(gamma) above one by less counts as one, for rounding."""


@dataclass(frozen=True, eq=False)
class CrabDrive:
    """Rings of N hinges whose axes all turn alike; the driving angle is theta_0.

    n_fold : N; rings : number of rings; delta : normal angle of the bars [rad]; r : scale [mm]
    """

    n_fold: int
    rings: int
    delta: float
    r: float

    @property
    def gamma(self) -> float:
        """Half the angle between the hinges of a ring about the axis."""
        return float(np.pi / self.n_fold)

    def thetas(self, ts: Numbers) -> Numbers:
        """(rings, T) angles of the hinge axes with the axis of the net; analytic in t = theta_0."""
        c = np.cos(self.gamma)
        size = np.sqrt(np.cos(ts) ** 2 + (c * np.sin(ts)) ** 2)
        out = [ts, 0.5 * double_turn(ts, c) + np.arccos(np.cos(self.delta) / size)]
        for _ in range(self.rings - 2):
            out.append(double_turn(out[-1], c) - out[-2])
        return np.stack(out)

    def radii_heights(self, thetas: Numbers) -> tuple[Numbers, Numbers]:
        """(rings, T) signed radii and heights [mm]."""
        c, s = np.cos(self.gamma), np.sin(self.gamma)
        sine, cosine = np.sin(thetas), np.cos(thetas)
        radii = (cosine[:-1] * sine[1:] - c * sine[:-1] * cosine[1:]) / s
        last = (c * cosine[-2:-1] * sine[-1:] - sine[-2:-1] * cosine[-1:]) / s
        rise = np.cumsum(sine[:-1] * sine[1:] * s, axis=0)
        radii = np.concatenate([radii, last])
        return self.r * radii, self.r * np.concatenate([0 * rise[:1], rise])

    def place(self, ts: Numbers) -> tuple[Numbers, Numbers]:
        """Points and axes, (T, V, 3), hinge k N + s on ring k; the net's axis is z."""
        thetas = self.thetas(np.asarray(ts))
        radii, heights = self.radii_heights(thetas)
        azimuth = self.gamma * (2 * np.arange(self.n_fold) + np.arange(self.rings)[:, None])
        around = np.stack([np.cos(azimuth), np.sin(azimuth)], axis=-1)
        # Axes twist by a right angle at most along bars: every other ring is turned round if not.
        sign = (-1.0 if self.delta > np.pi / 2 else 1.0) ** np.arange(self.rings)[:, None]

        def ring(out: Numbers, up: Numbers) -> Numbers:
            flat = out.T[:, :, None, None] * around
            tall = np.broadcast_to(up.T[:, :, None, None], (*flat.shape[:-1], 1))
            return np.concatenate([flat, tall], axis=-1).reshape(len(flat), -1, 3)

        return ring(radii, heights), ring(sign * np.sin(thetas), sign * np.cos(thetas))

    def bounds(self, ts: Floats, half: Floats) -> Bounds:
        """See `ddgfab.linkages.crab_rates.crab_bounds`."""
        return crab_bounds(self, self.grid(), ts, half)

    def grid(self) -> Grid:
        """Bars up and forward, then up and backward; isograms of three rings each."""
        ids: Ints = np.arange(self.rings * self.n_fold).reshape(self.rings, self.n_fold)
        forward = np.stack([ids[:-1], ids[1:]], axis=-1)
        backward = np.stack([ids[:-1], np.roll(ids[1:], 1, axis=1)], axis=-1)
        bars = np.concatenate([forward.reshape(-1, 2), backward.reshape(-1, 2)])
        hand = np.repeat([0, 1], len(bars) // 2)
        level = np.tile(np.repeat(np.arange(self.rings - 1), self.n_fold), 2)
        low, middle, top = ids[:-2], ids[1:-1], np.roll(ids[2:], 1, axis=1)
        cells = np.stack([low, middle, top, np.roll(middle, 1, axis=1)], axis=-1).reshape(-1, 4)
        return Grid(bars, hand, 2 * level + hand, cells, np.tile([0, 1], (len(cells), 1)))


def double_turn(theta: Numbers, c: float) -> Numbers:
    """2 atan2(c sin, cos), continued without jumps and analytically: 2 theta plus a small angle."""
    sine, cosine = np.sin(theta), np.cos(theta)
    return 2.0 * (theta + np.arctan((c - 1.0) * sine * cosine / (cosine**2 + c * sine**2)))


@checked
def crab_mechanism(net: CrabNet, *, scale_mm: float = 1.0) -> Mechanism:
    """Linkage of a closed rotational K-net that opens and closes with its symmetry.

    Hinge k N + s is point s of ring k. Bars up and forward come first (direction 0), those up and
    backward, of the other hand, follow (direction 1). The driving angle is theta_0, the angle of
    the hinge axes of ring 0 with the axis of the net.

    Parameters
    ----------
    net : three rings or more
    scale_mm : mm per unit of its points

    Raises
    ------
    InputError
        Fewer than three rings, or a scale that is not positive.
    DegenerateError
        theta_0 at the end of what the bars allow.

    Source: mathematics.md 3.13, 4.5.
    """
    if net.rings < 3:
        raise InputError(f"{net!r} has no isograms; three rings are needed")
    if not 0 < scale_mm < np.inf:
        raise InputError(f"scale_mm = {scale_mm:g}: millimetres per unit are positive")
    drive = CrabDrive(net.n_fold, net.rings, net.delta, net.r * scale_mm)
    design = float(net.thetas[0])
    limits = _limits(drive, design)
    if not limits[0] < design < limits[1]:
        raise DegenerateError(
            f"theta_0 = {np.degrees(design):g} deg is at the end of its range: the second ring "
            "ceases to exist there; take another"
        )

    def radii(ts: Floats) -> Floats:
        return np.asarray(drive.radii_heights(drive.thetas(ts))[0].T)

    cones = crossings(radii, limits)
    return assemble(
        "crab",
        drive,
        drive.grid(),
        design=design,
        limits=limits,
        driver="theta_0, the angle of the hinge axes of ring 0 with the axis of the net",
        path=f"{net.n_fold}-fold symmetric",
        extra=tuple((t, f"ring {', '.join(map(str, ids))} on the axis") for t, ids in cones),
    )


def _limits(drive: CrabDrive, design: float) -> tuple[float, float]:
    """Angles theta_0 around the design with |sin(theta_0)| sin(gamma) < sin(delta).

    Where all angles are, a whole turn.
    """
    ratio = np.sin(drive.delta) / np.sin(drive.gamma)
    if ratio > 1 + RATIO_ROOM:
        return design - np.pi, design + np.pi
    turn = np.floor(design / np.pi) * np.pi
    room = float(np.arcsin(ratio)) - END_ROOM
    if design - turn < np.pi / 2:
        return float(turn - room), float(turn + room)
    return float(turn + np.pi - room), float(turn + np.pi + room)
