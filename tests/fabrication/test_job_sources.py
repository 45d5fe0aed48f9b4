"""One folder, one project: files of one name in two places are two, a project that moves is one."""

from __future__ import annotations

import json
import os
import shutil
from pathlib import Path
from typing import Any

import pytest
from folder_cases import fill, text_of
from roofs import barrel
from typer.testing import CliRunner

from ddgfab.io import write_obj
from fabrication import design, make
from fabrication.cli import app
from fabrication.job.folder import OtherProjectError, OutputFolder
from fabrication.job.manifest import made_from, write_run
from fabrication.job.sources import Sources


def job(target: Path, text: str, sources: Sources, force: bool = False) -> None:
    """A result made from these files, as a job writes it."""
    place = OutputFolder(target, project="roof", sources=sources, force=force)
    with place as folder:
        fill(folder, text)
        write_run(folder / "run.json", sources.record(place.target), {"detail": 0.1})


def files(folder: Path, mesh: str, project: str | None = None) -> Sources:
    """A mesh, and a project file where its text is given, in a new folder."""
    folder.mkdir(parents=True)
    (folder / "roof.obj").write_text(mesh)
    if project is None:
        return Sources(None, folder / "roof.obj")
    (folder / "roof.toml").write_text(project)
    return Sources(folder / "roof.toml", folder / "roof.obj")


@pytest.mark.parametrize("project", [None, "same text"])
def test_one_name_in_two_folders_is_two_projects(tmp_path: Path, project: str | None) -> None:
    one = files(tmp_path / "a", "one", project)
    two = files(tmp_path / "b", "two", project)
    job(tmp_path / "out", "one", one)
    with pytest.raises(OtherProjectError) as caught:
        OutputFolder(tmp_path / "out", project="roof", sources=two).check()
    named = "roof.obj" if project is None else "roof.toml"
    for word in (tmp_path / "a" / named, tmp_path / "b" / named, "project.name", "force"):
        assert str(word) in str(caught.value)
    job(tmp_path / "out", "edited", files(tmp_path / "c", "one", project))  # a copy
    assert text_of(tmp_path / "out") == "edited"
    with pytest.raises(OtherProjectError):
        job(tmp_path / "out", "two", two)
    job(tmp_path / "out", "two", two, force=True)
    assert text_of(tmp_path / "out") == "two"


@pytest.mark.parametrize("project", [None, "text"])
def test_an_edited_project_is_the_same(tmp_path: Path, project: str | None) -> None:
    sources = files(tmp_path / "a", "one", project)
    job(tmp_path / "out", "one", sources)
    for path in filter(None, (sources.project, sources.input)):
        path.write_text("edited")
    job(tmp_path / "out", "edited", sources)
    assert text_of(tmp_path / "out") == "edited"


@pytest.mark.parametrize("project", [None, "text"])
@pytest.mark.parametrize("edited", [False, True])
def test_a_moved_folder_is_the_same_project(
    tmp_path: Path, project: str | None, edited: bool
) -> None:
    """With its outputs or, unedited, without."""
    sources = files(tmp_path / "here" / "a", "one", project)
    job(tmp_path / "here" / "outputs" / "roof", "one", sources)
    (tmp_path / "here").rename(tmp_path / "there")
    moved = tmp_path / "there" / "a"
    if edited:
        (moved / "roof.obj").write_text("edited")
    there = Sources(project and moved / "roof.toml", moved / "roof.obj")
    job(tmp_path / "there" / "outputs" / "roof", "two", there)
    assert text_of(tmp_path / "there" / "outputs" / "roof") == "two"
    (tmp_path / "there" / "outputs" / "roof").rename(tmp_path / "roof")
    place = OutputFolder(tmp_path / "roof", project="roof", sources=there)
    place.check()  # only the result moved: known by its content
    (moved / "roof.obj").write_text("edited once more")
    with pytest.raises(OtherProjectError):
        place.check()


def test_a_project_file_made_later_for_a_mesh_is_the_same_project(tmp_path: Path) -> None:
    sources = files(tmp_path / "a", "one", "text")
    job(tmp_path / "out", "one", Sources(None, sources.input))
    job(tmp_path / "out", "two", sources)
    job(tmp_path / "out", "three", Sources(None, sources.input))
    assert text_of(tmp_path / "out") == "three"
    second = files(tmp_path / "b", "one", "other text")
    job(tmp_path / "out", "four", sources)
    with pytest.raises(OtherProjectError):  # variants of one mesh, by project files
        job(tmp_path / "out", "five", second)


def test_what_has_no_file_goes_by_its_name(tmp_path: Path) -> None:
    job(tmp_path / "out", "one", Sources())
    job(tmp_path / "out", "two", Sources())
    with pytest.raises(OtherProjectError, match="made from no file"):
        job(tmp_path / "out", "three", files(tmp_path / "a", "one"))
    job(tmp_path / "out", "four", files(tmp_path / "b", "one"), force=True)
    with pytest.raises(OtherProjectError, match="this is made from no file"):
        job(tmp_path / "out", "five", Sources())


