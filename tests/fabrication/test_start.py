"""The program where only the geometry is installed: what is missing, not a traceback."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def test_what_is_not_installed_is_named() -> None:
    program = """
import sys
sys.modules["typer"] = None
from fabrication.start import main
main()
"""
    done = subprocess.run(
        [sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 2
    assert done.stderr.startswith("error: the command line needs typer, which is not installed")
    assert done.stderr.count("\n") == 1
