"""Jobs on a disk that becomes full, at any byte: one message, and the folder as it was before.

    python tests/attack/disks.py --count 300      # needs the right to mount (root)

A small disk in memory (tmpfs) gets a job of a roof, in all formats; half of the disks hold an
earlier result with a file of somebody else. The program's own process works, so that what libraries
in C++ make of a full disk is seen too.
"""

from __future__ import annotations

import os
import random
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

os.environ.setdefault("SOURCE_DATE_EPOCH", "1700000000")
HERE = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(HERE), str(HERE / "tests" / "attack"), str(HERE / "tests" / "fabrication")]

from roofs import barrel  # noqa: E402
from watch import Watch, run  # noqa: E402

from ddgfab.errors import OutputError  # noqa: E402
from fabrication import Design, design, make  # noqa: E402
from fabrication.job.manifest import faults  # noqa: E402

FORMATS = ["step", "stl", "3mf", "glb", "csv", "xlsx"]
SECONDS = 60.0
"""A whole job may compute so long."""

DRAWING = 8 << 30
"""Memory [bytes] that may be reserved: the renderer of pictures ends the process without it."""


@contextmanager
def disk(point: Path, size: int) -> Iterator[Path]:
    """A disk of so many bytes (whole pages).

    Raises
    ------
    PermissionError
        Nothing can be mounted here.
    """
    point.mkdir(exist_ok=True)
    done = subprocess.run(
        ["mount", "-t", "tmpfs", "-o", f"size={size}", "tmpfs", str(point)],
        capture_output=True,
        text=True,
    )
    if done.returncode:
        raise PermissionError(done.stderr.strip())
    try:
        yield point
    finally:
        subprocess.run(["umount", str(point)], check=True)


@cache
def designs() -> tuple[tuple[Design, int, dict[str, bytes]], ...]:
    """Roofs with all formats, the bytes of their results, and what is in their files."""
    found = []
    for mesh, formats in ((barrel(1, 2), FORMATS), (barrel(3, 4), FORMATS), (barrel(2, 3), [])):
        made = design(mesh, output={"formats": formats}, checks={"verify": "none"})
        with TemporaryDirectory() as folder:
            make(made, folder)
            found.append((made, bytes_in(Path(folder)), contents(Path(folder))))
    return tuple(found)


def contents(folder: Path) -> dict[str, bytes]:
    """What is in the files of a result that is the same every time."""
    found = {str(p.relative_to(folder)): p.read_bytes() for p in folder.rglob("*") if p.is_file()}
    return {name: data for name, data in found.items() if name not in ("run.json", "mine.txt")}


def bytes_in(folder: Path) -> int:
    """Bytes that the files of a folder take on a disk of pages."""
    return sum(path.stat().st_size // 4096 * 4096 + 8192 for path in folder.rglob("*"))


def attack(watch: Watch, seed: int, folder: Path) -> None:
    """One disk, somewhere between nothing and enough."""
    watch.call(seed, lambda: job(seed, folder), SECONDS)


def job(seed: int, folder: Path) -> None:
    """The result is whole, or what was there before is, and nothing else."""
    rng = random.Random(seed)
    made, needed, right = rng.choice(designs())
    again = rng.random() < 0.5
    size = needed + (max(4096, int(rng.uniform(0.0, 1.1) * needed)) if again else 0)
    size = size if again else max(4096, int(rng.uniform(0.0, 1.1) * needed))
    with disk(folder / "disk", size) as place:
        out = place / "out"
        if again:
            make(made, out)
            (out / "mine.txt").write_text("keep")
        before = files(place)
        try:
            result = make(made, out)
        except OutputError as error:
            require_full(str(error), files(place) ^ before)
            raise
        finally:
            if again:
                assert (out / "mine.txt").read_text() == "keep", "a file of others is lost"
        wrong = faults(out)
        assert wrong is None, f"not whole: {wrong}"
        there = contents(out)
        if any("no preview.png" in warning for warning in result.warnings):
            # A picture that cannot be drawn is a warning, whatever the cause; the manifest has it.
            right = {n: d for n, d in right.items() if n not in ("preview.png", "manifest.json")}
            there.pop("manifest.json")
        assert set(there) == set(right), f"files differ: {sorted(set(there) ^ set(right))}"
        wrong = next((name for name in right if there[name] != right[name]), None)
        assert wrong is None, f"{wrong} is not what was written to a disk with room"


def require_full(message: str, changes: set[tuple[str, int]]) -> None:
    """The message is about a full disk and the folder of the result, and nothing is changed."""
    assert "disk is full" in message, f"another message: {message}"
    assert "new-" not in message, f"a message about a working folder: {message}"
    assert not changes, f"files differ: {sorted(changes)}"


def files(place: Path) -> set[tuple[str, int]]:
    """Names and lengths of all files."""
    return {(str(p.relative_to(place)), p.stat().st_size * p.is_file()) for p in place.rglob("*")}


if __name__ == "__main__":
    if os.name != "posix" or os.geteuid() != 0:
        sys.exit("mounting needs root")
    with TemporaryDirectory() as place:
        sys.exit(run(attack, __doc__, 300, Path(place), memory=DRAWING))
