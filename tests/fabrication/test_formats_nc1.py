"""DSTV NC: read back by our strict reader, and by one that others wrote where it is there."""

from __future__ import annotations

import math
import os
import re
import subprocess
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import pytest
from gridshell_kinds import KINDS
from roofs import barrel

from ddgfab.errors import InputError
from fabrication.formats.base import Header, Material, Part, Provenance, Title
from fabrication.formats.nc1 import FORMAT, stated_volume
from fabrication.formats.nc1.read import read_nc1
from fabrication.formats.nc1.write import plain
from fabrication.formats.report import inspect_file
from fabrication.gridshell.design import design
from fabrication.parts.beam import BeamShape, CrossHole, EndCut
from fabrication.solids import realise, second_volume_of
from fabrication.solids.sawn import section_of
from fabrication.specs import Family, Instance
from fabrication.standards.profiles import profile

READER = os.environ.get("DSTV_READER", "")
"""A program that prints what a DSTV reader of others makes of the file that it is given."""

ABOUT = Provenance("roof", Header(), title=Title(number="P-7 'Süd'"))
STEEL = Material("S355J2", 7850.0)
HOLES = (CrossHole(150.0, -40.0, 14.0), CrossHole(1100.0, -35.0, 18.0))
NAMES = ("FL 80x10", "RHS 100x50x4", "RHS 120x60x5", "T 60x60x7")


def bar(name: str, *holes: CrossHole) -> Part:
    shape = BeamShape(profile(name), EndCut(40.0, 0.2), EndCut(1300.0, -0.1), holes)
    pieces = tuple(Instance(f"B-{k:04d}", None) for k in range(3))  # type: ignore[arg-type]
    family = Family("BP-001", KINDS["beam"], shape, pieces, 0.0)
    return Part.of(family, realise(shape, 0.1, solid=False), STEEL)


def written(part: Part, folder: Path) -> Path:
    path = folder / "BP-001.nc1"
    FORMAT.write_part(path, part, ABOUT)
    return path


@pytest.mark.parametrize("name", NAMES)
def test_bars_come_back_with_cuts_holes_and_volume(name: str, tmp_path: Path) -> None:
    holes = () if name.startswith("T") else HOLES
    part = bar(name, *holes)
    path = written(part, tmp_path)
    assert [check for check in FORMAT.check_part(path, part) if not check.passed] == []
    read = read_nc1(path)
    section = section_of(part.shape.profile)  # type: ignore[attr-defined]
    assert section is not None
    assert read.header["code"] == {"F": "B", "R": "M", "T": "T"}[name[0]]
    assert (read.header["order"], read.header["steel"]) == ("P-7 'Sud'", "S355J2")
    low, high = -part.shape.profile.depth, 0.0  # type: ignore[attr-defined]
    start = sorted(40.0 + 0.2 * z for z in (low, high))
    assert read.value("length") == pytest.approx(1300.0 - 0.1 * low - start[0], abs=0.01)
    # The cuts' lines in the front view against the upright, counterclockwise.
    assert read.value("web_start") == pytest.approx(-math.degrees(math.atan(0.2)), abs=1e-3)
    assert read.value("web_end") == pytest.approx(math.degrees(math.atan(0.1)), abs=1e-3)
    fronts = [c for c in read.contours if c[0][0] == "v"]
    assert len(fronts) == 1
    corners = [(x, y) for _, x, y, _ in fronts[0]]
    assert min(x for x, _ in corners) == 0.0
    twice = sum(a * d - c * b for (a, b), (c, d) in pairwise(corners))
    assert twice > 0.0  # counterclockwise
    walls = 2 if name.startswith("RHS") else 1
    assert len(read.holes) == walls * len(holes)
    for face, x, y, (diameter, depth) in read.holes[: len(holes)]:
        assert (face, depth) == ("v", 0.0)
        near = [h for h in holes if h.diameter == diameter]
        assert x == pytest.approx(near[0].x - start[0], abs=0.006)
        assert y == pytest.approx(near[0].z - low, abs=0.006)
    assert stated_volume(read, 7850.0) == pytest.approx(second_volume_of(part.shape), rel=2e-4)
    assert "3 of" in inspect_file(path).text()


def test_sections_are_measured_from_their_outlines() -> None:
    hollow = section_of(profile("RHS 120x60x5"))
    assert hollow is not None
    assert (hollow.code, hollow.web, hollow.low) == ("M", pytest.approx(5.0), -120.0)
    tee = section_of(profile("T 60x60x7"))
    assert tee is not None
    assert (tee.code, tee.flange, tee.web) == ("T", pytest.approx(7.0), pytest.approx(7.0))


