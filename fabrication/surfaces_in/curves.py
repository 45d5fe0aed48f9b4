"""Drawn curves from DXF, OBJ and CSV files, as polylines [mm]."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final

import numpy as np

from ddgfab.errors import InputError, clipped
from ddgfab.io.regular import read_regular
from ddgfab.io.units import FACTORS
from ddgfab.mesh import Floats

CURVE_SUFFIXES: Final = (".dxf", ".obj", ".csv")
"""Files that curves are read from."""

_MOST_BYTES: Final = 64 * 1024**2
_CHORD: Final = 1e-4
"""Curved DXF entities leave their chords by this part of their size at most."""
_DXF_UNITS: Final = {1: "in", 2: "ft", 4: "mm", 5: "cm", 6: "m"}
_EXACT: Final = ("SPLINE", "ARC", "CIRCLE", "ELLIPSE")
_DXF_KINDS: Final = ("LINE", "LWPOLYLINE", "POLYLINE", "SPLINE", "ARC", "CIRCLE", "ELLIPSE")


def read_curves(path: Path) -> list[Floats]:
    """The curves of a file as polylines (m, 3) [mm].

    DXF: lines, polylines, splines, arcs, circles and ellipses of the model space, in the unit of
    $INSUNITS (none: millimetres). OBJ: lines `l`, in the unit of a comment "# units: m". CSV: a
    point x, y, z (or x, y) a row; an empty row, or another text in a first column of names, begins
    the next curve.

    Raises
    ------
    InputError
        A file that is missing, of another kind, or holds no curve; a row that is not a point (with
        its line).
    """
    suffix = path.suffix.lower()
    if suffix not in CURVE_SUFFIXES:
        raise InputError(
            f'unknown kind of curve file "{suffix}"; known: {", ".join(CURVE_SUFFIXES)}',
            file=str(path),
        )
    data = read_regular(
        path, _MOST_BYTES, InputError, what="a file of curves", advice="curves only, please"
    )
    curves = {".dxf": _dxf, ".obj": _obj, ".csv": _csv}[suffix](data, str(path))
    if not curves:
        raise InputError(
            "holds no curve: "
            + {
                ".dxf": f"{', '.join(_DXF_KINDS)} of the model space are read",
                ".obj": "lines 'l' are read",
                ".csv": "a row a point: x,y,z",
            }[suffix],
            file=str(path),
        )
    return curves


def _text(data: bytes, file: str) -> str:
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise InputError("is not a text file in UTF-8", file=file) from None


def _dxf(data: bytes, file: str) -> list[Floats]:
    from ezdxf import recover
    from ezdxf.lldxf.const import DXFError
    from ezdxf.path import make_path

    try:
        document, _ = recover.read(io.BytesIO(data))
    except (DXFError, OSError, ValueError) as error:
        raise InputError(
            f"is not a DXF file that can be read ({clipped(error)})", file=file
        ) from None
    factor = FACTORS[_DXF_UNITS.get(int(document.header.get("$INSUNITS", 4)), "mm")]
    out = []
    for entity in document.modelspace():
        if entity.dxftype() not in _DXF_KINDS:
            continue
        try:
            path: Any = make_path(entity)
            control = np.array([tuple(p) for p in path.control_vertices()], dtype=np.float64)
            chord = max(_CHORD * float(np.linalg.norm(np.ptp(control, axis=0))), 1e-12)
            # paths are cubics: circles of them are 3e-4 off, entities themselves are exact
            curve: Any = entity if entity.dxftype() in _EXACT else path
            points = [tuple(p) for p in curve.flattening(chord)]
        except (TypeError, ValueError, DXFError):
            continue
        out.append(factor * np.array(points, dtype=np.float64))
    return [curve for curve in out if len(curve) > 1]


def _obj(data: bytes, file: str) -> list[Floats]:
    from ddgfab.io.header import comments_of
    from ddgfab.io.units import stated_unit

    text = _text(data, file)
    points: list[tuple[float, float, float]] = []
    rows: list[tuple[int, list[int]]] = []
    for number, line in enumerate(text.splitlines(), 1):
        parts = line.partition("#")[0].split()
        if parts[:1] == ["v"]:
            points.append(_point(parts[1:4], file, number))
        elif parts[:1] == ["l"]:
            try:
                ids = [int(token.partition("/")[0]) for token in parts[1:]]
            except ValueError:
                raise InputError("a line 'l' of something else than numbers", file=file,
                                 line=number) from None  # fmt: skip
            rows.append((number, [k - 1 if k > 0 else len(points) + k for k in ids]))
    unit = stated_unit(comments_of(text, "#"))
    table = FACTORS[unit or "mm"] * np.array(points, dtype=np.float64).reshape(-1, 3)
    out = []
    for number, ids in rows:
        if not all(0 <= k < len(points) for k in ids):
            raise InputError(f"a line of vertices beyond {len(points)}", file=file, line=number)
        if len(ids) > 1:
            out.append(table[ids])
    return _chained(out)


def _csv(data: bytes, file: str) -> list[Floats]:
    text = _text(data, file)
    out: list[list[tuple[float, float, float]]] = [[]]
    name: str | None = None
    delimiter = ";" if text.count(";") > text.count(",") else ","
    for number, row in _rows(text, delimiter):
        cells = [cell.strip() for cell in row]
        if not any(cells):
            out.append([])
            continue
        named = len(cells) in (3, 4) and not _is_number(cells[0]) and _is_number(cells[1])
        if named:
            if cells[0] != name:
                out.append([])
            name = cells[0]
            cells = cells[1:]
        elif number == 1 and not _is_number(cells[0]):
            continue  # titles of the columns
        if len(cells) == 2:
            cells.append("0")
        out[-1].append(_point(cells, file, number))
    return [np.array(curve, dtype=np.float64) for curve in out if len(curve) > 1]


def _rows(text: str, delimiter: str) -> Iterator[tuple[int, list[str]]]:
    reader = csv.reader(io.StringIO(text), delimiter=delimiter)
    for row in reader:
        yield reader.line_num, row


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _point(tokens: list[str], file: str, line: int) -> tuple[float, float, float]:
    try:
        x, y, z = (float(token) for token in tokens)
    except ValueError:
        raise InputError(
            f"{clipped(' '.join(tokens))} is not a point: three numbers are needed",
            file=file,
            line=line,
        ) from None
    if not np.isfinite([x, y, z]).all():
        raise InputError("a coordinate is not finite", file=file, line=line)
    return x, y, z


def _chained(curves: list[Floats]) -> list[Floats]:
    """Polylines of which one begins where the one before it ends, as one."""
    out: list[Floats] = []
    for curve in curves:
        if out and (out[-1][-1] == curve[0]).all():
            out[-1] = np.concatenate([out[-1], curve[1:]])
        else:
            out.append(curve)
    return out
