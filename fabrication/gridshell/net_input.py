"""The net of a project: read, generated or traced, in millimetres, with where it came from."""

from __future__ import annotations

from contextlib import nullcontext
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final

import numpy as np

from ddgfab.errors import InputError
from ddgfab.forms.generators import GENERATORS
from ddgfab.forms.registry import find_generator, generate
from ddgfab.io import SHORTEST_MEDIAN_MM, Groups, ReadResult, likely_setting, unlikely_size
from ddgfab.io.regular import unchanged
from ddgfab.mesh import Floats, Mesh
from ddgfab.support import SupportKind
from ddgfab.surfaces.spline import SplineSurface
from ddgfab.trace.groups import tag_groups
from fabrication.gridshell.net_settings import MESH, SURFACE
from fabrication.gridshell.project import Project
from fabrication.gridshell.traced import traced_net
from fabrication.meshes_in import read_mesh
from fabrication.project.toml import toml_text

LONGEST_EDGE_MM: Final = 1e6
"""A median edge above this [mm] means that a mesh is in another unit, as a very short one does."""


@dataclass(frozen=True, eq=False)
class NetInput:
    """A net [mm] and where it came from: file and sha256, reader's notes.

    The file is that of the mesh, or of the combinatorics that a generated net starts from; None
    where there is none. axes : (V, 3) node axes that the file carries, or None. surfaces : what a
    traced net was traced on; reference : the same as a fine mesh, what its optimisation stays near
    to. origin : what was subtracted from the coordinates of a file that lies far from its own [mm].
    groups : named vertices and edges: of an OBJ file, or "rim", "corner" and "inner" of a net that
    was traced
    """

    mesh: Mesh
    file: str | None
    sha256: str | None
    notes: tuple[str, ...]
    axes: Floats | None = None
    surfaces: tuple[SplineSurface, ...] = ()
    reference: Mesh | None = None
    origin: tuple[float, float, float] = (0.0, 0.0, 0.0)
    groups: Groups = field(default_factory=Groups)


def support_kind(project: Project) -> SupportKind:
    """The project's kind of node axes; where it names none, what suits its kind of net."""
    generated = GENERATORS.get(project.net.kind)
    if generated is None or project.support.kind != "auto":
        return project.support.kind
    return generated.support


def load_net(project: Project, mesh: Mesh | None = None) -> NetInput:
    """The project's net in millimetres; `mesh` is used instead of the project's own.

    Raises
    ------
    InputError
        The mesh cannot be read, or its edges are so short or long that its unit must be another.
    DegenerateError
        Parameters of a generated net that fit their limits but not each other; names the cell.
    """
    named: Path | None = None
    digest: str | None = None
    if mesh is None and project.net.kind == SURFACE:
        return _traced(project)
    if mesh is None and project.net.kind != MESH:
        folder = Path() if project.file is None else project.file.parent
        for name in find_generator(project.net.kind).files(project.net.parameters):
            named = folder / project.net.parameters[name]
        with nullcontext() if named is None else unchanged(named) as digest:
            mesh = generate(project.net.kind, project.net.parameters, folder)
    path = project.mesh_path
    read = _read(project, path) if mesh is None and path is not None else None
    if read is not None:
        mesh = read.mesh
    if mesh is None:
        raise InputError(f'[net] kind = "{project.net.kind}" has no mesh of its own')
    median = float(np.median(mesh.edge_lengths))
    stated, file = (None, None) if read is None else (read.units, read.file)
    factor = project.project.factor(median, stated, file)
    if not SHORTEST_MEDIAN_MM <= median * factor <= LONGEST_EDGE_MM:
        raise InputError(
            f"{unlikely_size(median * factor)}\n"
            f"Set [project] {_size(project, median * factor, factor, stated)}median_edge_mm = 1500 "
            "(on the command line: --set project.KEY=VALUE).",
            file=file,
        )
    if named is not None:
        return NetInput(mesh.scaled(factor), str(named), digest, _notes(project))
    if read is None:
        return NetInput(mesh.scaled(factor), None, None, _notes(project))
    x, y, z = (read.origin * factor).tolist()
    return NetInput(
        mesh.scaled(factor),
        read.file,
        read.sha256,
        read.notes,
        read.axes,
        origin=(x, y, z),
        groups=read.groups,
    )


def _size(project: Project, median_mm: float, factor: float, stated: str | None) -> str:
    """The setting that probably is meant where edges are too short or too long, and "or"."""
    settings = project.project
    if settings.median_edge_mm is not None:
        return ""
    fixed = "mm" if project.net.kind in GENERATORS else stated
    key, value = likely_setting(median_mm, factor, settings.scale, fixed)
    return f"{key} = {toml_text(value)}, or "


def _traced(project: Project) -> NetInput:
    """The net traced on the project's surface."""
    path = project.mesh_path
    with nullcontext() if path is None else unchanged(path) as digest:
        found = traced_net(project)
    name = found.surfaces[0].name if len(found.surfaces) == 1 else f"{len(found.surfaces)} patches"
    notes = tuple(f"net traced on {name}: {row}" for row in found.remarks())
    file = None if path is None else str(path)
    groups = tag_groups(found.mesh, found.tag)
    return NetInput(
        found.mesh, file, digest, notes, None, found.surfaces, found.reference, groups=groups
    )


def _read(project: Project, path: Path) -> ReadResult:
    """The project's mesh file in its own unit."""
    net = project.net
    ways: dict[str, Any] = {"up": net.up, "flip": net.flip, "quads": net.quads}
    if net.weld_mm is None:
        return read_mesh(path, **ways)
    apart = read_mesh(path, merge=0, **ways)
    factor = project.project.factor(float(np.median(apart.mesh.edge_lengths)), apart.units)
    return read_mesh(path, merge=net.weld_mm / factor, **ways)


def _notes(project: Project) -> tuple[str, ...]:
    """Remarks on a generated net, for report and manifest."""
    if support_kind(project) != "normals" or project.support.kind != "auto":
        return ()
    return (
        f'[net] kind = "{project.net.kind}" follows asymptotic lines: no upright axes are free of '
        "torsion, so node axes are the surface normals and every beam twists between its ends "
        "([checks] torsion_deg is the limit)",
    )
