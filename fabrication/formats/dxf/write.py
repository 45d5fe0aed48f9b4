"""Plates as text DXF; header, tables and objects are ezdxf's, the outlines are written here."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import Final, TypeAlias

import numpy as np

from fabrication.drawings.dxf_file import Layer, template
from fabrication.drawings.strokes import Stroke
from fabrication.solids.plate import Plate
from fabrication.specs import Loop

CUT: Final = "CUT"
DETAIL: Final = "DETAIL"
ENGRAVE: Final = "ENGRAVE"
MARK: Final = "MARK"
LAYERS: Final = (Layer(CUT, 7), Layer(ENGRAVE, 5), Layer(MARK, 3), Layer(DETAIL, 8))
"""Layers and their colors by index: what is cut through; what is engraved into metal; what glass
is marked with, to be read from outside; the outline of the smaller face."""

STOCK: Final = "STOCK"
NESTED_LAYERS: Final = (*LAYERS, Layer(STOCK, 1))
"""The same with the borders and titles of sheets of stock."""

Drawn: TypeAlias = tuple[str, Loop, bool]
"""A layer, a line on it, and whether the line is closed."""

_FIRST_HANDLE: Final = 0x1000


def dxf_text(
    flat: Plate, release: str = "R2010", marks: Sequence[Stroke] = (), layer: str = ENGRAVE
) -> str:
    """A plate as DXF of a release, R2010 or R12; the latter names no unit.

    Every file of a release has the same header, tables and objects, made by ezdxf once.

    Parameters
    ----------
    marks : open lines for a layer, ENGRAVE or MARK
    """
    drawn: list[Drawn] = [(CUT, loop, True) for loop in flat.loops]
    drawn += [(DETAIL, loop, True) for loop in flat.other]
    drawn += [(layer, Loop(points, np.zeros(len(points))), False) for points in marks]
    return lines_text(drawn, release, LAYERS)


def lines_text(drawn: Iterable[Drawn], release: str, layers: tuple[Layer, ...]) -> str:
    """Lines on layers as DXF of a release, R2010 or R12."""
    before, after, owner = template(release, layers)
    handles = iter(range(_FIRST_HANDLE, 1 << 32))
    draw = _lightweight if release != "R12" else _vertices
    entities = [
        line for on, loop, closed in drawn for line in draw(on, loop, handles, owner, closed=closed)
    ]
    seed = f"{next(handles):X}"
    return before.replace("$SEED$", seed) + "".join(f"{line}\n" for line in entities) + after


def _lightweight(
    layer: str, loop: Loop, handles: Iterator[int], owner: str, *, closed: bool = True
) -> list[str]:
    """LWPOLYLINE."""
    head = ["LWPOLYLINE", f"{next(handles):X}", owner, "AcDbEntity", layer, "AcDbPolyline"]
    lines = [
        f"{code:3d}\n{value}" for code, value in zip((0, 5, 330, 100, 8, 100), head, strict=True)
    ]
    lines += [f" 90\n{len(loop.points)}", f" 70\n{int(closed)}"]
    for (x, y), bulge in zip(loop.points.tolist(), loop.bulges.tolist(), strict=True):
        lines.append(f" 10\n{_number(x)}\n 20\n{_number(y)}")
        if bulge:
            lines.append(f" 42\n{_number(bulge)}")
    return lines


def _vertices(
    layer: str, loop: Loop, handles: Iterator[int], owner: str, *, closed: bool = True
) -> list[str]:
    """POLYLINE with its VERTEX entities, as R12 has it."""
    lines = [
        f"  0\nPOLYLINE\n  5\n{next(handles):X}\n  8\n{layer}\n 66\n1",
        f" 10\n0.0\n 20\n0.0\n 30\n0.0\n 70\n{int(closed)}",
    ]
    for (x, y), bulge in zip(loop.points.tolist(), loop.bulges.tolist(), strict=True):
        at = f" 10\n{_number(x)}\n 20\n{_number(y)}\n 30\n0.0\n 42\n{_number(bulge)}"
        lines.append(f"  0\nVERTEX\n  5\n{next(handles):X}\n  8\n{layer}\n{at}")
    return [*lines, f"  0\nSEQEND\n  5\n{next(handles):X}\n  8\n{layer}"]


def _number(value: float) -> str:
    """At 1e-9 mm, without the sign of a zero."""
    return repr(round(value, 9) + 0.0)
