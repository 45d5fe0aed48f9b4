"""Where the program starts: the command line, or what is missing for it."""

from __future__ import annotations

import os
import sys

BAD_INPUT = 2
"""Exit code, as in `fabrication.cli.terminal`."""


def main() -> None:
    """Run the console script `ddgfab`, also where only the geometry is installed."""
    _open_closed_streams()
    try:
        from fabrication.cli import main as run
    except ModuleNotFoundError as error:
        package = str(error.name).partition(".")[0]
        if package in ("ddgfab", "fabrication"):
            raise
        sys.stderr.write(
            f"error: the command line needs {package}, which is not installed: "
            "pip install ddgfab with its dependencies\n"
        )
        raise SystemExit(BAD_INPUT) from None
    run()


def _open_closed_streams() -> None:
    """Standard streams that were closed (`>&-`) lead nowhere: else files would take their numbers.

    What a library prints to number 1 would then stand in the first file that is written.
    """
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # takes the least number that is free: this one
    for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, mode))  # noqa: PTH123, SIM115 - to the end
