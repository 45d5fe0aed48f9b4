"""One part number at a time: solid, mesh, checks, files. Runs in any process."""

from __future__ import annotations

import math
import time
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final, TypeAlias

from ddgfab.errors import DdgError, OutputError
from fabrication.checks.crossing import crossings
from fabrication.checks.mesh import check_mesh
from fabrication.checks.solid import check_solid
from fabrication.formats.glb import write_glb
from fabrication.formats.step import (
    Header,
    Material,
    Product,
    Schema,
    assembly_bytes,
    part_bytes,
)
from fabrication.formats.step.read import check_step_part
from fabrication.formats.step.whole import check_step_assembly
from fabrication.formats.stl import check_stl_part, stl_bytes
from fabrication.formats.threemf import Body3MF, check_threemf, threemf_bytes
from fabrication.pictures.preview import write_preview
from fabrication.solids import boundary_of, realise, second_volume_of, solid_of
from fabrication.specs import Check, Family, Kind, Placement, Properties, Role, Shape, TriangleMesh

VOLUME_RELATIVE: Final = 1e-9
"""How far the closed forms of a volume may differ: from the boundary, and from the numbers."""

VerifyTask: TypeAlias = tuple[str, float, TriangleMesh, dict[str, Path]]
"""Number, volume [mm3], mesh and files of a part to be read back."""


@dataclass(frozen=True, eq=False)
class PartJob:
    """A part number to be made."""

    number: str
    kind: Kind
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
    threemf: bool = False


@dataclass(frozen=True, eq=False)
class PartResult:
    """A part number made: properties, mesh, checks, its files by format, seconds by step."""

    job: PartJob
    properties: Properties
    mesh: TriangleMesh
    checks: tuple[Check, ...]
    files: dict[str, Path]
    seconds: dict[str, float]

    @property
    def number(self) -> str:
        """The part number."""
        return self.job.number


def make_parts(jobs: Sequence[PartJob], settings: PartSettings) -> list[PartResult]:
    """Make a batch of part numbers; see `make_part`."""
    return [make_part(job, settings) for job in jobs]


def make_part(job: PartJob, settings: PartSettings) -> PartResult:
    """Solid, mesh, their checks, and the files of one part number.

    Without STEP among the formats the exact solid is not made, and no kernel is loaded where the
    boundary is exact.

    Raises
    ------
    DdgError
        The part cannot be made at all; the message begins with its number.
    """
    clock = _Clock()
    try:
        made = realise(job.shape, settings.chord, solid=settings.step)
    except DdgError as error:
        raise type(error)(f"{job.number}: {error}") from error
    clock.lap("build")
    volume, again = made.properties.volume, second_volume_of(job.shape)
    deviation = abs(again - volume) / volume if volume > 0 else math.inf
    checks = [Check("volume two ways", deviation <= VOLUME_RELATIVE, deviation, VOLUME_RELATIVE)]
    if settings.step:
        checks += check_solid(made.solid, volume)
    checks += check_mesh(
        made.mesh,
        volume=volume,
        area=made.properties.area,
        chord=settings.chord,
        genus=made.genus,
        self_crossing=False,  # read back, with the file
    )
    clock.lap("check")
    files = {}
    if settings.step:
        path = files["step"] = settings.folder / "parts" / "step" / f"{job.number}.step"
        product = Product(
            job.number,
            job.kind,
            made.solid,
            made.properties,
            settings.materials[job.kind.role],
            made.boundary,
        )
        path.write_bytes(
            part_bytes(product, path.name, header=settings.header, schema=settings.schema)
        )
    if settings.stl:
        path = files["stl"] = settings.folder / "parts" / "stl" / f"{job.number}.stl"
        path.write_bytes(stl_bytes(made.mesh, job.number))
    if settings.threemf:
        path = files["3mf"] = settings.folder / "parts" / "3mf" / f"{job.number}.3mf"
        body = Body3MF(job.number, made.mesh, job.kind.color)
        path.write_bytes(threemf_bytes([body], title=job.number))
    clock.lap("write")
    return PartResult(job, made.properties, made.mesh, tuple(checks), files, clock.seconds)


def verify_parts(tasks: Sequence[VerifyTask]) -> tuple[dict[str, list[Check]], float]:
    """Read files back and look closer at the meshes: checks by number, and the seconds it took."""
    begin = time.perf_counter()
    found: dict[str, list[Check]] = {}
    for number, volume, mesh, files in tasks:
        crossing = float(len(crossings(mesh)))
        found[number] = [Check("mesh crossings", crossing == 0, crossing, 0.0)]
        if "step" in files:
            found[number] += check_step_part(files["step"], number=number, volume=volume)
        if "stl" in files:
            found[number] += check_stl_part(files["stl"], mesh)
        if "3mf" in files:
            found[number] += check_threemf(files["3mf"], [(number, mesh, 1)])
    return found, time.perf_counter() - begin


def assemble(
    path: Path,
    name: str,
    parts: Sequence[tuple[PartJob, Properties]],
    instances: Sequence[tuple[str, str, Placement]],
    settings: PartSettings,
    verify: bool,
) -> tuple[list[Check], dict[str, float]]:
    """Write assembly.step and, if asked, read it back: checks of the whole, and seconds."""
    clock = _Clock()
    products = []
    for job, properties in parts:
        boundary = boundary_of(job.shape)
        solid = solid_of(job.shape) if boundary is None else None
        material = settings.materials[job.kind.role]
        products.append(Product(job.number, job.kind, solid, properties, material, boundary))
    data = assembly_bytes(
        products,
        instances,
        name=name,
        file_name=path.name,
        header=settings.header,
        schema=settings.schema,
    )
    path.write_bytes(data)
    clock.lap("assembly.step")
    checks: list[Check] = []
    if verify:
        volume = {job.number: properties.volume for job, properties in parts}
        expected = {mark: (number, volume[number], at) for number, mark, at in instances}
        checks = check_step_assembly(path, expected)
        clock.lap("read back assembly.step")
    return checks, clock.seconds


def draw(
    folder: Path,
    families: Sequence[Family],
    meshes: Mapping[str, TriangleMesh],
    failed: Collection[str],
    glb: bool,
) -> tuple[list[str], float]:
    """Write preview.png and, if asked, model.glb: warnings, and seconds.

    A machine without graphics is no fault of the structure: no preview then, and a warning.
    """
    begin = time.perf_counter()
    warnings = []
    if glb:
        write_glb(folder / "model.glb", families, meshes, failed)
    try:
        write_preview(folder / "preview.png", families, meshes, failed)
    except OutputError as error:
        warnings.append(f"no preview.png: {error}")
    return warnings, time.perf_counter() - begin


class _Clock:
    """Seconds between laps, by name."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}
        self._last = time.perf_counter()

    def lap(self, name: str) -> None:
        now = time.perf_counter()
        self.seconds[name] = now - self._last
        self._last = now
