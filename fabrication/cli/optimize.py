"""`ddgfab optimize`: from any mesh to a buildable one."""

from __future__ import annotations

import json
import shlex
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Final

import typer

from fabrication.cli.common import (
    DONE,
    FAILED,
    Debug,
    Flip,
    Quads,
    Reading,
    Scale,
    Units,
    Up,
    Weld,
    app,
    errors,
    progress,
    toml_value,
    values_of,
)

if TYPE_CHECKING:
    from ddgfab.errors import OptimizeError
    from ddgfab.mesh import Floats, Mesh
    from ddgfab.optimize import OptimizeResult


@app.command("optimize")
def optimize_command(
    source: Annotated[Path, typer.Argument(help="OBJ, OFF, PLY, STL or COMPAS JSON.")],
    target: Annotated[Path, typer.Argument(help="OBJ, OFF or PLY to write.")],
    goal: Annotated[
        str, typer.Option(help="planar, circular, conical, torsion-free or families.")
    ] = "planar",
    flat: Annotated[
        float | None,
        typer.Option(help="How far faces may be from planar [%]: 0.2; 0 is exact."),
    ] = None,
    keep: Annotated[
        str, typer.Option(help="close (to the surface), balanced, fair (smooth), or a number.")
    ] = "balanced",
    surface: Annotated[
        Path | None, typer.Option(help="Mesh to stay near to; SOURCE by default.")
    ] = None,
    boundary: Annotated[str, typer.Option(help="free, glide or fixed.")] = "free",
    fix: Annotated[str, typer.Option(help="Vertices that stay: 0,17,230.")] = "",
    features: Annotated[
        float | None, typer.Option(help="Edges sharper than this [deg] need not stay smooth.")
    ] = None,
    max_movement: Annotated[
        float | None, typer.Option(help="Greatest movement of a vertex [mm].")
    ] = None,
    change: Annotated[
        list[str] | None, typer.Option("--set", help="A setting of [optimize]: key=value.")
    ] = None,
    units: Units = None,
    scale: Scale = 1.0,
    up: Up = "z",
    flip: Flip = False,
    quads: Quads = False,
    weld: Weld = None,
    picture: Annotated[bool, typer.Option(help="Write TARGET.png: distance and creases.")] = True,
    as_json: Annotated[bool, typer.Option("--json", help="Machine-readable report.")] = False,
    debug: Debug = False,
) -> None:
    """Make the faces planar, the net circular or conical, the structure torsion-free.

    The result stays as near to the surface as it can, without folds. Writes the mesh, a report
    (TARGET.json: distance from the surface both ways, rise, creases, movement, what less flat faces
    would cost, every measure before and after) and a picture of distance and creases. Where the
    goal is missed, or the result is no longer the design (mean distance 0.25, greatest 1 mean edge,
    new reflex corners, folds), the best mesh is written to TARGET.missed.obj, with the next
    command to try, and nothing else is written; the exit code is 1.
    """
    from ddgfab.errors import OptimizeError

    with errors(debug), progress() as report:
        from ddgfab.io import check_target
        from ddgfab.io.atomic import atomic_path
        from ddgfab.optimize import TorsionFreeResult
        from ddgfab.optimize.report import comparison, comparison_text
        from fabrication.gridshell.optimized import optimized_mesh

        check_target(target)
        given: dict[str, Any] = {"goal": goal, "boundary": boundary}
        if flat is not None:
            given["flat_percent"] = float(flat)
        if keep != "balanced":
            given["keep"] = toml_value(keep)
        settings = _settings(given, fix, features, max_movement, change or [])
        reading = Reading(units, scale, up, flip, quads, weld)
        read = reading.read(source)
        reference = None
        if surface is not None:
            near = reading.read(surface)
            reference = near.mesh.with_vertices(near.in_place.vertices - read.origin)
        try:
            result = optimized_mesh(read.mesh, settings, report, surface=reference)
        except OptimizeError as error:
            if debug:
                raise
            _write_missed(error, source, target, reading, read.origin, given)
            raise typer.Exit(FAILED) from None
        record = {"file": read.file, "sha256": read.sha256, **comparison(result)}
        if isinstance(result, TorsionFreeResult):
            record["axes"] = result.axes.tolist()
        _write(target, result.mesh, read.origin)
        with atomic_path(target.with_suffix(".json")) as temporary:
            temporary.write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")
        warning = _draw(target, result) if picture else ""
    typer.echo(json.dumps(record, indent=1) if as_json else comparison_text(result))
    if warning:
        typer.echo(warning, err=True)
    if not as_json:
        typer.echo(f"written to {target} [mm]")
    raise typer.Exit(DONE)


