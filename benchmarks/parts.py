"""Parts: build and check each kind of part, against the way build123d's documentation suggests.

    python benchmarks/parts.py [--parts N]

Both sides make the same solids in one run and check them with the kernel's BRepCheck; every part
has dimensions of its own, so nothing can be reused. The other side is `naive.py`. Median of three
rounds. Target: 20 times.
"""

from __future__ import annotations

import argparse
import math
import statistics
import time
from collections.abc import Callable

import naive
import numpy as np

from fabrication.parts.beam import BeamShape, CrossHole, EndCut
from fabrication.parts.node import NodeShape, Seat
from fabrication.parts.panel import PanelShape
from fabrication.solids import is_valid, kernel_properties, load_kernel, solid_of
from fabrication.specs import Loop, Profile, Shape

ROUNDS = 3
WIDTH, DEPTH, COPE, HOLE = 8.0, 60.0, 45.0, 13.0
RADIUS, BORE, SEAT = 60.0, 25.0, 40.0
THICKNESS, CORNER, MITRE = 12.0, 20.0, 2.0
TARGET = 20.0


def beam_shape(k: int) -> BeamShape:
    """A flat bar coped by two cylinders, with two bolt holes; its length depends on k."""
    y, z = WIDTH / 2, DEPTH / 2
    loop = Loop(np.array([(-y, -z), (y, -z), (y, z), (-y, z)]), np.zeros(4))
    end = 1400.0 + k
    return BeamShape(
        Profile("FL 60x8", (loop,), WIDTH, DEPTH),
        EndCut(50.0, 0.1, COPE),
        EndCut(end, -0.15, COPE),
        (CrossHole(110.0, 0.0, HOLE), CrossHole(end - 60.0, 0.0, HOLE)),
    )


def node_shape(k: int) -> NodeShape:
    """A tube with four milled seats; its height depends on k."""
    distance = math.sqrt(RADIUS**2 - SEAT**2 / 4.0)
    seats = tuple(Seat(j * math.pi / 2 + 0.05 * j, distance, SEAT) for j in range(4))
    return NodeShape(RADIUS, BORE, -40.0, 40.0 + 0.1 * k, seats)


def panel_shape(k: int) -> PanelShape:
    """A pane with rounded corners; its width depends on k."""
    corners = np.array([(0.0, 0.0), (1500.0 + k, 40.0), (1450.0 + k, 900.0), (100.0, 1000.0)])
    return PanelShape(THICKNESS, corners, corners, CORNER)


def mitred_shape(k: int) -> PanelShape:
    """A pane with mitred sides and rounded corners; its width depends on k."""
    inner = panel_shape(k).inner
    # Sides lean inwards, 2 mm over the thickness: the outer polygon is an offset of the inner.
    along = np.roll(inner, -1, axis=0) - inner
    inward = np.column_stack([-along[:, 1], along[:, 0]])
    inward /= np.linalg.norm(inward, axis=1)[:, None]
    level = np.sum(inward * inner, axis=1) + MITRE
    outer = [
        np.linalg.solve([inward[i - 1], inward[i]], [level[i - 1], level[i]]) for i in range(4)
    ]
    return PanelShape(THICKNESS, inner, np.array(outer), CORNER)


KINDS: list[tuple[str, Callable[[int], Shape]]] = [
    ("beam, two copes, two holes", beam_shape),
    ("node, four seats, bore", node_shape),
    ("panel, rounded corners", panel_shape),
    ("panel, mitred and rounded", mitred_shape),
]


def per_part(work: Callable[[int], object], count: int) -> float:
    """Milliseconds a part."""
    begin = time.perf_counter()
    for k in range(count):
        work(k)
    return (time.perf_counter() - begin) / count * 1e3


def compare(shape: Callable[[int], Shape], count: int) -> list[tuple[float, float, float, float]]:
    """Milliseconds a part in every round: build and build + check, of ours and of theirs."""
    shapes = [shape(k) for k in range(count)]

    def ours(k: int) -> None:
        solid_of(shapes[k])

    def ours_checked(k: int) -> None:
        assert is_valid(solid_of(shapes[k]))

    def theirs(k: int) -> None:
        naive.solid(shapes[k])

    def theirs_checked(k: int) -> None:
        assert naive.solid(shapes[k]).is_valid

    few = max(1, count // 8)
    return [
        (
            per_part(ours, count),
            per_part(ours_checked, count),
            per_part(theirs, few),
            per_part(theirs_checked, few),
        )
        for _ in range(ROUNDS)
    ]


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description="Parts against build123d")
    parser.add_argument("--parts", type=int, default=80, help="parts a round (peer: an eighth)")
    count = parser.parse_args().parts
    load_kernel()
    print("milliseconds a part: build / build + validity check")
    print(f"{'part':28}{'ddgfab':>16}{'build123d':>16}{'ratios':>13}{'volumes differ':>17}")
    missed = []
    for name, shape in KINDS:
        one = kernel_properties(solid_of(shape(0))).volume
        two = kernel_properties(naive.solid(shape(0)).wrapped, adaptive=True).volume
        rounds = compare(shape, count)
        a, b, c, d = (statistics.median(column) for column in zip(*rounds, strict=True))
        build = statistics.median(r[2] / r[0] for r in rounds)
        whole = statistics.median(r[3] / r[1] for r in rounds)
        print(
            f"{name:28}{a:8.2f} /{b:6.2f}{c:8.1f} /{d:6.1f}{build:6.0f}x /{whole:3.0f}x"
            f"{abs(two / one - 1):17.1e}"
        )
        if whole < TARGET:
            missed.append(name)
    print(f"target {TARGET:.0f}x, check included: {'missed by ' if missed else 'met'}", end="")
    print("; ".join(missed))


if __name__ == "__main__":
    main()
