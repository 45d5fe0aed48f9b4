"""Bytes of files: regular ones only, up to a limit, and never waiting for more."""

from __future__ import annotations

import hashlib
import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Final

from ddgfab.errors import InputError, MeshError

_KINDS: Final = {
    stat.S_IFDIR: "a folder",
    stat.S_IFIFO: "a named pipe",
    stat.S_IFCHR: "a device",
    stat.S_IFBLK: "a device",
    stat.S_IFSOCK: "a socket",
}
_AT_ONCE: Final = getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_NOCTTY", 0)
_BINARY: Final = getattr(os, "O_BINARY", 0) | getattr(os, "O_CLOEXEC", 0)
_BLOCK: Final = 1 << 20


def read_regular(
    path: str | Path,
    limit_bytes: int,
    error: type[InputError] = MeshError,
    *,
    what: str = "a mesh file",
    advice: str = "simplify the mesh or raise limit_bytes",
) -> bytes:
    """Content of a regular file.

    Pipes, devices, folders and files of the system that state no size are refused, not waited
    for. No more than `limit_bytes` are read, also where a file grows meanwhile.

    Parameters
    ----------
    error : class of the error to raise
    what : is needed, for messages
    advice : what to do about a file that is too large

    Raises
    ------
    InputError
        Of the class `error`: what is missing, is not a regular file, is above the limit, or what
        the system refuses to read.
    """
    file = str(path)
    with _opened(path, error, what) as (descriptor, size):
        if size > limit_bytes:
            raise error(f"{size} bytes exceed the limit of {limit_bytes}; {advice}", file=file)
        data = bytearray()
        while len(data) <= size:
            part = os.read(descriptor, size + 1 - len(data))
            if not part:
                break
            data += part
    if len(data) > size:
        raise error(
            "grows while it is read, or is not a file on a disk: copy it, and give the copy",
            file=file,
        )
    return bytes(data)


def digest_regular(path: str | Path) -> str:
    """Sha256 of the content of a regular file of any size.

    Raises
    ------
    InputError
        As `read_regular`.
    """
    with _opened(path, InputError, "a file") as (descriptor, size):
        digest = hashlib.sha256()
        while size > 0 and (part := os.read(descriptor, min(size, _BLOCK))):
            digest.update(part)
            size -= len(part)
    return digest.hexdigest()


@contextmanager
def unchanged(path: str | Path) -> Iterator[str]:
    """The sha256 of a file that is read by name in the block; at its end the content is the same.

    Raises
    ------
    InputError
        As `read_regular`, or the file was changed meanwhile: what was read may be half of each.
    """
    before = digest_regular(path)
    yield before
    if digest_regular(path) != before:
        raise InputError("was changed while it was read: run again", file=str(path))


@contextmanager
def _opened(path: str | Path, error: type[InputError], what: str) -> Iterator[tuple[int, int]]:
    """Descriptor and bytes of a regular file; what the system refuses becomes an error."""
    file = str(path)
    try:
        descriptor = os.open(path, os.O_RDONLY | _AT_ONCE | _BINARY)
        try:
            state = os.fstat(descriptor)
            kind = stat.S_IFMT(state.st_mode)
            if kind != stat.S_IFREG:
                raise _wrong_kind(kind, what, file, error)
            yield descriptor, state.st_size
        finally:
            os.close(descriptor)
    except FileNotFoundError:
        raise error("no such file", file=file) from None
    except InputError:
        raise
    except (OSError, ValueError) as reason:  # also names with NUL, and names that are not UTF-8
        if _is_folder(path):
            raise _wrong_kind(stat.S_IFDIR, what, file, error) from None
        text = getattr(reason, "strerror", None) or str(reason)
        raise error(f"cannot be read: {text}", file=file) from None


def _wrong_kind(kind: int, what: str, file: str, error: type[InputError]) -> InputError:
    return error(f"this is {_KINDS.get(kind, 'no regular file')}; {what} is needed", file=file)


def _is_folder(path: str | Path) -> bool:
    """Whether it is a folder, which some systems refuse to open."""
    try:
        return Path(path).is_dir()
    except (OSError, ValueError):
        return False
