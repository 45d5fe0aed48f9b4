"""What is in a file of solids: bodies, whether they are closed and valid, what they share."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np

from fabrication.checks.overlaps import ClosedMesh, overlaps, volume_factor
from fabrication.checks.shells import Shells, examine_shells, signed_volume
from fabrication.formats.report import FileReport
from fabrication.specs import Placement, TriangleMesh

MESH_ROUNDING: Final = 2.0**-20
"""Rounding of the coordinates in mesh files (single precision, or six digits), relative to the
largest: overlaps of less depth are none."""


@dataclass(frozen=True)
class BodyReport:
    """One product or mesh of a file.

    name : product or object name, empty when the format has none
    instances : how often the file places it
    solids, triangles : how many it has; None where the format has no such thing
    volume_mm3 : of one instance, signed: negative when it is inside out; what shells cover twice
        counts once
    problems : for people, empty when it is sound
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
class SolidsReport(FileReport):
    """What is in a file of solids.

    unit : of the lengths in the file
    volume_mm3 : of every instance
    """

    unit: str
    bodies: tuple[BodyReport, ...]
    volume_mm3: float


def mesh_report(
    path: Path,
    kind: str,
    unit: str,
    meshes: Sequence[tuple[str, int, TriangleMesh]],
    standing: Sequence[tuple[int, str, Placement]] = (),
) -> SolidsReport:
    """Report on meshes, and on the volume that they share where they are placed.

    Parameters
    ----------
    meshes : name, how often it is placed, mesh [mm]
    standing : what is placed: which mesh, its name, (4, 4) placement [mm]
    """
    bodies: list[BodyReport] = []
    solids: list[ClosedMesh | None] = []
    for name, instances, mesh in meshes:
        shells = examine_shells(mesh, _rounding(mesh))
        solid = None
        if isinstance(shells, Shells):
            found, volume = shells.problems, shells.union
            solid = None if found else ClosedMesh(shells.mesh, volume, name)
            counts = (len(shells.volumes), shells.cavities, len(shells.touching))
        else:
            volume = signed_volume(mesh)
            open_edges = f"{shells} edges without exactly one partner: not closed"
            found, counts = (open_edges if shells else "contains no triangles",), (0, 0, 0)
        solids.append(solid)
        bodies.append(
            BodyReport(name, instances, None, len(mesh.triangles), volume, tuple(found), *counts)
        )
    rounding = [_rounding(mesh) for _, _, mesh in meshes]
    shared = interference(solids, standing, rounding)
    total: float | None = None
    if standing:
        grown = np.abs(volume_factor(np.array([at for _, _, at in standing]))).tolist()
        rows = zip(standing, grown, strict=True)
        total = sum(bodies[k].volume_mm3 * factor for (k, _, _), factor in rows)
    return solids_report(path, kind, unit, bodies, shared, total)


def interference(
    solids: Sequence[ClosedMesh | None],
    standing: Sequence[tuple[int, str, Placement]],
    tolerances: Sequence[float],
    groups: Sequence[int] | None = None,
) -> list[str]:
    """For people: which placed solids share volume, most volume first.

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


def solids_report(
    path: Path,
    kind: str,
    unit: str,
    bodies: list[BodyReport],
    between: Sequence[str] = (),
    volume: float | None = None,
) -> SolidsReport:
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
        problems.append("contains no body")
    if volume is None:
        volume = sum(body.volume_mm3 * body.instances for body in bodies)
    return SolidsReport(
        str(path),
        kind,
        f"{_contents(bodies)}, {volume:.1f} mm3",
        tuple(problems),
        unit,
        tuple(bodies),
        volume,
        sound="closed and valid",
    )


def _contents(bodies: Sequence[BodyReport]) -> str:
    """How many bodies, instances, triangles, shells, cavities and touching shells."""
    placed = sum(body.instances for body in bodies)
    what = f"{len(bodies)} {'body' if len(bodies) == 1 else 'bodies'}"
    if placed != len(bodies):
        what += f", {placed} instances"
    triangles = [body.triangles for body in bodies if body.triangles is not None]
    if triangles:
        what += f", {sum(triangles)} triangles"
    shells = sum(body.shells for body in bodies)
    if shells > len(bodies):
        what += f", {shells} shells"
    for count, one, many in (
        (sum(body.cavities for body in bodies if body.shells > 1), "cavity", "cavities"),
        (sum(body.touching for body in bodies), "pair touches", "pairs touch"),
    ):
        what += f", {count} {one if count == 1 else many}" if count else ""
    return what
