"""What a file states, before anything is checked or mended: points, polygons and their lines."""

from __future__ import annotations

from array import array
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np

from ddgfab.errors import MeshError
from ddgfab.io.groups import Groups
from ddgfab.io.tokens import number
from ddgfab.mesh import Floats, Ints

LIMIT_ELEMENTS = 500_000
"""A file with more vertices or more faces is refused, whatever its size in bytes."""

CORNERS = 4
"""All faces together may have so many times as many corners."""

SMALL = 1e-2
"""Numbers below this part of the largest show how many digits a writer gives to small ones."""

SAMPLE = 4000
"""Coordinates looked at for the digits of a text file; even a file of few digits shows them."""


@dataclass(frozen=True, eq=False)
class RawMesh:
    """Polygons as a file states them, ids from 0, nothing checked yet.

    Attributes
    ----------
    file : name for messages
    points : (V, 3)
    corners : (C,) vertex ids, face after face
    sizes : (F,) number of corners of each face
    point_lines, face_lines : (V,), (F,) line of each in the file, None for binary files
    notes : what was ignored or read in another sense than the format's
    step : coordinates are rounded to about this (the last digit that the file holds)
    units : unit that the file states (a key of `units.FACTORS`), None where it states none
    axes : (V, 3) node axes that the file carries, zero where a point has none; None without
    axes_of : digest of the geometry that the file says they belong to (`header.geometry_digest`)
    lost : what rounding took from its largest numbers; `step` where nothing shows that it was less
    groups : named groups of its vertices and edges
    """

    file: str
    points: Floats
    corners: Ints
    sizes: Ints
    point_lines: Ints | None
    face_lines: Ints | None
    notes: list[str] = field(default_factory=list)
    step: float = 0.0
    units: str | None = None
    axes: Floats | None = None
    axes_of: str | None = None
    lost: float = 0.0
    groups: Groups = field(default_factory=Groups)

    def fail(self, reason: str, *, point: int | None = None, face: int | None = None) -> MeshError:
        """The error to raise, with the line of the point or face it is about."""
        lines, index = (self.point_lines, point) if face is None else (self.face_lines, face)
        line = None if lines is None or index is None else int(lines[index])
        return MeshError(reason, file=self.file, line=line)

    def line_of(self, face: int) -> str:
        """Text such as " (line 7)" for a face of a text file, otherwise empty; for messages."""
        return "" if self.face_lines is None else f" (line {int(self.face_lines[face])})"

    @staticmethod
    def of(
        file: str,
        rows: Rows,
        notes: list[str],
        *,
        units: str | None = None,
        axes: Floats | None = None,
        axes_of: str | None = None,
        groups: Groups | None = None,
    ) -> RawMesh:
        """Raw mesh of what was read line by line."""
        return RawMesh(
            file,
            np.array(rows.points, dtype=np.float64).reshape(-1, 3),
            np.array(rows.corners, dtype=np.int64),
            np.array(rows.sizes, dtype=np.int64),
            np.array(rows.point_lines, dtype=np.int64),
            np.array(rows.face_lines, dtype=np.int64),
            notes,
            rows.digits.step,
            units,
            axes,
            axes_of,
            rows.digits.lost,
            Groups() if groups is None else groups,
        )


def check_count(count: int, what: str, file: str, line: int | None = None) -> None:
    """Raise where a file holds, or says that it holds, more of something than is read.

    Raises
    ------
    MeshError
        Names the limit (`LIMIT_ELEMENTS`).
    """
    if count > LIMIT_ELEMENTS:
        raise MeshError(
            f"has more {what} than are read: the limit is {LIMIT_ELEMENTS}\n"
            "simplify the mesh, or read it in parts",
            file=file,
            line=line,
        )


