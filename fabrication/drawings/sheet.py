"""A sheet as plain data: lines, arcs, texts, dimensions and views in millimeters on paper.

The origin is the lower left corner of the paper, y points up. Writers turn it into files; nothing
here knows of any.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Final, Literal, Protocol, TypeAlias

from fabrication.drawings.lettering import BELOW, LEAST, text_width

Point: TypeAlias = tuple[float, float]
Pen: TypeAlias = Literal["outline", "hidden", "chain", "thin", "frame", "text"]
Anchor: TypeAlias = Literal["left", "center", "right"]

WIDTHS: Final[dict[Pen, float]] = {
    "outline": 0.5,
    "hidden": 0.25,
    "chain": 0.25,
    "thin": 0.25,
    "frame": 0.7,
    "text": 0.25,
}
"""Widths of lines [mm]: ISO 128-2, group 0.5."""

DASHES: Final[dict[Pen, tuple[float, ...]]] = {"hidden": (3.0, 1.0), "chain": (6.0, 1.0, 0.5, 1.0)}
"""Dashes and gaps of broken lines [mm]."""


class Writer(Protocol):
    """What puts the items of a sheet into a file."""

    def path(self, path: Path) -> None:
        """Straight lines."""
        ...

    def arc(self, arc: Arc) -> None:
        """A circular arc."""
        ...

    def fill(self, fill: Fill) -> None:
        """A filled polygon."""
        ...

    def text(self, text: Text) -> None:
        """A text."""
        ...


@dataclass(frozen=True)
class Path:
    """Straight lines from point to point."""

    points: tuple[Point, ...]
    pen: Pen
    closed: bool = False

    def moved(self, x: float, y: float) -> Path:
        """The same elsewhere."""
        return Path(tuple((a + x, b + y) for a, b in self.points), self.pen, self.closed)

    def write(self, writer: Writer) -> None:
        """Put it into a file."""
        writer.path(self)

    def stroke_points(self, step: float) -> tuple[Point, ...]:
        """Points of a line that it is followed by; arcs by chords of an angle [rad]."""
        return (*self.points, self.points[0]) if self.closed else self.points

    def circle(self) -> tuple[Point, float] | None:
        """Center and radius where it is a full circle."""
        return None

    def extent(self) -> Iterator[Point]:
        """Points whose bounds are its own."""
        return iter(self.points)


@dataclass(frozen=True)
class Arc:
    """A circular arc, counterclockwise from one angle to another [rad], at most a full turn."""

    center: Point
    radius: float
    start: float
    end: float
    pen: Pen

    @property
    def full(self) -> bool:
        """Whether it is a circle."""
        return self.end - self.start >= 2.0 * math.pi - 1e-9

    def at(self, angle: float) -> Point:
        """The point at an angle [rad]."""
        x, y = self.center
        return (x + self.radius * math.cos(angle), y + self.radius * math.sin(angle))

    def moved(self, x: float, y: float) -> Arc:
        """The same elsewhere."""
        a, b = self.center
        return Arc((a + x, b + y), self.radius, self.start, self.end, self.pen)

    def write(self, writer: Writer) -> None:
        """Put it into a file."""
        writer.arc(self)

    def stroke_points(self, step: float) -> tuple[Point, ...]:
        """Points of a line that it is followed by; arcs by chords of an angle [rad]."""
        count = max(2, math.ceil((self.end - self.start) / step))
        turn = (self.end - self.start) / count
        return tuple(self.at(self.start + k * turn) for k in range(count + 1))

    def circle(self) -> tuple[Point, float] | None:
        """Center and radius where it is a full circle."""
        return (self.center, self.radius) if self.full else None

    def extent(self) -> Iterator[Point]:
        """Its ends, and where it is farthest left, right, up and down."""
        yield self.at(self.start)
        yield self.at(self.end)
        for quarter in range(math.ceil(self.start / (math.pi / 2.0)), 9):
            angle = quarter * math.pi / 2.0
            if angle >= self.end:
                break
            yield self.at(angle)


@dataclass(frozen=True)
class Fill:
    """A polygon filled with black: arrowheads and dots."""

    points: tuple[Point, ...]

    def moved(self, x: float, y: float) -> Fill:
        """The same elsewhere."""
        return Fill(tuple((a + x, b + y) for a, b in self.points))

    def write(self, writer: Writer) -> None:
        """Put it into a file."""
        writer.fill(self)

    def stroke_points(self, step: float) -> tuple[Point, ...]:
        """Points of a line that it is followed by; arcs by chords of an angle [rad]."""
        return (*self.points, self.points[0])

    def circle(self) -> tuple[Point, float] | None:
        """Center and radius where it is a full circle."""
        return None

    def extent(self) -> Iterator[Point]:
        """Its corners."""
        return iter(self.points)


@dataclass(frozen=True)
class Text:
    """A line of text on a base line at a point, turned by an angle [rad]; height of capitals."""

    at: Point
    text: str
    height: float = LEAST
    anchor: Anchor = "left"
    angle: float = 0.0
    bold: bool = False

    @property
    def width(self) -> float:
        """How wide it is [mm]."""
        return text_width(self.text, self.height, self.bold)

    def bounds(self, margin: float = 0.0) -> tuple[float, float, float, float]:
        """Left, low, right and high side [mm] from its point, along it and up, with a margin."""
        width = self.width
        left = {"left": 0.0, "center": -0.5 * width, "right": -width}[self.anchor] - margin
        low, high = -BELOW * self.height - margin, self.height + margin
        return left, low, left + width + 2.0 * margin, high

    def box(self, margin: float = 0.0) -> tuple[Point, Point, Point, Point]:
        """Corners of the rectangle that it fills, counterclockwise, with a margin [mm]."""
        left, low, right, high = self.bounds(margin)
        c, s = math.cos(self.angle), math.sin(self.angle)
        x, y = self.at
        corners = ((left, low), (right, low), (right, high), (left, high))
        one, two, three, four = ((x + c * u - s * v, y + s * u + c * v) for u, v in corners)
        return one, two, three, four

    def moved(self, x: float, y: float) -> Text:
        """The same elsewhere."""
        a, b = self.at
        return Text((a + x, b + y), self.text, self.height, self.anchor, self.angle, self.bold)

    def write(self, writer: Writer) -> None:
        """Put it into a file."""
        writer.text(self)

    def stroke_points(self, step: float) -> tuple[Point, ...]:
        """Points of a line that it is followed by; arcs by chords of an angle [rad]."""
        return ()

    def circle(self) -> tuple[Point, float] | None:
        """Center and radius where it is a full circle."""
        return None

    def extent(self) -> Iterator[Point]:
        """The corners of its box."""
        return iter(self.box())


Item: TypeAlias = Path | Arc | Fill | Text


@dataclass(frozen=True)
class Dimension:
    """A value on a sheet, with what is drawn for it.

    name : the column of the schedule that has the same value, "edge_1_mm"; empty where none has
    value : in millimeters or degrees
    feet : what it is measured between: two points, or the corner and a point on each side of an
        angle
    true : whether the feet, divided by the scale, measure the value: not across a broken view, and
        not for the angle of anything that is seen askew
    """

    name: str
    value: float
    text: Text
    items: tuple[Item, ...]
    feet: tuple[Point, ...] = ()
    true: bool = True

    def moved(self, x: float, y: float) -> Dimension:
        """The same elsewhere."""
        return Dimension(
            self.name,
            self.value,
            self.text.moved(x, y),
            tuple(item.moved(x, y) for item in self.items),
            tuple((a + x, b + y) for a, b in self.feet),
            self.true,
        )

    def parts(self) -> Iterator[Item]:
        """All that is drawn."""
        yield from self.items
        yield self.text


@dataclass(frozen=True)
class Placed:
    """A view on a sheet: its title, scale, and the rectangle that it fills with its dimensions."""

    title: str
    scale: float
    low: Point
    high: Point


@dataclass(frozen=True)
class Paper:
    """A size of paper [mm] of ISO 5457, as it lies."""

    name: str
    width: float
    height: float


A4: Final = Paper("A4", 210.0, 297.0)
A3: Final = Paper("A3", 420.0, 297.0)
A2: Final = Paper("A2", 594.0, 420.0)
A1: Final = Paper("A1", 841.0, 594.0)
A0: Final = Paper("A0", 1189.0, 841.0)

FILING: Final = 20.0
"""Width of the left margin of a sheet [mm]: ISO 5457."""

MARGIN: Final = 10.0
"""Width of its other margins [mm]."""


@dataclass(frozen=True)
class Rectangle:
    """An upright rectangle on paper [mm]."""

    x0: float
    y0: float
    x1: float
    y1: float

    @property
    def width(self) -> float:
        """From left to right."""
        return self.x1 - self.x0

    @property
    def height(self) -> float:
        """From bottom to top."""
        return self.y1 - self.y0

    def contains(self, point: Point, slack: float = 1e-6) -> bool:
        """Whether a point is inside."""
        x, y = point
        return self.x0 - slack <= x <= self.x1 + slack and self.y0 - slack <= y <= self.y1 + slack


def frame_of(paper: Paper) -> Rectangle:
    """The frame of a sheet, inside which everything is."""
    return Rectangle(FILING, MARGIN, paper.width - MARGIN, paper.height - MARGIN)


@dataclass(frozen=True)
class Sheet:
    """One sheet.

    Attributes
    ----------
    subject : what it is about: a part number, or the name of an overview
    title : what bookmarks show
    items : lines, arcs, texts that are no dimensions
    dimensions : values with what is drawn for them
    views : where the views are, and their scales
    outlines : the visible edges of the views, which no text may touch
    """

    subject: str
    title: str
    paper: Paper
    items: tuple[Item, ...]
    dimensions: tuple[Dimension, ...] = ()
    views: tuple[Placed, ...] = ()
    outlines: tuple[Item, ...] = field(default=(), repr=False)

    def drawn(self) -> Iterator[Item]:
        """Everything, lines before texts."""
        yield from self.outlines
        yield from self.items
        for dimension in self.dimensions:
            yield from dimension.parts()

    def texts(self) -> Iterator[Text]:
        """All texts."""
        return (item for item in self.drawn() if isinstance(item, Text))
