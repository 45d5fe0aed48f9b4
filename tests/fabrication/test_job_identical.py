"""The same job twice: with SOURCE_DATE_EPOCH every byte is equal, whoever makes it, and where."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from roofs import hexagons

from ddgfab.io import write_obj

HERE = Path(__file__).resolve().parents[2]
RUN = "run.json"
BALL = """
[net]
kind = "koebe"
shape = "goldberg"
cells = 1
radius_mm = 1800
[support]
kind = "edge"
[beam]
profile = "SHS 50x4"
[node]
kind = "tube"
"""
"""A small ball of pentagons: few part numbers of many pieces, hollow bars."""

CANOPY = ["canopy", "--set", "net.panels_along=12", "--set", "net.panels_across=2"]


def files(folder: Path) -> dict[str, bytes]:
    """Content of every file below a folder, by path."""
    found = (path for path in folder.rglob("*") if path.is_file())
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in found}


def run(place: Path, seed: int, jobs: int, words: list[str], output: str) -> dict[str, bytes]:
    """A job in a fresh interpreter, in a folder of its own."""
    place.mkdir()
    write_obj(place / "hexagons.obj", hexagons())
    (place / "ball.toml").write_text(BALL)
    done = subprocess.run(
        [sys.executable, "-m", "fabrication", *words, "-q", "-o", output, "--jobs", str(jobs)],
        cwd=place,
        env={
            **os.environ,
            "PYTHONPATH": str(HERE),
            "PYTHONHASHSEED": str(seed),
            "SOURCE_DATE_EPOCH": "1700000000",
        },
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.returncode == 0, done.stderr
    return files(place / output)


@pytest.mark.slow
@pytest.mark.parametrize(
    "words",
    [
        ["make", *CANOPY, "--verify", "none"],
        ["make", "ball.toml", "--verify", "none"],
        ["make", "hexagons.obj", "--verify", "none"],
        ["linkage", "--set", "checks.verify=none"],
    ],
    ids=["canopy", "ball", "hexagons", "bennett"],
)
def test_every_byte_is_equal(words: list[str], tmp_path: Path) -> None:
    one = run(tmp_path / "first", 1, 1, words, "out")
    two = run(tmp_path / "second", 2, 2, words, "elsewhere/result")
    assert one.keys() == two.keys() >= {RUN, "manifest.json", "assembly.step", "preview.png"}
    different = [name for name in one if one[name] != two[name] and name != RUN]
    assert different == []
    assert b'"parts"' in one[RUN]
