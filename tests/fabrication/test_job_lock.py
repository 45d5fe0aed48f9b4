"""One job at a time in a folder, by locks and signs of life, never by process ids."""

from __future__ import annotations

import errno
import json
import os
import subprocess
import sys
import types
from collections.abc import Callable
from pathlib import Path
from typing import Any

import folder_cases as cases
import pytest

from ddgfab.errors import OutputError
from fabrication.job import folder as folder_module
from fabrication.job import lock as lock_module
from fabrication.job.folder import OutputFolder
from fabrication.job.lock import FolderLock

HERE = Path(__file__).resolve().parents[2]


def work_of(target: Path) -> Path:
    return OutputFolder(target).work


def make_and(target: Path, last: Callable[[Path], object]) -> None:
    """A job with something that happens at its end."""
    with OutputFolder(target) as folder:
        cases.fill(folder, "new")
        last(folder)


def leave_lock(target: Path, **changes: Any) -> Path:
    """What a job leaves that was killed: its lock and half a staging folder; the staging folder."""
    work = work_of(target)
    (work / "new-0123").mkdir(parents=True)
    (work / "new-0123" / "half.step").write_text("ISO")
    owner = {"token": "x", "host": "h", "boot": lock_module.boot(), "process": os.getpid()}
    (work / "lock").write_text(json.dumps({**owner, **changes}))
    return work / "new-0123"


def test_a_second_job_is_refused_and_the_first_one_is_whole(tmp_path: Path) -> None:
    target = tmp_path / "out"
    with OutputFolder(target) as folder:
        cases.fill(folder, "new")
        for check in (OutputFolder(target).prepare, OutputFolder(target).__enter__):
            with pytest.raises(OutputError, match=f"another job.*process {os.getpid()} on"):
                check()
        program = (
            "import sys; from fabrication.job.folder import OutputFolder\n"
            "OutputFolder(sys.argv[1]).__enter__()"
        )
        done = subprocess.run(
            [sys.executable, "-c", program, str(target)],
            capture_output=True,
            text=True,
            env={**os.environ, "PYTHONPATH": str(HERE)},
        )
        assert "another job is writing it" in done.stderr
    assert cases.text_of(target) == "new"
    assert [path.name for path in tmp_path.iterdir()] == ["out"]


def test_a_mounted_folder_and_the_same_folder_elsewhere_are_one(
    tmp_path: Path, monkeypatch: Any
) -> None:
    """In a container the folder is a mount point, on the host it is none: two working folders."""
    target = tmp_path / "out"
    cases.make_job(target, "old")
    first = OutputFolder(target)
    with first as folder:
        cases.fill(folder, "new")
        monkeypatch.setattr(folder_module, "holds_mounts", lambda target: True)
        assert OutputFolder(target).work != first._held.folder
        with pytest.raises(OutputError, match="another job"):
            OutputFolder(target).__enter__()
    assert cases.text_of(target) == "new"


@pytest.mark.parametrize("process", [os.getpid(), 1, 999_999_999], ids=["own", "first", "free"])
def test_what_a_killed_job_left_is_cleared_whoever_has_its_number_now(
    tmp_path: Path, process: int
) -> None:
    staging = leave_lock(tmp_path / "out", process=process)
    cases.make_job(tmp_path / "out", "new")
    assert not staging.exists()
    assert [path.name for path in tmp_path.iterdir()] == ["out"]


def test_a_job_on_another_machine_lives_while_it_gives_signs(tmp_path: Path) -> None:
    """Its kernel's locks may not be known here, and its process ids mean nothing."""
    staging = leave_lock(tmp_path / "out", boot="elsewhere", host="other", process=999_999_999)
    with pytest.raises(OutputError, match="process 999999999 on other"):
        cases.make_job(tmp_path / "out", "new")
    assert (staging / "half.step").exists()
    lock = work_of(tmp_path / "out") / "lock"
    old = lock.stat().st_mtime - lock_module.DEAD - 60
    os.utime(lock, (old, old))
    cases.make_job(tmp_path / "out", "new")
    assert not staging.exists()
    assert cases.text_of(tmp_path / "out") == "new"


