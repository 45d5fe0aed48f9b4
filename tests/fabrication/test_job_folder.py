"""The output folder: whole or not at all; only ours are replaced; and the manifest in it."""

from __future__ import annotations

import errno
import json
import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ddgfab.errors import InputError, OutputError
from ddgfab.io.atomic import atomic_write
from fabrication.job.folder import OutputFolder
from fabrication.job.manifest import (
    build_manifest,
    file_records,
    part_record,
    read_manifest,
    write_manifest,
    write_run,
)
from fabrication.specs import Check


def manifest(**changes: Any) -> dict[str, Any]:
    part = part_record(
        mark="B-0000",
        number="BP-001",
        role="beam",
        placement=-np.zeros((4, 4)),
        volume_mm3=1.5,
        mass_kg=0.25,
        bbox_mm=np.array([[0, 0, 0], [1, 2, 3]]),
        checks=[Check("solid valid", True), Check("clearance", False, np.float64(-0.1), 0.5)],
    )
    content: dict[str, Any] = {
        "project": "roof",
        "facts": {
            "input": {"file": "a.obj"},
            "settings": {},
            "net": {"worst": np.array([1, 2]), "bad": float("nan")},
            "support": {"kind": "normal", "torsion_deg_max": 1e-9},
        },
        "parts": [part],
        "files": [],
    }
    return build_manifest(**(content | changes))


def fill(folder: Path, text: str = "new") -> None:
    (folder / "parts").mkdir()
    (folder / "parts" / "a.step").write_text(text)
    write_manifest(folder / "manifest.json", manifest(files=file_records(folder)))


def stop(folder: Path, error: type[BaseException]) -> None:
    fill(folder)
    raise error


def test_a_folder_appears_whole_and_nothing_else_remains(tmp_path: Path) -> None:
    target = tmp_path / "deep" / "out"
    with OutputFolder(target) as folder:
        fill(folder)
        assert not target.exists()
    assert (target / "parts" / "a.step").read_text() == "new"
    assert [p.name for p in target.parent.iterdir()] == ["out"]


@pytest.mark.parametrize("error", [RuntimeError, KeyboardInterrupt, SystemExit])
def test_an_exception_leaves_the_old_folder_and_no_other(
    tmp_path: Path, error: type[BaseException]
) -> None:
    target = tmp_path / "out"
    with OutputFolder(target) as folder:
        fill(folder, "old")
    with pytest.raises(error), OutputFolder(target) as folder:
        stop(folder, error)
    assert (target / "parts" / "a.step").read_text() == "old"
    assert [p.name for p in tmp_path.iterdir()] == ["out"]


def test_ours_is_replaced_and_strangers_files_are_carried_over(tmp_path: Path) -> None:
    target = tmp_path / "out"
    with OutputFolder(target) as folder:
        fill(folder, "old")
        (folder / "gone.txt").write_text("listed, and not made again")
        write_manifest(folder / "manifest.json", manifest(files=file_records(folder)))
    (target / "notes").mkdir()
    (target / "notes" / "mine.txt").write_text("keep")
    with OutputFolder(target) as folder:
        fill(folder, "new")
    assert (target / "parts" / "a.step").read_text() == "new"
    assert (target / "notes" / "mine.txt").read_text() == "keep"
    assert not (target / "gone.txt").exists()
    assert [p.name for p in tmp_path.iterdir()] == ["out"]


def test_a_folder_that_is_not_ours_is_refused_before_any_work(tmp_path: Path) -> None:
    target = tmp_path / "thesis"
    target.mkdir()
    with OutputFolder(target) as folder:  # an empty one may be used
        fill(folder)
    for content in ("{}", "[]", '{"format_version": 1}', "not json"):
        (target / "manifest.json").write_text(content)
        with (
            pytest.raises(OutputError, match="not an output folder of ddgfab"),
            OutputFolder(target),
        ):
            pytest.fail("entered")
    assert (target / "parts" / "a.step").exists()
    with pytest.raises(OutputError, match="is a file"), OutputFolder(target / "manifest.json"):
        pytest.fail("entered")
    assert [p.name for p in tmp_path.iterdir()] == ["thesis"]


