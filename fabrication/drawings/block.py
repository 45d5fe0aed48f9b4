"""Frame and title block: the fields of ISO 7200, and what a shop asks first."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

from fabrication.drawings.lettering import LEAST, clip, text_width, wrap
from fabrication.drawings.sheet import Arc, Item, Paper, Path, Rectangle, Text, frame_of

WIDE: Final = 180.0
"""Width of the title block [mm]: ISO 7200."""

ROW: Final = 9.5
"""Height of its rows [mm]."""

FIRST: Final = 76.0
"""Width of material and tolerances [mm]."""

VALUE: Final = 3.0
"""Height of its values [mm], where they fit."""


@dataclass(frozen=True)
class Block:
    """What the title block says; texts of any length, empty where nothing is known.

    Attributes
    ----------
    title, subtitle : of the project, and what the sheet shows
    number : identification number of the sheet
    document : type of document
    owner, client : whose drawing it is, and whom it is for
    author, date, revision : who made it, when, and which version it is
    material, mass, quantity, tolerance : of a part
    scale : of the main view
    """

    title: str = ""
    subtitle: str = ""
    number: str = ""
    document: str = ""
    owner: str = ""
    client: str = ""
    author: str = ""
    date: str = ""
    revision: str = ""
    material: str = ""
    mass: str = ""
    quantity: str = ""
    tolerance: str = ""
    scale: str = ""


def block_rectangle(paper: Paper) -> Rectangle:
    """Where the title block is: in the lower right corner of the frame."""
    frame = frame_of(paper)
    return Rectangle(frame.x1 - WIDE, frame.y0, frame.x1, frame.y0 + 5.0 * ROW)


def frame_items(paper: Paper) -> Iterator[Item]:
    """The frame, with centering marks."""
    frame = frame_of(paper)
    yield Path(_corners(frame), "frame", closed=True)
    x, y = 0.5 * paper.width, 0.5 * paper.height
    for ends in (
        ((x, frame.y0), (x, frame.y0 - 5.0)),
        ((x, frame.y1), (x, frame.y1 + 5.0)),
        ((frame.x0, y), (frame.x0 - 5.0, y)),
        ((frame.x1, y), (frame.x1 + 5.0, y)),
    ):
        yield Path(ends, "frame")


def block_items(paper: Paper, block: Block, sheet: int, sheets: int) -> Iterator[Item]:
    """The title block of a sheet of so many."""
    about = block_rectangle(paper)
    rows: tuple[tuple[tuple[str, str, float], ...], ...] = (
        (
            ("Material", block.material, FIRST),
            ("Mass, one piece", block.mass, 32.0),
            ("Quantity", block.quantity, 22.0),
            ("Scale", block.scale, 24.0),
            ("", "", 26.0),
        ),
        (
            ("General tolerances", block.tolerance, FIRST),
            ("Created by", block.author, 52.0),
            ("Approved by", "", 52.0),
        ),
        (
            ("Legal owner", block.owner, 76.0),
            ("Client", block.client, 64.0),
            ("Document type", block.document, 40.0),
        ),
        (("Title", block.title, 118.0), ("Identification number", block.number, 62.0)),
        (
            ("Supplementary title", block.subtitle, 76.0),
            ("Revision", block.revision, 20.0),
            ("Date of issue", block.date, 30.0),
            ("Language", "en", 20.0),
            ("Paper", paper.name, 14.0),
            ("Sheet", f"{sheet} / {sheets}", 20.0),
        ),
    )
    yield Path(_corners(about), "outline", closed=True)
    for k, row in enumerate(rows):
        top = about.y1 - k * ROW
        if k:
            yield Path(((about.x0, top), (about.x1, top)), "thin")
        x = about.x0
        for place, (label, value, width) in enumerate(row):
            if place:
                yield Path(((x, top), (x, top - ROW)), "thin")
            yield from _field(label, value, x, top, width)
            x += width
    yield from _first_angle(about.x1 - 13.0, about.y1 - 0.5 * ROW)


def cut_short(block: Block) -> Iterator[tuple[str, str]]:
    """Name and whole text of what a shop works by and the title block cuts: its room is fixed."""
    for label, value in (("Material", block.material), ("General tolerances", block.tolerance)):
        if text_width(value, LEAST) > FIRST - 2.0:
            yield label, value


def _field(label: str, value: str, x: float, top: float, width: float) -> Iterator[Item]:
    """Its name above, its value below: smaller, then cut, where it is long."""
    if label:
        yield Text((x + 1.0, top - 1.0 - LEAST), label)
    if not value:
        return
    room = width - 2.0
    height = VALUE if text_width(value, VALUE) <= room else LEAST
    if text_width(value, height) > room:
        value = clip(value, room, height)
    yield Text((x + 1.0, top - ROW + 1.3), value, height)


def _first_angle(x: float, y: float) -> Iterator[Item]:
    """The symbol of first-angle projection: a cone from the side, and from its left."""
    cone = ((x - 9.0, y - 1.5), (x - 2.0, y - 3.0), (x - 2.0, y + 3.0), (x - 9.0, y + 1.5))
    yield Path(cone, "outline", closed=True)
    yield Path(((x - 10.5, y), (x + 11.5, y)), "chain")
    for radius in (1.5, 3.0):
        yield Arc((x + 6.0, y), radius, 0.0, 6.283185307179586, "outline")
    yield Path(((x + 6.0, y - 4.0), (x + 6.0, y + 4.0)), "chain")


def _corners(r: Rectangle) -> tuple[tuple[float, float], ...]:
    return ((r.x0, r.y0), (r.x1, r.y0), (r.x1, r.y1), (r.x0, r.y1))


__all__ = ["Block", "block_items", "block_rectangle", "cut_short", "frame_items", "wrap"]
