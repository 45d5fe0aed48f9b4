"""What is not ours in an output folder: kept as it is, told, and never in the way."""

from __future__ import annotations

import errno
import json
import os
import signal
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import folder_cases as cases
import pytest

from ddgfab.errors import OutputError
from fabrication.job import folder as folder_module
from fabrication.job import place
from fabrication.job.folder import OtherProjectError, OutputFolder


@pytest.fixture(params=["beside", "inside"])
def target(request: Any, tmp_path: Path, monkeypatch: Any) -> Path:
    if request.param == "inside":
        monkeypatch.setattr(folder_module, "holds_mounts", lambda target: True)
        (tmp_path / "out").mkdir()
    return tmp_path / "out"


def test_edited_files_are_kept_beside_the_new_ones_and_told(target: Path) -> None:
    cases.make_job(target, "old")
    for k in range(1, 4):
        (target / "schedule.csv").write_text(f"edited {k}")
        notes = cases.make_job(target, f"run{k}")
        assert len(notes) == 1
        assert "schedule.csv" in notes[0]
        assert "kept as schedule.kept" in notes[0]
        assert (target / "schedule.csv").read_text() == f"run{k}"
    kept = sorted(path.name for path in target.glob("schedule.kept*"))
    assert [(target / name).read_text() for name in kept] == ["edited 2", "edited 3", "edited 1"]
    assert cases.make_job(target, "last") == []


def test_a_name_that_the_new_result_needs(target: Path) -> None:
    cases.make_job(target, "old")
    (target / "only-new.txt").write_text("mine")
    (target / "schedule.csv").unlink()
    (target / "schedule.csv").symlink_to("only-new.txt")
    (target / "parts" / "step" / "1.step").unlink()
    (target / "parts" / "step" / "1.step").mkdir()
    (target / "parts" / "step" / "1.step" / "mine").write_text("also mine")
    cases.make_job(target, "new")
    assert cases.text_of(target) == "new"
    assert (target / "only-new.kept.txt").read_text() == "mine"
    assert str((target / "schedule.kept.csv").readlink()) == "only-new.txt"
    assert (target / "parts/step/1.kept.step/mine").read_text() == "also mine"


def test_others_things_stay_the_same_things(target: Path) -> None:
    cases.make_job(target, "old")
    cases.add_others(target)
    before = (target / "notes" / "mine.txt").stat()
    os.utime(target / "notes", (1e9, 1e9))
    cases.make_job(target, "new")
    cases.require_others(target)
    after = (target / "notes" / "mine.txt").stat()
    assert (after.st_ino, after.st_mtime_ns, after.st_nlink) == (
        before.st_ino,
        before.st_mtime_ns,
        1,
    )
    assert (target / "notes").stat().st_mtime == 1e9


def test_a_file_that_is_saved_while_the_folders_are_exchanged(
    tmp_path: Path, monkeypatch: Any
) -> None:
    """An editor puts a new file in the place of the old one at the last moment."""
    target = tmp_path / "out"
    cases.make_job(target, "old")
    cases.add_others(target)
    exchange = place.exchange

    def late(one: Path, two: Path) -> bool:
        (target / "notes" / "later.txt").write_text("saved late")
        (target / "parts" / "step" / "0.step").write_text("edited late")
        return exchange(one, two)

    monkeypatch.setattr(place, "exchange", late)
    cases.make_job(target, "new")
    assert (target / "notes" / "later.txt").read_text() == "saved late"
    assert (target / "parts/step/0.kept.step").read_text() == "edited late"
    assert cases.text_of(target) == "new"


def test_another_project_is_refused_without_force(target: Path) -> None:
    cases.make_job(target, "old", project="東京")
    with pytest.raises(OtherProjectError, match="holds the result of project 東京; this is 大阪"):
        OutputFolder(target, project="大阪").check()
    with pytest.raises(OtherProjectError, match="force"):
        cases.make_job(target, "new", project="大阪")
    assert cases.text_of(target) == "old"
    cases.make_job(target, "new", project="大阪", force=True)
    assert cases.text_of(target) == "new"


@pytest.mark.parametrize("files", ["x", [1, "x", {"path": 5}, {"path": "../../mine"}, {}], None])
def test_an_odd_manifest_of_ours_loses_nothing(target: Path, files: Any) -> None:
    cases.make_job(target, "old")
    (target.parent / "mine").write_text("outside")
    path = target / "manifest.json"
    content = json.loads(path.read_text())
    path.write_text(json.dumps({**content, "files": files, "project": ["roof"]}))
    cases.make_job(target, "new", force=True)
    assert (target / "only-old.txt").exists()  # not known to be ours any more
    assert (target / "schedule.csv").read_text() == "new"
    assert (target / "schedule.kept.csv").read_text() == "old"
    assert (target.parent / "mine").read_text() == "outside"


