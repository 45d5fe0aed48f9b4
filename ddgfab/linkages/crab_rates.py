"""Proven bounds on the motion of closed rotational K-nets.

theta_1(theta_0) and theta_k+1 = f(theta_k) - theta_k-1 as Taylor models; radii and heights are sums
of sines of theta_k +- theta_k+1. Source: mathematics.md 3.13.
"""

from __future__ import annotations

from itertools import pairwise
from typing import Protocol

import numpy as np

from ddgfab.linkages.cauchy import Numbers
from ddgfab.linkages.frames import angular_velocity, frames_and_rates
from ddgfab.linkages.grid import Grid
from ddgfab.linkages.mechanism import Bounds
from ddgfab.linkages.taylor_models import DISC, ORDER, WIDER, TaylorModel, closing, product
from ddgfab.mesh import Floats


class MovingRings(Protocol):
    """What the bounds read of rings of hinges; see `ddgfab.linkages.crab.CrabDrive`."""

    @property
    def n_fold(self) -> int:
        """Hinges of a ring."""

    @property
    def rings(self) -> int:
        """Number of rings."""

    @property
    def delta(self) -> float:
        """Normal angle of the bars [rad]."""

    @property
    def r(self) -> float:
        """Scale [mm]."""

    @property
    def gamma(self) -> float:
        """Half the angle between the hinges of a ring about the axis [rad]."""

    def thetas(self, ts: Numbers) -> Numbers:
        """(rings, T) angles of the hinge axes with the axis of the net; analytic in t."""

    def place(self, ts: Numbers) -> tuple[Numbers, Numbers]:
        """Points and axes, (T, V, 3) each."""


def crab_bounds(drive: MovingRings, grid: Grid, ts: Floats, half: Floats) -> Bounds:
    """Bounds over |t - ts| <= half in the frame of the net's axis; proven up to rounding."""
    models = _models(drive, ts, half)
    first, second = zip(*(model.speeds(half) for model in models), strict=True)
    turn = np.stack(first)
    bend = np.stack(second) + turn**2  # |n''| <= |theta''| + |theta'|^2
    pull = _accelerations(drive, models, half)
    hinges = np.repeat(np.arange(drive.rings), drive.n_fold)
    acceleration = pull[hinges].T
    i, j = hinges[grid.bars].T
    length = drive.r * np.sin(drive.delta)
    frames, rates = frames_and_rates(drive, ts, grid.bars)
    edge_pull = ((pull[i] + pull[j]) / length).T
    # The frame's axes are e, n x e, n; omega = e x e' + (n'.(e x n)) e.
    edge_now = np.linalg.norm(rates[..., :3, 0], axis=-1)
    edge_rate = edge_now + half[:, None] * edge_pull
    spin_rate = edge_pull + bend[i].T + 2.0 * turn[i].T * edge_rate
    now = np.linalg.norm(angular_velocity(frames, rates), axis=-1)
    return Bounds(acceleration, spin_rate, now + half[:, None] * spin_rate)


def _models(drive: MovingRings, ts: Floats, half: Floats) -> list[TaylorModel]:
    """Models of theta_0, theta_1, ..."""
    c = float(np.cos(drive.gamma))
    middles = drive.thetas(ts)
    start = TaylorModel.linear(1.0, len(ts))
    # f(theta) = 2 atan(c tan(theta)) = -2 atan(c / tan((2 theta + pi) / 2)).
    turns = [closing(c, 2.0 * ts + np.pi, start.scaled(2.0), half).scaled(-1.0)]
    out = [start, turns[0].scaled(0.5) + _second(drive, ts, half)]
    for k in range(1, drive.rings - 1):
        turned = closing(c, 2.0 * middles[k] + np.pi, out[k].scaled(2.0), half).scaled(-1.0)
        out.append(turned - out[k - 1])
    return out


