"""Bytes of files: regular ones only, up to a limit, and never waiting for more."""

from __future__ import annotations

import os
import stat
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
    try:
        descriptor = os.open(path, os.O_RDONLY | _AT_ONCE | _BINARY)
        with open(descriptor, "rb", buffering=0) as stream:  # noqa: PTH123 - a descriptor
            state = os.fstat(descriptor)
            kind = stat.S_IFMT(state.st_mode)
            if kind != stat.S_IFREG:
                raise _wrong_kind(kind, what, file, error)
            size = state.st_size
            if size > limit_bytes:
                raise error(f"{size} bytes exceed the limit of {limit_bytes}; {advice}", file=file)
            data = bytearray()
            while len(data) <= min(size, limit_bytes):
                part = stream.read(min(size, limit_bytes) + 1 - len(data))
                if not part:
                    break
                data += part
    except FileNotFoundError:
        raise error("no such file", file=file) from None
    except InputError:
        raise
    except (OSError, ValueError) as reason:  # also names with NUL, and names that are not UTF-8
        if _is_folder(path):
            raise _wrong_kind(stat.S_IFDIR, what, file, error) from None
        text = getattr(reason, "strerror", None) or str(reason)
        raise error(f"cannot be read: {text}", file=file) from None
    if len(data) > size:
        raise error(
            "grows while it is read, or is not a file on a disk: copy it, and give the copy",
            file=file,
        )
    return bytes(data)


def _wrong_kind(kind: int, what: str, file: str, error: type[InputError]) -> InputError:
    return error(f"this is {_KINDS.get(kind, 'no regular file')}; {what} is needed", file=file)


def _is_folder(path: str | Path) -> bool:
    """Whether it is a folder, which some systems refuse to open."""
    try:
        return Path(path).is_dir()
    except (OSError, ValueError):
        return False
