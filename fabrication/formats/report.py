"""What is in a file: bodies, whether they are closed and valid, volumes; for `ddgfab check`."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np

from ddgfab.errors import InputError
from fabrication.checks.overlaps import Body as Solid
from fabrication.checks.overlaps import overlaps
from fabrication.checks.shells import Shells, examine_shells, signed_volume
from fabrication.formats.registry import find, names
from fabrication.specs import Placement, TriangleMesh

MESH_ROUNDING: Final = 2.0**-20
"""Rounding of the coordinates in mesh files (single precision, or six digits), relative to the
largest: overlaps of less depth are none."""


@dataclass(frozen=True)
class Body:
    """One product or mesh of a file.

    name : product or object name, empty when the format has none
    instances : how often the file places it
    solids, triangles : how many it has; None where the format has no such thing
    volume_mm3 : of one instance, signed: negative when it is inside out; what shells cover twice
        counts once
    problems : in words, empty when it is sound
    shells, cavities : closed surfaces of a mesh, and how many of them are cavities; 0 if open
    touching : pairs of shells that touch and share no volume
    """

    name: str
    instances: int
    solids: int | None
    triangles: int | None
    volume_mm3: float
    problems: tuple[str, ...]
    shells: int = 0
    cavities: int = 0
    touching: int = 0


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
        shells = sum(body.shells for body in self.bodies)
        if shells > len(self.bodies):
            what += f", {shells} shells"
        for count, one, many in (
            (sum(body.cavities for body in self.bodies if body.shells > 1), "cavity", "cavities"),
            (sum(body.touching for body in self.bodies), "pair touches", "pairs touch"),
        ):
            what += f", {count} {one if count == 1 else many}" if count else ""
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
    path: Path,
    kind: str,
    unit: str,
    meshes: Sequence[tuple[str, int, TriangleMesh]],
    standing: Sequence[tuple[int, str, Placement]] = (),
) -> FileReport:
    """Report on meshes, and on the volume that they share where they are placed.

    Parameters
    ----------
    meshes : name, how often it is placed, mesh [mm]
    standing : what is placed: which mesh, its name, (4, 4) placement [mm]
    """
    bodies: list[Body] = []
    solids: list[Solid | None] = []
    for name, instances, mesh in meshes:
        shells = examine_shells(mesh, _rounding(mesh))
        solid = None
        if isinstance(shells, Shells):
            found, volume = shells.problems, shells.union
            solid = None if found else Solid(shells.mesh, volume, name)
            counts = (len(shells.volumes), shells.cavities, len(shells.touching))
        else:
            volume = signed_volume(mesh)
            open_edges = f"{shells} edges without exactly one partner: not closed"
            found, counts = (open_edges if shells else "holds no triangles",), (0, 0, 0)
        solids.append(solid)
        bodies.append(
            Body(name, instances, None, len(mesh.triangles), volume, tuple(found), *counts)
        )
    rounding = [_rounding(mesh) for _, _, mesh in meshes]
    shared = interference(solids, standing, rounding)
    total: float | None = None
    if standing:
        grown = [abs(float(np.linalg.det(at[:3, :3]))) for _, _, at in standing]
        rows = zip(standing, grown, strict=True)
        total = sum(bodies[k].volume_mm3 * factor for (k, _, _), factor in rows)
    return file_report(path, kind, unit, bodies, shared, total)


def interference(
    solids: Sequence[Solid | None],
    standing: Sequence[tuple[int, str, Placement]],
    tolerances: Sequence[float],
    groups: Sequence[int] | None = None,
) -> list[str]:
    """In words: which placed solids share volume, most volume first.

    Parameters
    ----------
    solids : None stands for one that is not sound, with which nothing is compared
    standing : which solid, the name of the placed one, (4, 4) placement [mm]
    tolerances : by solid, how far [mm] its mesh may be from what it stands for
    groups : solids that stand in one group are not compared with each other
    """
    rows = [row for row, (k, _, _) in enumerate(standing) if solids[k] is not None]
    known = [k for k, solid in enumerate(solids) if solid is not None]
    place = {k: i for i, k in enumerate(known)}
    if not rows:
        return []
    found = overlaps(
        [solid for solid in solids if solid is not None],
        np.array([place[standing[row][0]] for row in rows]),
        np.array([standing[row][2] for row in rows], dtype=np.float64),
        np.array([tolerances[k] for k in known]),
        None if groups is None else np.array(groups)[rows],
    )
    names = [standing[row][1] or "body" for row in rows]
    totals, counts = Counter(names), Counter[str]()
    for at, name in enumerate(names):
        counts[name] += 1
        if totals[name] > 1:
            names[at] = f"{name} ({counts[name]} of {totals[name]})"
    return [
        f"{names[overlap.pair[0]]} and {names[overlap.pair[1]]} overlap: they share "
        f"{overlap.volume:.6g} mm3, some {overlap.depth:.2g} mm deep"
        for overlap in sorted(found, key=lambda overlap: -overlap.volume)
    ]


def _rounding(mesh: TriangleMesh) -> float:
    """How far [mm] the coordinates of a mesh may be rounded."""
    return MESH_ROUNDING * float(np.abs(mesh.vertices).max(initial=0.0))


def file_report(
    path: Path,
    kind: str,
    unit: str,
    bodies: list[Body],
    between: Sequence[str] = (),
    volume: float | None = None,
) -> FileReport:
    """Report on bodies: their problems, and those between them, are the file's.

    The volume is that of all instances, unless they are scaled and it is given.
    """
    problems = [
        f"{body.name}: {problem}" if body.name else problem
        for body in bodies
        for problem in body.problems
    ]
    problems += between
    if not bodies:
        problems.append("holds no body")
    if volume is None:
        volume = sum(body.volume_mm3 * body.instances for body in bodies)
    return FileReport(str(path), kind, unit, tuple(bodies), volume, tuple(problems))
