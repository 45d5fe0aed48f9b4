"""The command line: the last room, and the only one that prints."""

from __future__ import annotations

import json
import signal
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:
    from ddgfab.mesh import Ints
    from fabrication.designs import Design, Progress
    from fabrication.pipeline import JobResult

app = typer.Typer(
    help="Discrete surfaces into things that can be built: torsion-free gridshells as checked "
    "STEP, STL and schedules.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)

DONE, FAILED, BAD_INPUT, INTERRUPTED = 0, 1, 2, 130

Debug = Annotated[bool, typer.Option("--debug", help="Show tracebacks.")]


def main() -> None:
    """Entry point of the console script `ddgfab`."""
    app()


@app.callback()
def _version(
    version: Annotated[bool, typer.Option("--version", help="Print the version.")] = False,
) -> None:
    if version:
        from fabrication.export.version import package_version

        typer.echo(f"ddgfab {package_version()}")
        raise typer.Exit


@app.command("make")
def make_command(
    source: Annotated[
        Path | None,
        typer.Argument(help="Project (TOML) or mesh (OBJ, OFF, PLY); none: the built-in example."),
    ] = None,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="Folder; default outputs/<project>.")
    ] = None,
    jobs: Annotated[int | None, typer.Option(min=0, help="Processes; 0: one a core.")] = None,
    formats: Annotated[
        str | None, typer.Option(help="Files to write, for instance step,stl,glb,csv,xlsx.")
    ] = None,
    verify: Annotated[
        str | None, typer.Option(help="Part numbers to read back: all, sample or none.")
    ] = None,
    change: Annotated[
        list[str] | None,
        typer.Option("--set", help="Change a setting: project.units=m, panel.kind=none, ..."),
    ] = None,
    debug: Debug = False,
) -> None:
    """From a mesh or project to checked CAD files and schedules."""
    with _errors(debug), _progress() as tell:
        from fabrication.designs import design_net, find_project, load_net
        from fabrication.pipeline import make
        from fabrication.pool import worker_pool

        begin = time.perf_counter()
        sections = _sections(change or [])
        given = {
            "jobs": jobs,
            "formats": None if formats is None else _words(formats),
        }
        output_section = {key: value for key, value in given.items() if value is not None}
        if output_section:
            sections["output"] = {**sections.get("output", {}), **output_section}
        if verify is not None:
            sections["checks"] = {**sections.get("checks", {}), "verify": verify}
        project = find_project(source, sections)
        with worker_pool(project.output.jobs) as pool:  # loads the kernel while this one designs
            plan = design_net(project, load_net(project), tell)
            result = make(plan, output, pool=pool, progress=tell)
        seconds = time.perf_counter() - begin
    _report(plan, result, seconds)
    raise typer.Exit(result.exit_code)


@app.command("inspect")
def inspect_command(
    mesh: Annotated[Path, typer.Argument(help="OBJ, OFF or PLY.")],
    as_json: Annotated[bool, typer.Option("--json", help="Machine-readable.")] = False,
    scale: Annotated[float, typer.Option(help="Factor on the coordinates, to mm.")] = 1.0,
    debug: Debug = False,
) -> None:
    """What kind of net a mesh is, and how far from planar, circular, conical, torsion-free."""
    with _errors(debug):
        from ddgfab.io import read_mesh
        from ddgfab.measures import inspect

        read = read_mesh(mesh, scale)
        report = inspect(read.mesh)
    if as_json:
        record = {"file": read.file, "sha256": read.sha256, "notes": list(read.notes)}
        typer.echo(json.dumps({**record, **report.to_dict()}, indent=1))
        return
    for note in read.notes:
        typer.echo(f"note: {note}")
    typer.echo(report.text())


@app.command("net")
def net_command(
    kind: Annotated[str | None, typer.Argument(help="Kind of net; see --list.")] = None,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="OBJ, OFF or PLY; default KIND.obj.")
    ] = None,
    change: Annotated[
        list[str] | None, typer.Option("--set", help="A parameter: panels_along=20, ...")
    ] = None,
    listing: Annotated[
        bool, typer.Option("--list", help="List all kinds, or the parameters of KIND.")
    ] = False,
    offset: Annotated[
        float | None,
        typer.Option(help="Write the net parallel to it at this distance [mm] instead."),
    ] = None,
    debug: Debug = False,
) -> None:
    """Write an exact net (planar, circular, conical, ...) as a mesh file."""
    with _errors(debug):
        from ddgfab.errors import InputError
        from ddgfab.io import write_mesh
        from ddgfab.nets.registry import find_generator, generate, kinds

        if listing:
            _list_nets(kinds() if kind is None else (kind,))
            return
        if kind is None:
            raise InputError(f"which kind of net? One of {', '.join(kinds())}; see --list")
        parameters = {}
        for text in change or []:
            name, equals, value = text.partition("=")
            if not equals:
                raise InputError(f"--set {text}: expected parameter=value")
            parameters[name.strip()] = _toml_value(value)
        mesh = generate(kind, parameters)
        said = find_generator(kind).summary
        if offset is not None:
            from ddgfab.offsets import exact_offset

            mesh, report = exact_offset(mesh, offset)
            said = str(report)
        target = output or Path(f"{kind}.obj")
        write_mesh(target, mesh)
    typer.echo(f"{said}\n{mesh!r}\nwritten to {target} [mm]")


