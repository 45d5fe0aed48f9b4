"""Letters of single strokes, as engravers and plotters draw them: data on a grid of 4 by 6."""

from __future__ import annotations

from typing import Final, TypeAlias

import numpy as np

from ddgfab.mesh import Floats

Stroke: TypeAlias = Floats
"""(n, 2) points of an open line."""

ROWS: Final = 6.0
"""Height of a capital on the grid."""

ADVANCE: Final = 6.0
"""From one letter to the next on the grid."""

_LETTERS: Final = {
    "0": "10 01 05 16 36 45 41 30 10,01 45",
    "1": "14 26 20,10 30",
    "2": "05 16 36 45 44 00 40",
    "3": "05 16 36 45 44 33 13,33 42 41 30 10 01",
    "4": "30 36 02 42",
    "5": "46 06 03 33 42 41 30 10 01",
    "6": "36 16 05 01 10 30 41 42 33 03",
    "7": "06 46 10",
    "8": "13 04 05 16 36 45 44 33 13 02 01 10 30 41 42 33",
    "9": "10 30 41 45 36 16 05 04 13 43",
    "A": "00 04 26 44 40,02 42",
    "B": "00 06 36 45 44 33 03,33 42 41 30 00",
    "C": "45 36 16 05 01 10 30 41",
    "D": "00 06 26 44 42 20 00",
    "E": "46 06 00 40,03 33",
    "F": "46 06 00,03 33",
    "G": "45 36 16 05 01 10 30 41 43 23",
    "H": "00 06,40 46,03 43",
    "I": "20 26,10 30,16 36",
    "J": "46 41 30 10 01",
    "K": "00 06,46 03 40",
    "L": "06 00 40",
    "M": "00 06 23 46 40",
    "N": "00 06 40 46",
    "O": "10 01 05 16 36 45 41 30 10",
    "P": "00 06 36 45 44 33 03",
    "Q": "10 01 05 16 36 45 41 30 10,22 40",
    "R": "00 06 36 45 44 33 03,23 40",
    "S": "45 36 16 05 04 13 33 42 41 30 10 01",
    "T": "20 26,06 46",
    "U": "06 01 10 30 41 46",
    "V": "06 20 46",
    "W": "06 10 23 30 46",
    "X": "00 46,06 40",
    "Y": "06 23 46,23 20",
    "Z": "06 46 00 40",
    "-": "13 33",
    "_": "00 40",
    ".": "20 21",
    "/": "00 46",
    "?": "05 16 36 45 44 23 22,20 21",
    " ": "",
}


def strokes(text: str, height: float) -> list[Stroke]:
    """The strokes of a text [mm] from its lower left corner; what has no letter is a "?"."""
    scale = height / ROWS
    out = []
    for place, letter in enumerate(text.upper()):
        for line in filter(None, _LETTERS.get(letter, _LETTERS["?"]).split(",")):
            points = np.array([(int(p[0]), int(p[1])) for p in line.split()], dtype=np.float64)
            points[:, 0] += ADVANCE * place
            out.append(points * scale)
    return out


def width_of(text: str, height: float) -> float:
    """Width of a text [mm]."""
    return (ADVANCE * len(text) - 2.0) * height / ROWS


def arrow(height: float) -> list[Stroke]:
    """An arrow to the right, as long as letters are high, from the left of its middle line [mm]."""
    head, half = 0.35 * height, 0.25 * height
    line = np.array([(0.0, 0.0), (height, 0.0)])
    return [line, np.array([(height - head, half), (height, 0.0), (height - head, -half)])]
