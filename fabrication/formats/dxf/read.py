"""The polylines of text DXF files of any release."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np

from ddgfab.errors import InputError, clipped
from ddgfab.io.regular import read_regular
from ddgfab.tolerances import COORDINATE_LIMIT
from fabrication.specs import Loop

LIMIT_BYTES: Final = 64 * 1024 * 1024
"""Larger files are refused."""


@dataclass(frozen=True, eq=False)
class Polyline:
    """A polyline of a file: its layer, whether it is closed, corners and bulges."""

    layer: str
    closed: bool
    loop: Loop


def read_dxf(path: Path) -> list[Polyline]:
    """The polylines of the model space of a text DXF of any release.

    Raises
    ------
    InputError
        Missing, binary, truncated, or with values that are not numbers; names the line.
    """
    data = read_regular(path, LIMIT_BYTES, InputError, what="a DXF file", advice="split it")
    if data.startswith(b"AutoCAD Binary DXF"):
        raise InputError("a binary DXF: save it as text", file=str(path))
    rows = data.decode("utf-8", "replace").splitlines()
    tags = _tags(rows, path)
    if not tags or tags[-1][1:] != (0, "EOF"):
        raise InputError("no DXF file, or truncated: it does not end with EOF", file=str(path))
    found: list[Polyline] = []
    section, entity = "", ""
    layer, closed = "", False
    points: list[list[float]] = []
    bulges: list[float] = []

    def flush() -> None:
        if entity in ("LWPOLYLINE", "POLYLINE") and section == "ENTITIES" and points:
            corners = np.array([[x, y] for x, y in points])
            found.append(Polyline(layer, closed, Loop(corners, np.array(bulges))))

    for line, code, value in tags:
        if code == 0 and value in ("VERTEX", "SEQEND") and entity == "POLYLINE":
            if value == "VERTEX":
                points.append([0.0, 0.0])
                bulges.append(0.0)
            continue
        if code == 0:
            flush()
            entity, layer, closed, points, bulges = value, "", False, [], []
        elif code == 2 and entity == "SECTION":
            section = value
        elif code == 8:
            layer = value
        elif code == 70 and not points:
            closed = bool(int(_value(value, line, path)) & 1)
        elif code == 10 and entity == "LWPOLYLINE":
            points.append([_value(value, line, path), 0.0])
            bulges.append(0.0)
        elif code in (10, 20) and points:
            points[-1][code == 20] = _value(value, line, path)
        elif code == 42 and points:
            bulges[-1] = _value(value, line, path)
    return found


def _tags(rows: Sequence[str], path: Path) -> list[tuple[int, int, str]]:
    """Line, group code and value of each pair of lines."""
    tags = []
    for k in range(0, len(rows) - 1, 2):
        code = rows[k].strip()
        if not code.lstrip("-").isdecimal() or len(code) > 6:
            text = f"a group code must be a whole number, not {clipped(rows[k])}"
            raise InputError(text, file=str(path), line=k + 1)
        tags.append((k + 2, int(code), rows[k + 1].strip()))
    return tags


def _value(text: str, line: int, path: Path) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not abs(value) <= COORDINATE_LIMIT:
        why = f"must be a finite number, at most {COORDINATE_LIMIT:g}, not {clipped(text)}"
        raise InputError(why, file=str(path), line=line)
    return value
