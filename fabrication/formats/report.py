"""What is in a STEP, STL or 3MF file: solids, closed, valid, volume, names; for `ddgfab check`."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Final

from ddgfab.errors import InputError
from fabrication.checks.crossing import crossings
from fabrication.checks.mesh import measure_mesh
from fabrication.formats.step.read import read_step
from fabrication.formats.stl import read_stl
from fabrication.formats.threemf import read_threemf
from fabrication.specs import TriangleMesh

CROSSING_TRIANGLES: Final = 20_000
"""Larger meshes are not searched for self-crossing, as the search grows with the square."""


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


def _threemf(path: Path) -> FileReport:
    """Placements are taken as rigid motions: volumes are those of the meshes as written."""
    content = read_threemf(path)
    found = [
        (body.name, placed, body.mesh)
        for body, placed in zip(content.bodies, content.placed, strict=True)
    ]
    return _report(path, "3MF", content.unit, found)