def _list_nets(names: tuple[str, ...]) -> None:
    """Kinds of net with their parameters, defaults, limits and meaning."""
    from ddgfab.nets.registry import find_generator

    for name in names:
        entry = find_generator(name)
        typer.echo(f"{name}: {entry.summary}")
        for known in entry.parameters:
            limits = f" [{known.limits}]" if known.limits else ""
            typer.echo(f"  {known.name} = {known.default:g}  {known.text}{limits}")


@app.command("check")
def check_command(
    files: Annotated[list[Path], typer.Argument(help="STEP or STL files.")],
    debug: Debug = False,
) -> None:
    """Is each file closed and valid, and what is its volume?"""
    failed = False
    with _errors(debug):
        from fabrication.checks.inspection import inspect_file

        for file in files:
            report = inspect_file(file)
            typer.echo(report.text())
            failed |= not report.passed
    raise typer.Exit(FAILED if failed else DONE)


def _words(text: str) -> list[str]:
    return [word.strip().lower() for word in text.split(",") if word.strip()]


def _sections(changes: list[str]) -> dict[str, dict[str, Any]]:
    """`section.key=value` as sections; the value is TOML, or a plain word."""
    from ddgfab.errors import ProjectError

    sections: dict[str, dict[str, Any]] = {}
    for change in changes:
        name, equals, value = change.partition("=")
        section, dot, key = name.strip().partition(".")
        if not (equals and dot and key):
            raise ProjectError(f"--set {change}: expected section.key=value")
        sections.setdefault(section, {})[key] = _toml_value(value)
    return sections


def _toml_value(text: str) -> Any:
    """A TOML value, or a plain word."""
    import tomllib

    try:
        return tomllib.loads(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError:
        return text.strip()


@contextmanager
def _errors(debug: bool) -> Iterator[None]:
    """One clear message and the right exit code; a traceback only with --debug."""
    from ddgfab.errors import DdgError

    def stop(signum: int, frame: object) -> None:
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGTERM, stop)
    try:
        yield
    except DdgError as error:
        if debug:
            raise
        typer.echo(f"error: {error}", err=True)
        raise typer.Exit(BAD_INPUT) from None
    except KeyboardInterrupt:
        typer.echo("interrupted: nothing was written", err=True)
        raise typer.Exit(INTERRUPTED) from None
    except (OSError, MemoryError, ArithmeticError, RuntimeError, LookupError) as error:
        if debug:
            raise
        kind = type(error).__name__
        typer.echo(
            f"error: unexpected {kind}: {error}\nNothing was written. "
            "This is a fault of ddgfab: run again with --debug and report it.",
            err=True,
        )
        raise typer.Exit(BAD_INPUT) from None
    finally:
        signal.signal(signal.SIGTERM, before)


@contextmanager
def _progress() -> Iterator[Progress]:
    """A bar a step on a terminal; a line a step elsewhere."""
    if not sys.stderr.isatty():
        said: set[str] = set()

        def line(step: str, done: int, of: int) -> None:
            if step not in said:
                said.add(step)
                typer.echo(f"{step} ...", err=True)

        yield line
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    columns = (
        TextColumn("{task.description:24}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
    )
    with Progress(*columns, console=Console(stderr=True)) as bars:
        tasks: dict[str, Any] = {}

        def bar(step: str, done: int, of: int) -> None:
            if step not in tasks:
                for task in tasks.values():
                    bars.stop_task(task)
                tasks[step] = bars.add_task(step, total=of or None)
            bars.update(tasks[step], completed=done, total=of or None)

        yield bar


def _named(letter: str, ids: Ints) -> str:
    return ", ".join(f"{letter}-{i:04d}" for i in ids.tolist())


def _report(plan: Design, result: JobResult, seconds: float) -> None:
    """The closing words of a job."""
    manifest = result.manifest
    numbers = len({part["number"] for part in manifest["parts"]})
    checks = manifest["checks"]
    support = plan.support
    typer.echo(repr(plan))
    typer.echo(
        f"node axes ({support.kind}): torsion max {support.torsion_deg_max:.1e}, mean "
        f"{support.torsion_deg_mean:.1e} deg, worst {_named('B', support.worst_edges(3))}; "
        f"lean max {support.lean_deg_max:.1f}, mean {support.lean_deg_mean:.1f} deg, "
        f"worst {_named('N', support.worst_vertices(3))}"
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
