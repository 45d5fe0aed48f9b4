"""Names of output folders: one for each project, never outside, never hidden, in any script."""

from __future__ import annotations

import errno
import os
from pathlib import Path, PureWindowsPath
from typing import Any

import pytest

from fabrication import kit
from fabrication.gridshell.design import Design
from fabrication.job.names import folder_for, safe_name, windows_fault
from fabrication.job.plan import plan_job

TEXTS = [
    "../../etc/passwd",
    "",
    "...",
    ".hidden",
    "CON",
    "nul.step",
    "com¹",
    "a/b\\c",
    "Dach über",
    "東京",
    "\u202eexe.fdp",
    "x\0y\nz",
    "\ud800",
    "é" * 300,
    "x" * 300,
]


@pytest.mark.parametrize("text", TEXTS)
def test_safe_names_never_leave_their_folder(tmp_path: Path, text: str) -> None:
    name = safe_name(text)
    assert name
    assert not name.startswith(".")
    assert name.isprintable()
    assert not set(name) & set('/\\:*?"<>| \0\n\u202e')
    assert len(name.encode()) <= 180
    assert (tmp_path / name).resolve().parent == tmp_path.resolve()
    (tmp_path / name).mkdir()
    assert name.split(".")[0].lower() not in {"con", "nul", "aux", "prn", "com1", "com¹", "lpt1"}
    assert safe_name(name) == name


@pytest.mark.parametrize("letter", ["x", "é", "東"])
def test_long_names_keep_what_fits(letter: str) -> None:
    name = safe_name(500 * letter)
    assert 180 - 10 < len(name.encode()) <= 180
    assert set(name[:-9]) == {letter}


@pytest.mark.parametrize("text", [*TEXTS, "con", "CON.a.b", "LPT9", "aux ", "a.", "b ", "CONIN$"])
def test_safe_names_are_names_on_windows_too(text: str) -> None:
    assert windows_fault("C:\\work\\outputs\\" + safe_name(text)[:60]) is None
    assert PureWindowsPath(safe_name(text)).parts == (safe_name(text),)


@pytest.mark.parametrize(
    ("path", "why"),
    [
        ("C:\\work\\CON", "name of a device"),
        ("C:\\work\\nul.txt\\out", "name of a device"),
        ("C:\\work\\com1", "name of a device"),
        ("C:\\work\\LPT³", "name of a device"),
        ("C:\\work\\aux .x", "name of a device"),
        ("C:\\work\\conout$", "name of a device"),
        ("C:\\work\\out.", "ends with a dot"),
        ("C:\\work\\out ", "ends with a space"),
        ("C:\\work\\a:b", "has the character :"),
        ("C:\\work\\what?", "has the character ?"),
        ("C:\\work\\a\tb", "has the character"),
        ("\\\\server\\share\\a|b", "has the character |"),
        ("C:\\" + "d" * 170, "characters leave no room"),
        ("C:\\work\\out", None),
        ("C:/work/out", None),
        ("\\\\server\\share\\out", None),
        ("D:\\Dach über\\東京", None),
        ("C:\\work\\console", None),
        ("C:\\work\\com10", None),
        ("C:\\" + "d" * 160, None),
    ],
)
def test_places_that_windows_cannot_have(path: str, why: str | None) -> None:
    found = windows_fault(path)
    assert found == why or (why is not None and found is not None and why in found)


@pytest.mark.slow
def test_every_file_of_a_job_has_a_name_on_windows(small_design: Design) -> None:
    """Also where capitals are not told apart, in the longest output folder."""
    plans = [plan_job(made.product(), "out") for made in (small_design, kit(None))]
    for plan in plans:
        files = [*plan.files, "manifest.json", "run.json"]
        assert len({name.casefold() for name in files}) == len(files)
        for name in files:
            assert windows_fault("C:\\" + name.replace("/", "\\")) is None
            work = ".ddgfab/new-0123456789abcdef/rejected/"
            assert len(work + name) < 90


def test_every_project_has_a_name_of_its_own() -> None:
    texts = ["東京", "大阪", "Дом", "dom", "???", "!!!", "é" * 200, "é" * 201, "unnamed", ""]
    names = [safe_name(text) for text in texts]
    assert names[:3] == texts[:3]
    assert len(set(names)) == len(names) - 1  # only "" and "unnamed" are one
    assert safe_name("e\u0301") == safe_name("\u00e9")  # two spellings of one letter


def test_a_file_system_without_such_names_gets_a_hash(tmp_path: Path, monkeypatch: Any) -> None:
    assert folder_for(tmp_path, "東京") == tmp_path / "東京"

    def refuse(path: str) -> None:
        raise OSError(errno.EILSEQ, "no such characters")

    monkeypatch.setattr(os, "lstat", refuse)
    one, two = folder_for(tmp_path, "東京"), folder_for(tmp_path, "大阪")
    assert one != two
    assert one.name.isascii()
    assert folder_for(tmp_path, "Müller").name.startswith("Muller-")
