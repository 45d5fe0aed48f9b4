"""Circular nets: evolution by angles and measures, against a plain double loop.

Run: python benchmarks/nets.py. Ratio in one run, median of three; the double loop does 100 x 100
cells, and its time a cell is compared. Prints also the greatest memory, by tracemalloc, in parts
of the net's data. One core: set OMP_NUM_THREADS=1 (nothing here calls a threaded BLAS).
"""

from __future__ import annotations

import math
import statistics
import time
import tracemalloc
from collections.abc import Callable

import numpy as np

from ddgfab.mesh import Floats
from ddgfab.nets.circular import circularity, evolve_by_angles
from ddgfab.nets.conjugate import planarity
from ddgfab.nets.crossratio import cross_ratios
from ddgfab.nets.miquel import evolve_circular_by_angles

LARGE, SMALL, CUBE = 1000, 100, 40
LIMIT_EVOLVE_S, LIMIT_MEASURE_S, LIMIT_MEMORY = 10.0, 1.0, 5.0


def data(cells: int) -> tuple[Floats, Floats, Floats]:
    """Two bent polylines and angles near right ones."""
    way = np.linspace(0.0, 1.0, cells + 1)
    first = np.stack([way, 0.1 * way**2, 0.2 * way**2], axis=1)
    second = np.stack([0.1 * way**2, way, -0.3 * way**2], axis=1)
    noise = np.random.default_rng(0).normal(size=(cells, cells))
    return first, second, math.pi / 2 + 0.5 / cells * noise


def loop_evolve(first: Floats, second: Floats, angles: Floats) -> Floats:
    """The same net, quad by quad, in numpy as one writes it down from mathematics.md 2.3."""
    net = np.empty((len(first), len(second), 3))
    net[:, 0], net[0] = first, second
    for i in range(len(first) - 1):
        for j in range(len(second) - 1):
            x, x1, x2 = net[i, j], net[i + 1, j], net[i, j + 1]
            a, b = x1 - x, x2 - x
            n = np.cross(a, b)
            center = x + (b @ b * np.cross(n, a) + a @ a * np.cross(b, n)) / (2 * n @ n)
            e = -a / np.linalg.norm(a)
            w = b - (b @ e) * e
            w /= np.linalg.norm(w)
            d = math.cos(angles[i, j]) * e + math.sin(angles[i, j]) * w
            net[i + 1, j + 1] = x1 + 2 * ((center - x1) @ d) * d
    return net


def loop_measures(net: Floats) -> tuple[float, float, float]:
    """Greatest circularity, planarity and imaginary cross-ratio, quad by quad."""
    worst = [0.0, 0.0, 0.0]
    for i in range(net.shape[0] - 1):
        for j in range(net.shape[1] - 1):
            x, x1, x2, x12 = net[i, j], net[i + 1, j], net[i, j + 1], net[i + 1, j + 1]
            a, b = x1 - x, x2 - x
            n = np.cross(a, b)
            center = x + (b @ b * np.cross(n, a) + a @ a * np.cross(b, n)) / (2 * n @ n)
            radius = np.linalg.norm(center - x)
            off = max(
                abs(np.linalg.norm(x12 - center) - radius),
                abs((x12 - x) @ n) / np.linalg.norm(n),
            )
            m = np.cross(x12 - x, x2 - x1)
            mean = 0.5 * (np.linalg.norm(x12 - x) + np.linalg.norm(x2 - x1))
            u, v, p, q = x - x1, x1 - x12, x12 - x2, x2 - x
            left, right = np.cross(u, v), np.cross(p, q)
            imaginary = u @ v * right + p @ q * left - np.cross(left, right)
            values = (
                off / radius,
                abs(a @ m) / np.linalg.norm(m) / mean,
                np.linalg.norm(imaginary) / (v @ v * (q @ q)),
            )
            worst = [max(w, float(value)) for w, value in zip(worst, values, strict=True)]
    return worst[0], worst[1], worst[2]


def measures(net: Floats) -> tuple[float, float, float]:
    """The same by the library."""
    return (
        float(circularity(net).max()),
        float(np.abs(planarity(net)).max()),
        float(cross_ratios(net)[1].max()),
    )


def median(task: Callable[[], object]) -> float:
    """Seconds, median of three."""
    times = []
    for _ in range(3):
        begin = time.perf_counter()
        task()
        times.append(time.perf_counter() - begin)
    return statistics.median(times)


def peak(task: Callable[[], object]) -> int:
    """Greatest memory [bytes] that a task takes beyond what was there."""
    tracemalloc.start()
    result = task()
    top = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    del result
    return top


def verdict(value: float, limit: float) -> str:
    return "ok" if value <= limit else "MISSED"


def main() -> None:
    """Print times, ratios and memory."""
    small, large = data(SMALL), data(LARGE)
    net_small, net = evolve_by_angles(*small), evolve_by_angles(*large)
    apart = float(np.abs(loop_evolve(*small) - net_small).max())
    print(f"{SMALL} x {SMALL} by both ways: {apart:.1e} apart; measures of {LARGE} x {LARGE}:")
    print("  circularity {:.1e}, planarity {:.1e}, imaginary {:.1e}".format(*measures(net)))
    cells = (LARGE / SMALL) ** 2
    for name, limit, ours, plain in (
        (
            "evolution by angles",
            LIMIT_EVOLVE_S,
            lambda: evolve_by_angles(*large),
            lambda: loop_evolve(*small),
        ),
        (
            "three measures",
            LIMIT_MEASURE_S,
            lambda: measures(net),
            lambda: loop_measures(net_small),
        ),
    ):
        fast, slow = median(ours), median(plain)
        memory = peak(ours) / net.nbytes
        print(
            f"{name}: {LARGE} x {LARGE} in {fast:.2f} s "
            f"(limit {limit:g} s: {verdict(fast, limit)}); "
            f"double loop {slow / SMALL**2 * 1e6:.0f} us a cell, ours {fast / LARGE**2 * 1e6:.2f}: "
            f"{slow * cells / fast:.0f} times faster; memory {memory:.2f} x data "
            f"({verdict(memory, LIMIT_MEMORY)})"
        )
    lines = [np.outer(np.linspace(0.0, 1.0, CUBE + 1), e) for e in np.eye(3)]
    for k, line in enumerate(lines):
        line[:, k - 1] += 0.1 * line[:, k] ** 2
    angles = dict.fromkeys(((0, 1), (0, 2), (1, 2)), math.pi / 2 + 0.002)
    seconds = median(lambda: evolve_circular_by_angles(lines, angles))
    print(f"three directions by Miquel, {CUBE}^3 cubes: {seconds:.2f} s")


if __name__ == "__main__":
    main()
