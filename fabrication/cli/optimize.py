"""`ddgfab optimize`: from any mesh to a buildable one."""

from __future__ import annotations

import json
import math
import shlex
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Final

import typer

from fabrication.cli.common import (
    Change,
    Debug,
    Flip,
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
from fabrication.cli.terminal import DONE, FAILED, Session, session

if TYPE_CHECKING:
    from ddgfab.errors import OptimizeError
    from ddgfab.mesh import Floats, Mesh
    from ddgfab.optimize import OptimizeResult
    from ddgfab.redesign.retrace import Retraced
    from fabrication.gridshell.net_settings import OptimizeSettings

PLANAR: Final = "planar"
"""The goal by default."""


@app.command("optimize")
def optimize_command(
    source: Annotated[Path, typer.Argument(help="OBJ, OFF, PLY, STL or COMPAS JSON.")],
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", help="OBJ, OFF or PLY to write; default SOURCE-GOAL.obj."),
    ] = None,
    goal: Annotated[
        str | None,
        typer.Option(help="planar (default), circular, conical, torsion-free or families."),
    ] = None,
    flat: Annotated[
        float | None,
        typer.Option(help="How far faces may be from planar [%]: 0.2; 0 is exact."),
    ] = None,
    keep: Annotated[
        str | None,
        typer.Option(help="close (to the surface), balanced (default), fair (smooth), a number."),
    ] = None,
    surface: Annotated[
        Path | None, typer.Option(help="Mesh to stay near to; SOURCE by default.")
    ] = None,
    boundary: Annotated[
        str | None, typer.Option(help="free (default), glide along its curve, or fixed.")
    ] = None,
    fix: Annotated[str | None, typer.Option(help="Vertices that stay: 0,17,230.")] = None,
    features: Annotated[
        float | None, typer.Option(help="Edges sharper than this [deg] need not stay smooth.")
    ] = None,
    max_pane: Annotated[
        str | None, typer.Option(help="Largest pane [mm]: 1500,2500; quads are divided.")
    ] = None,
    max_movement: Annotated[
        float | None, typer.Option(help="Greatest movement of a vertex [mm].")
    ] = None,
    anew: Annotated[
        bool,
        typer.Option(
            "--retrace",
            help="Fit a surface, trace a net on it at the mesh's spacing, optimize that.",
        ),
    ] = False,
    change: Change = None,
    units: Units = None,
    scale: Scale = 1.0,
    up: Up = "z",
    flip: Flip = False,
    quads: Quads = False,
    weld: Weld = None,
    picture: Annotated[bool, typer.Option(help="Write OUTPUT.png: distance and creases.")] = True,
    as_json: Annotated[bool, typer.Option("--json", help="Machine-readable report.")] = False,
    quiet: Quiet = False,
    verbose: Verbose = False,
    debug: Debug = False,
) -> None:
    """Make the faces planar, the net circular or conical, the structure torsion-free.

    The result stays as near to the surface as it can, without folds. Writes the mesh, a report
    (OUTPUT.json: distance from the surface both ways, rise, creases, movement, what less flat faces
    would cost, every measure before and after) and a picture of distance and creases. Where the
    goal is missed, or the result is no longer the design (mean distance 0.25, greatest 1 mean edge,
    new reflex corners, folds), the best mesh is written to OUTPUT.missed.obj, with the next
    command to try, and nothing else is written; the exit code is 1. Settings are those of
    [optimize]: `--set optimize.distance_limit_edges=[0.5, 2]`.
    """
    from ddgfab.errors import OptimizeError

    with session(debug, quiet, verbose) as run:
        run.progress("mesh", 0, 0)
        from ddgfab.io import check_target
        from ddgfab.io.atomic import atomic_path
        from ddgfab.optimize import TorsionFreeResult
        from ddgfab.optimize.report import comparison, comparison_text
        from fabrication.cli.changes import put, sections_of, value_of
        from fabrication.cli.settings import reading_with
        from fabrication.gridshell.foresight import foreseen_text
        from fabrication.gridshell.load import make_project
        from fabrication.gridshell.optimized import optimized_mesh

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
        )
        given = {"goal": PLANAR, **sections.get("optimize", {})}
        if anew:  # the net follows the surface already
            given = {"keep": "close", **given}
        settings = make_project({"optimize": given}).optimize
        target = output or Path(f"{_stem(source)}-{settings.goal}.obj")
        check_target(target)
        reading = reading_with(Reading(units, scale, up, flip, quads, weld), sections)
        read = reading.read(source)
        reference = None
        if surface is not None:
            near = reading.read(surface)
            reference = near.mesh.with_vertices(near.in_place.vertices - read.origin)
        _describe(run, settings)
        start, traced, rim = read.mesh, None, None
        if anew:
            run.progress("retrace", 0, 0)
            traced = _retraced(read.mesh, source, surface is not None or fix is not None)
            start, reference, rim = traced.mesh, traced.reference, traced.reference
        if settings.goal == PLANAR and (foreseen := foreseen_text(start)):
            run.say(foreseen)
        try:
            result = optimized_mesh(start, settings, run.progress, surface=reference, rim=rim)
        except OptimizeError as error:
            if debug:
                raise
            run.stop()
            missed = _Command(source, output, reading, given, anew=anew)
            _write_missed(run, error, missed, target, read.origin)
            raise typer.Exit(FAILED) from None
        record = {"file": read.file, "sha256": read.sha256, **comparison(result)}
        if traced is not None:
            record["retraced"] = traced.traced.quality.to_dict()
            for note in (*traced.notes(), traced.distance_note(read.mesh, result.mesh)):
                if not as_json:
                    run.say(f"note: {note}")
        axes = result.axes if isinstance(result, TorsionFreeResult) else None
        _write(target, result.mesh, read.origin, axes)
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
    raise typer.Exit(DONE)


