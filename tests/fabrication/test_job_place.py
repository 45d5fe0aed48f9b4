"""What a killed job left is put right; names, rights and arguments at the edges of a job."""

from __future__ import annotations

import os
import stat
from pathlib import Path
from typing import Any

import folder_cases as cases
import pytest
from roofs import barrel

from ddgfab.errors import OutputError
from fabrication.formats import registry
from fabrication.formats.base import Header, Provenance, Whole
from fabrication.gridshell.design import design
from fabrication.job import exchange as exchange_module
from fabrication.job import place, run
from fabrication.job import whole as whole_module
from fabrication.job.manifest import faults
from fabrication.job.others import WORK
from fabrication.job.steps import _batches


def test_a_result_that_was_moved_away_comes_back(tmp_path: Path) -> None:
    """A kill between the two renames of an exchange: the target is gone, its files are beside."""
    target, work = tmp_path / "out", tmp_path / ".work"
    cases.fill(work / "old-1", "old")
    notes = place.recover(target, work)
    assert faults(target) is None
    assert cases.text_of(target) == "old"
    assert len(notes) == 1
    assert "in place again" in notes[0]


def test_results_inside_a_mount_point_are_not_put_in_its_place(tmp_path: Path) -> None:
    """There no result is ever renamed, so one in the working folder is the copy of a broken job."""
    target = tmp_path / "out"
    cases.fill(target, "current")
    cases.fill(target / WORK / "new-1", "half")
    assert place.recover(target, target / WORK) == []
    assert cases.text_of(target) == "current"
    assert list((target / WORK).iterdir()) == []


@pytest.mark.parametrize("name", ["-first.txt", ".a", WORK + "x", "zz.txt"])
def test_files_of_others_stay_whatever_they_are_called(tmp_path: Path, name: str) -> None:
    """Also those whose names sort before or after that of the working folder."""
    target = tmp_path / "out"
    cases.make_job(target, "old")
    (target / name).write_text("mine")
    cases.make_job(target, "new")
    assert cases.text_of(target) == "new"
    assert (target / name).read_text() == "mine"


def test_folders_without_rights_are_opened_before_they_are_deleted(
    tmp_path: Path, monkeypatch: Any
) -> None:
    """Asked as another user than root: only folders that can be written and entered are left."""

    def access(path: Path, mode: int) -> bool:
        return (stat.S_IMODE(path.stat().st_mode) >> 6) & mode == mode

    modes = {"open": 0o700, "read": 0o500, "write": 0o200, "enter": 0o100}
    for name, mode in modes.items():
        (tmp_path / "gone" / name).mkdir(parents=True)
        (tmp_path / "gone" / name).chmod(mode)
    found: dict[str, int] = {}

    def looked_at(folder: Path, **_: Any) -> None:
        found.update({p.name: stat.S_IMODE(p.stat().st_mode) for p in folder.iterdir()})

    monkeypatch.setattr(os, "access", access)
    monkeypatch.setattr(place.shutil, "rmtree", looked_at)
    place._delete(tmp_path / "gone")
    assert found == dict.fromkeys(modes, 0o700)


def test_a_folder_without_a_name_is_refused() -> None:
    with pytest.raises(OutputError, match="the folder has no name"):
        run.target_for("roof", "")
    assert run.target_for("roof", "x") == Path("x")
    assert run.target_for("roof").parent == Path("outputs")


@pytest.mark.parametrize("verify", ["all", "sample", "none"])
def test_what_reads_files_back_is_asked_for_unless_nothing_is_verified(
    verify: str, monkeypatch: Any, tmp_path: Path
) -> None:
    class Asked(Exception):
        pass

    def missing(formats: Any, checked: bool) -> None:
        raise Asked(checked)

    monkeypatch.setattr(registry, "missing", missing)
    made = design(barrel(2, 2), checks={"verify": verify}, output={"formats": ["csv"]})
    with pytest.raises(Asked) as caught:
        run.make(made, tmp_path / "out")
    assert caught.value.args == (verify != "none",)


@pytest.mark.parametrize("count", [0, 1, 2, 63, 64, 65, 1000])
def test_batches_have_all_items_in_order_and_are_no_larger_than_need_be(count: int) -> None:
    batches = _batches(range(count))
    assert [item for batch in batches for item in batch] == list(range(count))
    assert all(batches)
    sizes = {len(batch) for batch in batches[:-1]}
    assert len(sizes) <= 1


def test_seconds_of_the_preview_are_those_it_took(tmp_path: Path, monkeypatch: Any) -> None:
    monkeypatch.setattr(whole_module, "write_preview", lambda *_: None)
    whole = Whole(Provenance("roof", Header("", "", "roof"), {}), {}, (), ())
    warnings, checks, seconds = whole_module.draw(tmp_path, whole)
    assert (warnings, checks) == ([], [])
    assert 0.0 <= seconds["preview"] < 5.0  # not the time of the clock


def test_mounts_below_a_folder_are_found_in_the_list_of_the_system(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A bind mount of the same disk shows nowhere else; spaces stand there as octal numbers."""
    folder = tmp_path / "my out"
    inside = str(folder / "parts").replace(" ", "\\040")
    mounts = tmp_path / "mountinfo"
    monkeypatch.setattr(exchange_module, "_MOUNTS", mounts)
    mounts.write_text(f"36 35 98:0 /a {inside} rw - ext4 /dev/a rw\n")
    assert exchange_module.holds_mounts(folder)
    assert not exchange_module.holds_mounts(tmp_path / "my")
    mounts.unlink()
    assert not exchange_module.holds_mounts(folder)
