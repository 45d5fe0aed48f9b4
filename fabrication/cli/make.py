"""`ddgfab make`: from a mesh or project to checked CAD files and schedules."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from fabrication.cli.common import (
    Anyway,
    Change,
    Debug,
    DryRun,
    Flip,
    Force,
    Formats,
    Jobs,
    Output,
    Quads,
    Quiet,
    Units,
    Verbose,
    Weld,
    app,
)
from fabrication.cli.terminal import session

if TYPE_CHECKING:
    from ddgfab.mesh import Ints
    from fabrication.gridshell.design import Design


@app.command("make")
def make_command(
    source: Annotated[
        Path | None,
        typer.Argument(
            help="Project (TOML), mesh (OBJ, OFF, PLY), surface (STEP, IGES) or kind of net; none: "
            "an example."
        ),
    ] = None,
    output: Output = None,
    jobs: Jobs = None,
    formats: Formats = None,
    units: Units = None,
    scale: Annotated[
        float | None, typer.Option(help="Factor on the coordinates, before the unit.")
    ] = None,
    up: Annotated[
        str | None, typer.Option(help="Axis of the file that is up: z, y, x, -z, -y or -x.")
    ] = None,
    flip: Flip = False,
    quads: Quads = False,
    weld: Weld = None,
    verify: Annotated[
        str | None, typer.Option(help="Part numbers to read back: all, sample or none.")
    ] = None,
    change: Change = None,
    anyway: Anyway = False,
    force: Force = False,
    dry_run: DryRun = False,
    quiet: Quiet = False,
    verbose: Verbose = False,
    debug: Debug = False,
) -> None:
    """From a mesh or project to checked CAD files and schedules.

    Settings are those of a project file; `ddgfab init` writes one with all of them.
    """
    with session(debug, quiet, verbose) as run:
        run.progress("project", 0, 0)
        from fabrication.cli.changes import comma_list, put, sections_of
        from fabrication.cli.jobs import JobOptions, run_job
        from fabrication.gridshell.design import design_net, find_project
        from fabrication.gridshell.net_input import load_net

        sections = sections_of(change)
        put(sections, "output", jobs=jobs, formats=comma_list(formats))
        put(sections, "project", units=units, scale=scale)
        put(sections, "net", up=up, flip=flip or None, quads=quads or None, weld_mm=weld)
        put(sections, "checks", verify=verify)
        project = find_project(source, sections)

        def design() -> Design:
            run.progress("net", 0, 0)
            return design_net(project, load_net(project), run.progress)

        code = run_job(
            run,
            project,
            design,
            _about,
            JobOptions(output, anyway, dry_run, force),
        )
    raise typer.Exit(code)


def _about(plan: Design) -> Iterator[str]:
    """What [optimize] did or would cost, the sizes, the node axes."""
    from fabrication.gridshell.foresight import foreseen_text

    support = plan.support
    if plan.optimized is not None:
        moved = plan.optimized
        yield (
            f"{moved.goal}: vertices moved {moved.movement_max:.1f} mm at most, "
            f"{moved.movement_mean:.1f} mm on average; distance from the surface "
            f"{moved.change.distance_max:.1f} mm at most, {moved.change.distance_mean:.1f} mm on "
            "average (optimized.png)"
        )
    elif foreseen := foreseen_text(plan.mesh):
        yield foreseen
    yield repr(plan)
    yield (
        f"node axes ({support.kind}): torsion max {support.torsion_deg_max:.1e}, mean "
        f"{support.torsion_deg_mean:.1e} deg, worst {_named('B', support.worst_edges(3))}; "
        f"lean max {support.lean_deg_max:.1f}, mean {support.lean_deg_mean:.1f} deg, "
        f"worst {_named('N', support.worst_vertices(3))}"
    )
    if support.kind == "edge" and support.beam_height_spread is not None:
        yield (
            "edge offset: beams of one height meet at the nodes with their lower edges too "
            f"(heights agree to {support.beam_height_spread:.1e})"
        )


def _named(letter: str, ids: Ints) -> str:
    return ", ".join(f"{letter}-{i:04d}" for i in ids.tolist())
