"""DSTV NC files read back, strictly: what does not belong into a file is an error with its line."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

from ddgfab.errors import InputError, clipped
from ddgfab.io.regular import read_regular
from ddgfab.tolerances import COORDINATE_LIMIT

LIMIT_BYTES: Final = 8 * 1024 * 1024
"""Larger files are refused."""

TEXTS: Final = ("order", "drawing", "phase", "piece", "steel", "quantity", "profile", "code")
NUMBERS: Final = (
    *("length", "height", "flange_width", "flange", "web", "radius", "weight", "surface"),
    *("web_start", "web_end", "flange_start", "flange_end"),
)
CODES: Final = ("I", "U", "L", "M", "RO", "RU", "B", "C", "T", "SO")
SKIPPED: Final = ("IK", "PU", "KO", "SC", "TO", "UE", "PR", "KA", "IN")
"""Blocks that are passed over."""

_QUANTITY: Final = re.compile(r"[0-9]{1,9}")
_NUMBER: Final = r"(-?\d+(?:\.\d*)?)"
_POINT: Final = re.compile(rf"([vouh])?\s*{_NUMBER}\s*([ous])?\s*{_NUMBER}\s*([tw])?\s*(.*)")
_MARK: Final = re.compile(rf"([vouh])\s*{_NUMBER}\s*([ous])?\s*{_NUMBER}\s+{_NUMBER}\s+(\d+)(.*)")

Point = tuple[str, float, float, tuple[float, ...]]
"""Face, x, y, and the numbers that follow."""


@dataclass
class Nc1:
    """A file: header by name, contours by face, holes, marked texts."""

    header: dict[str, str | float] = field(default_factory=dict)
    contours: list[list[Point]] = field(default_factory=list)
    holes: list[Point] = field(default_factory=list)
    marks: list[tuple[str, float, float, str]] = field(default_factory=list)

    def value(self, name: str) -> float:
        """A number of the header."""
        return float(self.header[name])


def read_nc1(path: Path) -> Nc1:
    """The header, and the blocks AK, BO and SI.

    Raises
    ------
    InputError
        Missing or damaged; names the line.
    """
    data = read_regular(path, LIMIT_BYTES, InputError, what="a DSTV file", advice="split it")
    rows = [
        (number, row.rstrip())
        for number, row in enumerate(data.decode("latin-1").splitlines(), start=1)
        if not row.startswith("**")
    ]
    if not rows or rows[0][1] != "ST":
        raise InputError("not a DSTV file: it does not begin with ST", file=str(path))
    if rows[-1][1] != "EN":
        raise InputError("not a DSTV file, or truncated: it does not end with EN", file=str(path))
    found = Nc1()
    after = _header(rows, found, path)
    block = ""
    for number, row in rows[after:-1]:
        if row and not row.startswith("  "):
            block = row
            if block not in ("AK", "BO", "SI", *SKIPPED):
                raise _error(f"{clipped(row)} is not a block of DSTV", path, number)
            if block == "AK":
                found.contours.append([])
        elif block == "SI" and row:
            mark = _MARK.fullmatch(row.strip())
            if mark is None:
                raise _error(f"{clipped(row)} is not a mark", path, number)
            x, y = (_number(mark[k], path, number) for k in (2, 4))
            found.marks.append((mark[1], x, y, mark[7].strip().removeprefix("r ")))
        elif block in ("AK", "BO") and row:
            own = found.contours[-1] if block == "AK" else found.holes
            own.append(_point(row, own[-1][0] if own else "", path, number))
    for contour in found.contours:
        if len(contour) < 3 or contour[0][:3] != contour[-1][:3]:
            raise _error("a contour is not closed", path, rows[-1][0])
    return found


def _header(rows: list[tuple[int, str]], found: Nc1, path: Path) -> int:
    """Read the header; returns the row after it."""
    names = (*TEXTS, *NUMBERS, "text1", "text2", "text3", "text4")
    if len(rows) < len(names) + 2:
        raise _error("the header is truncated", path, rows[-1][0])
    for (number, row), name in zip(rows[1:], names, strict=False):
        if name in NUMBERS:
            found.header[name] = _number(row.strip().partition(",")[0], path, number)
        elif name == "quantity" and not _QUANTITY.fullmatch(row.strip()):
            text = f"the quantity must be a number of at most nine digits, not {clipped(row)}"
            raise _error(text, path, number)
        elif name == "code" and row.strip() not in CODES:
            raise _error(f"{clipped(row.strip())} is not a code of profiles", path, number)
        else:
            found.header[name] = row.strip()
    return 1 + len(names)


def _point(row: str, face: str, path: Path, number: int) -> Point:
    point = _POINT.fullmatch(row.strip())
    if point is None or not (point[1] or face):
        raise _error(f"{clipped(row)} is not a point", path, number)
    rest = tuple(_number(text, path, number) for text in point[6].split())
    x, y = (_number(point[k], path, number) for k in (2, 4))
    return point[1] or face, x, y, rest


def _number(text: str, path: Path, number: int) -> float:
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    if not abs(value) <= COORDINATE_LIMIT:
        raise _error(f"{clipped(text)} is not a number up to {COORDINATE_LIMIT:g}", path, number)
    return value


def _error(text: str, path: Path, number: int) -> InputError:
    return InputError(text, file=str(path), line=number)
