"""What a finished job gives."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any


@dataclass(frozen=True, eq=False, repr=False)
class JobResult:
    """A finished job.

    Attributes
    ----------
    folder : where everything is
    manifest : what manifest.json says
    problems : what failed a check or a limit, a line each
    warnings : what could not be done but is not a fault of the structure
    seconds : what each step took
    kept : files of others, and edited ones of ours, that got another name; jobs put right
    """

    folder: Path
    manifest: dict[str, Any]
    problems: tuple[str, ...]
    warnings: tuple[str, ...]
    seconds: dict[str, float]
    kept: tuple[str, ...] = ()

    @property
    def exit_code(self) -> int:
        """0 when every check passed, else 1."""
        return 1 if self.problems else 0

    def __repr__(self) -> str:
        parts = len(self.manifest["parts"])
        state = f"{len(self.problems)} problems" if self.problems else "every check passed"
        return f"JobResult({parts} parts in {self.folder}, {state})"
