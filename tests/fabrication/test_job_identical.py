"""The same job twice: with SOURCE_DATE_EPOCH every byte is equal, whoever makes it, and where."""

from __future__ import annotations

import json
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


KEEP = ["--verify", "none"]
JOBS = {
    "canopy": (["make", *CANOPY, *KEEP], 2),
    "ball": (["make", "ball.toml", *KEEP], 1),
    "hexagons": (["make", "hexagons.obj", *KEEP], 1),
    "bennett": (["linkage", "--set", "checks.verify=none"], 2),
}
"""Words of each job, and how many processes it has the second time."""

PROGRAM = """
import json, sys
from fabrication.cli import app
for words in json.loads(sys.argv[1]):
    code = app(words, standalone_mode=False)
    assert not code, (words, code)
"""


def files(folder: Path) -> dict[str, bytes]:
    """Content of every file below a folder, by path."""
    found = (path for path in folder.rglob("*") if path.is_file())
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in found}


def run(place: Path, seed: int, jobs: list[list[str]]) -> None:
    """Jobs, one after the other, in a fresh interpreter and a folder of its own."""
    place.mkdir()
    write_obj(place / "hexagons.obj", hexagons())
    (place / "ball.toml").write_text(BALL)
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM, json.dumps(jobs)],
        cwd=place,
        env={
            **os.environ,
            "PYTHONPATH": str(HERE),
            "PYTHONHASHSEED": str(seed),
            "SOURCE_DATE_EPOCH": "1700000000",
        },
        capture_output=True,
        text=True,
        timeout=600,
    )
    assert done.returncode == 0, done.stderr


@pytest.mark.slow
def test_every_byte_is_equal(tmp_path: Path) -> None:
    """The second time in the other order, in deeper folders, and by more processes."""
    first = [[*words, "-q", "-o", name, "--jobs", "1"] for name, (words, _) in JOBS.items()]
    second = [
        [*words, "-q", "-o", f"elsewhere/{name}", "--jobs", str(count)]
        for name, (words, count) in reversed(JOBS.items())
    ]
    run(tmp_path / "first", 1, first)
    run(tmp_path / "second", 2, second)
    for name in JOBS:
        one, two = files(tmp_path / "first" / name), files(tmp_path / "second/elsewhere" / name)
        assert one.keys() == two.keys() >= {RUN, "manifest.json", "assembly.step", "preview.png"}
        different = [file for file in one if one[file] != two[file] and file != RUN]
        assert different == [], name
        assert b'"parts"' in one[RUN]
