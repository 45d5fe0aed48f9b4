"""Where the program starts: the command line, or what is missing for it."""

from __future__ import annotations

import sys

BAD_INPUT = 2
"""Exit code, as in `fabrication.cli.terminal`."""


def main() -> None:
    """Run the console script `ddgfab`, also where only the geometry is installed."""
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