def test_what_a_saw_cannot_make_has_no_file() -> None:
    plain_bar = bar("FL 80x10")
    assert FORMAT.takes(plain_bar.family)
    for start in (EndCut(40.0, 0.0, radius=60.0), EndCut(40.0, 0.1, skew=0.1)):
        shape = replace(plain_bar.shape, start=start)  # type: ignore[type-var]
        assert not FORMAT.takes(replace(plain_bar.family, shape=shape))
    made = design(barrel(1, 2), beam={"profile": "RHS 120x60x5", "end": "flat"},
                  connection={"kind": "end_plate"})  # fmt: skip
    beams = [f for f in made.families if f.role == "beam"]
    assert beams
    assert all(FORMAT.takes(f) for f in beams)  # the bars between their plates
    assert not any(FORMAT.takes(f) for f in made.families if f.role != "beam")


@pytest.mark.parametrize(
    ("pattern", "instead", "message"),
    [
        (r"^ST\r\n", "", "does not begin with ST"),
        (r"EN\r\n$", "", "does not end with EN"),
        (r"\r\n  M\r\n", "\r\n  Q7\r\n", ":9: Q7 is not a code"),
        (r"\r\nBO\r\n", "\r\nXX\r\n", "XX is not a block"),
        (r"\r\n  3\r\n", "\r\n  three\r\n", "quantity must be a number"),
        (r"AK\r\n  v +[\d.]+", "AK\r\n  v  1e400", "not a point"),
        (r"AK\r\n  v +([\d.]+)u", "AK\r\n  v  77.0u", "a contour is not closed"),
        (r"SI\r\n  v", "SI\r\n  z", "is not a mark"),
    ],
)  # fmt: skip
def test_damage_is_named(tmp_path: Path, pattern: str, instead: str, message: str) -> None:
    part = bar("RHS 100x50x4", *HOLES)
    path = written(part, tmp_path)
    text = path.read_bytes().decode("ascii")
    spoilt, count = re.subn(pattern, lambda _: instead, text, count=1)
    assert count == 1
    path.write_bytes(spoilt.encode("ascii"))
    with pytest.raises(InputError, match=re.escape(message)):
        read_nc1(path)
    assert [check.passed for check in FORMAT.check_part(path, part)] == [False]


@pytest.mark.parametrize(
    ("pattern", "instead", "message"),
    [
        (r"\r\nAK\r\n  v", "\r\nAK\r\n  o", "the contour on face v"),
        (r"(BO\r\n  \w +[\d.]+\w? +[\d.-]+).*", r"\1", "a hole has no diameter"),
        (r"\r\n  3\r\n", "\r\n  " + "9" * 400 + "\r\n", "at most nine digits"),
    ],
)
def test_files_of_other_bars_fail_their_check(
    tmp_path: Path, pattern: str, instead: str, message: str
) -> None:
    part = bar("RHS 100x50x4", *HOLES)
    path = written(part, tmp_path)
    text = path.read_bytes().decode("ascii")
    spoilt, count = re.subn(pattern, instead, text, count=1)
    assert count == 1
    path.write_bytes(spoilt.encode("ascii"))
    (check,) = FORMAT.check_part(path, part)
    assert not check.passed
    assert message in str(check.value)


def test_large_files_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.nc1"
    with path.open("wb") as stream:
        stream.truncate(8 * 1024 * 1024 + 1)
    with pytest.raises(InputError, match="8"):
        read_nc1(path)


def test_a_changed_hole_or_length_is_found(tmp_path: Path) -> None:
    part = bar("RHS 100x50x4", *HOLES)
    path = written(part, tmp_path)
    text = path.read_text("ascii")
    for old, new, check in (
        ("     14.00", "     34.00", "nc1 volume"),
        ("\n  3\n", "\n  4\n", "nc1 pieces"),
    ):
        path.write_text(text.replace(old, new), "ascii")
        failed = {c.name for c in FORMAT.check_part(path, part) if not c.passed}
        assert failed == {check}
    path.write_text(text.replace(" BP-001\nEN", " BP-002\nEN"), "ascii")
    assert [c.name for c in FORMAT.check_part(path, part) if not c.passed] == ["nc1 number"]


def test_texts_are_ascii_on_one_line() -> None:
    assert plain("Süd\n'7' \U0001f3db") == "Sud?'7' ?"
    assert plain("  ") == "-"
    assert len(plain("x" * 300)) == 40


@pytest.mark.parametrize("name", NAMES)
def test_a_reader_of_others_finds_the_same(name: str, tmp_path: Path) -> None:
    if not READER:
        pytest.skip("no reader of DSTV files by others (DSTV_READER)")
    path = written(bar(name, *(() if name.startswith("T") else HOLES)), tmp_path)
    done = subprocess.run([READER, str(path)], capture_output=True, text=True, check=True)
    found = dict(line.split("=", 1) for line in done.stdout.splitlines())
    read = read_nc1(path)
    assert found["piece"] == "BP-001"
    assert int(found["quantity"]) == 3
    assert float(found["length"]) == pytest.approx(read.value("length"))
    assert float(found["web_start_cut"]) == pytest.approx(read.value("web_start"))
    assert int(found["holes"]) == len(read.holes)
    assert int(found["contours"]) == len(read.contours)
    assert int(found["numerations"]) == 1
