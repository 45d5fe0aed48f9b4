"""`ddgfab linkage`: from a kind of linkage or a project to a kit that can be printed and moved."""

from __future__ import annotations

import re
import time
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fabrication.cli.common import Anyway, Debug, app, comma_list, errors, progress, sections_of

if TYPE_CHECKING:
    from fabrication.job.run import JobResult
    from fabrication.linkage.kit import Kit


@app.command("linkage")
def linkage_command(
    source: Annotated[
        str | None,
        typer.Argument(
            help="bennett, cube, knet, crab, a project (TOML) or a K-net mesh (OBJ, OFF, PLY); "
            "none: the default Bennett kit."
        ),
    ] = None,
    output: Annotated[
        str | None, typer.Option("-o", "--output", help="Folder; default outputs/<name>.")
    ] = None,
    a: Annotated[float | None, typer.Option(help="Bennett: length a in mm.")] = None,
    alpha: Annotated[float | None, typer.Option(help="Bennett: twist alpha in deg.")] = None,
    b: Annotated[float | None, typer.Option(help="Bennett: length b in mm.")] = None,
    beta: Annotated[float | None, typer.Option(help="Bennett: twist beta in deg.")] = None,
    printer: Annotated[
        str | None, typer.Option(help="Preset: fdm-0.4, fdm-0.25, sla, sls.")
    ] = None,
    pin: Annotated[str | None, typer.Option(help="metal or printed.")] = None,
    bed: Annotated[str | None, typer.Option(help="Bed of the printer in mm, as 220x220.")] = None,
    maximize_range: Annotated[
        bool,
        typer.Option("--maximize-range", help="Try other levels, slimmer bars."),
    ] = False,
    labels: Annotated[bool, typer.Option(help="Part numbers on the links.")] = True,
    jobs: Annotated[int | None, typer.Option(min=0, help="Processes; 0: one a core.")] = None,
    formats: Annotated[
        str | None, typer.Option(help="Files to write, for instance step,stl,3mf,csv,html,gif.")
    ] = None,
    change: Annotated[
        list[str] | None,
        typer.Option(
            "--set", help="Change a setting: linkage.design_deg=60, parts.label=none, ..."
        ),
    ] = None,
    anyway: Anyway = False,
    debug: Debug = False,
) -> None:
    """A Bennett linkage, a 12-bar cube or a whole K-net as a kit that prints and moves."""
    with errors(debug), progress() as report:
        from fabrication.formats.registry import needs_kernel
        from fabrication.job.pool import worker_pool
        from fabrication.job.run import make
        from fabrication.linkage.kit import detail_kit, find_kit_project

        begin = time.perf_counter()
        sections = sections_of(change or [])
        _set(sections, "linkage", a_mm=a, alpha_deg=alpha, b_mm=b, beta_deg=beta)
        _set(sections, "printer", preset=printer, bed_mm=None if bed is None else _size(bed))
        _set(sections, "parts", pin=pin, label=None if labels else "none")
        _set(sections, "motion", maximize_range=maximize_range or None)
        _set(
            sections, "output", jobs=jobs, formats=None if formats is None else comma_list(formats)
        )
        project = find_kit_project(source, sections)
        checked = project.checks.verify != "none"
        kernel = needs_kernel(project.output.formats, checked=checked)
        with worker_pool(project.output.jobs, kernel=kernel) as pool:
            made = detail_kit(project, report)
            result = make(made, output, pool=pool, progress=report, anyway=anyway)
        seconds = time.perf_counter() - begin
    _report(made, result, seconds)
    raise typer.Exit(result.exit_code)


def _set(sections: dict[str, dict[str, Any]], section: str, **values: Any) -> None:
    """Put values that are given into a section."""
    given = {name: value for name, value in values.items() if value is not None}
    if given:
        sections.setdefault(section, {}).update(given)


def _size(text: str) -> tuple[float, float]:
    """`220x220` as two numbers [mm]."""
    from ddgfab.errors import ProjectError

    match = re.fullmatch(r"\s*(\d+(?:\.\d+)?)\s*[xX]\s*(\d+(?:\.\d+)?)\s*", text)
    if match is None:
        raise ProjectError(f"--bed {text}: expected width x depth in mm, such as 220x220")
    return float(match[1]), float(match[2])


def _report(kit: Kit, result: JobResult, seconds: float) -> None:
    """Print the summary of a job."""
    manifest = result.manifest
    typer.echo(f"{kit.name}: {kit.summary()}")
    for name, value in kit.motion_facts():
        typer.echo(f"{name}: {value}")
    numbers = len(kit.families)
    checks = manifest["checks"]
    plates = f"{len(kit.plates)} plate{'s' if len(kit.plates) != 1 else ''}"
    typer.echo(
        f"{len(manifest['parts'])} parts of {numbers} part numbers on {plates}; "
        f"{checks['passed']} checks passed, {checks['failed']} failed; {seconds:.1f} s"
    )
    for note in manifest["notes"]:
        typer.echo(f"note: {note}")
    for problem in result.problems:
        typer.echo(f"FAILED {problem}", err=True)
    typer.echo(f"{len(manifest['files'])} files in {result.folder}")
