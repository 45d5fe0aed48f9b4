"""A format defined in this file alone: written, read back and checked by whole jobs of both
products, listed in the manifest, and opened by `ddgfab check`.
"""

from __future__ import annotations

import csv
import hashlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final

import numpy as np
import pytest
from roofs import barrel

from ddgfab.errors import InputError, ProjectError
from fabrication.formats import registry
from fabrication.formats.base import Format, Part, Provenance, Whole
from fabrication.formats.report import FileReport, inspect_file
from fabrication.formats.solids import mesh_report
from fabrication.gridshell.design import Design, design
from fabrication.gridshell.load import make_project
from fabrication.job.result import JobResult
from fabrication.job.run import make
from fabrication.linkage.kit import kit
from fabrication.specs import Check, TriangleMesh

INDEX: Final = "index.tri"


class Triangles(Format):
    """TRI: a line a triangle, nine numbers; the whole as a line a piece."""

    name = "tri"
    suffixes = (".tri",)
    parts = True
    libraries = ("pytest",)
    options = {"comment": ("#", "%")}  # noqa: RUF012
    spoilt: str | None = None  # part number whose file is written without its last triangle

    def write_part(self, path: Path, part: Part, about: Provenance) -> None:
        corners = part.mesh.vertices[part.mesh.triangles].reshape(-1, 9)
        if part.number == self.spoilt:
            corners = corners[:-1]
        lines = [" ".join(map(repr, row)) for row in corners.tolist()]
        path.write_text(
            "\n".join([f"{self.option(about, 'comment')} {part.number}", *lines, ""]), "utf-8"
        )

    def check_part(self, path: Path, part: Part) -> list[Check]:
        wanted = part.mesh.vertices[part.mesh.triangles]
        found = np.loadtxt(path, comments=self.options["comment"]).reshape(-1, 3, 3)
        same = found.shape == wanted.shape and bool((found == wanted).all())
        return [Check("tri corners", same, float(len(found)), float(len(wanted)))]

    def write_whole(self, folder: Path, whole: Whole) -> list[str]:
        lines = [f"{mark} {number}" for number, mark, _ in whole.passed()]
        (folder / INDEX).write_text("\n".join([*lines, ""]), "utf-8")
        return []

    def check_whole(self, folder: Path, whole: Whole) -> list[Check]:
        found = len((folder / INDEX).read_text("utf-8").splitlines())
        wanted = len(list(whole.passed()))
        return [Check("tri pieces", found == wanted, float(found), float(wanted))]

    def inspect(self, path: Path) -> FileReport:
        corners = np.loadtxt(path, comments=self.options["comment"]).reshape(-1, 3)
        points, inverse = np.unique(corners, axis=0, return_inverse=True)
        mesh = TriangleMesh(points, inverse.reshape(-1, 3))
        return mesh_report(path, "TRI", "mm", [("", 1, mesh)])


@pytest.fixture
def tri() -> Iterator[Triangles]:
    format = Triangles()
    registry.register(format)
    yield format
    registry.unregister("tri")


def check_result(result: JobResult) -> None:
    """Exit code 0, and all traces of the format in folder and manifest."""
    assert result.exit_code == 0, result.problems
    manifest = result.manifest
    numbers = {part["number"] for part in manifest["parts"]}
    listed = {record["path"]: record["sha256"] for record in manifest["files"]}
    assert {p for p in listed if p.endswith(".tri")} == {
        INDEX,
        *(f"parts/tri/{number}.tri" for number in numbers),
    }
    for name in listed:
        data = (result.folder / name).read_bytes()
        assert hashlib.sha256(data).hexdigest() == listed[name]
    for part in manifest["parts"]:
        assert [c["passed"] for c in part["checks"] if c["name"] == "tri corners"] == [True]
    assert [c["passed"] for c in manifest["checks"]["job"] if c["name"] == "tri pieces"] == [True]
    assert manifest["versions"]["pytest"] == pytest.__version__
    report = inspect_file(next((result.folder / "parts" / "tri").glob("*.tri")))
    assert report.passed, report.problems
    assert report.format == "TRI"


@pytest.mark.slow
def test_a_gridshell(tri: Triangles, tmp_path: Path) -> None:
    options = {"tri": {"comment": "%"}}
    made = design(barrel(1, 2), output={"formats": ["tri", "csv"], "options": options})
    check_result(make(made, tmp_path / "roof"))
    files = list((tmp_path / "roof" / "parts" / "tri").iterdir())
    assert all(path.read_text("utf-8").startswith("% ") for path in files)


