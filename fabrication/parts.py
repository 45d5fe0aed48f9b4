"""One part number at a time: solid, mesh, checks, files. Runs in any process."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from ddgfab.errors import DdgError
from fabrication.checks.file import check_step_part, check_stl_part
from fabrication.checks.mesh import check_mesh
from fabrication.checks.solid import check_solid
from fabrication.checks.whole import check_step_assembly
from fabrication.export.step import Header, Material, Product, Schema, write_assembly, write_part
from fabrication.export.stl import write_stl
from fabrication.export.xcaf import solid_from_bytes, solid_to_bytes
from fabrication.solids import genus_of, mesh_of, properties_of, solid_of
from fabrication.specs import Check, Placement, Properties, Role, Shape, TriangleMesh

@dataclass(frozen=True, eq=False)
class PartJob:
    """A part number to be made."""

    number: str
    role: Role
    shape: Shape


@dataclass(frozen=True)
class PartSettings:
    """What every part of a job shares. `folder` is where files go, `chord` the mesh's [mm]."""

    folder: Path
    step: bool
    stl: bool
    chord: float
    schema: Schema
    header: Header
    materials: dict[Role, Material]


@dataclass(frozen=True, eq=False)
class PartResult:
    """A part number made: properties, mesh, solid as a BinTools stream, checks, files, seconds."""

    number: str
    role: Role
    properties: Properties
    mesh: TriangleMesh
    solid: bytes | None
    checks: tuple[Check, ...]
    files: dict[str, Path]
    seconds: dict[str, float] = field(default_factory=dict)


def make_parts(jobs: Sequence[PartJob], settings: PartSettings) -> list[PartResult]:
    """Make a batch of part numbers; see `make_part`."""
    return [make_part(job, settings) for job in jobs]


def make_part(job: PartJob, settings: PartSettings) -> PartResult:
    """Solid, mesh, their checks, and the files of one part number.

    Without STEP among the formats no kernel is loaded and the exact solid is not made.

    Raises
    ------
    DdgError
        The part cannot be made at all; the message begins with its number.
    """
    clock = _Clock()
    try:
        properties = properties_of(job.shape)
        mesh = mesh_of(job.shape, settings.chord)
        genus = genus_of(job.shape)
        clock.lap("mesh")
        solid = solid_of(job.shape) if settings.step else None
        clock.lap("solid")
    except DdgError as error:
        raise type(error)(f"{job.number}: {error}") from error
    checks = check_mesh(
        mesh,
        volume=properties.volume,
        area=properties.area,
        chord=settings.chord,
        genus=genus,
    )
    if solid is not None:
        checks = check_solid(solid, properties.volume) + checks
    clock.lap("check")
    files = {}
    if solid is not None:
        files["step"] = settings.folder / "parts" / "step" / f"{job.number}.step"
        write_part(
            files["step"],
            solid,
            number=job.number,
            role=job.role,
            properties=properties,
            header=settings.header,
            material=settings.materials[job.role],
            schema=settings.schema,
        )
        clock.lap("write step")
    if settings.stl:
        files["stl"] = settings.folder / "parts" / "stl" / f"{job.number}.stl"
        write_stl(files["stl"], mesh, job.number)
        clock.lap("write stl")
    return PartResult(
        job.number,
        job.role,
        properties,
        mesh,
        None if solid is None else solid_to_bytes(solid),
        tuple(checks),
        files,
        clock.seconds,
    )


def verify_parts(
    tasks: Sequence[tuple[str, float, TriangleMesh, dict[str, Path]]],
) -> tuple[dict[str, list[Check]], float]:
    """Read files back: (number, volume, mesh, files) -> checks by number, and seconds."""
    begin = time.perf_counter()
    found: dict[str, list[Check]] = {}
    for number, volume, mesh, files in tasks:
        found[number] = []
        if "step" in files:
            found[number] += check_step_part(files["step"], number=number, volume=volume)
        if "stl" in files:
            found[number] += check_stl_part(files["stl"], mesh)
    return found, time.perf_counter() - begin


def verify_assembly(
    path: Path, expected: Mapping[str, tuple[str, float, Placement]]
) -> tuple[list[Check], float]:
    """Read assembly.step back: expected (number, volume, placement) by mark."""
    begin = time.perf_counter()
    checks = check_step_assembly(path, expected)
    return checks, time.perf_counter() - begin


def assemble(
    path: Path,
    name: str,
    parts: Sequence[PartResult],
    instances: Sequence[tuple[str, str, Placement]],
    settings: PartSettings,
) -> float:
    """Write assembly.step from made parts; returns the seconds it took."""
    begin = time.perf_counter()
    products = [
        Product(
            part.number,
            part.role,
            solid_from_bytes(part.solid),
            part.properties,
            settings.materials[part.role],
        )
        for part in parts
        if part.solid is not None
    ]
    write_assembly(
        path, products, instances, name=name, header=settings.header, schema=settings.schema
    )
    return time.perf_counter() - begin


class _Clock:
    """Seconds between laps, by name."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}
        self._last = time.perf_counter()

    def lap(self, name: str) -> None:
        now = time.perf_counter()
        self.seconds[name] = now - self._last
        self._last = now