def test_a_job_without_a_manifest_is_not_complete(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match="left no manifest"), OutputFolder(tmp_path / "out"):
        pass
    assert list(tmp_path.iterdir()) == []


def test_a_full_disk_ends_in_one_message(tmp_path: Path) -> None:
    with (
        pytest.raises(OutputError, match="disk is full") as caught,
        OutputFolder(tmp_path / "out"),
    ):
        raise OSError(errno.ENOSPC, "No space left on device")
    assert len(str(caught.value).splitlines()) <= 3
    assert list(tmp_path.iterdir()) == []


def test_a_file_that_cannot_be_written_is_named_where_it_was_to_be(tmp_path: Path) -> None:
    """As a process of the job says it: an error with a text, about the folder it was given."""
    target = tmp_path / "out"

    def fail() -> None:
        with OutputFolder(target) as folder, atomic_write(folder / "a.csv"):
            raise OSError(errno.ENOSPC, "No space left on device")

    with pytest.raises(OutputError) as caught:
        fail()
    first, second = str(caught.value).splitlines()
    assert first.startswith(f"{target / 'a.csv'}: cannot be written: the disk is full")
    assert second == "Nothing was written."
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(os.name != "posix", reason="links need rights on Windows")
@pytest.mark.parametrize("name", ["one", "one/out"])
def test_links_in_a_circle_are_named(tmp_path: Path, name: str) -> None:
    (tmp_path / "one").symlink_to("two")
    (tmp_path / "two").symlink_to("one")
    with pytest.raises(OutputError, match="links lead in a circle"):
        OutputFolder(tmp_path / name).check()
    with pytest.raises(OutputError, match="no such place"):
        OutputFolder("a\x00b")


def test_a_parent_that_cannot_be_written_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError, match="file: is a"), OutputFolder(tmp_path / "file" / "out"):
        pytest.fail("entered")


def test_the_manifest_is_plain_json_in_a_fixed_order(tmp_path: Path) -> None:
    path = tmp_path / "manifest.json"
    write_manifest(path, manifest())
    text = path.read_text()
    assert "-0.0" not in text.replace("-0.1", "")
    back = read_manifest(path)
    assert back == json.loads(text)
    assert (back["format_version"], back["units"], back["net"]["bad"]) == (1, "mm", None)
    assert back["checks"]["passed"] == back["checks"]["failed"] == 1
    assert back["parts"][0]["checks"][1] == {
        "name": "clearance",
        "passed": False,
        "value": -0.1,
        "limit": 0.5,
    }
    assert list(back)[-1] == "versions"
    part = back["parts"][0]
    assert (part["mark"], part["volume_mm3"], part["mass_kg"]) == ("B-0000", 1.5, 0.25)
    assert part["placement"] == np.zeros((4, 4)).tolist()
    assert part["bbox_mm"] == [[0, 0, 0], [1, 2, 3]]
    with pytest.raises(InputError, match=r"none\.json"):
        read_manifest(tmp_path / "none.json")


def test_file_records_match_sha256_of_the_files(tmp_path: Path) -> None:
    (tmp_path / "b").mkdir()
    (tmp_path / "b" / "x.txt").write_text("abc")
    (tmp_path / "a.txt").write_text("")
    (tmp_path / "manifest.json").write_text("{}")
    first, second = file_records(tmp_path)
    assert (first["path"], first["bytes"]) == ("a.txt", 0)
    assert second["path"] == "b/x.txt"
    # FIPS 180-2, appendix B.1
    assert second["sha256"].startswith("ba7816bf8f01cfea414140de5dae2223")


def test_a_run_says_its_sources_and_the_longest_steps_first(tmp_path: Path) -> None:
    sources = {"input": {"file": "a.obj"}}
    write_run(tmp_path / "run.json", sources, {"parts": 2.00004, "preview": 0.5, "reading": 31.0})
    found = json.loads((tmp_path / "run.json").read_text())
    assert found["made_from"] == sources
    assert list(found["seconds"].items()) == [("reading", 31.0), ("parts", 2.0), ("preview", 0.5)]