@pytest.mark.parametrize(
    "text",
    [
        "",
        "[]",
        "[" * 100_000,
        '{"made_from": 5}',
        '{"made_from": {"input": {"file": "\\u0000"}}}',
        '{"made_from": {"input": {"file": 5}, "project": []}}',
        '{"made_from": {"input": {"file": "../a/roof.obj", "sha256": 9}}}',
        "\ud800",
    ],
)
def test_a_record_that_is_damaged_is_never_in_the_way_of_force(tmp_path: Path, text: str) -> None:
    sources = files(tmp_path / "a", "one")
    job(tmp_path / "out", "one", sources)
    (tmp_path / "out" / "run.json").write_bytes(text.encode("utf-8", "surrogatepass"))
    try:
        job(tmp_path / "out", "two", sources)
    except OtherProjectError:
        job(tmp_path / "out", "two", sources, force=True)
    assert text_of(tmp_path / "out") == "two"


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no pipes here")
def test_a_pipe_is_not_waited_for(tmp_path: Path) -> None:
    job(tmp_path / "out", "one", files(tmp_path / "a", "one"))
    os.mkfifo(tmp_path / "roof.obj")
    with pytest.raises(OtherProjectError):
        OutputFolder(
            tmp_path / "out", project="roof", sources=Sources(None, tmp_path / "roof.obj")
        ).check()


@pytest.mark.slow
def test_by_command_and_from_python(tmp_path: Path, monkeypatch: Any) -> None:
    """Meshes of one name, by paths from other folders, and after the project has moved."""
    (tmp_path / "work" / "a").mkdir(parents=True)
    (tmp_path / "work" / "b").mkdir()
    write_obj(tmp_path / "work" / "a" / "roof.obj", barrel(1, 2))
    write_obj(tmp_path / "work" / "b" / "roof.obj", barrel(2, 1))
    words = ["--formats", "csv", "--verify", "none", "--jobs", "1", "-q"]

    def made(*arguments: str) -> Any:
        return CliRunner().invoke(app, ["make", *arguments, *words])

    monkeypatch.chdir(tmp_path / "work")
    assert made("a/roof.obj").exit_code == 0
    refused = made("b/roof.obj")
    assert refused.exit_code == 2
    assert "made from a/roof.obj; this is made from b/roof.obj" in refused.output
    assert "--set project.name=" in refused.output
    assert made("b/roof.obj", "--dry-run").exit_code == 2
    assert made("b/roof.obj", "--set", "project.name=other").exit_code == 0
    shutil.move(tmp_path / "work", tmp_path / "moved")
    monkeypatch.chdir(tmp_path / "moved" / "a")
    assert made("roof.obj", "-o", "../outputs/roof").exit_code == 0
    with pytest.raises(OtherProjectError):
        make(design("../b/roof.obj", output={"formats": ["csv"]}), "../outputs/roof")
    record = made_from(tmp_path / "moved" / "outputs" / "roof")
    assert record is not None
    assert record["input"]["file"] == "../../a/roof.obj"
    assert str(tmp_path) not in json.dumps(record)


@pytest.mark.skipif(os.name == "nt", reason="file names are Unicode there")
def test_a_name_that_is_not_utf_8_is_a_record_too(tmp_path: Path) -> None:
    name = os.fsdecode(b"r\xe9of.obj")
    for place in ("a", "b"):
        (tmp_path / place).mkdir()
        try:
            (tmp_path / place / name).write_text(place)
        except OSError:
            pytest.skip("this file system takes UTF-8 names only")
    job(tmp_path / "out", "one", Sources(None, tmp_path / "a" / name))
    json.loads((tmp_path / "out" / "run.json").read_bytes())
    with pytest.raises(OtherProjectError):
        job(tmp_path / "out", "two", Sources(None, tmp_path / "b" / name))


@pytest.mark.parametrize("change", [Path.unlink, lambda path: path.write_text("half a mesh")])
def test_an_input_that_changes_while_the_job_runs_is_noted(change: Any, tmp_path: Path) -> None:
    mesh, target = tmp_path / "roof.obj", tmp_path / "out"
    write_obj(mesh, barrel(1, 2))
    made = design(mesh, output={"formats": ["csv"]}, checks={"verify": "none"})
    record = made.product().sources.record(target)

    def progress(step: str, done: int, of: int) -> None:
        if step == "clearances":
            change(mesh)

    result = make(made, target, progress=progress)
    assert [n for n in result.manifest["notes"] if "roof.obj was changed while the job ran" in n]
    assert made_from(target) == record
    write_obj(mesh, barrel(1, 2))
    again = make(design(mesh, output={"formats": ["csv"]}, checks={"verify": "none"}), target)
    assert not [note for note in again.manifest["notes"] if "was changed" in note]