def test_a_job_gives_signs_of_life(tmp_path: Path, monkeypatch: Any) -> None:
    monkeypatch.setattr(lock_module, "BEAT", 0.01)
    lock = FolderLock(tmp_path / "work", tmp_path / "out")
    lock.acquire()
    os.utime(lock.file, (1, 1))
    for _ in range(500):
        if lock.file.stat().st_mtime > 1:
            break
        lock._ended.wait(0.01)
    assert lock.file.stat().st_mtime > 1
    lock.release()
    assert not lock.folder.exists()


def test_a_file_system_without_locks_goes_by_signs_of_life(
    tmp_path: Path, monkeypatch: Any
) -> None:
    import fcntl

    def refuse(descriptor: int, operation: int) -> None:
        raise OSError(errno.ENOLCK, "No locks available")

    monkeypatch.setattr(fcntl, "flock", refuse)
    with OutputFolder(tmp_path / "out") as folder:
        cases.fill(folder, "new")
        with pytest.raises(OutputError, match="another job"):
            OutputFolder(tmp_path / "out").__enter__()
    assert cases.text_of(tmp_path / "out") == "new"


def test_a_job_that_lost_its_lock_writes_nothing(tmp_path: Path) -> None:
    target = tmp_path / "out"
    cases.make_job(target, "old")

    def lose(folder: Path) -> None:
        (folder.parent / "lock").write_text('{"token": "another"}')

    with pytest.raises(OutputError, match="another job took the folder over"):
        make_and(target, lose)
    assert cases.text_of(target) == "old"
    (work_of(target) / "lock").unlink()


def test_files_that_another_removed_are_missed(tmp_path: Path) -> None:
    """The manifest's list decides, not what is there."""
    target = tmp_path / "out"
    cases.make_job(target, "old")
    with pytest.raises(OutputError, match=r"1\.step: No such file"):
        make_and(target, lambda folder: (folder / "parts" / "step" / "1.step").unlink())
    with pytest.raises(OutputError, match=r"0\.step is not what"):
        make_and(target, lambda folder: (folder / "parts" / "step" / "0.step").write_text("NEW 0"))
    assert cases.text_of(target) == "old"
    assert [path.name for path in tmp_path.iterdir()] == ["out"]


@pytest.mark.parametrize("free", [True, False])
def test_a_lock_of_windows_is_on_a_byte_that_nobody_reads(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, free: bool
) -> None:
    """Others must be able to read the owner, who stands in the first 4096 bytes."""
    places = []

    def locking(descriptor: int, mode: int, count: int) -> None:
        places.append((os.lseek(descriptor, 0, os.SEEK_CUR), mode, count))
        if not free:
            raise OSError(errno.EACCES, "locked")

    windows = types.SimpleNamespace(locking=locking, LK_NBLCK=2)
    monkeypatch.setitem(sys.modules, "msvcrt", windows)
    (tmp_path / "lock").write_text("{}")
    descriptor = os.open(tmp_path / "lock", os.O_RDWR)
    try:
        assert lock_module._windows(descriptor) is free
    finally:
        os.close(descriptor)
    ((place, mode, count),) = places
    assert place > 4096
    assert (mode, count) == (2, 1)


@pytest.mark.skipif(os.name != "posix", reason="folders have advisory locks on POSIX")
def test_locks_of_two_working_folders_of_one_target_exclude_each_other(tmp_path: Path) -> None:
    target = tmp_path / "out"
    target.mkdir()
    first = FolderLock(tmp_path / "beside", target)
    second = FolderLock(target / "inside", target)
    first.acquire()
    with pytest.raises(OutputError, match="another job is writing it"):
        second.acquire()
    first.release()
    second.acquire()
    second.release()
    assert list(tmp_path.iterdir()) == [target]


def test_a_job_that_is_suspended_keeps_its_lock(tmp_path: Path) -> None:
    """Its sign of life is old; the system knows that it lives."""
    target = tmp_path / "out"
    with OutputFolder(target) as folder:
        cases.fill(folder, "new")
        os.utime(work_of(target) / "lock", (1.0, 1.0))
        with pytest.raises(OutputError, match="another job is writing it"):
            OutputFolder(target).prepare()
    assert cases.text_of(target) == "new"
