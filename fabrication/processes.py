"""What this process is: one that people wait for, or one that may be lost."""

from __future__ import annotations

from typing import Final

_MAY_BE_LOST: Final = [False]


def expendable() -> None:
    """State that this process may be lost: what can end a process is done in it from now on."""
    _MAY_BE_LOST[0] = True


def is_expendable() -> bool:
    """Whether it may be lost: a job goes on without one of its workers."""
    return _MAY_BE_LOST[0]
