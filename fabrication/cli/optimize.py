"""`ddgfab optimize`: from any mesh to a buildable one."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from fabrication.cli.common import (
    Change,
    Debug,
    Flip,
    Json,
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
from fabrication.cli.missed import PLANAR, Command, stem, untraceable, write_missed
from fabrication.cli.terminal import FAILED, Session, session

if TYPE_CHECKING:
    from ddgfab.io import ReadResult
    from ddgfab.mesh import Mesh
    from ddgfab.optimize import OptimizeResult
    from ddgfab.redesign.retrace import Retraced
    from fabrication.gridshell.net_settings import OptimizeSettings

Target = Annotated[
    Path | None,
    typer.Option("-o", "--output", help="OBJ, OFF or PLY to write; default SOURCE-GOAL.obj."),
]
Goal = Annotated[
    str | None,
    typer.Option(help="planar (default), circular, conical, torsion-free or families."),
]
Flat = Annotated[
    float | None, typer.Option(help="How far faces may be from planar [%]: 0.2; 0 is exact.")
]
Keep = Annotated[
    str | None,
    typer.Option(help="close (to the surface), balanced (default), fair (smooth), a number."),
]
Surface = Annotated[Path | None, typer.Option(help="Mesh to stay near to; SOURCE by default.")]
Boundary = Annotated[
    str | None, typer.Option(help="free (default), glide along its curve, or fixed.")
]
Fix = Annotated[str | None, typer.Option(help="Vertices that stay: 0,17,230.")]
Features = Annotated[
    float | None, typer.Option(help="Edges sharper than this [deg] need not stay smooth.")
]
MaxPane = Annotated[
    str | None, typer.Option(help="Largest pane [mm]: 1500,2500; quads are divided.")
]
MaxMovement = Annotated[float | None, typer.Option(help="Greatest movement of a vertex [mm].")]
Retrace = Annotated[
    bool,
    typer.Option(
        "--retrace",
        help="Fit a surface, trace a net on it at the mesh's spacing, optimize that.",
    ),
]
Diagonals = Annotated[
    bool,
    typer.Option("--diagonals", help="Take the net of the faces' diagonals; edges become quads."),
]
EqualEdges = Annotated[
    int | None,
    typer.Option(help="Wish for this number of lengths of edges; the report names its price."),
]
EqualPanels = Annotated[
    int | None, typer.Option(help="Wish for this number of shapes of panels; likewise.")
]
Picture = Annotated[bool, typer.Option(help="Write OUTPUT.png: distance and creases.")]


@app.command("optimize")
def optimize_command(
    source: Annotated[Path, typer.Argument(help="OBJ, OFF, PLY, STL or COMPAS JSON.")],
    output: Target = None,
    goal: Goal = None,
    flat: Flat = None,
    keep: Keep = None,
    surface: Surface = None,
    boundary: Boundary = None,
    fix: Fix = None,
    features: Features = None,
    max_pane: MaxPane = None,
    max_movement: MaxMovement = None,
    anew: Retrace = False,
    diagonals: Diagonals = False,
    equal_edges: EqualEdges = None,
    equal_panels: EqualPanels = None,
    change: Change = None,
    units: Units = None,
    scale: Scale = 1.0,
    up: Up = "z",
    flip: Flip = False,
    quads: Quads = False,
    weld: Weld = None,
    picture: Picture = True,
    as_json: Json = False,
    quiet: Quiet = False,
    verbose: Verbose = False,
    debug: Debug = False,
) -> None:
    """Make the faces planar, the net circular or conical, the structure torsion-free.

    The result stays as near to the surface as it can, without folds. Writes the mesh, a report
    (OUTPUT.json: distance from the surface both ways, rise, creases, movement, what less flat faces
    would cost, every measure before and after) and a picture of distance and creases. Where the
    goal is missed, or the result is no longer the design (mean distance 0.25, greatest 1 mean edge,
    a fifth of the rise lost, crumpled, stretched, new reflex corners, folds), the best mesh is
    written to OUTPUT.missed.obj, with the next command to try, and nothing else is written; the
    exit code is 1. Settings are those of [optimize]: `--set optimize.distance_limit_edges=[0.5,
    2]`.
    """
    with session(debug, quiet, verbose) as run:
        run.progress("mesh", 0, 0)
        from ddgfab.io import check_target
        from fabrication.cli.changes import put, sections_of, value_of
        from fabrication.cli.settings import reading_with
        from fabrication.gridshell.load import make_project

        sections = sections_of(change, only=("optimize", "project", "net"))
        put(
            sections,
            "optimize",
            goal=goal,
            flat_percent=None if flat is None else float(flat),
            keep=None if keep is None else value_of(keep, "--keep"),
            boundary=boundary,
            fix=None if fix is None else _ids(fix),
            max_pane_mm=None if max_pane is None else _pane(max_pane),
            feature_angle_deg=None if features is None else float(features),
            max_movement_mm=None if max_movement is None else float(max_movement),
            diagonals=True if diagonals else None,
            equal_edges=equal_edges,
            equal_panels=equal_panels,
        )
        given = {"goal": PLANAR, **sections.get("optimize", {})}
        reading = reading_with(Reading(units, scale, up, flip, quads, weld), sections)
        own = Command(source, output, reading, given, anew=False)
        if anew:  # the net follows the surface already
            given = {"keep": "close", **given}
            _refuse_named(surface, fix, bool(given.get("diagonals")))
        settings = make_project({"optimize": given}).optimize
        target = output or Path(f"{stem(source)}-{settings.goal}.obj")
        check_target(target)
        _describe(run, settings)
        start = _start(run, own, surface, anew=anew)
        missed = Command(source, output, own.reading, given, anew=anew, surface=surface)
        result = _optimized(run, start, settings, missed, target, debug=debug)
        _write(run, target, start, result, picture=picture, as_json=as_json)


@dataclass(frozen=True, eq=False)
class _Start:
    """What is optimized: the mesh of a file, or the net traced anew on its surface."""

    read: ReadResult
    mesh: Mesh
    surface: Mesh | None
    traced: Retraced | None = None


def _start(run: Session, own: Command, surface: Path | None, *, anew: bool) -> _Start:
    """The mesh of a file with the surface that it is to stay near to, traced anew if asked for.

    own : the command on the mesh's own edges
    """
    read = own.reading.read(own.source)
    if anew:
        from ddgfab.errors import DegenerateError, InputError
        from ddgfab.redesign.retrace import retrace

        run.progress("retrace", 0, 0)
        try:
            traced = retrace(read.mesh, name=own.source.name)
        except (InputError, DegenerateError) as error:
            raise untraceable(error, read.mesh, own, run.progress) from None
        return _Start(read, traced.mesh, traced.reference, traced)
    if surface is None:
        return _Start(read, read.mesh, None)
    near = own.reading.read(surface)
    return _Start(read, read.mesh, near.mesh.with_vertices(near.in_place.vertices - read.origin))


def _optimized(
    run: Session,
    start: _Start,
    settings: OptimizeSettings,
    missed: Command,
    target: Path,
    *,
    debug: bool,
) -> OptimizeResult:
    """The result; where the goal is missed, the best mesh is written and the command ends."""
    from ddgfab.errors import OptimizeError
    from ddgfab.optimize import diagonal_net
    from fabrication.gridshell.foresight import foreseen_text
    from fabrication.gridshell.optimized import optimized_mesh

    net = diagonal_net(start.mesh) if settings.diagonals else start.mesh
    if settings.goal == PLANAR and (foreseen := foreseen_text(net)):
        run.say(foreseen)
    rim = None if start.traced is None else start.surface
    try:
        return optimized_mesh(start.mesh, settings, run.progress, surface=start.surface, rim=rim)
    except OptimizeError as error:
        if debug:
            raise
        run.stop()
        write_missed(run, error, missed, target, start.read.origin)
        raise typer.Exit(FAILED) from None


def _write(
    run: Session,
    target: Path,
    start: _Start,
    result: OptimizeResult,
    *,
    picture: bool,
    as_json: bool,
) -> None:
    """Write mesh, report and picture; print what was reached."""
    from ddgfab.io import write_mesh
    from ddgfab.io.atomic import atomic_path
    from ddgfab.optimize import TorsionFreeResult, kept_groups
    from ddgfab.optimize.report import comparison, comparison_text

    record = {"file": start.read.file, "sha256": start.read.sha256, **comparison(result)}
    if (traced := start.traced) is not None:
        record["retraced"] = traced.traced.quality.to_dict()
        notes = (*traced.notes(), traced.distance_note(start.read.mesh, result.mesh))
        if not as_json:
            run.say("\n".join(f"note: {note}" for note in notes))
    axes = result.axes if isinstance(result, TorsionFreeResult) else None
    groups = kept_groups(start.read.groups, start.mesh, result) if start.traced is None else None
    moved = result.mesh.with_vertices(result.mesh.vertices + start.read.origin)
    write_mesh(target, moved, units="mm", axes=axes, groups=groups)
    if axes is not None:
        record["axes"] = axes.tolist()
    with atomic_path(target.with_suffix(".json")) as temporary:
        temporary.write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")
    warning = _draw(target, result) if picture else ""
    if as_json:
        run.result(json.dumps(record, indent=1))
    else:
        run.say(comparison_text(result))
    if warning:
        run.fail(warning)
    if not as_json:
        run.result(f"written to {target} [mm]")


def _refuse_named(surface: Path | None, fix: str | None, diagonals: bool) -> None:
    from ddgfab.errors import InputError

    if diagonals:
        raise InputError("--retrace and --diagonals make different nets: give one of them")
    if surface is not None or fix is not None:
        raise InputError("--retrace makes another net: --fix and --surface name parts of the old")


def _ids(text: str) -> list[int]:
    """`0,17,230` as vertex ids."""
    from ddgfab.errors import InputError, clipped

    items = [item.strip() for item in text.split(",")]
    bad = [item for item in items if not (item.isdecimal() and len(item) < 19)]
    if bad:
        raise InputError(
            f"--fix {clipped(text)}: {clipped(bad[0]) or 'nothing'} is not a vertex; expected "
            "vertex ids such as 0,17,230"
        )
    return [int(item) for item in items]


def _pane(text: str) -> list[float]:
    """`1500,2500` as two lengths."""
    from ddgfab.errors import InputError, clipped

    try:
        first, second = (float(item) for item in text.split(","))
    except ValueError:
        raise InputError(
            f"--max-pane {clipped(text)}: expected two lengths in mm, such as 1500,2500"
        ) from None
    return [first, second]


def _describe(run: Session, settings: OptimizeSettings) -> None:
    """The settings that are not as they are by default, if verbose."""
    for key, value in settings.model_dump(exclude_defaults=True).items():
        run.detail(f"optimize.{key} = {value}")


def _draw(target: Path, result: OptimizeResult) -> str:
    """The picture of distance and creases; a warning where this machine cannot draw."""
    from ddgfab.errors import OutputError
    from fabrication.pictures.change import write_change

    try:
        write_change(target.with_suffix(".png"), result.change)
    except OutputError as error:
        return f"no picture: {error}"
    return ""
