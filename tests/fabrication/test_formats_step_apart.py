"""The kernel reads in a process of its own: crashes, hangs and hunger end there, with a message."""

from __future__ import annotations

import os
import signal
import time
from pathlib import Path

import pytest
from typer.testing import CliRunner

from ddgfab.errors import InputError
from fabrication.cli import app
from fabrication.formats.report import inspect_file
from fabrication.formats.step import apart as module
from fabrication.formats.step.apart import apart

CASES = Path(__file__).resolve().parents[3] / "shared" / "data" / "cases"

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(os.name != "posix", reason="limits of processes are POSIX's"),
]


# Run in the other process, which finds them by name.
def process_of(path: Path) -> tuple[int, int]:
    return os.getpid(), os.getppid()


def crash(path: Path) -> None:
    os.kill(os.getpid(), signal.SIGSEGV)


def spin(path: Path) -> None:
    while True:
        pass


def fill(path: Path) -> int:
    blocks = []
    while True:
        blocks.append(b"x" * (64 << 20))


def odd(path: Path) -> None:
    raise UnicodeDecodeError("utf-8", b"\xff", 0, 1, "\x1b[31m")


@pytest.fixture
def file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    here = str(Path(__file__).parent)
    monkeypatch.syspath_prepend(here)
    path = tmp_path / "x.step"
    path.write_text("ISO-10303-21;")
    return path


def test_one_process_stays_and_each_file_has_a_copy_of_it(file: Path) -> None:
    module._drop()
    (one, stays), (two, also) = apart(process_of, file), apart(process_of, file)
    assert len({one, two, stays, os.getpid()}) == 4
    assert stays == also
    assert apart(process_of, file, foreign=False)[0] == stays
    with pytest.raises(InputError, match=r"x\.step: the CAD kernel crashed on it \(SIGSEGV\)"):
        apart(crash, file)
    assert apart(process_of, file)[1] == stays
    with pytest.raises(InputError, match="crashed"):
        apart(crash, file, foreign=False)
    assert apart(process_of, file)[1] != stays


def test_paths_are_seen_from_the_folder_of_the_question(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("one", "two"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "file.txt").write_text(name)
        monkeypatch.chdir(tmp_path / name)
        assert apart(Path.read_text, Path("file.txt")) == name


def test_limits_end_a_hang_and_hunger(file: Path) -> None:
    begin = time.process_time()
    with pytest.raises(InputError, match="takes more than 4 s of computing, the limit"):
        apart(spin, file)
    with pytest.raises(InputError, match="takes more than 512 MB of memory, the limit"):
        apart(fill, file)
    assert time.process_time() - begin < 1
    assert apart(process_of, file)[0] > 0


def test_whatever_the_kernel_raises_is_a_message(file: Path) -> None:
    with pytest.raises(InputError, match=r"cannot use it \(UnicodeDecodeError") as caught:
        apart(odd, file)
    assert "\x1b" not in str(caught.value)


def test_what_is_no_regular_file_is_not_read(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.step")
    (tmp_path / "device.step").symlink_to("/dev/zero")
    (tmp_path / "folder.step").mkdir()
    for name in ("pipe.step", "device.step", "folder.step"):
        with pytest.raises(InputError, match="is not a file"):
            inspect_file(tmp_path / name)
    with pytest.raises(InputError, match="no such file"):
        inspect_file(tmp_path / "none.step")


def test_a_file_that_crashes_the_kernel() -> None:
    path = CASES / "segv.step"
    if not path.exists():
        pytest.skip("segv.step is not in ../shared/data/cases of this checkout")
    with pytest.raises(InputError, match=r"segv\.step: the CAD kernel crashed on it"):
        inspect_file(path)


@pytest.mark.parametrize("command", ["check", "trace", "make"])
def test_commands_survive_it(command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = CASES / "segv.step"
    if not path.exists():
        pytest.skip("segv.step is not in ../shared/data/cases of this checkout")
    monkeypatch.chdir(tmp_path)
    result = CliRunner().invoke(app, [command, str(path)])
    assert result.exit_code == 2, result.output
    assert "segv.step: " in result.output
    assert "damaged" in result.output or "has no faces" in result.output
    assert list(tmp_path.iterdir()) == []
