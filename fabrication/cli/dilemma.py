"""`ddgfab dilemma`: the least change of a surface for which drawn edges are principal."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fabrication.cli.common import (
    Change,
    Debug,
    Flip,
    Json,
    MeshOutput,
    Quads,
    Quiet,
    Reading,
    Scale,
    Units,
    Up,
    Verbose,
    Weld,
    app,
)
from fabrication.cli.terminal import FAILED, Session, session

if TYPE_CHECKING:
    from ddgfab.mesh import Floats, Mesh
    from ddgfab.redesign.dilemma import Dilemma, Movement
    from ddgfab.surfaces.spline import SplineSurface
    from ddgfab.trace.alignment import Alignment
    from fabrication.cli.settings import DilemmaSettings


Goal = Annotated[
    str | None,
    typer.Option(
        help="principal (default: planar faces, straight node axes) or planar (faces only)."
    ),
]
Keep = Annotated[
    float | None,
    typer.Option(
        help="Part of the difference of the curvatures to keep, 0 to 1; default: 0.5 where "
        "edges are more than 25 deg from principal, otherwise what the nearest surface leaves."
    ),
]
Nearest = Annotated[bool, typer.Option("--nearest", help="The nearest surface, whatever is left.")]
Plan = Annotated[bool, typer.Option("--plan", help="Move heights only (with --goal planar).")]
Surface = Annotated[
    str | None,
    typer.Option(help="That the net is drawn on: a file or a name, as for ddgfab trace."),
]
Forecast = Annotated[
    bool, typer.Option("--forecast", help="Only directions and forecast; write nothing.")
]
Picture = Annotated[bool, typer.Option(help="Write a picture beside the mesh: angles, movement.")]


@app.command("dilemma")
def dilemma_command(
    mesh: Annotated[Path, typer.Argument(help="OBJ, OFF, PLY, STL or COMPAS JSON: drawn quads.")],
    output: MeshOutput = Path("moved.obj"),
    goal: Goal = None,
    keep: Keep = None,
    nearest: Nearest = False,
    plan: Plan = False,
    surface: Surface = None,
    forecast: Forecast = False,
    units: Units = None,
    scale: Scale = 1.0,
    up: Up = "z",
    flip: Flip = False,
    quads: Quads = False,
    weld: Weld = None,
    change: Change = None,
    picture: Picture = True,
    as_json: Json = False,
    quiet: Quiet = False,
    verbose: Verbose = False,
    debug: Debug = False,
) -> None:
    """How far drawn edges are from principal, and the least change of the surface that makes them.

    Says first how far the edges are from principal and from conjugate directions, and how far the
    surface will have to move. Then writes the changed mesh where its file had it [mm], and a
    picture (OUTPUT.png): angles to the principal directions before, movement along the normal
    after. Exit code 1 where no such net is near. The options are settings of [dilemma] too:
    `--set dilemma.keep=0.3`.
    """
    with session(debug, quiet, verbose) as run:
        from ddgfab.io import check_target
        from ddgfab.redesign.dilemma import forecast_dict
        from ddgfab.trace.alignment import alignment
        from fabrication.cli.changes import put, sections_of
        from fabrication.cli.settings import dilemma_settings, reading_with

        sections = sections_of(change, only=("dilemma", "project", "net"))
        put(
            sections,
            "dilemma",
            goal=goal,
            keep=None if keep is None else float(keep),
            nearest=nearest or None,
            plan=plan or None,
            surface=surface,
        )
        settings = dilemma_settings(sections)
        if not forecast:
            check_target(output)
        read = reading_with(Reading(units, scale, up, flip, quads, weld), sections).read(mesh)
        drawn = _surface(settings.surface, read.origin)
        before = alignment(read.mesh, drawn)
        if not as_json:
            for note in read.notes:
                run.say(f"note: {note}")
        expected = _forecast(run, read.mesh, before, settings, quiet=as_json)
        if forecast:
            if as_json:
                record = {"before": before.to_dict(), "forecast": forecast_dict(expected)}
                run.result(json.dumps(record, indent=1))
            return
        found = _moved(run, read.mesh, settings, drawn, output, debug=debug)
        _write(output, found.mesh, read.origin)
        warning = _draw(output.with_suffix(".png"), found) if picture else ""
        if as_json:
            run.result(json.dumps(found.to_dict(), indent=1))
        else:
            run.say(_text(found.change_lines()))
            run.result(f"written to {output} [mm]")
        if warning:
            run.fail(warning)


def _moved(
    run: Session,
    mesh: Mesh,
    settings: DilemmaSettings,
    drawn: SplineSurface | None,
    output: Path,
    *,
    debug: bool,
) -> Dilemma:
    """The changed surface; where no such net is near, the command ends."""
    from ddgfab.errors import OptimizeError
    from ddgfab.redesign.dilemma import dilemma

    try:
        return dilemma(
            mesh,
            settings.goal,  # type: ignore[arg-type] # named where it is unknown
            keep=settings.keep,
            nearest=settings.nearest,
            surface=drawn,
            plan=settings.plan,
        )
    except OptimizeError as error:
        if debug:
            raise
        run.fail(f"FAILED {error}\n{output} was not written")
        raise typer.Exit(FAILED) from None


def _forecast(
    run: Session, mesh: Mesh, before: Alignment, settings: DilemmaSettings, *, quiet: bool
) -> Movement:
    """How far the surface will have to move; printed with the directions, unless quiet."""
    from ddgfab.redesign.dilemma import forecast_lines, kept_by_default, large, mesh_forecast

    kept = settings.keep
    if kept is None and not settings.nearest and settings.goal != "planar":
        kept = kept_by_default(before)
    expected = mesh_forecast(mesh, before, kept)
    if not quiet:
        run.say(_text([*before.lines(), *forecast_lines(expected)]))
    if warning := large(expected, mesh):
        run.fail(f"warning: {warning}")
    return expected


def _text(rows: list[tuple[str, str]]) -> str:
    return "\n".join(f"{title:<20}{text}".rstrip() for title, text in rows)


def _surface(source: str | None, origin: Floats) -> SplineSurface | None:
    if source is None:
        return None
    from fabrication.surfaces_in.find import find_surfaces

    return find_surfaces(source)[0].moved(-origin)


def _write(path: Path, mesh: Mesh, origin: Floats) -> None:
    from ddgfab.io import write_mesh

    write_mesh(path, mesh.with_vertices(mesh.vertices + origin), units="mm")


def _draw(path: Path, found: Dilemma) -> str:
    """Angles before, movement after; a warning where this machine cannot draw."""
    import numpy as np

    from ddgfab.errors import OutputError
    from fabrication.pictures.fields import FieldPlot, write_panels

    angles: Any = np.full(found.original.n_faces, np.nan)
    known = found.before.faces[found.before.determined]
    angles[known] = np.degrees(found.before.principal[found.before.determined])
    one = FieldPlot(found.original, angles, "edges from principal [deg]", (0.0, 45.0))
    two = FieldPlot(found.mesh, found.normal, "moved along the normal [mm]")
    try:
        write_panels(path, [one, two])
    except OutputError as error:
        return f"no picture: {error}"
    return ""
