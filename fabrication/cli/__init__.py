"""The command line: the last room, and the only one that prints. One module a command."""

from __future__ import annotations

from typing import Annotated

import typer

from fabrication.cli.common import app

# Imported for their commands, in the order in which `--help` lists them.
# isort: off
from fabrication.cli import make, linkage, optimize, look, net  # noqa: F401

# isort: on

__all__ = ["app", "main"]


def main() -> None:
    """Entry point of the console script `ddgfab`."""
    app()


@app.callback()
def _version(
    version: Annotated[bool, typer.Option("--version", help="Print the version.")] = False,
) -> None:
    if version:
        from fabrication.version import package_version

        typer.echo(f"ddgfab {package_version()}")
        raise typer.Exit
