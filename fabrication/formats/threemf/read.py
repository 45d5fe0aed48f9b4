"""3MF read back by lib3mf, the reader of the 3MF consortium; its meshes compared with ours."""

from __future__ import annotations

import io
import zipfile
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Any, Final

import numpy as np

from ddgfab.errors import InputError, clipped
from ddgfab.io.regular import read_regular
from ddgfab.mesh import Floats, Ints
from fabrication.formats.archive import UNREADABLE
from fabrication.formats.threemf.write import DECIMALS, Body3MF
from fabrication.specs import Check, Placement, TriangleMesh

SINGLE_ROUNDING: Final = 2.0**-23
"""Greatest rounding of a coordinate in lib3mf (single precision), relative to its size."""

DECIMAL_MM: Final = 0.5 * 10.0**-DECIMALS
"""How far [mm] the writer may have rounded a coordinate."""

LIMIT_BYTES: Final = 256 * 1024 * 1024
"""Larger files are refused, also where they are larger when unpacked."""

MOST_ITEMS, DEEPEST = 100_000, 50
"""Bodies that are placed, and components in components: a few lines can name any number."""

_UNITS: Final = {
    "MicroMeter": ("micron", 0.001),
    "MilliMeter": ("millimeter", 1.0),
    "CentiMeter": ("centimeter", 10.0),
    "Inch": ("inch", 25.4),
    "Foot": ("foot", 304.8),
    "Meter": ("meter", 1000.0),
}
"""Names of lib3mf's units in the file, and their millimeters."""


@dataclass(frozen=True, eq=False)
class Content3MF:
    """A 3MF read back, in millimeters.

    unit : of the file
    bodies : the meshes with their names, unplaced; the color is not read
    placed : how often the build places each body, through components too
    items : what the build places: which body, its part number (or its name), (4, 4) motion [mm]
    oriented : whether lib3mf finds each one manifold and oriented
    warnings : of the reader
    """

    unit: str
    bodies: tuple[Body3MF, ...]
    placed: tuple[int, ...]
    items: tuple[tuple[int, str, Placement], ...]
    oriented: tuple[bool, ...]
    warnings: tuple[str, ...]


def read_threemf(path: Path, *, strict: bool = True) -> Content3MF:
    """The meshes of a 3MF as written, and where the build places them.

    Raises
    ------
    InputError
        Missing, no 3MF, broken, or lib3mf is not installed; names the file and what is wrong.
    """
    try:
        import lib3mf
    except ImportError as error:
        text = f"reading 3MF needs lib3mf: pip install 'ddgfab[3mf]' ({error})"
        raise InputError(text, file=str(path)) from error

    _require_small(path)
    model = lib3mf.get_wrapper().CreateModel()
    reader = model.QueryReader("3mf")
    reader.SetStrictModeActive(strict)
    try:
        reader.ReadFromFile(str(path))
        unit, factor = _UNITS[model.GetUnit().name]
        objects, found = model.GetMeshObjects(), []
        while objects.MoveNext():
            found.append(objects.GetCurrentMeshObject())
        ids = [body.GetResourceID() for body in found]
        items = tuple(islice(_items(model, ids, factor), MOST_ITEMS + 1))
        if len(items) > MOST_ITEMS:
            raise ValueError(f"more than {MOST_ITEMS} bodies are placed")
        bodies = tuple(Body3MF(body.GetName(), _mesh(body, factor)) for body in found)
        oriented = tuple(bool(body.IsManifoldAndOriented()) for body in found)
        warnings = tuple(reader.GetWarning(i)[1] for i in range(reader.GetWarningCount()))
    except (lib3mf.ELib3MFException, KeyError, ValueError) as error:
        raise InputError(
            f"not a readable 3MF file ({clipped(error, 200)})", file=str(path)
        ) from error
    used = Counter(body for body, _, _ in items)
    counts = tuple(used[body] for body in range(len(found)))
    return Content3MF(unit, bodies, counts, items, oriented, warnings)


def _require_small(path: Path) -> None:
    """Raise unless it is an archive of moderate size, also unpacked: lib3mf has no such limits."""
    data = read_regular(path, LIMIT_BYTES, InputError, what="a 3MF file", advice="split the model")
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            size = sum(entry.file_size for entry in archive.infolist())
    except UNREADABLE as error:
        text = f"not a readable 3MF file (no archive: {clipped(error)})"
        raise InputError(text, file=str(path)) from error
    if size > LIMIT_BYTES:
        text = f"{size} bytes when unpacked exceed the limit of {LIMIT_BYTES}; split the model"
        raise InputError(text, file=str(path))


