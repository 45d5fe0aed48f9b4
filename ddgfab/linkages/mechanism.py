"""Mechanism: hinges and rigid bars that move with one driving angle; poses, placements, speeds.

A vertex of a K-net is a hinge, its normal the hinge's axis; an edge is a bar, which carries two
hinge axes perpendicular to it. Source: mathematics.md 4, 11; Bobenko, Pinkall 1996; Wunderlich
1951.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.arguments import checked
from ddgfab.errors import InputError
from ddgfab.linkages.cauchy import Numbers
from ddgfab.linkages.frames import bar_frames, frames_and_rates
from ddgfab.mesh import Floats, Ints

END_SLACK = 1e-12
"""Driving angles may exceed the limits by this [rad], for rounding."""


@dataclass(frozen=True, eq=False)
class Pose:
    """Where the hinges are: one pose, or a stack of T poses with a leading axis.

    Attributes
    ----------
    points : (V, 3) or (T, V, 3) foot point of each hinge on its axis [mm]: the K-net's vertex
    axes : (V, 3) or (T, V, 3) unit hinge axes: the K-net's normals, continuous in t
    """

    points: Floats
    axes: Floats

    def __getitem__(self, index: int | slice) -> Pose:
        """One pose of a stack, or a part of it."""
        return Pose(self.points[index], self.axes[index])


@dataclass(frozen=True, eq=False)
class Bounds:
    """Bounds over |t - t_0| <= h in the drive's own frame, for T intervals at once.

    Proven, up to the rounding of float64.

    acceleration : (T, V) of |x''(t)| of each hinge point [mm/rad^2]
    spin_rate : (T, E) of the rate of change of each bar's angular velocity [1/rad]
    spin : (T, E) of each bar's angular velocity [rad per rad of the driving angle]
    """

    acceleration: Floats
    spin_rate: Floats
    spin: Floats


class Drive(Protocol):
    """How hinges follow the driving angle, in a frame of its own."""

    def place(self, ts: Numbers) -> tuple[Numbers, Numbers]:
        """Points and unit axes, (T, V, 3) each; analytic in the (T,) parameters."""

    def bounds(self, ts: Floats, half: Floats) -> Bounds:
        """Bounds over |t - ts| <= half, (T,) each."""


@dataclass(frozen=True, eq=False, repr=False)
class Mechanism:
    """Rigid bars on hinges, with one driving angle t. Millimetres and radians.

    Make one with `bennett`, `cube`, `knet_mechanism` or `crab_mechanism`.

    Attributes
    ----------
    kind : "bennett", "cube", "knet" or "crab"
    bars : (E, 2) hinge ids (i, j). Frame of a bar: origin x_i, x axis along x_j - x_i, z along the
        axis of hinge i
    lengths : (E,) distances of the hinge points [mm]
    twists : (E,) signed angles about x_j - x_i from the axis of hinge i to that of hinge j [rad]
    strips : (E,) bars of a strip are congruent, up to levels
    directions : (E,) lattice direction 0, 1, 2
    cells : (F, 4) hinge ids of every isogram, in order around it
    mobility : degrees of freedom, by the rank of the linkage Jacobian in the design pose
    driver : what the driving angle is
    limits : open interval of the driving angle
    design : driving angle of the design pose
    dead_points : driving angles at which isograms are folded, and which
    path : how the other degrees of freedom are fixed
    drive : how the hinges follow the driving angle
    """

    kind: str
    bars: Ints
    lengths: Floats
    twists: Floats
    strips: Ints
    directions: Ints
    cells: Ints
    mobility: int
    driver: str
    limits: tuple[float, float]
    design: float
    dead_points: tuple[tuple[float, str], ...]
    path: str
    drive: Drive

    @property
    def n_hinges(self) -> int:
        """Number of hinges V."""
        return int(self.bars.max()) + 1

    @property
    def n_bars(self) -> int:
        """Number of bars E."""
        return len(self.bars)

    def __repr__(self) -> str:
        return (
            f"Mechanism({self.kind}: {self.n_bars} bars on {self.n_hinges} hinges, "
            f"mobility {self.mobility})"
        )

    def pose(self, t: float) -> Pose:
        """The pose at one driving angle [rad]; see `poses`."""
        return self.poses([t])[0]

    def poses(self, ts: ArrayLike) -> Pose:
        """Stacked poses at (T,) driving angles [rad], in the frame of bar 0, which stays fixed.

        Raises
        ------
        InputError
            A driving angle outside the limits.
        """
        angles = self.check(ts)
        points, axes = self.drive.place(angles)
        ground = bar_frames(points, axes, self.bars[:1])[:, 0]
        turn, origin = ground[:, :3, :3], ground[:, :3, 3]
        return Pose((points - origin[:, None]) @ turn, axes @ turn)

    def check(self, ts: ArrayLike) -> Floats:
        """(T,) driving angles, all within the limits, or `InputError`."""
        angles = np.atleast_1d(np.asarray(ts, dtype=np.float64))
        low, high = self.limits
        bad = ~((angles >= low - END_SLACK) & (angles <= high + END_SLACK))
        if bad.any():
            raise InputError(
                f"driving angle {np.degrees(angles[np.argmax(bad)]):.3f} deg is outside its limits "
                f"{np.degrees(low):.3f} to {np.degrees(high):.3f} deg ({self.driver})"
            )
        return angles

    def bar_frames(self, pose: Pose) -> Floats:
        """(E, 4, 4) or (T, E, 4, 4) placements of the bars; see `bars` for the frame of a bar."""
        return np.asarray(bar_frames(pose.points, pose.axes, self.bars))

    def moving_frames(self, ts: ArrayLike) -> tuple[Floats, Floats]:
        """(T, E, 4, 4) frames of the bars in the drive's own frame, and their derivatives by t."""
        return frames_and_rates(self.drive, self.check(ts), self.bars)


@checked
def signed_twists(pose: Pose, bars: Ints) -> Floats:
    """(E,) angle about x_j - x_i from the axis of hinge i to that of hinge j, in (-pi, pi]."""
    i, j = bars.T
    edge = pose.points[j] - pose.points[i]
    edge /= np.linalg.norm(edge, axis=-1, keepdims=True)
    sine = np.einsum("ei,ei->e", edge, np.cross(pose.axes[i], pose.axes[j]))
    return np.asarray(np.arctan2(sine, np.einsum("ei,ei->e", pose.axes[i], pose.axes[j])))


@checked
def bar_lengths(pose: Pose, bars: Ints) -> Floats:
    """(E,) distances of the hinge points of every bar."""
    return np.asarray(np.linalg.norm(pose.points[bars[:, 1]] - pose.points[bars[:, 0]], axis=-1))
