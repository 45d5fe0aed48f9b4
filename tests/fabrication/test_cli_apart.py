"""Files that make the CAD kernel crash: a message, as for any damaged file."""

from __future__ import annotations

import os
import signal
from pathlib import Path

import pytest
from typer.testing import CliRunner

from ddgfab.errors import InputError
from fabrication.cli import app
from fabrication.cli.apart import Apart

CRASHING = Path(__file__).resolve().parents[3] / "shared" / "data" / "cases" / "segv.step"


def _crash(path: Path) -> None:
    os.kill(os.getpid(), signal.SIGSEGV)


def _refuse(path: Path) -> None:
    raise InputError("is damaged", file=str(path), line=3)


def _parent(path: Path) -> int:
    return os.getppid()


@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
def test_a_crash_is_an_error_and_the_next_file_is_read() -> None:
    with Apart() as apart:
        assert apart.call(Path("a.step"), _parent) == os.getpid()
        with pytest.raises(InputError, match=r"^b\.step: the CAD kernel crashed .* damaged"):
            apart.call(Path("b.step"), _crash)
        with pytest.raises(InputError, match=r"^c\.step:3: is damaged$"):
            apart.call(Path("c.step"), _refuse)
        assert apart.call(Path("d.step"), _parent) == os.getpid()


@pytest.mark.slow
@pytest.mark.parametrize("command", ["check", "trace", "make"])
def test_a_file_that_crashes_the_kernel(
    command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    if not CRASHING.exists():
        pytest.skip("segv.step is not in ../shared/data/cases of this checkout")
    monkeypatch.chdir(tmp_path)
    result = CliRunner().invoke(app, [command, str(CRASHING)])
    assert result.exit_code == 2, result.output
    assert "segv.step: " in result.output
    assert "damaged" in result.output or "has no faces" in result.output
    assert list(tmp_path.iterdir()) == []
