"""What commands print, and how they end: one message and an exit code for every error."""

from __future__ import annotations

import os
import re
import shlex
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, Final

import typer
from typer.core import TyperGroup

from fabrication.cli.steps import StepPrinter
from fabrication.cli.stops import STOPS, hidden_stops, stopping
from fabrication.processes import TOO_LITTLE, too_little

if TYPE_CHECKING:
    from fabrication.progress import Progress

DONE, FAILED, BAD_INPUT, FAULT, INTERRUPTED = 0, 1, 2, 3, 130
"""Exit codes: every check passed; a check failed; bad usage or input; a fault of the program; ended
by Ctrl-C. Other signals that end it, SIGTERM and the SIGHUP of a terminal that is closed: 128 and
their number."""

_REASON: Final = re.compile(r"Invalid value for '?(?P<what>[^']*?)'?: Input should be (?P<how>.*)")
_EXTRA: Final = re.compile(r"Got unexpected extra arguments?(?:\(s\))? \((.*)\)", re.DOTALL)
_PARSING: Final = re.compile(r", unable to parse string as an? \w+$")


def write(text: str, *, error: bool = False) -> None:
    """Print text that may hold names, paths and values of others: escaped for the terminal."""
    from ddgfab.errors import printable

    typer.echo(printable(text), err=error)


class Session:
    """One run of a command: what it prints, by `--quiet` and `--verbose`, and its progress.

    Attributes
    ----------
    outcome : what is printed besides when the command is interrupted; None: the files that it has
        put in their places, or that nothing was written
    """

    def __init__(self, quiet: bool = False, verbose: bool = False) -> None:
        self.quiet, self.verbose = quiet, verbose
        self.outcome: str | None = None
        self._steps = StepPrinter(hidden=quiet, timed=verbose)

    @property
    def progress(self) -> Progress:
        """To be called as (step, done, of)."""
        return self._steps

    def result(self, text: str) -> None:
        """Print what the command is for: always."""
        self.close()
        write(text)

    def say(self, text: str) -> None:
        """Print, unless quiet."""
        if not self.quiet:
            self.result(text)

    def detail(self, text: str) -> None:
        """Print, if verbose."""
        if self.verbose:
            self.result(text)

    def fail(self, text: str) -> None:
        """Print what is wrong, on standard error: always."""
        self.close()
        write(text, error=True)

    def close(self) -> None:
        """Stop the clocks: the last step is done."""
        self._steps.close()

    def stop(self) -> None:
        """Stop the clocks: the last step will not end."""
        self._steps.stop()


@contextmanager
def session(debug: bool, quiet: bool = False, verbose: bool = False) -> Iterator[Session]:
    """A run of a command; one clear message and the right exit code where it fails."""
    run = Session(quiet, verbose)
    with errors(debug, run):
        if quiet and verbose:
            from ddgfab.errors import InputError

            raise InputError("--quiet and --verbose exclude each other")
        yield run
        run.close()


@contextmanager
def errors(debug: bool, run: Session) -> Iterator[None]:
    """One clear message and the right exit code; a traceback only with --debug."""
    from ddgfab.errors import DdgError  # loads numpy: `start` has the errors of that
    from ddgfab.io.atomic import forget_placed

    forget_placed()
    try:
        with hidden_stops():
            yield
    except (typer.Exit, typer.Abort, typer.TyperException):
        run.close()
        raise
    except DdgError as error:
        run.stop()
        if debug:
            raise
        run.fail(f"error: {_limits_text(error) or error}")
        raise typer.Exit(BAD_INPUT) from None
    except KeyboardInterrupt as interrupt:
        run.stop()
        run.fail(f"interrupted: {str(interrupt) or run.outcome or _written()}")
        STOPS.told = True
        raise typer.Exit(STOPS.code) from None
    except BrokenPipeError:  # the reader has what it wanted, as in `ddgfab net --list | head`
        sys.stdout = open(os.devnull, "w")  # noqa: PTH123, SIM115 - nothing is left to be flushed
        raise typer.Exit(DONE) from None
    except ModuleNotFoundError as error:
        run.stop()
        package = str(error.name).partition(".")[0]
        if debug or package in ("ddgfab", "fabrication"):
            raise
        run.fail(f"error: {package} is needed for this and not installed: pip install {package}")
        raise typer.Exit(BAD_INPUT) from None
    except Exception as error:
        run.stop()
        if not debug and too_little(error):
            run.fail(f"error: {TOO_LITTLE}\nNothing was written. With --jobs 1 it takes less.")
            raise typer.Exit(BAD_INPUT) from None
        if debug or (isinstance(error, OSError) and error.filename is None):  # see `output`
            raise
        run.fail(
            f"error: unexpected {type(error).__name__}: {error}\nNothing was written. "
            "This is a fault of ddgfab: run again with --debug and report it."
        )
        raise typer.Exit(FAULT) from None