def _second(drive: MovingRings, ts: Floats, half: Floats) -> TaylorModel:
    """Taylor model of y = acos(cos(delta) / M), M^2 = A + B cos(2 theta_0).

    dy/dtheta = -cos(delta) B sin(2 theta) / (M^2 sqrt(M^2 - cos(delta)^2)).
    """
    c, near = np.cos(drive.gamma), float(np.cos(drive.delta))
    a, b = (1.0 + c * c) / 2.0, (1.0 - c * c) / 2.0
    waves = (np.sin(2 * ts), np.cos(2 * ts), -np.sin(2 * ts), -np.cos(2 * ts))
    sine, square = np.empty((ORDER, len(ts))), np.empty((ORDER, len(ts)))
    factor = 1.0
    for j in range(ORDER):
        sine[j], square[j] = factor * waves[j % 4], b * factor * waves[(j + 1) % 4]
        factor *= 2.0 / (j + 1)
    square[0] += a
    rest = square.copy()
    rest[0] -= near**2
    rate = product(-near * b * sine, product(power(square, -1.0), power(rest, -0.5)))
    terms = rate / np.arange(1, ORDER + 1)[:, None]
    tail = np.full(len(ts), np.inf)
    for widening in WIDER:
        disc = widening * DISC * half
        steep = _steepest(ts, disc, near, a, b)
        tail = np.minimum(tail, steep * disc * widening ** -(ORDER + 1) / (1.0 - 1.0 / widening))
    return TaylorModel(terms, tail)


def _steepest(ts: Floats, disc: Floats, near: float, a: float, b: float) -> Floats:
    """(T,) bound of |dy/dtheta| on complex discs about real angles."""
    wide = np.minimum(disc, 10.0)
    high = np.cosh(2 * wide)
    # Real part of cos(2z) on the disc: cos(2x) moves by 2 disc at most.
    lowest = np.maximum(np.cos(2 * ts) - 2 * wide, -1.0)
    square = a + b * np.where(lowest < 0, lowest * high, lowest)
    sine = np.minimum(np.abs(np.sin(2 * ts)) + 2 * wide, 1.0) * high + np.sinh(2 * wide)
    room = square - near**2
    safe = np.where(room > 0, room, 1.0)
    bound = abs(near) * b * sine / (np.where(room > 0, square, 1.0) * np.sqrt(safe))
    return np.asarray(np.where((room > 0) & (disc < 10.0), bound, np.inf))


def power(series: Floats, exponent: float) -> Floats:
    """Series (n, T) with positive first terms to a real power, cut after n terms.

    From (s^p)' s = p s' s^p (Miller's recurrence).
    """
    out = np.empty_like(series)
    out[0] = series[0] ** exponent
    for k in range(1, len(series)):
        j = np.arange(1, k + 1)[:, None]
        weight = (exponent * j - (k - j)) * series[1 : k + 1] * out[:k][::-1]
        out[k] = weight.sum(axis=0) / (k * series[0])
    return out


def _accelerations(drive: MovingRings, models: list[TaylorModel], half: Floats) -> Floats:
    """(rings, T) bounds of |x''| of the hinges [mm].

    r sin(gamma) = (1 + c)/2 sin(m) +- (1 - c)/2 sin(p) and the rise of a level is
    sin(gamma)/2 (cos(m) - cos(p)), with p, m = theta_k+1 +- theta_k; |sin(p)''| <= |p''| + |p'|^2.
    """
    c, s = np.cos(drive.gamma), np.sin(drive.gamma)
    out_rows, rise_rows = [], []
    for low, high in pairwise(models):
        bends = []
        for model in (high + low, high - low):
            first, second = model.speeds(half)
            bends.append(second + first**2)
        out_rows.append(((1 - c) / 2 * bends[0] + (1 + c) / 2 * bends[1]) / s)
        rise_rows.append(s / 2 * (bends[0] + bends[1]))
    out_rows.append(out_rows[-1])
    rise = np.concatenate([np.zeros((1, len(half))), np.cumsum(rise_rows, axis=0)])
    return np.asarray(drive.r * np.hypot(np.stack(out_rows), rise))
