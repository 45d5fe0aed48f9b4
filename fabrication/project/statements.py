"""Order data: what a project states of its parts, what holds by default, and what is left open."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

from fabrication.formats.tables import Legend
from fabrication.project.sections import Section, one_line

Row = dict[str, Any]

LEGEND: Final = Legend(
    title="Order data",
    about="what holds for all parts of a kind, and what the project does not state",
    meanings={
        "parts": "what it is about",
        "subject": "what is stated",
        "value": "the statement; empty: to be agreed before parts are ordered",
        "basis": "project: a setting of the project file; default: the program's, where the "
        "project has no other; not stated: the project leaves it open",
        "setting": "section and key of the project file that state it",
    },
)

PROJECT: Final = "project"
DEFAULT: Final = "default"
OPEN: Final = "not stated"
"""Where a statement comes from."""


@dataclass(frozen=True)
class Statements:
    """Rows about parts that a section of the project describes.

    parts : what they are about
    name, section : of the section in the project file, and the section itself
    """

    parts: str
    name: str
    section: Section

    def row(self, subject: str, value: str, key: str) -> Row:
        """A statement, of the project where it sets the key."""
        basis = OPEN if not value else PROJECT if key in self.section.changed() else DEFAULT
        return {
            "parts": self.parts,
            "subject": subject,
            "value": one_line(value),
            "basis": basis,
            "setting": f"{self.name}.{key}",
        }


def not_stated(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """Settings that the project leaves open."""
    return [str(row["setting"]) for row in rows if row["basis"] == OPEN]