def test_places_that_cannot_be_used_are_found_at_entry(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    (tmp_path / "fifo").mkdir()
    os.mkfifo(tmp_path / "fifo" / "out")
    for bad, words in (
        ("/", "no job can take this place"),
        ("", "empty"),
        (tmp_path / "file", "is a file"),
        (tmp_path / "file" / "out", "is a file"),
        (tmp_path / "fifo" / "out", "is a file"),
        (tmp_path / ("x" * 300), "too long"),
        (Path("/proc/out"), "/proc/out: "),
    ):
        with pytest.raises(OutputError, match=words):
            OutputFolder(bad).__enter__()


def test_names_of_neighbors_are_left_alone(tmp_path: Path) -> None:
    odd = ["out.ddgfab", ".out.ddgfab-2", ".out.partial-1", ".out.old-77", "a]b", "out*"]
    for name in odd:
        (tmp_path / name).mkdir()
    cases.make_job(tmp_path / "out", "old")
    cases.make_job(tmp_path / "out", "new")
    cases.make_job(tmp_path / "a]b", "new")
    cases.make_job(tmp_path / ("y" * 250), "new")
    names = {path.name for path in tmp_path.iterdir()}
    assert names == {*odd, "out", "y" * 250}


def test_the_current_folder_stays_the_current_folder(tmp_path: Path, monkeypatch: Any) -> None:
    monkeypatch.chdir(tmp_path)
    for text in ("old", "new"):
        cases.make_job(Path(), text)
        assert Path("schedule.csv").read_text() == text
    assert cases.text_of(tmp_path) == "new"
    assert not (tmp_path / ".ddgfab").exists()


@pytest.fixture
def interrupts() -> Iterator[None]:
    """Ctrl-C as at a terminal, also where the tests run in the background, which ignores it."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def test_an_interrupt_while_the_old_folder_goes(
    target: Path, monkeypatch: Any, interrupts: None
) -> None:
    """The result is in place already: it stays, whole, and the message says so."""
    cases.make_job(target, "old")
    discard = place.discard

    def interrupted(folder: Path) -> None:
        os.kill(os.getpid(), signal.SIGINT)
        discard(folder)

    monkeypatch.setattr(place, "discard", interrupted)
    with pytest.raises(KeyboardInterrupt, match="the files are complete in"):
        cases.make_job(target, "new")
    assert cases.text_of(target) == "new"
    assert [path.name for path in target.parent.iterdir()] == ["out"]


def test_a_refused_exchange_leaves_the_old_folder(target: Path, monkeypatch: Any) -> None:
    cases.make_job(target, "old")
    cases.add_others(target)

    def refuse(self: Path, to: Path) -> Path:
        if self.parent.name.startswith("new-") or self.name.startswith("new-"):
            raise OSError(errno.EACCES, "no")
        return self.replace(to)

    monkeypatch.setattr(place, "exchange", lambda one, two: False)
    monkeypatch.setattr(Path, "rename", refuse)
    with pytest.raises(OutputError, match="no permission"):
        cases.make_job(target, "new")
    monkeypatch.undo()
    assert cases.text_of(target) == "old"
    cases.require_others(target)


@pytest.fixture(params=["tmpfs", "bind"])
def mounted(request: Any, tmp_path: Path) -> Iterator[Path]:
    """A folder that is a mount point, of a disk of its own or of the same disk."""
    point, source = tmp_path / "out", tmp_path / "source"
    point.mkdir()
    source.mkdir()
    kind = ["-t", "tmpfs", "tmpfs"] if request.param == "tmpfs" else ["--bind", str(source)]
    done = subprocess.run(["mount", *kind, str(point)], capture_output=True, text=True)
    if done.returncode:
        pytest.skip(f"cannot mount here: {done.stderr.strip()}")
    yield point
    subprocess.run(["umount", str(point)], check=True)


@pytest.mark.skipif(os.name != "posix" or os.geteuid() != 0, reason="mounting needs root")
def test_a_mount_point(mounted: Path) -> None:
    cases.make_job(mounted, "old")
    cases.add_others(mounted)
    cases.make_job(mounted, "new")
    assert cases.text_of(mounted) == "new"
    cases.require_others(mounted)
    assert {path.name for path in mounted.parent.iterdir()} == {"out", "source"}
    assert not (mounted / ".ddgfab").exists()
