"""Names of output folders: one for each project, never outside, never hidden, in any script."""

from __future__ import annotations

import errno
import os
from pathlib import Path
from typing import Any

import pytest

from fabrication.job.names import folder_for, safe_name

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