class Digits:
    """To what the coordinates of a text file are rounded, from a sample over the whole of it.

    Every row is taken, then every second, every fourth, ... so that about `SAMPLE` numbers stay.
    """

    def __init__(self) -> None:
        self._rows: list[list[str]] = []
        self._seen = 0
        self._every = 1

    def look(self, tokens: list[str]) -> None:
        """The coordinates of a vertex as they stand in the file."""
        if self._seen % self._every == 0:
            self._rows.append(tokens)
            if 3 * len(self._rows) > 2 * SAMPLE:
                del self._rows[1::2]
                self._every *= 2
        self._seen += 1

    @property
    def step(self) -> float:
        """The place of the last digit (`decimal_step`)."""
        return decimal_step(token for row in self._rows for token in row)

    @property
    def lost(self) -> float:
        """What rounding took from the largest numbers.

        Where small numbers have fewer digits than large ones, writers kept a number of decimals,
        and zeros at the end of large numbers are missing: then the finest decimal counts.
        """
        tokens = [token for row in self._rows for token in row]
        size = [abs(number(token, "", 0)) for token in tokens]
        large = max(size, default=0.0)
        small = [t for t, s in zip(tokens, size, strict=True) if s < SMALL * large]
        if not small or _digits(small) + 1 >= _digits(tokens):
            return self.step
        return float(
            min(10.0 ** -len(t.lower().partition("e")[0].partition(".")[2]) for t in tokens)
        )


@dataclass
class Rows:
    """Vertices and faces of a text file while it is read, in arrays that grow."""

    file: str
    points: array[float] = field(default_factory=lambda: array("d"))
    corners: array[int] = field(default_factory=lambda: array("q"))
    sizes: array[int] = field(default_factory=lambda: array("q"))
    point_lines: array[int] = field(default_factory=lambda: array("q"))
    face_lines: array[int] = field(default_factory=lambda: array("q"))
    digits: Digits = field(default_factory=Digits)

    def vertex(self, tokens: list[str], line: int, per: int = 1) -> None:
        """A vertex from its three tokens; `per` times as many as usual may come.

        Raises
        ------
        MeshError
            A token that is not a finite number, or one vertex too many.
        """
        file = self.file
        x, y, z = tokens
        self.points.extend((number(x, file, line), number(y, file, line), number(z, file, line)))
        self.digits.look(tokens)
        self.point_lines.append(line)
        if len(self.point_lines) > per * LIMIT_ELEMENTS:
            what = "vertices" if per == 1 else "faces"
            check_count(len(self.point_lines) // per + 1, what, file, line)

    def face(self, corners: Sequence[int], line: int) -> None:
        """A face from its vertex ids.

        Raises
        ------
        MeshError
            One face or corner too many.
        """
        self.corners.extend(corners)
        self.sizes.append(len(corners))
        self.face_lines.append(line)
        if len(self.sizes) > LIMIT_ELEMENTS:
            check_count(len(self.sizes), "faces", self.file, line)
        if len(self.corners) > CORNERS * LIMIT_ELEMENTS:
            raise MeshError(
                f"has more corners of faces than are read: the limit is "
                f"{CORNERS * LIMIT_ELEMENTS}\nsimplify the mesh, or read it in parts",
                file=self.file,
                line=line,
            )


def _digits(tokens: Iterable[str]) -> int:
    """The most digits of a number, without zeros before them."""
    mantissas = (token.lower().partition("e")[0] for token in tokens)
    return max(len("".join(c for c in m if c.isdecimal()).lstrip("0")) for m in mantissas)


def decimal_step(tokens: Iterable[str]) -> float:
    """To what the coordinates of a text file are rounded: the place of their last digit.

    Writers keep a number of digits (%.6g drops zeros at the end) or of decimals (%.6f). The
    numbers with the most digits are those that were cut, and the last digit of the largest of
    them is the coarsest rounding in the file.
    """
    most, step = 0, 0.0
    for token in tokens:
        mantissa, _, exponent = token.lower().replace("d", "e").partition("e")
        whole, _, decimals = mantissa.lstrip("+-").partition(".")
        digits = len((whole + decimals).lstrip("0"))
        if not digits or digits < most:
            continue
        try:
            place = 10.0 ** (int(exponent or 0) - len(decimals))
        except (ValueError, OverflowError):
            continue
        step = place if digits > most else max(step, place)
        most = digits
    return step


def binary_step(points: Floats, code: str) -> float:
    """To what binary coordinates of a numpy type are rounded: the spacing of the largest one."""
    if not len(points):
        return 0.0
    largest = float(np.abs(points[np.isfinite(points)]).max(initial=0.0))
    if np.dtype(code).kind != "f":
        return 1.0
    return float(np.spacing(np.array(largest, dtype=np.dtype(code))))
