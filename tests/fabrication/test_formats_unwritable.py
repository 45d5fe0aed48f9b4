"""Files that find no room, in every format: an error, and never a file that is taken for whole."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from roofs import barrel
from wholes import whole_of

from ddgfab.errors import DdgError
from fabrication.formats.base import Whole
from fabrication.formats.registry import names
from fabrication.gridshell.design import Design, design

resource = pytest.importorskip("resource", reason="limits of processes are POSIX's")
ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def made() -> Design:
    return design(barrel(1, 2))


@pytest.fixture(scope="module")
def whole(made: Design) -> Whole:
    return whole_of(made)


@contextmanager
def room_for(size: int) -> Iterator[None]:
    """No file may be longer than so many bytes, as on a disk that is full."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


@pytest.mark.parametrize("size", [0, 300])
@pytest.mark.parametrize("name", [*names(), "compas"])
def test_what_finds_no_room_is_an_error(
    name: str, size: int, made: Design, whole: Whole, tmp_path: Path
) -> None:
    format = made.product().format(name)
    folders = [tmp_path / "short", tmp_path / "long"]
    for folder in folders:
        folder.mkdir()
    part = next((p for p in whole.parts.values() if format.takes(p.family)), None)
    if format.parts and part is not None:
        with room_for(size), pytest.raises((DdgError, OSError)):
            format.write_part(folders[0] / f"part.{name}", part, whole.about)
    if format.writes_whole():
        format.write_whole(folders[1], whole)
        least = max((p.stat().st_size for p in folders[1].rglob("*") if p.is_file()), default=0)
        if least > size:
            with room_for(size), pytest.raises((DdgError, OSError)):
                format.write_whole(folders[0], whole)


KERNEL = """
import sys
sys.path.insert(0, {folder!r})
sys.argv = ["ddgfab", "make", "--formats", "step", "-o", "out", "--jobs", "{jobs}"]
from fabrication.start import main
if __name__ == "__main__":
    main()
"""


@pytest.mark.slow
@pytest.mark.parametrize("jobs", [1, 2])
def test_a_kernel_that_cannot_be_loaded_is_a_message(jobs: int, tmp_path: Path) -> None:
    """A library below it is missing: it is installed, and fails as it is loaded."""
    broken = tmp_path / "broken" / "OCP"
    broken.mkdir(parents=True)
    text = "libGL.so.1: cannot open shared object file"
    (broken / "__init__.py").write_text(f"raise ImportError({text!r})\n")
    program = tmp_path / "program.py"
    program.write_text(KERNEL.format(folder=str(tmp_path / "broken"), jobs=jobs))
    done = subprocess.run(
        [sys.executable, str(program)],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        env={"PYTHONPATH": f"{tmp_path / 'broken'}:{ROOT}", "PATH": ""},
        timeout=300,
    )
    assert done.returncode == 2, done.stderr
    assert "libGL.so.1" in done.stderr
    assert "Traceback" not in done.stderr
    assert "fault of ddgfab" not in done.stderr
    assert not (tmp_path / "out").exists()
