"""Design: everything about a gridshell that needs no CAD, from a mesh to its schedules."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from numpy.typing import ArrayLike

from ddgfab.errors import InputError, clipped
from ddgfab.forms.registry import kinds
from ddgfab.measures import Report, inspect
from ddgfab.mesh import Mesh
from ddgfab.optimize import OptimizeResult, TorsionFreeResult, kept_groups
from ddgfab.suggest import suggestion
from ddgfab.support import SupportStructure
from fabrication.families import families
from fabrication.gridshell.axes import node_axes, notes_on_axes
from fabrication.gridshell.detailing.gridshell import Gridshell, detail
from fabrication.gridshell.given import Source, given_mesh, with_axes
from fabrication.gridshell.load import load_project, make_project, project_for_mesh
from fabrication.gridshell.net_input import NetInput, load_net, support_kind
from fabrication.gridshell.optimized import optimized_mesh
from fabrication.gridshell.plausible import unlikely
from fabrication.gridshell.project import EXAMPLE, Project
from fabrication.gridshell.schedules import schedules
from fabrication.gridshell.schedules.glass import beyond_glass
from fabrication.gridshell.traced import distance_note, traced_optimum
from fabrication.progress import Progress, silent
from fabrication.specs import Family, rejected
from fabrication.standards import lying
from fabrication.table import Table

if TYPE_CHECKING:
    from fabrication.gridshell.product import GridshellProduct

GIVEN: Final = "mesh given in Python"
"""Stands for the kind of net where a script gave the mesh itself."""


@dataclass(frozen=True, eq=False, repr=False)
class Design:
    """A gridshell as numbers: net, measures, support structure, specs, families, schedules.

    `optimized` is the result of [optimize], whose mesh is `source.mesh`; None without a goal.
    Made by `design`. Loads no CAD kernel until solids are requested.
    """

    project: Project
    source: NetInput
    measures: Report
    support: SupportStructure
    gridshell: Gridshell
    families: tuple[Family, ...]
    seconds: Mapping[str, float]
    optimized: OptimizeResult | None = None

    @property
    def mesh(self) -> Mesh:
        """The net, in millimetres."""
        return self.source.mesh

    def __repr__(self) -> str:
        return (
            f"Design({self.project.name}: {self.summary()}, "
            f"torsion max {self.support.torsion_deg_max:.1e} deg, "
            f"lean max {self.support.lean_deg_max:.1f} deg)"
        )

    def summary(self) -> str:
        """The gridshell in a sentence."""
        grid = self.gridshell
        return (
            f"{len(grid.beams)} beams, {len(grid.nodes)} nodes, {len(grid.panels)} panels of "
            f"{len(self.families)} part numbers"
        )

    @cached_property
    def schedules(self) -> dict[str, Table]:
        """The schedules by name ("bom", "panels", "beams", "nodes", ...): dictionaries as rows.

        Their status is that of the limits; solids and clearances are checked by the job.
        """
        beyond = rejected(self.gridshell.pieces)
        tables, product = schedules(self.gridshell, self.families), self.product()
        return {name: table.with_status(beyond, product.marks_of) for name, table in tables.items()}

    @property
    def beams(self) -> Table:
        """Schedule of the beams, as in beams.csv."""
        return self.schedules["beams"]

    @property
    def nodes(self) -> Table:
        """Schedule of the nodes, as in nodes.csv."""
        return self.schedules["nodes"]

    @property
    def panels(self) -> Table:
        """Schedule of the panels, as in panels.csv."""
        return self.schedules["panels"]

    def product(self) -> GridshellProduct:
        """What the job makes of it; see `fabrication.job`."""
        from fabrication.gridshell.product import GridshellProduct

        return GridshellProduct(self)

    def to_build123d(self) -> Any:
        """A labelled `build123d.Compound`: children Beams, Nodes, Panels with a solid a piece."""
        from fabrication.handover import to_build123d

        return to_build123d(self.project.name, self.families)

    def to_cadquery(self) -> Any:
        """A `cadquery.Assembly` with a named, colored, placed solid for each piece."""
        from fabrication.handover import to_cadquery

        return to_cadquery(self.project.name, self.families)

    def _repr_png_(self) -> bytes:
        from fabrication.pictures.preview import preview_png

        return preview_png(self.families)


def design(
    source: Source = None,
    *,
    axes: ArrayLike | None = None,
    progress: Progress | None = None,
    **sections: Mapping[str, Any],
) -> Design:
    """From a project, a mesh or arrays to specs and schedules; loads no CAD kernel.

    Parameters
    ----------
    source : project file (TOML), mesh file, `Mesh`, (vertices, faces), what `support_structure` or
        `optimize` gave (with its node axes), or None for the built-in example
    axes : (V, 3) node axes at the vertices of a mesh given in Python, of any length other than
        zero; by default [support] says how they are found
    progress : called as (step, done, of)
    sections : settings by section that differ from the project's or the defaults, for instance
        ``beam={"profile": "RHS 100x60x4"}``

    Raises
    ------
    DdgError
        The project, the mesh, the structure or a part is invalid; names the value and its limit.
    """
    mesh, own = given_mesh(source, axes)
    if mesh is None:
        assert source is None or isinstance(source, str | Path)
        project = find_project(source, sections)
    else:
        project = project_for_mesh(GIVEN, sections)  # of any unit, as a file is
        given = project.net.model_copy(update={"kind": GIVEN, "file": None})
        project = project.model_copy(update={"net": given})
    net = load_net(project, mesh)
    if own is not None:
        net = with_axes(net, own, project)
    return design_net(project, net, progress)


def find_project(source: str | Path | None, sections: Mapping[str, Mapping[str, Any]]) -> Project:
    """The project of a TOML or mesh file, a kind of net, or the built-in one; `sections` changed.

    Raises
    ------
    InputError
        A name that is neither a file's nor a kind's; names the nearest kind.
    """
    if source is None:
        return load_project(EXAMPLE, sections)
    if not Path(source).suffix:
        name = str(source)
        if name not in kinds():
            raise InputError(
                f'"{clipped(name)}" is neither a kind of net nor a file; '
                f"{suggestion(name, kinds())}"
            )
        return make_project({**sections, "net": {"kind": name, **sections.get("net", {})}})
    if Path(source).suffix.lower() == ".toml":
        return load_project(source, sections)
    return project_for_mesh(source, sections)


def design_net(project: Project, net: NetInput, progress: Progress | None = None) -> Design:
    """The design of a validated project on a net that `load_net` read."""
    report = progress or silent
    seconds: dict[str, float] = {}
    begin = time.perf_counter()

    def start(step: str) -> None:
        nonlocal begin
        report(step, 0, 0)
        begin = time.perf_counter()

    def stop(step: str) -> None:
        seconds[step] = time.perf_counter() - begin

    optimized = None
    if project.optimize.goal != "none":
        start("optimize")
        more: tuple[str, ...] = ()
        if net.reference is None:
            optimized = optimized_mesh(net.mesh, project.optimize, report)
        else:
            optimized, more = traced_optimum(net.mesh, net.reference, project, report)
        found = optimized.axes if isinstance(optimized, TorsionFreeResult) else None
        off = (distance_note(net.surfaces, optimized.mesh),) if net.surfaces else ()
        notes = (*net.notes, *off, *more, *optimized.remarks)
        groups = kept_groups(net.groups, net.mesh, optimized)
        net = replace(net, mesh=optimized.mesh, notes=notes, axes=found, groups=groups)
        stop("optimize")
    start("measure")
    measures = inspect(net.mesh)
    stop("measure")
    start("support structure")
    kind = support_kind(project)
    support = node_axes(net.mesh, kind, project, net.axes)
    on_axes = notes_on_axes(net.mesh, net.axes, support, project, kind)
    sideways = lying(project.beam.section())
    net = replace(net, notes=(*net.notes, *on_axes, *([sideways] if sideways else [])))
    stop("support structure")
    start("detail")
    gridshell = detail(net.mesh, support, project, net.groups)
    large = tuple(beyond_glass(gridshell.panels, project))
    net = replace(net, notes=(*net.notes, *_unlikely(project, net.mesh, gridshell), *large))
    grouped = families(gridshell.pieces, gridshell.family_tolerance)
    stop("detail")
    return Design(project, net, measures, support, gridshell, grouped, seconds, optimized)


def _unlikely(project: Project, mesh: Mesh, gridshell: Gridshell) -> tuple[str, ...]:
    """What is unlikely of the design, as notes or as an error, as the project says."""
    if project.checks.plausibility == "ignore":
        return ()
    found = unlikely(project, mesh, gridshell)
    if found and project.checks.plausibility == "fail":
        raise InputError(
            "\n".join([*found, '[checks] plausibility = "warn" goes on all the same']),
            file=None if project.file is None else str(project.file),
        )
    return found
