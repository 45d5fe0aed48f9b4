"""What is in a file: bodies, whether they are closed and valid, volumes; for `ddgfab check`."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Final

from ddgfab.errors import InputError
from fabrication.checks.crossing import crossings
from fabrication.checks.mesh import measure_mesh
from fabrication.formats.registry import find, names
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
    """Look into a file; its ending says by which format.

    Raises
    ------
    InputError
        Missing, of another format, truncated or broken; names the file and what is wrong.
    """
    path = Path(path)
    known: list[str] = []
    for format in (find(name) for name in names()):
        if format.inspects():
            known += format.suffixes
            if path.suffix.lower() in format.suffixes:
                return format.inspect(path)
    raise InputError(f"not a file that can be checked; {', '.join(known)}", file=str(path))


def mesh_report(
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
    return file_report(path, kind, unit, bodies)


def file_report(path: Path, kind: str, unit: str, bodies: list[Body]) -> FileReport:
    """Report on bodies: their problems are the file's."""
    problems = [
        f"{body.name}: {problem}" if body.name else problem
        for body in bodies
        for problem in body.problems
    ]
    if not bodies:
        problems.append("holds no body")
    volume = sum(body.volume_mm3 * body.instances for body in bodies)
    return FileReport(str(path), kind, unit, tuple(bodies), volume, tuple(problems))
