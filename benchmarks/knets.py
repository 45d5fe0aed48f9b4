"""K-nets: evolution from Cauchy data and a Baecklund transform, against a plain double loop.

Run: python benchmarks/knets.py. Ratio in one run, median of three; the double loop, the same
half-turn rule cell by cell in plain Python numbers (and, for the K-net, in numpy on vectors of
three), does 100 x 100 cells, and its time a cell is compared. One core: set OMP_NUM_THREADS=1
(nothing here calls a threaded BLAS).
"""

from __future__ import annotations

import math
import statistics
import time
from collections.abc import Callable

import numpy as np

from ddgfab.mesh import Floats
from ddgfab.nets.knet import KNet, knet
from ddgfab.transforms import baecklund

LARGE, SMALL = 1000, 100
LIMIT_S, LIMIT_NORM = 10.0, 1e-11
SIGMA, PSI = 1.0, 0.7
COARSE = 300.0

Vector = tuple[float, float, float]
Grids = tuple[list[list[Vector]], list[list[Vector]]]


def data(cells: int, reach: float = 4.0) -> tuple[list[Floats], list[Floats], float]:
    """Uneven normal angles and turns; reach is the sum of the angles of a direction."""
    rng = np.random.default_rng(0)
    deltas = [reach / cells * rng.uniform(0.5, 1.5, cells) for _ in range(2)]
    turns = [reach / cells * rng.uniform(-0.5, 0.5, cells - 1) for _ in range(2)]
    return deltas, turns, 1.2


def vector(v: Floats) -> Vector:
    return float(v[0]), float(v[1]), float(v[2])


def loop(net: KNet) -> Grids:
    """m and x of a net from its axes, cell by cell."""
    rows, cols = net.shape
    m = [[(0.0, 0.0, 0.0)] * cols for _ in range(rows)]
    x = [[(0.0, 0.0, 0.0)] * cols for _ in range(rows)]
    for i in range(rows):
        m[i][0], x[i][0] = vector(net.m[i, 0]), vector(net.points[i, 0])
    for j in range(cols):
        m[0][j], x[0][j] = vector(net.m[0, j]), vector(net.points[0, j])
    for i in range(1, rows):
        for j in range(1, cols):
            a, b, c = m[i - 1][j - 1], m[i][j - 1], m[i - 1][j]
            m[i][j] = new = turned(a, b, c)
            x[i][j] = moved(x[i][j - 1], new, b, net.r)
    return m, x


def loop_transform(net: KNet, other: KNet) -> Grids:
    """m' and x' of a transform from its first normal, point by point."""
    rows, cols = net.shape
    m, x = net.m.tolist(), net.points.tolist()
    new = [[(0.0, 0.0, 0.0)] * cols for _ in range(rows)]
    new[0][0] = vector(other.m[0, 0])
    for i in range(rows):
        for j in range(cols):
            if i:
                new[i][j] = turned(m[i - 1][j], m[i][j], new[i - 1][j])
            elif j:
                new[i][j] = turned(m[i][j - 1], m[i][j], new[i][j - 1])
    points = [[moved(x[i][j], new[i][j], m[i][j], net.r) for j in range(cols)] for i in range(rows)]
    return new, points


def loop_numpy(net: KNet) -> Floats:
    """The same in numpy as one writes it down from mathematics.md 3.4."""
    m, x = net.m.copy(), net.points.copy()
    for i in range(1, len(m)):
        for j in range(1, m.shape[1]):
            d = m[i - 1, j] - m[i, j - 1]
            m[i, j] = m[i - 1, j - 1] - 2 * (m[i - 1, j - 1] @ d) / (d @ d) * d
            x[i, j] = x[i, j - 1] + net.r * np.cross(m[i, j], m[i, j - 1])
    return x


def turned(a: Vector, b: Vector, c: Vector) -> Vector:
    """a - 2 <a, d> / <d, d> d with d = c - b."""
    p, q, s = c[0] - b[0], c[1] - b[1], c[2] - b[2]
    f = 2.0 * (a[0] * p + a[1] * q + a[2] * s) / (p * p + q * q + s * s)
    return a[0] - f * p, a[1] - f * q, a[2] - f * s


def moved(x: Vector, a: Vector, b: Vector, r: float) -> Vector:
    """x + r a x b."""
    return (
        x[0] + r * (a[1] * b[2] - a[2] * b[1]),
        x[1] + r * (a[2] * b[0] - a[0] * b[2]),
        x[2] + r * (a[0] * b[1] - a[1] * b[0]),
    )


def median(task: Callable[[], object]) -> float:
    """Seconds, median of three."""
    times = []
    for _ in range(3):
        begin = time.perf_counter()
        task()
        times.append(time.perf_counter() - begin)
    return statistics.median(times)


def residuals(net: KNet) -> str:
    return ", ".join(f"{key} {value:.0e}" for key, value in net.residuals().items())


def verdict(value: float, limit: float) -> str:
    return "ok" if value < limit else "MISSED"


def main() -> None:
    """Print sizes, times, ratios, norms and residuals."""
    small, large = knet(*data(SMALL)), knet(*data(LARGE))
    small_other = baecklund(small, SIGMA, PSI)
    large_other = baecklund(large, SIGMA, PSI)
    cases: list[tuple[str, KNet, Callable[[], KNet], Callable[[], Grids], KNet]] = [
        ("K-net from Cauchy data", large, lambda: knet(*data(LARGE)), lambda: loop(small), small),
        (
            "Baecklund transform",
            large_other,
            lambda: baecklund(large, SIGMA, PSI),
            lambda: loop_transform(small, small_other),
            small_other,
        ),
    ]
    for name, net, ours, plain, both in cases:
        points = np.array(plain()[1], dtype=np.float64)
        apart = float(np.abs(points - both.points).max())
        fast, slow = median(ours), median(plain)
        norms = float(np.abs(np.sqrt(np.einsum("...i,...i->...", net.m, net.m)) - 1.0).max())
        print(
            f"{name}: {LARGE} x {LARGE} cells in {fast:.2f} s (limit {LIMIT_S:g} s: "
            f"{verdict(fast, LIMIT_S)}), | |n| - 1 | < {math.nextafter(norms, 1.0):.1e} (limit "
            f"{LIMIT_NORM:g}: {verdict(norms, LIMIT_NORM)})"
        )
        print(
            f"  double loop {slow / SMALL**2 * 1e6:.2f} us a cell, ours "
            f"{fast / LARGE**2 * 1e6:.3f}: {slow / SMALL**2 / fast * LARGE**2:.0f} times faster; "
            f"{SMALL} x {SMALL} by both ways: {apart:.1e} apart"
        )
        print(f"  residuals, relative to edges of about {4 / LARGE:g}: {residuals(net)}")
    coarse = knet(*data(LARGE, COARSE))
    print(f"{LARGE} x {LARGE} coarse cells, edges of about {COARSE / LARGE:g}: {residuals(coarse)}")
    print(f"  its transform: {residuals(baecklund(coarse, SIGMA, PSI))}")
    numpy = median(lambda: loop_numpy(small)) / SMALL**2
    ours_a_cell = median(lambda: knet(*data(LARGE))) / LARGE**2
    print(
        f"double loop in numpy: {numpy * 1e6:.0f} us a cell of the K-net, "
        f"{numpy / ours_a_cell:.0f} times ours; "
        f"{np.abs(loop_numpy(small) - small.points).max():.1e} apart"
    )


if __name__ == "__main__":
    main()
