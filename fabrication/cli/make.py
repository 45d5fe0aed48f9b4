"""`ddgfab make`: from a mesh or project to checked CAD files and schedules."""

from __future__ import annotations

import time
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from fabrication.cli.common import (
    Anyway,
    Debug,
    Units,
    app,
    comma_list,
    errors,
    progress,
    sections_of,
)

if TYPE_CHECKING:
    from ddgfab.mesh import Ints
    from fabrication.gridshell.design import Design
    from fabrication.job.run import JobResult


@app.command("make")
def make_command(
    source: Annotated[
        Path | None,
        typer.Argument(
            help="Project (TOML), mesh (OBJ, OFF, PLY), surface (STEP, IGES); none: an example."
        ),
    ] = None,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="Folder; default outputs/<project>.")
    ] = None,
    jobs: Annotated[int | None, typer.Option(min=0, help="Processes; 0: one a core.")] = None,
    formats: Annotated[
        str | None, typer.Option(help="Files to write, for instance step,stl,glb,csv,xlsx.")
    ] = None,
    units: Units = None,
    scale: Annotated[
        float | None, typer.Option(help="Factor on the coordinates, before the unit.")
    ] = None,
    verify: Annotated[
        str | None, typer.Option(help="Part numbers to read back: all, sample or none.")
    ] = None,
    change: Annotated[
        list[str] | None,
        typer.Option("--set", help="Change a setting: project.units=m, panel.kind=none, ..."),
    ] = None,
    anyway: Anyway = False,
    debug: Debug = False,
) -> None:
    """From a mesh or project to checked CAD files and schedules."""
    with errors(debug), progress() as report:
        from fabrication.formats.registry import needs_kernel
        from fabrication.gridshell.design import design_net, find_project, load_net
        from fabrication.job.pool import worker_pool
        from fabrication.job.run import make

        begin = time.perf_counter()
        sections = sections_of(change or [])
        given = {
            "jobs": jobs,
            "formats": None if formats is None else comma_list(formats),
        }
        output_section = {key: value for key, value in given.items() if value is not None}
        if output_section:
            sections["output"] = {**sections.get("output", {}), **output_section}
        general = {key: v for key, v in (("units", units), ("scale", scale)) if v is not None}
        if general:
            sections["project"] = {**sections.get("project", {}), **general}
        if verify is not None:
            sections["checks"] = {**sections.get("checks", {}), "verify": verify}
        project = find_project(source, sections)
        checked = project.checks.verify != "none"
        kernel = needs_kernel(project.output.formats, checked=checked)
        with worker_pool(project.output.jobs, kernel=kernel) as pool:
            plan = design_net(project, load_net(project), report)
            result = make(plan, output, pool=pool, progress=report, anyway=anyway)
        seconds = time.perf_counter() - begin
    _report(plan, result, seconds)
    raise typer.Exit(result.exit_code)


def _named(letter: str, ids: Ints) -> str:
    return ", ".join(f"{letter}-{i:04d}" for i in ids.tolist())


def _report(plan: Design, result: JobResult, seconds: float) -> None:
    """Print the summary of a job."""
    manifest = result.manifest
    numbers = len({part["number"] for part in manifest["parts"]})
    checks = manifest["checks"]
    support = plan.support
    if plan.optimized is not None:
        moved = plan.optimized
        typer.echo(
            f"{moved.goal}: vertices moved {moved.movement_max:.1f} mm at most, "
            f"{moved.movement_mean:.1f} mm on average; distance from the surface "
            f"{moved.change.distance_max:.1f} mm at most, {moved.change.distance_mean:.1f} mm on "
            "average (optimized.png)"
        )
    typer.echo(repr(plan))
    typer.echo(
        f"node axes ({support.kind}): torsion max {support.torsion_deg_max:.1e}, mean "
        f"{support.torsion_deg_mean:.1e} deg, worst {_named('B', support.worst_edges(3))}; "
        f"lean max {support.lean_deg_max:.1f}, mean {support.lean_deg_mean:.1f} deg, "
        f"worst {_named('N', support.worst_vertices(3))}"
    )
    if support.kind == "edge" and support.beam_height_spread is not None:
        typer.echo(
            "edge offset: beams of one height meet at the nodes with their lower edges too "
            f"(heights agree to {support.beam_height_spread:.1e})"
        )
    typer.echo(
        f"{len(manifest['parts'])} parts of {numbers} part numbers; "
        f"{checks['passed']} checks passed, {checks['failed']} failed; {seconds:.1f} s"
    )
    for note in manifest["notes"]:
        typer.echo(f"note: {note}")
    for problem in result.problems:
        typer.echo(f"FAILED {problem}", err=True)
    typer.echo(f"{len(manifest['files'])} files in {result.folder}")
