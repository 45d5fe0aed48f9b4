"""Progress of long computations, reported to a callback."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

Progress: TypeAlias = Callable[[str, int, int], None]
"""Called with the step's name, how much of it is done, and how much there is (0: unknown)."""


def silent(step: str, done: int, of: int) -> None:
    """Report nothing."""
