"""Two folders exchanged in one step, where the system can; and where folders cannot be renamed."""

from __future__ import annotations

import ctypes
import errno
import os
import re
import sys
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any, Final

_AT_FDCWD: Final = -100
_RENAME_EXCHANGE: Final = 2
"""Of Linux's renameat2; of macOS's renamex_np it is RENAME_SWAP, with the same value."""

_CANNOT: Final = (errno.ENOSYS, errno.EINVAL, errno.ENOTSUP)
_MOUNTS: Final = Path("/proc/self/mountinfo")


def exchange(one: Path, two: Path) -> bool:
    """Exchange what two paths name, in one step; False where the system or file system cannot.

    Raises
    ------
    OSError
        The system can, and refused.
    """
    sys.audit("fabrication.exchange", str(one), str(two))
    call = _call()
    if call is None:
        return False
    if call(os.fsencode(one), os.fsencode(two)) == 0:
        return True
    number = ctypes.get_errno()
    if number in _CANNOT:
        return False
    raise OSError(number, os.strerror(number), str(two))


def sync_file_system(folder: Path) -> None:
    """Everything that was written to the file system of a folder is on its disk afterwards.

    One call to the system: thousands of single files cost seconds.
    """
    library = _library()
    if library is not None and hasattr(library, "syncfs"):
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            if library.syncfs(descriptor) == 0:
                return
        finally:
            os.close(descriptor)
    if hasattr(os, "sync"):
        os.sync()
        return
    for path in folder.rglob("*"):
        if path.is_file():
            with path.open("rb+") as stream:
                os.fsync(stream.fileno())


def holds_mounts(folder: Path) -> bool:
    """Whether a folder is a mount point or has one inside: it cannot change its name then."""
    if os.path.ismount(folder):
        return True
    try:
        lines = _MOUNTS.read_text("utf-8", "surrogateescape").splitlines()
    except OSError:
        return False
    for line in lines:  # a bind mount of the same disk shows only here
        place = re.sub(r"\\([0-7]{3})", lambda found: chr(int(found[1], 8)), line.split(" ")[4])
        with suppress(ValueError):
            if Path(place).is_relative_to(folder):
                return True
    return False


@cache
def _library() -> Any:
    try:
        return ctypes.CDLL(None, use_errno=True)
    except (OSError, TypeError):
        return None


@cache
def _call() -> Any:
    """The system's exchange of (path, path) as bytes; 0 is success, errno gives the reason."""
    library = _library()
    if hasattr(library, "renameat2"):
        function = library.renameat2
        function.argtypes = [
            ctypes.c_int,
            ctypes.c_char_p,
            ctypes.c_int,
            ctypes.c_char_p,
            ctypes.c_uint,
        ]
        return lambda one, two: function(_AT_FDCWD, one, _AT_FDCWD, two, _RENAME_EXCHANGE)
    if hasattr(library, "renamex_np"):
        function = library.renamex_np
        function.argtypes = [ctypes.c_char_p, ctypes.c_char_p, ctypes.c_uint]
        return lambda one, two: function(one, two, _RENAME_EXCHANGE)
    return None
