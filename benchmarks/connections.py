"""Parts of every kind of connection: time of each, and against build123d as it is documented.

    python benchmarks/connections.py [--kind stud] [--parts N]

The parts are those of a small canopy, each with dimensions of its own. First what a job does with a
part before it reads anything back (exact boundary, closed-form properties, mesh; then its checks,
STEP and STL); then the kernel solid with BRepCheck beside the same solid of `naive_connections.py`.
Processor time, median of three rounds. Targets: 2 ms a part to build, 20 times.
"""

from __future__ import annotations

import argparse
import statistics
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final

import naive_connections

from fabrication.gridshell.design import design
from fabrication.job.part import Shop, make_part
from fabrication.solids import is_valid, kernel_properties, load_kernel, realise, solid_of
from fabrication.specs import Family

ROUNDS: Final = 3
BUILD_MS: Final = 2.0
TARGET: Final = 20.0
HOLLOW: Final = {"profile": "RHS 120x60x5"}

KINDS: Final[dict[str, dict[str, dict[str, Any]]]] = {
    "welded": {"beam": {"profile": "FL 80x40"}},
    "stud": {"beam": {"profile": "FL 80x40"}, "connection": {"kind": "stud"}},
    "stud, hollow": {
        "beam": HOLLOW, "node": {"kind": "tube", "wall_mm": 25.0}, "connection": {"kind": "stud"},
    },
    "end_plate": {
        "beam": {"profile": "FL 80x12"},
        "connection": {"kind": "end_plate", "bolts": 4, "bolt": "M8"},
    },
    "bolted_tongue": {
        "beam": {"profile": "FL 160x60"},
        "node": {"kind": "star"},
        "connection": {"kind": "bolted_tongue", "bolt": "M16"},
    },
    "slotted": {
        "beam": {"profile": "FL 280x120", "density": 420.0, "material": "Timber"},
        "node": {"kind": "plates"},
        "connection": {"kind": "slotted", "bolt": "M16"},
    },
}  # fmt: skip


def median_ms(work: Callable[[Family], object], families: list[Family]) -> float:
    """Milliseconds of processor time a part number."""
    rounds = []
    for _ in range(ROUNDS):
        begin = time.process_time()
        for family in families:
            work(family)
        rounds.append(1e3 * (time.process_time() - begin) / len(families))
    return statistics.median(rounds)


def measure(kind: str, most: int) -> list[tuple[str, ...]]:
    """Rows of the table: beams and nodes of a kind."""
    size = {"panels_along": 3, "panels_across": 2, "panel_mm": 2200.0}
    net = {"kind": "canopy", "parameters": size}
    plan = design(net=net, **KINDS[kind])
    product = plan.product()
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        formats = tuple(product.format(name) for name in ("step", "stl"))
        for format in formats:
            (Path(folder) / "parts" / format.name).mkdir(parents=True)
        shop = Shop(Path(folder), formats, product.about(), product.chord)
        for role in ("beam", "node"):
            families = [f for f in product.families if f.role == role][:most]
            few = families[: max(2, most // 4)]
            material = product.material(families[0])
            built = median_ms(lambda f: realise(f.shape, product.chord, solid=False), families)
            whole = median_ms(lambda f, m=material: make_part(f, m, shop), families)
            ours = median_ms(lambda f: solid_of(f.shape), families)
            theirs = median_ms(lambda f: naive_connections.solid(f.shape), few)
            checked = median_ms(lambda f: is_valid(solid_of(f.shape)), families)
            theirs_checked = median_ms(lambda f: naive_connections.solid(f.shape).is_valid, few)
            one = kernel_properties(solid_of(few[0].shape)).volume
            two = float(naive_connections.solid(few[0].shape).volume)
            rows.append(
                (
                    f"{kind}, {role}",
                    f"{built:.1f}",
                    f"{whole:.1f}",
                    f"{ours:.2f} / {checked:.2f}",
                    f"{theirs:.0f} / {theirs_checked:.0f}",
                    f"{theirs / ours:.0f}x / {theirs_checked / checked:.0f}x",
                    f"{abs(two / one - 1):.0e}",
                )
            )
    return rows


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description="Parts with connections")
    parser.add_argument("--kind", choices=list(KINDS), help="one kind; default all")
    parser.add_argument("--parts", type=int, default=16, help="part numbers of a kind")
    options = parser.parse_args()
    load_kernel()
    head = ("part", "build", "+ checks, files", "solid / + check", "build123d", "ratios", "volumes")
    print(" | ".join(head))
    for kind in [options.kind] if options.kind else KINDS:
        for row in measure(kind, options.parts):
            print(" | ".join(row), flush=True)
    print(f"targets: {BUILD_MS:g} ms to build, {TARGET:.0f}x")


if __name__ == "__main__":
    main()