@pytest.mark.slow
def test_a_kit(tri: Triangles, tmp_path: Path) -> None:
    made = kit("bennett", output={"formats": ["tri", "csv"]})
    check_result(make(made, tmp_path / "kit"))


def spoilt_job(made: Any, tri: Triangles, number: str, folder: Path) -> JobResult:
    """A job in which the file of one part number does not agree with its part."""
    tri.spoilt = number
    result = make(made, folder)
    assert result.exit_code == 1
    assert not (folder / "parts" / "tri" / f"{number}.tri").exists()
    assert (folder / "rejected" / "tri" / f"{number}.tri").exists()
    return result


@pytest.mark.slow
def test_what_reading_back_finds_changes_the_files_of_the_whole(
    tri: Triangles, tmp_path: Path
) -> None:
    """They were written when every piece had passed so far, so they must be written again."""
    made = design(barrel(1, 2), output={"formats": ["tri", "step", "csv"]})
    result = spoilt_job(made, tri, "PP-001", tmp_path / "roof")
    bad = {p["mark"] for p in result.manifest["parts"] if p["number"] == "PP-001"}
    good = {p["mark"] for p in result.manifest["parts"]} - bad
    index = [line.split()[0] for line in (result.folder / INDEX).read_text("utf-8").splitlines()]
    assert sorted(index) == sorted(good)
    from fabrication.formats.step.read import read_step

    content = read_step(result.folder / "assembly.step")
    assert sorted(name for _, name, _ in content.instances) == sorted(good | bad)
    assert {mark for mark, names in content.layers.items() if names == {"REJECTED"}} == bad
    whole = {c["name"]: c["value"] for c in result.manifest["checks"]["job"]}
    assert whole["assembly rejected"] == len(bad)  # of the second assembly, not of the first
    with (result.folder / "schedules" / "panels.csv").open(encoding="utf-8", newline="") as file:
        status = {row["mark"]: row["status"] for row in csv.DictReader(file)}
    assert status == {mark: "rejected" if mark in bad else "ok" for mark in status}
    assert set(status) >= bad
    assert len(result.problems) == 1
    assert result.problems[0].startswith("tri corners: 2 panels (limit ")


@pytest.mark.slow
def test_a_rejected_part_of_a_kit_is_on_no_plate(tri: Triangles, tmp_path: Path) -> None:
    from fabrication.formats.threemf import read_threemf

    made = kit("bennett", output={"formats": ["tri", "3mf"]})
    result = spoilt_job(made, tri, "LP-001", tmp_path / "kit")
    assert (result.folder / "rejected" / "3mf" / "LP-001.3mf").exists()
    plates = sorted((result.folder / "plates").iterdir())
    bodies = [body for plate in plates for body in read_threemf(plate).bodies]
    printed = {part.number for part in made.printed}
    assert "LP-001" in printed
    assert {body.name for body in bodies} == printed - {"LP-001"}


def test_a_new_format_does_not_change_what_is_written_by_default(tri: Triangles) -> None:
    """It says itself for which products it is written where a project names no formats."""
    before = {
        False: ("step", "stl", "glb", "csv", "xlsx", "html"),
        True: ("step", "stl", "3mf", "glb", "csv", "xlsx", "html"),
    }
    assert "tri" in registry.names()
    for printed, formats in before.items():
        assert registry.defaults(printed=printed) == formats
    assert make_project({}).output.formats == before[False]
    tri.by_default = "printed"  # type: ignore[misc]
    assert registry.defaults(printed=False) == before[False]
    assert registry.defaults(printed=True) == (*before[True], "tri")
    tri.by_default = "always"  # type: ignore[misc]
    assert make_project({}).output.formats == (*before[False], "tri")


def test_unknown_and_missing_formats_are_named() -> None:
    with pytest.raises(ProjectError, match=r'format "tri" is unknown; known: step'):
        make_project({"output": {"formats": ["tri"]}})
    with pytest.raises(ProjectError, match=r'"gif" is unknown'):
        make_project({"output": {"formats": ["gif"]}})  # of linkages alone


def test_a_package_that_a_format_needs(
    small_design: Design, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Needy(Triangles):
        name = "needy"
        needs = {"no_such_module": "no-such-package"}  # noqa: RUF012

    registry.register(Needy())
    try:
        made = design(barrel(1, 2), output={"formats": ["needy"]})
        with pytest.raises(InputError, match="pip install no-such-package"):
            make(made, tmp_path / "roof")
    finally:
        registry.unregister("needy")
    assert list(tmp_path.iterdir()) == []