def _written() -> str:
    """Which files a command that is interrupted has written."""
    from ddgfab.io.atomic import placed

    files = [str(path) for path in placed()]
    if not files:
        return "nothing was written"
    return f"{' and '.join(files)} {'is' if len(files) == 1 else 'are'} complete"


def _limits_text(error: Exception) -> str | None:
    """The message of a job that stopped at entry, with the next commands; None for others."""
    from fabrication.gridshell.axes import AxesError
    from fabrication.job.folder import OtherProjectError
    from fabrication.job.limits import LimitError, set_arguments

    given = ["ddgfab", *sys.argv[1:]]
    if isinstance(error, AxesError):
        return f"{error}\nNext: {shlex.join([*given, *set_arguments(error.settings)])}"
    if isinstance(error, OtherProjectError):
        again = shlex.join([*given, "--force"])
        return f"{error.summary}\nChoose another folder with -o, or replace that result: {again}"
    if not isinstance(error, LimitError):
        return None
    lines = [f"{error.summary}; nothing was made"]
    if error.settings:
        lines.append(f"Next: {shlex.join([*given, *set_arguments(error.settings)])}")
    elif error.advice:
        lines.append(error.advice)
    lines.append(f"Or make the parts all the same, and reject them: {shlex.join(given)} --anyway")
    return "\n".join(lines)


@contextmanager
def output() -> Iterator[None]:
    """Standard output that a full disk ends: one message, also for what commands do not write."""
    for stream in (sys.stdout, sys.stderr):
        reconfigure: Any = getattr(stream, "reconfigure", None)
        if reconfigure is not None:  # a terminal without Unicode shows escapes
            reconfigure(errors="backslashreplace")
    try:
        try:
            yield
        finally:
            sys.stdout.flush()
    except OSError as error:
        sys.stdout = open(os.devnull, "w")  # noqa: PTH123, SIM115 - nothing is left to be flushed
        write(f"error: output cannot be written: {error.strerror}", error=True)
        raise SystemExit(BAD_INPUT) from None


class Program(TyperGroup):
    """The program: wrong usage ends as every other error does, with one message and code 2."""

    def main(self, args: Any = None, *rest: Any, **kwargs: Any) -> Any:
        """Run it; see `typer.core.TyperGroup.main`."""
        alone = kwargs.pop("standalone_mode", True)
        kwargs["standalone_mode"] = False
        if not alone:
            return super().main(args, *rest, **kwargs)
        try:
            with stopping():
                code = self._code(args, *rest, **kwargs)
        except KeyboardInterrupt:
            code = INTERRUPTED
        if code == INTERRUPTED and not STOPS.told:  # before or after what a session does
            write("interrupted", error=True)
            code = STOPS.code
        sys.exit(code)

    def _code(self, args: Any, *rest: Any, **kwargs: Any) -> int:
        """Run it, and print what is wrong with its usage; the exit code."""
        try:
            with hidden_stops():
                code = super().main(args, *rest, **kwargs)
        except typer.TyperException as error:
            if type(error).__name__ != "NoArgsIsHelpError":  # which has shown the help already
                write(_usage_text(error), error=True)
            return BAD_INPUT
        except typer.Abort:
            return INTERRUPTED
        return code if isinstance(code, int) else DONE


def _usage_text(error: typer.TyperException) -> str:
    """What is wrong with the arguments, and where they are explained."""
    from ddgfab.errors import clipped

    message = error.format_message().rstrip(".")
    if found := _EXTRA.fullmatch(message):
        message = f"there is no place for {clipped(found[1])}; what is written is named by -o"
    if found := _REASON.fullmatch(message):
        message = f"{found['what']} must be {_PARSING.sub('', found['how'])}"
    context = getattr(error, "ctx", None)
    command = "ddgfab" if context is None else context.command_path
    return f"error: {message}\nSee {command} --help"
