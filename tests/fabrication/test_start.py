"""The program where only the geometry is installed: what is missing, not a traceback."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from fabrication.processes import too_little
from fabrication.start import LEAST_MB

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


@pytest.mark.parametrize(("given", "used"), [(None, "1"), ("3", "3")])
def test_numbers_take_one_thread_unless_the_user_says_otherwise(
    given: str | None, used: str
) -> None:
    """It has to be said before numpy is loaded."""
    program = """
import os, sys
import fabrication.start
assert "numpy" not in sys.modules
sys.modules["typer"] = None
try:
    fabrication.start.main()
except SystemExit:
    print(os.environ["OPENBLAS_NUM_THREADS"])
"""
    environment = {k: v for k, v in os.environ.items() if not k.endswith("_NUM_THREADS")}
    if given is not None:
        environment["OPENBLAS_NUM_THREADS"] = given
    done = subprocess.run(
        [sys.executable, "-c", program],
        cwd=ROOT,
        env=environment,
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.strip() == used


@pytest.mark.skipif(os.name != "posix", reason="limits on memory are POSIX's")
def test_too_little_memory_to_begin_is_one_message() -> None:
    """Below it, the libraries of numbers crash or hang as they are loaded."""
    done = subprocess.run(
        ["/bin/sh", "-c", f"ulimit -v {100 << 10}; exec {sys.executable} -m fabrication --help"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 2
    assert done.stderr == (
        f"error: 100 MB of address space are allowed (ulimit -v); at least {LEAST_MB} are needed\n"
    )


@pytest.mark.parametrize(
    ("error", "answer"),
    [
        (MemoryError(), True),
        (OSError(12, "Cannot allocate memory"), True),
        (ImportError("libx.so: failed to map segment from shared object"), True),
        (RuntimeError("can't start new thread"), True),
        (ImportError("cannot import name x"), False),
        (RuntimeError("dictionary changed size"), False),
        (OSError(28, "No space left on device"), False),
    ],
)
def test_lack_of_memory_is_told_from_faults(error: Exception, answer: bool) -> None:
    assert too_little(error) is answer
