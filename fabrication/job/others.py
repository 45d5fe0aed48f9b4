"""What in an output folder is not ours: files of others, and files of ours that were edited."""

from __future__ import annotations

import errno
import os
import shutil
import stat
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from itertools import chain, count, islice
from pathlib import Path, PurePosixPath
from typing import Any, Final

from fabrication.job.manifest import UNLISTED, digest_of

WORK: Final = ".ddgfab"
"""Folder of ours inside an output folder that cannot be renamed."""

Records = Mapping[str, Mapping[str, Any]]


@dataclass(frozen=True)
class Other:
    """Something that is not ours: its path below the folder, and why it is not.

    edited : whether it stands where a file of ours stood
    folder : whether it is a folder, and no link to one
    """

    name: str
    edited: bool = False
    folder: bool = False


@dataclass
class Others:
    """What is not ours in a folder, by the manifest's list of files.

    The content of a file is read once, and again only when the file has changed since.
    """

    records: Records
    _same: dict[str, tuple[int, int, int]] = field(default_factory=dict)

    def within(self, folder: Path) -> Iterator[Other]:
        """All of it, folders before what they hold."""
        ours = {str(above) for name in self.records for above in PurePosixPath(name).parents}
        for name, entry in _walk(folder):
            if entry.is_dir(follow_symlinks=False):
                if name not in ours:
                    yield Other(name, folder=True)
            elif name not in self.records:
                if name not in UNLISTED:
                    yield Other(name)
            elif not self._unchanged(name, entry):
                yield Other(name, edited=True)

    def _unchanged(self, name: str, entry: os.DirEntry[str]) -> bool:
        found = entry.stat(follow_symlinks=False)
        state = (found.st_ino, found.st_size, found.st_mtime_ns)
        if self._same.get(name) == state:
            return True
        record = self.records[name]
        if not stat.S_ISREG(found.st_mode) or found.st_size != record.get("bytes"):
            return False
        if digest_of(Path(entry.path)) != record.get("sha256"):
            return False
        self._same[name] = state
        return True


def link(source: Path, copy: Path) -> None:
    """A second name for a file, a link, a pipe; left out where the file system has no such names.

    What is left out is moved when the folders have been exchanged.
    """
    with suppress(OSError, NotImplementedError):
        os.link(source, copy, follow_symlinks=False)


def carry(
    old: Path, new: Path, others: Others, place: Callable[[Path, Path], object] = Path.rename
) -> list[str]:
    """Bring what is not ours from an old folder into a new one; returns what people must know.

    Something whose name is taken in the new folder, and files of ours that were edited, get a name
    of their own beside it. What is there already, by another name of the same file, is passed over.

    Parameters
    ----------
    place : `Path.rename` moves, `link` leaves the old folder as it is

    Raises
    ------
    OSError
        Something cannot be read, or not be moved.
    """
    there = {_identity(entry) for _, entry in _walk(new) if not entry.is_dir(follow_symlinks=False)}
    moved: dict[str, str] = {}  # folders that got another name
    folders: list[tuple[Path, Path]] = []
    notes = []
    for other in others.within(old):
        source = old / other.name
        above, _, last = other.name.rpartition("/")
        wanted = f"{moved.get(above, above)}/{last}" if above else last
        if other.folder:
            moved[other.name] = wanted = _folder_name(wanted, new)
            if not (new / wanted).is_dir():
                (new / wanted).mkdir(parents=True)
                folders.append((source, new / wanted))
            continue
        found = source.lstat()
        if (found.st_dev, found.st_ino) in there or _equal(source, new / wanted):
            continue
        name = free_name(wanted, new, old, kept=other.edited)
        (new / name).parent.mkdir(parents=True, exist_ok=True)
        place(source, new / name)
        if name != wanted and os.path.lexists(new / name):
            notes.append(note_of(other, name))
    for source, copy in reversed(folders):
        with suppress(OSError, AttributeError):
            shutil.copystat(source, copy)
            owner = source.stat()
            os.chown(copy, owner.st_uid, owner.st_gid)
    return notes


def free_name(name: str, new: Path, old: Path, *, kept: bool = False) -> str:
    """The name, or where the new folder has it one such as `beams.kept.csv` that neither has.

    Parameters
    ----------
    kept : whether the name itself will not do
    """
    if not kept and not os.path.lexists(new / name):
        return name
    free = (
        found
        for found in _names_beside(name)
        if not (os.path.lexists(new / found) or os.path.lexists(old / found))
    )
    return next(free)


def _folder_name(name: str, new: Path) -> str:
    """The name, or one beside it, that is free in a folder or a folder already."""
    for found in chain([name], islice(_names_beside(name), 1000)):
        if not (new / found).is_symlink() and (
            (new / found).is_dir() or not (new / found).exists()
        ):
            return found
    raise FileExistsError(errno.EEXIST, "every name beside it is taken", name)


def _names_beside(name: str) -> Iterator[str]:
    path = PurePosixPath(name)
    for number in count(1):
        again = "" if number == 1 else f"-{number}"
        yield str(path.with_name(f"{path.stem}.kept{again}{path.suffix}"))


def note_of(other: Other, name: str) -> str:
    """What people must know of something that got another name."""
    if other.edited:
        return f"{other.name} was changed since ddgfab wrote it: kept as {name}"
    return f"{other.name} is not of ddgfab, and the new result has one: kept as {name}"


def _equal(one: Path, two: Path) -> bool:
    """Whether two regular files have the same content."""
    with suppress(OSError):
        first, second = one.lstat(), two.lstat()
        if stat.S_ISREG(first.st_mode) and stat.S_ISREG(second.st_mode):
            return first.st_size == second.st_size and digest_of(one) == digest_of(two)
    return False


def _identity(entry: os.DirEntry[str]) -> tuple[int, int]:
    found = entry.stat(follow_symlinks=False)
    return found.st_dev, found.st_ino


def _walk(folder: Path, above: str = "") -> Iterator[tuple[str, os.DirEntry[str]]]:
    """Everything below a folder by its path with slashes; links are not followed."""
    with os.scandir(folder) as entries:
        found = sorted(entries, key=lambda entry: entry.name)
    for entry in found:
        name = f"{above}{entry.name}"
        if name == WORK:
            continue
        yield name, entry
        if entry.is_dir(follow_symlinks=False):
            yield from _walk(Path(entry.path), f"{name}/")
