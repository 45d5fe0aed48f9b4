"""A kill at every operation of the commit: the folder is the old or the new one, and nothing else.

A child process ends itself (no cleaning up, as with SIGKILL) at the n-th operation on files that
Python announces, for every n until it comes through.
"""

from __future__ import annotations

import errno
import os
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import folder_cases as cases
import pytest

from fabrication.job import folder as folder_module
from fabrication.job import place
from fabrication.job.folder import OutputFolder

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork"),
]
EVERY = 1 if os.environ.get("DDGFAB_ATTACK") else 0
"""Whether the rarer ways are killed at every step too; see benchmarks/README.md."""


@pytest.fixture(autouse=True)
def no_waiting_for_disks(monkeypatch: Any) -> None:
    """A killed process leaves what it wrote; only power cuts need what waits for disks."""
    monkeypatch.setattr(os, "fsync", lambda descriptor: None)
    for module in (place, folder_module):
        monkeypatch.setattr(module, "sync_file_system", lambda folder: None)


def one_step(monkeypatch: Any) -> None:
    """Exchange in one step."""


def two_steps(monkeypatch: Any) -> None:
    """A system that cannot exchange."""
    monkeypatch.setattr(place, "exchange", lambda one, two: False)


def inside(monkeypatch: Any) -> None:
    """A target that is a mount point."""
    monkeypatch.setattr(folder_module, "holds_mounts", lambda target: True)


def refused(monkeypatch: Any) -> None:
    """A target that turns out to be one only at the end."""

    def busy(one: Path, two: Path) -> bool:
        raise OSError(errno.EBUSY, "Device or resource busy")

    monkeypatch.setattr(place, "exchange", busy)


def no_links(monkeypatch: Any) -> None:
    """A file system without second names."""
    monkeypatch.setattr(place, "link", lambda source, copy: None)


WAYS = [one_step, two_steps, inside, refused, no_links]


def kills(target: Path, monkeypatch: Any, every: int = 1) -> Iterator[int]:
    """The steps at which a second job, over an old result, is killed; prepares each."""
    for step in range(1, 2000, every):
        cases.make_job(target, "old", force=True)
        cases.add_others(target)
        armed = [False]
        commit = OutputFolder._commit

        def counted(self: OutputFolder, armed: Any = armed, commit: Any = commit) -> None:
            armed[0] = True
            commit(self)

        with monkeypatch.context() as patch:
            patch.setattr(OutputFolder, "_commit", counted)
            code = cases.killed_at(
                step, lambda: cases.make_job(target, "new"), lambda armed=armed: bool(armed[0])
            )
        yield step
        if code == 0:
            assert step > 10, "the job ended before anything was counted"
            return
        assert code == cases.KILLED
    pytest.fail("no end")


@pytest.mark.parametrize("way", WAYS)
def test_a_kill_leaves_the_old_or_the_new_folder(
    way: Callable[[Any], None], tmp_path: Path, monkeypatch: Any
) -> None:
    way(monkeypatch)
    target = tmp_path / "out"
    seen = set()
    for step in kills(target, monkeypatch, EVERY or (7 if way in (refused, no_links) else 1)):
        if way is one_step:  # whole at every moment, before anything is put right
            cases.text_of(target)
            cases.require_others(target)
        OutputFolder(target, project="roof").prepare()
        seen.add(cases.text_of(target))
        cases.require_others(target)
        assert [path.name for path in tmp_path.iterdir()] == ["out"], step
        cases.make_job(target, "third")
        assert cases.text_of(target) == "third"
        cases.require_others(target)
        assert (target / "schedule.csv").read_text() == "third"
        assert not any(path.name.startswith(".ddgfab") for path in target.iterdir())
        _remove(target)
    assert seen == {"old", "new"}


@pytest.mark.parametrize("way", [one_step, two_steps, inside])
def test_a_kill_while_the_last_kill_is_put_right(
    way: Callable[[Any], None], tmp_path: Path, monkeypatch: Any
) -> None:
    """At some steps of the commit, and then at some of the putting right."""
    way(monkeypatch)
    target = tmp_path / "out"
    for step in kills(target, monkeypatch, EVERY or 23):
        place_of = OutputFolder(target, project="roof")
        for again in range(1, 2000, EVERY or 11):
            if cases.killed_at(again, place_of.prepare, lambda: True) == 0:
                break
        place_of.prepare()
        assert cases.text_of(target) in {"old", "new"}
        cases.require_others(target)
        assert [path.name for path in tmp_path.iterdir()] == ["out"], step
        _remove(target)


@pytest.mark.parametrize("way", [one_step, inside])
def test_a_kill_of_the_first_job(
    way: Callable[[Any], None], tmp_path: Path, monkeypatch: Any
) -> None:
    """Nothing was there: afterwards there is nothing, or all."""
    way(monkeypatch)
    for step in range(1, 500):
        target = tmp_path / str(step) / "out"
        target.parent.mkdir()
        target.mkdir() if way is inside else None
        armed = lambda: True  # noqa: E731
        code = cases.killed_at(step, lambda t=target: cases.make_job(t, "new"), armed)
        if code == 0:
            assert step > 20
            break
        OutputFolder(target).prepare()
        if target.exists() and any(target.iterdir()):
            assert not (target / ".ddgfab").exists(), step
            assert cases.text_of(target) == "new"
        cases.make_job(target, "third")
        assert cases.text_of(target) == "third"
        assert [path.name for path in target.parent.iterdir()] == ["out"]


def _remove(target: Path) -> None:
    place._delete(target)
    assert not target.exists()
