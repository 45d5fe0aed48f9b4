"""Whose result an output folder holds: that of a project of this name, made from these files.

Two files of one name in two folders are two projects, though both are called by that name and
would go to outputs/<name>. Paths are kept as seen from the output folder, so that a whole project
folder can be moved or mounted elsewhere; files that were moved alone are known by their content.
"""

from __future__ import annotations

import os
import unicodedata
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path, PurePath
from typing import Any

from ddgfab.errors import InputError
from ddgfab.io.regular import digest_regular

PROJECT, INPUT = "project", "input"


@dataclass(frozen=True)
class Sources:
    """The files that a product is made from; None for what is made in Python, or built in.

    project : the project file
    input : the mesh, or the surface
    """

    project: Path | None = None
    input: Path | None = None

    def record(self, target: Path) -> dict[str, dict[str, str | None] | None]:
        """Path as seen from an output folder, and sha256, of each file, or None."""
        return {
            name: None if path is None else {"file": _seen(path, target), "sha256": _digest(path)}
            for name, path in self._named()
        }

    def changes(self, record: Mapping[str, Any]) -> list[str]:
        """Notes on the files whose content is not that of an earlier record any more."""
        return [
            f"{_shown(path)} was changed while the job ran: the files are of what it held before"
            for name, path in self._named()
            if path is not None and _digest(path) != record[name]["sha256"]
        ]

    def match(self, record: Mapping[str, Any], target: Path) -> bool:
        """Whether a record of an output folder is one of this project.

        Project files are compared where both sides have one, else the inputs: `ddgfab make
        roof.obj` and a project file made for it later are one project. Files are the same where
        their paths are, as seen from the folder, or where the contents of all of them are.
        """
        there = {name: _entry(record, name) for name in (PROJECT, INPUT)}
        both = self.project is not None and there[PROJECT] is not None
        path, entry = (self.project, there[PROJECT]) if both else (self.input, there[INPUT])
        if path is None or entry is None:
            return self == Sources() and not any(there.values())
        if entry["file"] == _seen(path, target):
            return True
        compared = self._named() if both else [(INPUT, path)]
        return all(_same(file, there[name]) for name, file in compared)

    def _named(self) -> list[tuple[str, Path | None]]:
        return [(PROJECT, self.project), (INPUT, self.input)]

    def __str__(self) -> str:
        """The file that identifies it best, for messages."""
        path = self.project or self.input
        return "no file" if path is None else _shown(path)


def source_of(record: Mapping[str, Any], target: Path) -> str:
    """The file that a record of an output folder names, for messages."""
    entry = _entry(record, PROJECT) or _entry(record, INPUT)
    if entry is None:
        return "no file"
    return _shown(target / str(entry["file"]))


def _entry(record: Mapping[str, Any], name: str) -> dict[str, Any] | None:
    """A file of a record; None where there is none, or none that can be understood."""
    entry = record.get(name)
    if not isinstance(entry, dict) or not isinstance(entry.get("file"), str):
        return None
    return None if "\0" in entry["file"] else entry


def _same(path: Path | None, entry: Mapping[str, Any] | None) -> bool:
    """Whether a file has the content that a record states."""
    if path is None or entry is None:
        return path is None and entry is None
    digest = _digest(path)
    return digest is not None and digest == entry.get("sha256")


def _seen(path: Path, target: Path) -> str:
    """The path from a folder to a file, with slashes; absolute where there is no way.

    Links on the way to the file are followed, the file's own name stays: a link that names the
    version of a mesh that counts is one project, whatever it points to.
    """
    full = path.parent.resolve() / path.name
    try:
        found = os.path.relpath(full, target)
    except ValueError:  # another drive
        found = os.fspath(full)
    return unicodedata.normalize("NFC", PurePath(found).as_posix())


def _digest(path: Path) -> str | None:
    """Sha256 of a file; None where it cannot be read."""
    with suppress(InputError):
        return digest_regular(path)
    return None


def _shown(path: Path) -> str:
    """A path for people: from the current folder where it lies below."""
    full = os.path.normpath(Path.cwd() / path)
    with suppress(ValueError):
        return os.fspath(Path(full).relative_to(Path.cwd()))
    return full