def _settings(
    given: dict[str, Any],
    fix: str,
    features: float | None,
    max_movement: float | None,
    changes: list[str],
) -> Any:
    """[optimize] of the options, checked as in a project."""
    from ddgfab.errors import InputError
    from fabrication.gridshell.load import make_project

    if fix:
        ids = [item.strip() for item in fix.split(",")]
        bad = [item for item in ids if not item.isdecimal()]
        if bad:
            raise InputError(f"--fix {fix}: {bad[0]!r} is no vertex; vertex ids: 0,17,230")
        given["fix"] = [int(item) for item in ids]
    if features is not None:
        given["feature_angle_deg"] = float(features)
    if max_movement is not None:
        given["max_movement_mm"] = float(max_movement)
    given |= values_of(changes, "key")
    return make_project({"optimize": given}).optimize


def _write(path: Path, mesh: Mesh, origin: Floats) -> None:
    """Write a mesh [mm] where its file had it."""
    from ddgfab.io import write_mesh

    write_mesh(path, mesh.with_vertices(mesh.vertices + origin), units="mm")


def _write_missed(
    error: OptimizeError,
    source: Path,
    target: Path,
    reading: Reading,
    origin: Floats,
    given: dict[str, Any],
) -> None:
    """Print what failed and what to try, and write the best mesh reached beside the target."""
    from ddgfab.optimize import OptimizeResult

    typer.echo(f"FAILED {error}", err=True)
    if not isinstance(error.result, OptimizeResult):  # refused before solving
        typer.echo(f"{target} was not written", err=True)
        return
    best = target.with_name(f"{target.stem}.missed.obj")
    _write(best, error.result.mesh, origin)
    typer.echo(f"the best mesh reached: {best} [mm]; {target} was not written", err=True)
    if error.result.advice:
        changed = given | {_KEYS.get(name, name): value for name, value in error.result.advice}
        typer.echo(f"next: {_command(source, target, reading, changed)}", err=True)


_KEYS: Final = {"flat": "flat_percent", "distance_limit": "distance_limit_edges"}
"""Keys of [optimize] for options of `ddgfab.optimize.optimize` with other names."""

_OPTIONS: Final = {
    "goal": "--goal",
    "boundary": "--boundary",
    "flat_percent": "--flat",
    "keep": "--keep",
    "max_movement_mm": "--max-movement",
    "feature_angle_deg": "--features",
}
"""Options of the command for keys of [optimize]; the others are given by --set."""


def _command(source: Path, target: Path, reading: Reading, settings: dict[str, Any]) -> str:
    """The command that optimizes with these settings."""
    arguments = ["ddgfab", "optimize", str(source), str(target), *reading.arguments()]
    for key, value in settings.items():
        if key in ("goal", "boundary") and value == _DEFAULTS[key]:
            continue
        if key in _OPTIONS:
            text = f"{value:g}" if isinstance(value, float) else str(value)
            arguments += [_OPTIONS[key], text]
        elif key == "fix":
            arguments += ["--fix", ",".join(map(str, value))]
        else:
            shown = list(value) if isinstance(value, tuple) else value
            arguments += ["--set", f"{key}={shown}"]
    return shlex.join(arguments)


_DEFAULTS: Final = {"goal": "planar", "boundary": "free"}


def _draw(target: Path, result: OptimizeResult) -> str:
    """The picture of distance and creases; a warning where this machine cannot draw."""
    from ddgfab.errors import OutputError
    from fabrication.pictures.change import write_change

    try:
        write_change(target.with_suffix(".png"), result.change)
    except OutputError as error:
        return f"no picture: {error}"
    return ""
