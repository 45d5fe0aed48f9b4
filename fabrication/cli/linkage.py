"""`ddgfab linkage`: from a kind of linkage or a project to a kit that can be printed and moved."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated

import typer

from fabrication.cli.common import (
    Anyway,
    Change,
    Debug,
    DryRun,
    Force,
    Formats,
    Jobs,
    Output,
    Quiet,
    Verbose,
    app,
)
from fabrication.cli.terminal import session

if TYPE_CHECKING:
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
    output: Output = None,
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
    jobs: Jobs = None,
    formats: Formats = None,
    change: Change = None,
    anyway: Anyway = False,
    force: Force = False,
    dry_run: DryRun = False,
    quiet: Quiet = False,
    verbose: Verbose = False,
    debug: Debug = False,
) -> None:
    """A Bennett linkage, a 12-bar cube or a whole K-net as a kit that prints and moves.

    Settings are those of a project file; `ddgfab init --linkage` writes one with all of them.
    """
    with session(debug, quiet, verbose) as run:
        run.progress("project", 0, 0)
        from fabrication.cli.changes import comma_list, put, sections_of
        from fabrication.cli.jobs import JobOptions, run_job
        from fabrication.linkage.kit import detail_kit, find_kit_project

        sections = sections_of(change)
        put(sections, "linkage", a_mm=a, alpha_deg=alpha, b_mm=b, beta_deg=beta)
        put(sections, "printer", preset=printer, bed_mm=None if bed is None else _size(bed))
        put(sections, "parts", pin=pin, label=None if labels else "none")
        put(sections, "motion", maximize_range=maximize_range or None)
        put(sections, "output", jobs=jobs, formats=comma_list(formats))
        project = find_kit_project(source, sections)
        code = run_job(
            run,
            project,
            lambda: detail_kit(project, run.progress),
            _about,
            JobOptions(output, anyway, dry_run, force),
        )
    raise typer.Exit(code)


def _size(text: str) -> tuple[float, float]:
    """`220x220` as two numbers [mm]."""
    from ddgfab.errors import ProjectError, clipped

    match = re.fullmatch(r"\s*(\d+(?:\.\d+)?)\s*[xX]\s*(\d+(?:\.\d+)?)\s*", text)
    if match is None:
        raise ProjectError(f"--bed {clipped(text)}: expected width x depth in mm, such as 220x220")
    return float(match[1]), float(match[2])


def _about(kit: Kit) -> Iterator[str]:
    """The mechanism, its motion, its print plates."""
    yield f"{kit.name}: {kit.summary()}"
    for name, value in kit.motion_facts():
        yield f"{name}: {value}"
    yield f"{len(kit.plates)} print plate{'' if len(kit.plates) == 1 else 's'}"
