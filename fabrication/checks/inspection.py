"""What is in a STEP, STL or 3MF file: solids, closed, valid, volume, names; for `ddgfab check`."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
import zipfile
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np

from ddgfab.errors import InputError
from ddgfab.mesh import Floats
from fabrication.checks.crossing import crossings
from fabrication.checks.file import read_step
from fabrication.checks.mesh import measure_mesh
from fabrication.export.stl import read_stl
from fabrication.specs import TriangleMesh

LARGEST_MODEL: Final = 1_000_000_000
"""Greatest size [bytes] of the model inside a 3MF once unpacked."""

CROSSING_TRIANGLES: Final = 20_000
"""Larger meshes are not searched for self-crossing, as the search grows with the square."""

_CORE: Final = "{http://schemas.microsoft.com/3dmanufacturing/core/2015/02}"
_MODEL: Final = "3D/3dmodel.model"


@dataclass(frozen=True)
class Body:
    """One product or mesh of a file.

    name : product or object name, empty when the format has none
    instances : how often the file places it
    solids, triangles : how many it has; None where the format has no such thing
    volume_mm3 : of one instance, signed: negative when it is inside out
    problems : in words, empty when it is sound
    """

    name: str
    instances: int
    solids: int | None
    triangles: int | None
    volume_mm3: float
    problems: tuple[str, ...]


@dataclass(frozen=True)
class FileReport:
    """What `inspect_file` found. volume_mm3 counts every instance."""

    file: str
    format: str
    unit: str
    bodies: tuple[Body, ...]
    volume_mm3: float
    problems: tuple[str, ...]

    @property
    def passed(self) -> bool:
        """Whether nothing is wrong."""
        return not self.problems

    def to_dict(self) -> dict[str, Any]:
        """Plain data for JSON."""
        return {**asdict(self), "passed": self.passed}

    def text(self) -> str:
        """One line for people."""
        placed = sum(body.instances for body in self.bodies)
        what = f"{len(self.bodies)} {'body' if len(self.bodies) == 1 else 'bodies'}"
        if placed != len(self.bodies):
            what += f", {placed} instances"
        triangles = [body.triangles for body in self.bodies if body.triangles is not None]
        if triangles:
            what += f", {sum(triangles)} triangles"
        state = "closed and valid" if self.passed else "; ".join(self.problems[:3])
        if len(self.problems) > 3:
            state += f"; and {len(self.problems) - 3} more problems"
        return f"{self.file}: {self.format}, {what}, {self.volume_mm3:.1f} mm3, {state}"


def inspect_file(path: Path | str) -> FileReport:
    """Look into a file by its ending: .step or .stp, .stl (binary or text), .3mf.

    Raises
    ------
    InputError
        Missing, of another format, truncated or broken; names the file and what is wrong.
    """
    path = Path(path)
    kind = path.suffix.lower()
    if kind in (".step", ".stp"):
        return _step(path)
    if kind == ".stl":
        return _report(path, "STL", "mm assumed", [("", 1, read_stl(path))])
    if kind == ".3mf":
        return _threemf(path)
    raise InputError("not a file that can be checked; .step, .stp, .stl or .3mf", file=str(path))


def _step(path: Path) -> FileReport:
    content = read_step(path)
    placed = [name for name, _, _ in content.instances]
    bodies = []
    for product in content.products:
        report = product.report
        problems = []
        if report.solids == 0:
            problems.append("no solid")
        elif not report.closed:
            problems.append("not closed")
        if not report.valid:
            problems.append("invalid" + (f" ({', '.join(report.faults)})" if report.faults else ""))
        if report.solids and report.volume <= 0:
            problems.append("inside out or without volume")
        bodies.append(
            Body(
                product.name,
                placed.count(product.name),
                report.solids,
                None,
                report.volume,
                tuple(problems),
            )
        )
    return _whole(path, "STEP", content.unit, bodies)


def _report(
    path: Path, kind: str, unit: str, meshes: list[tuple[str, int, TriangleMesh]]
) -> FileReport:
    """Report on (name, instances, mesh in mm)."""
    bodies = []
    for name, instances, mesh in meshes:
        report = measure_mesh(mesh)
        problems = []
        if not report.watertight:
            problems.append(f"{report.open_edges} edges without exactly one partner: not closed")
        elif report.volume <= 0:
            problems.append("inside out or without volume")
        if report.watertight and report.triangles <= CROSSING_TRIANGLES:
            crossing = len(crossings(mesh))
            if crossing:
                problems.append(f"triangles go through each other at {crossing} places")
        bodies.append(Body(name, instances, None, report.triangles, report.volume, tuple(problems)))
    return _whole(path, kind, unit, bodies)


def _whole(path: Path, kind: str, unit: str, bodies: list[Body]) -> FileReport:
    problems = [
        f"{body.name}: {problem}" if body.name else problem
        for body in bodies
        for problem in body.problems
    ]
    if not bodies:
        problems.append("holds no body")
    volume = sum(body.volume_mm3 * body.instances for body in bodies)
    return FileReport(str(path), kind, unit, tuple(bodies), volume, tuple(problems))


# --- 3MF -----------------------------------------------------------------------------------------
_MILLIMETRES: Final = {
    "micron": 0.001,
    "millimeter": 1.0,
    "centimeter": 10.0,
    "inch": 25.4,
    "foot": 304.8,
    "meter": 1000.0,
}


def _threemf(path: Path) -> FileReport:
    """The meshes of a 3MF's main model (core specification 1.3, chapters 3 and 4).

    Placements are taken as rigid motions: volumes are those of the meshes as they are written.
    """
    root = _model(path)
    unit = root.get("unit", "millimeter")
    if unit not in _MILLIMETRES:
        raise InputError(f"3MF with the unknown unit {unit!r}", file=str(path))
    placed: dict[str, int] = {}
    components: dict[str, list[str]] = {}
    meshes: dict[str, tuple[str, TriangleMesh]] = {}
    for item in root.iterfind(f"{_CORE}resources/{_CORE}object"):
        key = item.get("id", "")
        mesh = item.find(f"{_CORE}mesh")
        if mesh is not None:
            meshes[key] = (item.get("name", ""), _mesh(mesh, _MILLIMETRES[unit], path))
        components[key] = [
            part.get("objectid", "")
            for part in item.iterfind(f"{_CORE}components/{_CORE}component")
        ]
    for build in root.iterfind(f"{_CORE}build/{_CORE}item"):
        placed[build.get("objectid", "")] = placed.get(build.get("objectid", ""), 0) + 1
    order = {key: at for at, key in enumerate(components)}
    for key in reversed(components):
        for part in components[key]:
            if order.get(part, len(order)) >= order[key]:
                raise InputError(
                    f"3MF object {key} has a part {part} that does not come before it",
                    file=str(path),
                )
            placed[part] = placed.get(part, 0) + placed.get(key, 0)
    found = [(name, placed.get(key, 0), mesh) for key, (name, mesh) in meshes.items()]
    return _report(path, "3MF", unit, found)


def _model(path: Path) -> ElementTree.Element:
    """The root of a 3MF's main model; refused when it declares entities or unpacks to too much."""
    try:
        with zipfile.ZipFile(path) as archive:
            info = archive.getinfo(_MODEL)
            if info.file_size > LARGEST_MODEL:
                raise InputError(
                    f"3MF model of {info.file_size} bytes; the limit is {LARGEST_MODEL}",
                    file=str(path),
                )
            data = archive.read(info)
        if b"<!DOCTYPE" in data or b"<!ENTITY" in data:
            raise InputError("3MF with a document type: refused", file=str(path))
        return ElementTree.fromstring(data)
    except (OSError, zipfile.BadZipFile, KeyError, ElementTree.ParseError) as error:
        raise InputError(f"not a readable 3MF file ({error})", file=str(path)) from error


def _mesh(element: ElementTree.Element, scale: float, path: Path) -> TriangleMesh:
    """A 3MF mesh in millimetres."""
    try:
        vertices: Floats = scale * np.array(
            [
                [float(v.attrib[axis]) for axis in "xyz"]
                for v in element.iterfind(f"{_CORE}vertices/{_CORE}vertex")
            ]
        ).reshape(-1, 3)
        triangles = np.array(
            [
                [int(t.attrib[corner]) for corner in ("v1", "v2", "v3")]
                for t in element.iterfind(f"{_CORE}triangles/{_CORE}triangle")
            ],
            dtype=np.int64,
        ).reshape(-1, 3)
    except (KeyError, ValueError) as error:
        raise InputError(f"3MF with a bad vertex or triangle ({error})", file=str(path)) from error
    if len(triangles) and not 0 <= triangles.min() <= triangles.max() < len(vertices):
        raise InputError(
            f"3MF triangle names vertex {triangles.max()}; there are {len(vertices)}",
            file=str(path),
        )
    if not np.isfinite(vertices).all():
        raise InputError("3MF with a coordinate that is not finite", file=str(path))
    return TriangleMesh(vertices, triangles)