def _retraced(mesh: Mesh, source: Path, named: bool) -> Retraced:
    """A net traced on the surface of a mesh."""
    from ddgfab.errors import InputError
    from ddgfab.redesign.retrace import retrace

    if named:
        raise InputError("--retrace makes another net: --fix and --surface name parts of the old")
    return retrace(mesh, name=source.name)


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


def _stem(source: Path) -> str:
    """The name of a mesh file without its endings."""
    return Path(source.name.removesuffix(".gz")).stem or "mesh"


def _describe(run: Session, settings: OptimizeSettings) -> None:
    """The settings that are not as they are by default, if verbose."""
    for key, value in settings.model_dump(exclude_defaults=True).items():
        run.detail(f"optimize.{key} = {value}")


def _write(path: Path, mesh: Mesh, origin: Floats, axes: Floats | None = None) -> None:
    """Write a mesh [mm] where its file had it, with the node axes that were found with it."""
    from ddgfab.io import write_mesh

    write_mesh(path, mesh.with_vertices(mesh.vertices + origin), units="mm", axes=axes)


def _write_missed(
    run: Session, error: OptimizeError, command: _Command, target: Path, origin: Floats
) -> None:
    """Print what failed and what to try, and write the best mesh reached beside the target."""
    from ddgfab.optimize import OptimizeResult
    from ddgfab.optimize.directions import TRACE

    run.fail(f"FAILED {error}")
    if not isinstance(error.result, OptimizeResult):  # refused before solving
        run.fail(f"{target} was not written")
        return
    best = target.with_name(f"{target.stem}.missed.obj")
    _write(best, error.result.mesh, origin)
    run.fail(f"the best mesh reached: {best} [mm]; {target} was not written")
    if error.result.advice:
        name, value = error.result.advice[0]
        if name == TRACE:
            run.fail(f"next: {command.traced(value)}")
            return
        changed = dict(_setting(name, value) for name, value in error.result.advice)
        run.fail(f"next: {command.text(changed)}")


_KEYS: Final = {
    "flat": "flat_percent",
    "distance_limit": "distance_limit_edges",
    "max_pane": "max_pane_mm",
    "max_movement": "max_movement_mm",
}
"""Keys of [optimize] for options of `ddgfab.optimize.optimize` with other names."""


def _setting(name: str, value: object) -> tuple[str, object]:
    """Key and value in [optimize] for an option of `ddgfab.optimize.optimize`."""
    if name == "max_lean" and isinstance(value, float):
        return "max_lean_deg", float(f"{math.degrees(value):.4g}")
    return _KEYS.get(name, name), value


_OPTIONS: Final = {
    "goal": "--goal",
    "boundary": "--boundary",
    "flat_percent": "--flat",
    "keep": "--keep",
    "max_movement_mm": "--max-movement",
    "feature_angle_deg": "--features",
}
"""Options of the command for keys of [optimize]; the others are given by --set."""


class _Command:
    """The command as given, to be printed again with other settings."""

    def __init__(
        self,
        source: Path,
        output: Path | None,
        reading: Reading,
        settings: dict[str, Any],
        *,
        anew: bool,
    ) -> None:
        self.begin = ["ddgfab", "optimize", str(source)]
        if output is not None:
            self.begin += ["-o", str(output)]
        self.source = source
        self.placed = Reading(reading.units, reading.scale).arguments()
        self.begin += reading.arguments()
        self.anew = anew
        self.settings = settings

    def traced(self, spacing: object) -> str:
        """The command that traces another net: of the same spacing, then one to be looked at."""
        if not self.anew and "fix" not in self.settings:
            settings = {key: value for key, value in self.settings.items() if key != "keep"}
            again = _Command(self.source, None, Reading(), settings, anew=True)
            again.begin = self.begin
            return again.text({})
        net = f"{_stem(self.source)}-net.obj"
        words = ["ddgfab", "trace", str(self.source), "-o", net, "--spacing", f"{spacing:g}"]
        return shlex.join(words + self.placed)

    def text(self, changed: dict[str, Any]) -> str:
        """It with these settings changed."""
        from fabrication.project.toml import argument_text

        arguments = [*self.begin, *(["--retrace"] if self.anew else [])]
        for key, value in {**self.settings, **changed}.items():
            if key == "goal" and value == PLANAR:
                continue
            if key in _OPTIONS:
                arguments += [_OPTIONS[key], argument_text(value)]
            elif key == "fix" and not isinstance(value, str):
                arguments += ["--fix", ",".join(map(str, value))]
            else:
                arguments += ["--set", f"optimize.{key}={argument_text(value)}"]
        return shlex.join(arguments)


def _draw(target: Path, result: OptimizeResult) -> str:
    """The picture of distance and creases; a warning where this machine cannot draw."""
    from ddgfab.errors import OutputError
    from fabrication.pictures.change import write_change

    try:
        write_change(target.with_suffix(".png"), result.change)
    except OutputError as error:
        return f"no picture: {error}"
    return ""
