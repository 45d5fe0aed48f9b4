"""What a file states, before anything is checked or mended: points, polygons and their lines."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np

from ddgfab.errors import MeshError
from ddgfab.mesh import Floats, Ints

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
        points: Sequence[Sequence[float]],
        faces: Sequence[Sequence[int]],
        point_lines: Sequence[int],
        face_lines: Sequence[int],
        notes: list[str],
        *,
        step: float = 0.0,
        units: str | None = None,
        axes: Floats | None = None,
    ) -> RawMesh:
        """Raw mesh from Python lists."""
        flat = [index for face in faces for index in face]
        return RawMesh(
            file,
            np.array(points, dtype=np.float64).reshape(-1, 3),
            np.array(flat, dtype=np.int64),
            np.array([len(face) for face in faces], dtype=np.int64),
            np.array(point_lines, dtype=np.int64),
            np.array(face_lines, dtype=np.int64),
            notes,
            step,
            units,
            axes,
        )


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
