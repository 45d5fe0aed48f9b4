"""What the commands share: the program, errors and exit codes, progress, settings as text."""

from __future__ import annotations

import os
import shlex
import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:
    from ddgfab.io import ReadResult
    from fabrication.progress import Progress

app = typer.Typer(
    help="Discrete surfaces into things that can be built: torsion-free gridshells as checked "
    "STEP, STL and schedules.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode="markdown",  # in "rich", units in brackets would be markup
)

DONE, FAILED, BAD_INPUT, FAULT, INTERRUPTED = 0, 1, 2, 3, 130
"""Exit codes: every check passed; a check failed; bad usage or input; a fault of the program."""

Anyway = Annotated[
    bool,
    typer.Option(
        "--anyway", help="Go on where parts are beyond limits: they are made, and rejected."
    ),
]
Debug = Annotated[bool, typer.Option("--debug", help="Show tracebacks.")]

Units = Annotated[
    str | None,
    typer.Option(
        help="Unit of the mesh file: mm, cm, m, in or ft; default: what it states in a comment "
        '("# units: m"), else mm.'
    ),
]
Scale = Annotated[float, typer.Option(help="Factor on the coordinates, before the unit.")]
Up = Annotated[str, typer.Option(help="Axis of the file that is up: z, y, x, -z, -y or -x.")]
Flip = Annotated[bool, typer.Option("--flip", help="Turn the faces over.")]
Quads = Annotated[bool, typer.Option("--quads", help="Merge pairs of triangles into quads.")]
Weld = Annotated[
    float | None,
    typer.Option(
        help="Vertices nearer than this [mm] are one; default: what the digits of the file leave."
    ),
]


@dataclass(frozen=True)
class Reading:
    """How a command reads mesh files: its options."""

    units: str | None = None
    scale: float = 1.0
    up: str = "z"
    flip: bool = False
    quads: bool = False
    weld: float | None = None

    def read(self, path: Path) -> ReadResult:
        """The mesh of a file [mm]."""
        from ddgfab.io import STATED, read_mesh

        return read_mesh(
            path,
            self.scale,
            units=self.units or STATED,
            merge=self.weld,
            up=self.up,
            flip=self.flip,
            quads=self.quads,
        )

    def arguments(self) -> list[str]:
        """The options that are not as they are by default, for commands to try next."""
        found = []
        for field in fields(self):
            value = getattr(self, field.name)
            if value == field.default:
                continue
            found.append(f"--{field.name}")
            if value is not True:
                found.append(f"{value:g}" if isinstance(value, float) else str(value))
        return found


def comma_list(text: str) -> list[str]:
    """Items between commas, in lower case."""
    return [item.strip().lower() for item in text.split(",") if item.strip()]


def sections_of(changes: list[str]) -> dict[str, dict[str, Any]]:
    """`section.key=value` as sections; the value is TOML, or text without quotes."""
    from ddgfab.errors import ProjectError

    sections: dict[str, dict[str, Any]] = {}
    for change in changes:
        name, equals, value = change.partition("=")
        section, dot, key = name.strip().partition(".")
        if not (equals and dot and key):
            raise ProjectError(f"--set {change}: expected section.key=value")
        sections.setdefault(section, {})[key] = toml_value(value)
    return sections


def values_of(changes: list[str], what: str = "parameter") -> dict[str, Any]:
    """`key=value` as a dictionary; the value is TOML, or text without quotes."""
    from ddgfab.errors import InputError

    values = {}
    for change in changes:
        name, equals, value = change.partition("=")
        if not (equals and name.strip()):
            raise InputError(f"--set {change}: expected {what}=value")
        values[name.strip()] = toml_value(value)
    return values


def toml_value(text: str) -> Any:
    """A TOML value, or text without quotes."""
    import tomllib

    try:
        return tomllib.loads(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError:
        return text.strip()


@contextmanager
def output() -> Iterator[None]:
    """Standard output that a full disk ends: one message, also for what commands do not write."""
    try:
        try:
            yield
        finally:
            sys.stdout.flush()
    except OSError as error:
        sys.stdout = open(os.devnull, "w")  # noqa: PTH123, SIM115 - nothing is left to be flushed
        typer.echo(f"error: output cannot be written: {error.strerror}", err=True)
        raise SystemExit(BAD_INPUT) from None


@contextmanager
def errors(debug: bool) -> Iterator[None]:
    """One clear message and the right exit code; a traceback only with --debug."""
    from ddgfab.errors import DdgError

    def stop(signum: int, frame: object) -> None:
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGTERM, stop)
    try:
        yield
    except (typer.Exit, typer.Abort, typer.TyperException):
        raise
    except DdgError as error:
        if debug:
            raise
        typer.echo(f"error: {_limits_text(error) or error}", err=True)
        raise typer.Exit(BAD_INPUT) from None
    except KeyboardInterrupt:
        typer.echo("interrupted: nothing was written", err=True)
        raise typer.Exit(INTERRUPTED) from None
    except BrokenPipeError:  # the reader has what it wanted, as in `ddgfab net --list | head`
        sys.stdout = open(os.devnull, "w")  # noqa: PTH123, SIM115 - nothing is left to be flushed
        raise typer.Exit(DONE) from None
    except Exception as error:
        if debug or (isinstance(error, OSError) and error.filename is None):  # see `output`
            raise
        kind = type(error).__name__
        typer.echo(
            f"error: unexpected {kind}: {error}\nNothing was written. "
            "This is a fault of ddgfab: run again with --debug and report it.",
            err=True,
        )
        raise typer.Exit(FAULT) from None
    finally:
        signal.signal(signal.SIGTERM, before)


def _limits_text(error: Exception) -> str | None:
    """The message of a job that stopped at limits, with the next commands; None for others."""
    from fabrication.job.limits import LimitError

    if not isinstance(error, LimitError):
        return None
    given = ["ddgfab", *sys.argv[1:]]
    lines = [f"{error.summary}; nothing was made"]
    if error.settings:
        lines.append(f"Next: {shlex.join([*given, *error.arguments()])}")
    lines.append(f"Or make the parts all the same, and reject them: {shlex.join(given)} --anyway")
    return "\n".join(lines)


@contextmanager
def progress() -> Iterator[Progress]:
    """A bar a step on a terminal; a line a step elsewhere."""
    if not sys.stderr.isatty():
        begun: set[str] = set()

        def line(step: str, done: int, of: int) -> None:
            if step not in begun:
                begun.add(step)
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
