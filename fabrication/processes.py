"""What this process is, one that people wait for or one that may be lost; and its memory."""

from __future__ import annotations

import errno
import re
from typing import Final

TOO_LITTLE: Final = "there is too little memory for this"

_NO_ROOM: Final = re.compile(
    r"failed to map segment|[Cc]annot allocate memory|can't start new thread"
)
_MAY_BE_LOST: Final = [False]


def expendable() -> None:
    """State that this process may be lost: what can end a process is done in it from now on."""
    _MAY_BE_LOST[0] = True


def is_expendable() -> bool:
    """Whether it may be lost: a job goes on without one of its workers."""
    return _MAY_BE_LOST[0]


def too_little(error: BaseException) -> bool:
    """Whether something failed for lack of memory: numbers, a library or a thread found no room."""
    if isinstance(error, ImportError | RuntimeError):
        return _NO_ROOM.search(str(error)) is not None
    return isinstance(error, MemoryError) or getattr(error, "errno", None) == errno.ENOMEM
