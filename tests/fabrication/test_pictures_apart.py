"""The process that draws: what ends it ends no job, and the next picture is drawn all the same."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest
from roofs import barrel

from ddgfab.errors import OutputError
from fabrication import design, make
from fabrication.pictures import apart, preview

ROOT = Path(__file__).resolve().parents[2]

pytestmark = pytest.mark.skipif(os.name != "posix", reason="signals and limits are POSIX's")


def process(pyvista: Any) -> int:
    return os.getpid()


def crash(pyvista: Any, *_: Any) -> None:
    os.kill(os.getpid(), signal.SIGSEGV)


def fill(pyvista: Any) -> None:
    raise MemoryError


def fault(pyvista: Any) -> None:
    raise KeyError("a key")


def test_what_ends_the_process_is_one_message() -> None:
    pytest.importorskip("pyvista")
    first = apart.drawn(process)
    assert first != os.getpid()
    assert apart.drawn(process) == first
    with pytest.raises(OutputError, match=r"ended \(SIGSEGV\), probably for lack of memory"):
        apart.drawn(crash)
    second = apart.drawn(process)
    assert second not in (first, os.getpid())
    with pytest.raises(OutputError, match="too little memory to draw"):
        apart.drawn(fill)
    with pytest.raises(OutputError, match=r"cannot be drawn \(KeyError: 'a key'\)"):
        apart.drawn(fault)
    assert apart.drawn(process) == second


def test_workers_draw_for_themselves(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("pyvista")
    monkeypatch.setattr(apart, "is_expendable", lambda: True)
    assert apart.drawn(process) == os.getpid()


def test_a_job_goes_on_without_its_picture(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("pyvista")
    monkeypatch.setattr(preview, "_rendered", crash)
    made = design(barrel(1, 2), output={"formats": ["csv"]}, checks={"verify": "none"})
    result = make(made, tmp_path / "out")
    assert result.exit_code == 0
    assert [n for n in result.manifest["notes"] if n.startswith("no preview.png: the process that")]
    assert not (tmp_path / "out" / "preview.png").exists()


@pytest.mark.slow
def test_the_process_ends_with_the_one_that_asks() -> None:
    program = (
        "import os, sys, time; sys.path[:0] = ['tests/fabrication']\n"
        "import test_pictures_apart as t\n"
        "print(t.apart.drawn(t.process), flush=True)\ntime.sleep(100)"
    )
    job = subprocess.Popen([sys.executable, "-c", program], cwd=ROOT, stdout=subprocess.PIPE)
    assert job.stdout is not None
    child = int(job.stdout.readline())
    os.kill(child, 0)
    job.kill()
    job.wait()
    job.stdout.close()
    for _ in range(100):
        try:
            os.kill(child, 0)
        except ProcessLookupError:
            return
        if Path(f"/proc/{child}/stat").read_text().rpartition(")")[2].split()[0] == "Z":
            return
        time.sleep(0.1)
    raise AssertionError("the process that draws is left")
