"""Damaged STEP files for `ddgfab check` and `ddgfab trace`: every one ends with a message.

    python tests/attack/step_files.py --count 20000

Prints how many files were read, refused, crashed or stopped; ends with 1 where anything but a
report or an error of ours came out, or a file took longer than the limit says.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter
from pathlib import Path
from tempfile import TemporaryDirectory

HERE = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(HERE), str(HERE / "tests" / "attack"), str(HERE / "tests" / "fabrication")]

from damage import damaged  # noqa: E402

from ddgfab.errors import DdgError  # noqa: E402
from fabrication.formats.report import inspect_file  # noqa: E402
from fabrication.formats.step.apart import limits  # noqa: E402

SEGV = HERE.parent / "shared" / "data" / "cases" / "segv.step"
SLACK = 60.0
"""Seconds by the clock, and ten times the limit on computing: other work may run meanwhile."""


def sound_files() -> dict[str, bytes]:
    """STEP files of ours, one of each kind of boundary; and a damaged one of others."""
    from gridshell_kinds import KINDS
    from parts_table import FLAT, RHS, beam

    from fabrication.formats.step import Material, StepProduct, part_bytes
    from fabrication.solids import realise

    found = {}
    for name, shape in {"flat": beam(FLAT), "rhs": beam(RHS)}.items():
        made = realise(shape, 0.1, solid=False)
        product = StepProduct(
            name, KINDS["beam"], None, made.properties, Material("S355", 7850.0), made.boundary
        )
        found[name] = part_bytes(product, f"{name}.step")
    if SEGV.exists():
        found["segv"] = SEGV.read_bytes()
    return found


def attack(begin: int, count: int, folder: Path, *, trace: bool = False) -> Counter[str]:
    """Outcomes by kind; what may not happen is "FOREIGN ..." or "SLOW ..."."""
    from fabrication.surfaces_in.cad import read_cad_surface

    sound, outcomes = sound_files(), Counter[str]()
    for seed in range(begin, begin + count):
        name = list(sound)[seed % len(sound)]
        data = damaged(sound[name], seed)
        path = folder / "damaged.step"
        path.write_bytes(data)
        clock = time.perf_counter()
        try:
            if trace and seed % 4 == 0:
                read_cad_surface(path, seed % 3)
                outcomes["surface"] += 1
            else:
                outcomes["sound" if inspect_file(path).passed else "faults told"] += 1
        except DdgError as error:
            outcomes[_kind(str(error))] += 1
        except BaseException as error:
            if isinstance(error, KeyboardInterrupt):
                raise
            outcomes[f"FOREIGN {type(error).__name__} at seed {seed}"] += 1
        taken = time.perf_counter() - clock
        if taken > 10.0 * limits(len(data))[0] + SLACK:
            outcomes[f"SLOW {taken:.1f} s at seed {seed}"] += 1
    return outcomes


def _kind(message: str) -> str:
    for words in ("crashed", "of computing", "of memory", "cannot use it", "not a readable STEP"):
        if words in message:
            return words
    return "other message"


def main() -> int:
    """Attack, print, and say whether all went well."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--begin", type=int, default=0, help="first seed")
    given = parser.parse_args()
    total: Counter[str] = Counter()
    with TemporaryDirectory() as folder:
        for begin in range(given.begin, given.begin + given.count, 200):
            count = min(200, given.begin + given.count - begin)
            total += attack(begin, count, Path(folder), trace=True)
            print(f"{begin + count - given.begin} files: {dict(total)}", flush=True)
    return 1 if any(kind.startswith(("FOREIGN", "SLOW")) for kind in total) else 0


if __name__ == "__main__":
    sys.exit(main())
