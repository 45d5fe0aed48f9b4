"""What a shape wants on its sheet: views, and what is measured in them.

Shapes say this in their own frame; nothing here knows scales, paper or kinds of parts.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

from fabrication.boundary import Vec

if TYPE_CHECKING:
    from fabrication.drawings.placing import PlacedView


class Measure(Protocol):
    """Something that a view shows beside the edges of the part: a dimension, a note."""

    def place(self, view: PlacedView) -> None:
        """Put it into a view, where it finds room."""
        ...


@dataclass(frozen=True)
class View:
    """A part as seen along a direction, from where `right` x `up` points.

    right, up : directions in the part's frame that point to the right and up on paper
    column, row : its place beside the main view, (0, 0): first-angle projection puts what is seen
        from above at row -1, what is seen from the left at column 1
    hidden : whether lines that are hidden are drawn, dashed
    breaks : whether a long part may be shown without its middle, along `right`
    near : a local view, of what is no farther than this behind its foremost point [mm]; None: all
    """

    title: str
    right: Vec
    up: Vec
    measures: tuple[Measure, ...] = ()
    column: int = 0
    row: int = 0
    hidden: bool = True
    breaks: bool = False
    near: float | None = None


@dataclass(frozen=True)
class List:
    """A list on a sheet: its title, headings, and rows of texts."""

    title: str
    headings: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


@dataclass(frozen=True)
class Drawing:
    """What a sheet of a part shows.

    lists : of the shape's own numbers
    columns : of the schedule of such parts that the sheet lists too, "{k}" for a number; where
        they differ between the pieces of a number, a row a piece
    notes : sentences for the shop
    """

    views: tuple[View, ...]
    lists: tuple[List, ...] = ()
    columns: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()


@runtime_checkable
class Drawn(Protocol):
    """A shape that says what its sheet shows."""

    def drawing(self, about: Mapping[str, Any]) -> Drawing:
        """Views with dimensions, lists and notes.

        Parameters
        ----------
        about : what the schedule says of all pieces alike, by column
        """
        ...


def shown(value: float, places: int) -> str:
    """A number on a sheet, without the sign of a zero.

    >>> shown(-0.004, 2), shown(1442.93, 1)
    ('0.00', '1442.9')
    """
    text = f"{value:.{places}f}"
    return text.lstrip("-") if float(text) == 0.0 else text
