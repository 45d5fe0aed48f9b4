"""The command line: the last room, and the only one that prints. One module a command."""

from __future__ import annotations

from typing import Annotated

import typer

from fabrication.cli.common import app
from fabrication.cli.terminal import output

# Imported for their commands, in the order in which `--help` lists them.
# isort: off
from fabrication.cli import make, linkage, init, optimize, trace, dilemma, look, net  # noqa: F401

# isort: on

__all__ = ["app", "main"]


def main() -> None:
    """Entry point of the console script `ddgfab`."""
    with output():
        app(prog_name="ddgfab")


def _print_version(asked: bool) -> None:
    if asked:
        from fabrication.version import package_version

        typer.echo(f"ddgfab {package_version()}")
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool,
        typer.Option(
            "--version", help="Print the version.", callback=_print_version, is_eager=True
        ),
    ] = False,
) -> None:
    """Options of the program itself."""
