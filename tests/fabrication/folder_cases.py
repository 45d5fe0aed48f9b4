"""Output folders for tests: results of two runs, things of others, and kills at every step."""

from __future__ import annotations

import os
import stat
import sys
from collections.abc import Callable
from pathlib import Path

from fabrication.job.folder import OutputFolder
from fabrication.job.manifest import build_manifest, faults, file_records, write_manifest

KILLED = 77
"""Exit code of a process that ended itself where a kill would end it."""

EVENTS = (
    "open",
    "os.rename",
    "os.remove",
    "os.rmdir",
    "os.mkdir",
    "os.link",
    "os.chmod",
    "os.chown",
    "os.utime",
    "os.truncate",
    "os.scandir",
    "os.listdir",
    "fcntl.flock",
    "shutil.rmtree",
    "fabrication.exchange",
)
"""Operations on files that Python announces before it asks the system."""


def fill(folder: Path, text: str, project: str = "roof", more: int = 2) -> None:
    """The files of a job: some that every run has, some of this text only."""
    (folder / "parts" / "step").mkdir(parents=True)
    for k in range(more):
        (folder / "parts" / "step" / f"{k}.step").write_text(f"{text} {k}")
    (folder / "schedule.csv").write_text(text)
    (folder / f"only-{text}.txt").write_text(text)
    (folder / "run.json").write_text("{}")
    content = build_manifest(
        project=project, facts={"text": text}, parts=[], files=file_records(folder)
    )
    write_manifest(folder / "manifest.json", content)


def make_job(target: Path, text: str, project: str = "roof", force: bool = False) -> list[str]:
    """One job; returns its notes."""
    place = OutputFolder(target, project=project, force=force)
    with place as folder:
        fill(folder, text, project)
    return place.notes


def add_others(target: Path) -> None:
    """What people put beside our files, and one of ours that they edited."""
    (target / "notes").mkdir(mode=0o750)
    (target / "notes" / "mine.txt").write_text("keep")
    (target / "notes" / "link").symlink_to("mine.txt")
    (target / "dangling").symlink_to("/nowhere/at/all")
    (target / "empty" / "inner").mkdir(parents=True)
    (target / "parts" / "mine.nc").write_text("G0")
    os.mkfifo(target / "pipe")
    (target / "schedule.csv").write_text("edited")


def require_others(target: Path) -> None:
    """Assert that all of it is there."""
    assert (target / "notes" / "mine.txt").read_text() == "keep"
    assert (target / "notes").stat().st_mode & 0o777 == 0o750
    assert str((target / "notes" / "link").readlink()) == "mine.txt"
    assert str((target / "dangling").readlink()) == "/nowhere/at/all"
    assert (target / "empty" / "inner").is_dir()
    assert (target / "parts" / "mine.nc").read_text() == "G0"
    assert stat.S_ISFIFO((target / "pipe").lstat().st_mode)
    kept = [target / "schedule.csv", target / "schedule.kept.csv"]
    assert "edited" in [path.read_text() for path in kept if path.exists()]


def text_of(target: Path) -> str:
    """Which run's result a folder holds; asserts that it is that one alone, and complete."""
    found = [path.stem[5:] for path in target.glob("only-*.txt") if ".kept" not in path.name]
    assert len(found) == 1, found
    wrong = faults(target)
    edited = wrong is not None and (target / "schedule.csv").read_text() == "edited"
    assert wrong is None or edited, wrong
    return found[0]


def killed_at(step: int, action: Callable[[], object], armed: Callable[[], bool]) -> int:
    """Run an action in a process that ends at its n-th operation on files; its exit code.

    Parameters
    ----------
    armed : counting begins when this is true
    """
    child = os.fork()
    if child:
        return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    count = 0

    def hook(event: str, arguments: object) -> None:
        nonlocal count
        if event in EVENTS and armed():
            count += 1
            if count == step:
                os._exit(KILLED)

    code = 1
    try:
        sys.addaudithook(hook)
        action()
        code = 0
    finally:
        os._exit(code)
