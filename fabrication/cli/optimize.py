"""`ddgfab optimize`: from any mesh to a buildable one."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fabrication.cli.common import DONE, FAILED, Debug, app, errors, progress

if TYPE_CHECKING:
    from ddgfab.optimize import OptimizeResult


@app.command("optimize")
def optimize_command(
    source: Annotated[Path, typer.Argument(help="OBJ, OFF or PLY.")],
    target: Annotated[Path, typer.Argument(help="OBJ, OFF or PLY to write.")],
    goal: Annotated[
        str, typer.Option(help="planar, circular, conical, torsion-free or families.")
    ] = "planar",
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
    scale: Annotated[float, typer.Option(help="Factor on the coordinates, to mm.")] = 1.0,
    picture: Annotated[bool, typer.Option(help="Write TARGET.png, colors by movement.")] = True,
    as_json: Annotated[bool, typer.Option("--json", help="Machine-readable report.")] = False,
    debug: Debug = False,
) -> None:
    """Make the faces planar, the net circular or conical, the structure torsion-free.

    Writes the mesh, a report (TARGET.json: every measure before and after, movement, history, node
    axes where they were found) and a picture of the movement. Where the goal is missed, the best
    mesh reached is written to TARGET.missed.obj and nothing else; the exit code is 1.
    """
    from ddgfab.errors import OptimizeError

    with errors(debug), progress() as report:
        from ddgfab.io import check_target, read_mesh, write_mesh
        from ddgfab.io.atomic import atomic_path
        from ddgfab.optimize import TorsionFreeResult
        from ddgfab.optimize.report import comparison, comparison_text
        from fabrication.gridshell.design import optimize_mesh

        check_target(target)
        settings = _settings(goal, boundary, fix, features, max_movement, change or [])
        read = read_mesh(source, scale)
        try:
            result = optimize_mesh(read.mesh, settings, report)
        except OptimizeError as error:
            if debug or error.result is None:
                raise
            _write_missed(error, target)
            raise typer.Exit(FAILED) from None
        record = {"file": read.file, "sha256": read.sha256, **comparison(result)}
        if isinstance(result, TorsionFreeResult):
            record["axes"] = result.axes.tolist()
        write_mesh(target, result.mesh)
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
    goal: str,
    boundary: str,
    fix: str,
    features: float | None,
    max_movement: float | None,
    changes: list[str],
) -> Any:
    """[optimize] of the options, checked as in a project."""
    from ddgfab.errors import InputError
    from fabrication.cli.common import toml_value
    from fabrication.gridshell.load import make_project

    given: dict[str, Any] = {"goal": goal, "boundary": boundary}
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
    for change in changes:
        name, equals, value = change.partition("=")
        if not equals:
            raise InputError(f"--set {change}: expected key=value")
        given[name.strip()] = toml_value(value)
    return make_project({"optimize": given}).optimize


def _write_missed(error: Any, target: Path) -> None:
    """Print what failed, and write the best mesh reached beside the target."""
    from ddgfab.io import write_mesh

    best = target.with_name(f"{target.stem}.missed.obj")
    write_mesh(best, error.result.mesh)
    typer.echo(f"FAILED {error}", err=True)
    typer.echo(f"the best mesh reached: {best} [mm]; {target} was not written", err=True)


def _draw(target: Path, result: OptimizeResult) -> str:
    """The picture of the movement; a warning where this machine cannot draw."""
    from ddgfab.errors import OutputError
    from fabrication.pictures.deviation import write_deviation

    try:
        write_deviation(target.with_suffix(".png"), result.mesh, result.movement)
    except OutputError as error:
        return f"no picture: {error}"
    return ""