def check_threemf(path: Path, expected: Sequence[tuple[str, TriangleMesh, int]]) -> list[Check]:
    """The checks of one 3MF file, read back by lib3mf and compared with the meshes written.

    Parameters
    ----------
    expected : the objects in their order: name, mesh [mm], how often it is placed

    Returns
    -------
    Checks "3mf readable", and if it is, "3mf objects" (names in their order), "3mf unit",
    "3mf manifold" (lib3mf: manifold and oriented), "3mf instances", and where the counts agree
    "3mf corners" (greatest distance [mm] of a corner, against single precision).
    """
    try:
        content = read_threemf(path, strict=True)
    except InputError as error:
        return [Check("3mf readable", False, str(error))]
    names = [body.name for body in content.bodies]
    wanted = [name for name, _, _ in expected]
    sound = bool(content.bodies) and all(content.oriented)
    counts = [count for _, _, count in expected]
    placed = list(content.placed)
    warnings = "; ".join(content.warnings)
    checks = [
        Check("3mf readable", not warnings, warnings or None),
        Check("3mf objects", names == wanted, ", ".join(names), ", ".join(wanted)),
        Check("3mf unit", content.unit == "millimeter", content.unit, "millimeter"),
        Check("3mf manifold", sound),
        Check("3mf instances", placed == counts, float(sum(placed)), float(sum(counts))),
    ]
    away = limit = 0.0
    for found, (_, mesh, _) in zip(content.bodies, expected, strict=False):
        same = found.mesh.vertices.shape == mesh.vertices.shape
        if not same or not np.array_equal(found.mesh.triangles, mesh.triangles):
            away = np.inf
            break
        away = max(away, float(np.abs(found.mesh.vertices - mesh.vertices).max()))
        single = SINGLE_ROUNDING * float(np.abs(mesh.vertices).max())
        limit = max(limit, DECIMAL_MM + single)
    checks.append(Check("3mf corners", away <= limit, away, limit))
    return checks


def _items(
    model: Any, meshes: Sequence[int], factor: float
) -> Iterator[tuple[int, str, Placement]]:
    """Every mesh that the build places, through components too; motions in millimeters."""
    numbers = {key: number for number, key in enumerate(meshes)}

    def place(
        body: Any, name: str, at: Placement, depth: int = 0
    ) -> Iterator[tuple[int, str, Placement]]:
        if depth > DEEPEST:
            raise ValueError(f"components in components, more than {DEEPEST} deep")
        number = numbers.get(body.GetResourceID())
        if number is not None:
            yield number, name or body.GetName(), at
            return
        parts = model.GetComponentsObjectByID(body.GetResourceID())
        for i in range(parts.GetComponentCount()):
            part = parts.GetComponent(i)
            motion = _motion(part.GetTransform(), factor)
            inner = part.GetObjectResource()
            own = f"{name} {inner.GetName()}".strip() if name else inner.GetName()
            yield from place(inner, own, at @ motion, depth + 1)

    build = model.GetBuildItems()
    while build.MoveNext():
        item = build.GetCurrent()
        motion = _motion(item.GetObjectTransform(), factor)
        yield from place(item.GetObjectResource(), item.GetPartNumber(), motion)


def _motion(transform: Any, factor: float) -> Placement:
    """(4, 4) matrix of a lib3mf transform, which multiplies row vectors."""
    rows = np.array([list(row) for row in transform.Fields], dtype=np.float64)
    motion = np.eye(4)
    motion[:3, :3], motion[:3, 3] = rows[:3].T, rows[3] * factor
    return motion


def _mesh(body: Any, factor: float) -> TriangleMesh:
    """The mesh of a lib3mf mesh object, its coordinates times a factor."""
    vertices: Floats = factor * np.array(
        [list(point.Coordinates) for point in body.GetVertices()], dtype=np.float64
    ).reshape(-1, 3)
    triangles: Ints = np.array(
        [list(corner.Indices) for corner in body.GetTriangleIndices()], dtype=np.int64
    ).reshape(-1, 3)
    return TriangleMesh(vertices, triangles)
