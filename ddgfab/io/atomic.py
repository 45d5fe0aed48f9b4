"""Files that are there whole or not at all."""

from __future__ import annotations

import errno
import os
import secrets
from collections import deque
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO, Final

from ddgfab.arguments import checked
from ddgfab.errors import OutputError

_PLACED: Final[deque[tuple[Path, int]]] = deque(maxlen=8)


def forget_placed() -> None:
    """Forget which files were put in their places until now."""
    _PLACED.clear()


def will_be_placed(target: Path, temporary: Path) -> None:
    """State that `temporary` is about to become `target`: see `placed`."""
    _PLACED.append((target, temporary.stat().st_ino))


def placed() -> list[Path]:
    """The last files that were put in their places, and stand there.

    For programs that are interrupted, and say what they have written: whether a file was put in
    its place is asked of the system, as signals come between any two steps.
    """
    found = []
    for target, number in _PLACED:
        with suppress(OSError):
            if target.stat().st_ino == number and target not in found:
                found.append(target)
    return found


@contextmanager
@checked
def atomic_path(path: str | Path) -> Iterator[Path]:
    """A temporary name in the target's folder, put in its place when the block ends well.

    For writers that want a file name. The temporary name keeps the suffix, since some choose the
    format by it. When the block raises, or Ctrl-C ends it, the temporary file is removed and an
    old target stays as it was.

    Raises
    ------
    OutputError
        The operating system refuses to write (no folder, no permission, disk full).
    """
    target = Path(path)
    temporary = target.with_name(f".{target.stem[:100]}.{secrets.token_hex(4)}{target.suffix}")
    try:
        yield temporary
        with temporary.open("rb+") as stream:
            os.fsync(stream.fileno())
        will_be_placed(target, temporary)
        temporary.replace(target)
        _sync_folder(target.parent)
    except OSError as error:
        full = error.errno in (errno.ENOSPC, getattr(errno, "EDQUOT", None))
        why = "the disk is full; free some space" if full else error.strerror or error
        raise OutputError(f"{target}: cannot be written: {why}") from error
    finally:
        with suppress(OSError):
            temporary.unlink()


@contextmanager
@checked
def atomic_write(path: str | Path) -> Iterator[BinaryIO]:
    """A binary stream to a file that appears, complete, when the block ends well.

    Raises
    ------
    OutputError
        As `atomic_path`.
    """
    with atomic_path(path) as temporary, temporary.open("xb") as stream:
        yield stream


def _sync_folder(folder: Path) -> None:
    """Make the new name last through a power cut, where the system can."""
    with suppress(OSError):
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)
