"""What `ddgfab check` finds in a file; what there is to find, each format states itself."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from ddgfab.errors import InputError
from fabrication.formats.registry import find, names


@dataclass(frozen=True)
class FileReport:
    """What `inspect_file` found.

    format : its name for people
    contents : what the file contains, for people: "1 body, 12 triangles", "24 rows"
    problems : for people, empty when there are none
    sound : the text for a file without problems
    """

    file: str
    format: str
    contents: str
    problems: tuple[str, ...]
    sound: str = field(default="no problems", kw_only=True)

    @property
    def passed(self) -> bool:
        """Whether nothing is wrong."""
        return not self.problems

    def to_dict(self) -> dict[str, Any]:
        """Plain data for JSON."""
        return {**asdict(self), "passed": self.passed}

    def text(self) -> str:
        """One line for people."""
        state = self.sound if self.passed else "; ".join(self.problems[:3])
        if len(self.problems) > 3:
            state += f"; and {len(self.problems) - 3} more problems"
        return f"{self.file}: {self.format}, {self.contents}, {state}"


def inspect_file(path: Path | str) -> FileReport:
    """Look into a file; its ending says by which format.

    Raises
    ------
    InputError
        Missing, of another format, truncated or broken; names the file and what is wrong.
    """
    path = Path(path)
    known: list[str] = []
    for format in (find(name) for name in names()):
        if format.inspects():
            known += format.suffixes
            if path.suffix.lower() in format.suffixes:
                return format.inspect(path)
    raise InputError(f"not a file that can be checked; {', '.join(known)}", file=str(path))
