"""report.html: all in one file, meshes and placements as given, safe against names."""

from __future__ import annotations

import csv
import json
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from roofs import barrel
from wholes import whole_of

from fabrication.formats.html import Html, page_data, page_html
from fabrication.formats.html.model import STEPS, css
from fabrication.formats.html.page import Subject
from fabrication.gridshell.design import Design, design
from fabrication.job.result import JobResult
from fabrication.job.run import make
from fabrication.linkage.kit import Kit
from fabrication.linkage.report import moves, steps_of
from fabrication.linkage.scene import LINK_COLORS, moving_scene

REPORT = "report.html"
OUTPUT = {"formats": ["csv", "html"]}


class Read:
    """What a page holds, taken apart by the description of its numbers."""

    def __init__(self, path: Path) -> None:
        self.text = path.read_text("utf-8")
        data = page_data(self.text)
        self.content: dict[str, Any] = json.loads(data["content"])
        numbers = self.content["numbers"]
        rest = memoryview(data["numbers"])

        def take(count: int, kind: str) -> np.ndarray:
            nonlocal rest
            size = count * np.dtype(kind).itemsize
            found = np.frombuffer(rest[:size], kind)
            rest = rest[-(-size // 4) * 4 :]
            return found

        points = take(3 * sum(n["points"] for n in numbers), "<u2").reshape(-1, 3)
        wide = bool(numbers) and numbers[0]["wide"]
        corners = take(3 * sum(n["triangles"] for n in numbers), "<u4" if wide else "<u2")
        corners = corners.reshape(-1, 3)
        self.placements = take(12 * len(self.content["pieces"]), "<f4").reshape(-1, 3, 4)
        poses = len(self.content.get("motion", {}).get("values", ()))
        self.poses = take(12 * len(self.content["pieces"]) * poses, "<f4").reshape(
            poses, len(self.content["pieces"]), 3, 4
        )
        assert not len(rest)
        self.meshes = {}
        for n in numbers:
            own, points = points[: n["points"]], points[n["points"] :]
            faces, corners = corners[: n["triangles"]], corners[n["triangles"] :]
            self.meshes[n["number"]] = (own / STEPS * n["size"] + n["low"], faces)


@pytest.fixture(scope="module")
def roof(small_job: JobResult) -> Read:
    return Read(small_job.folder / REPORT)


@pytest.fixture(scope="module")
def moving(kit_job: JobResult) -> Read:
    return Read(kit_job.folder / REPORT)


def test_the_page_is_one_file_that_asks_for_nothing(roof: Read, moving: Read) -> None:
    for page in (roof, moving):
        assert len(page.text) < 1.0e6
        assert not re.search(
            r"""<(script|link|img|iframe)[^>]*\s(src|href)=["'](?!data:|\$\{)""", page.text
        )
        assert "default-src 'none'" in page.text
        assert "SPDX-License-Identifier: MIT" in page.text
        assert "{{" not in page.text.split("<script>")[0]


def test_meshes_and_placements_are_those_of_the_parts(
    roof: Read, small_design: Design, small_job: JobResult
) -> None:
    from fabrication.formats.stl import read_stl

    folder = small_job.folder
    for number, (points, faces) in roof.meshes.items():
        mesh = read_stl(folder / f"parts/stl/{number}.stl")
        a, b = (
            np.sort(p[f].reshape(-1, 9), axis=0)
            for p, f in ((points, faces), (mesh.vertices, mesh.triangles))
        )
        size = np.ptp(mesh.vertices, axis=0).max()
        assert np.abs(a - b).max() < 2 * size / STEPS + 1e-3
    given = {i.mark: i.placement[:3] for f in small_design.families for i in f.instances}
    assert [mark for mark, _, _ in roof.content["pieces"]] == list(given)
    assert np.abs(roof.placements - np.array(list(given.values()))).max() < 2e-3


def test_checks_and_rows_are_those_of_manifest_and_schedules(
    roof: Read, small_job: JobResult
) -> None:
    marks = [mark for mark, _, _ in roof.content["pieces"]]
    names = roof.content["checks"]["names"]
    found = {
        mark: [(names[c[0]], bool(c[1])) for c in own]
        for mark, own in zip(marks, roof.content["checks"]["rows"], strict=True)
    }
    manifest = json.loads((small_job.folder / "manifest.json").read_text("utf-8"))
    for part in manifest["parts"]:
        assert found[part["mark"]]
        assert all(passed for _, passed in found[part["mark"]])
    assert {"torsion_deg", "lean_deg", "planarity_percent", "clearance"} <= set(names)
    for table in roof.content["tables"]:
        with (small_job.folder / f"schedules/{table['name']}.csv").open(encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        assert len(rows) == len(table["rows"])
        assert set(rows[0]) == {column["name"] for column in table["columns"]}
        if "mark" in rows[0]:
            chosen = [[marks[k] for k in own] for own in table["pieces"]]
            assert chosen == [[row["mark"]] for row in rows]


def test_files_of_a_part_are_there(roof: Read, small_job: JobResult) -> None:
    for number in roof.content["numbers"]:
        assert len(number["files"]) == 2
        for name in number["files"]:
            assert (small_job.folder / name).is_file()
            assert number["number"] in name


def test_rings_hold_every_piece_once(roof: Read) -> None:
    pieces = [k for step in roof.content["steps"] for k in step["pieces"]]
    assert sorted(pieces) == list(range(len(roof.content["pieces"])))


def test_problems_are_told_and_what_fails_is_marked(tmp_path: Path) -> None:
    # No pane of a roof has corners of 91 degrees all round.
    made = design(barrel(), output=OUTPUT, checks={"verify": "none", "min_angle_deg": 91})
    result = make(made, tmp_path / "out", anyway=True)
    assert result.exit_code == 1
    page = Read(tmp_path / "out" / REPORT)
    assert page.text.count('<li class="bad">FAILED ') == len(result.problems) > 0
    failed = {mark for mark, _, bad in page.content["pieces"] if bad}
    assert failed == set(result.manifest["rejected"])
    assert f"{len(failed)} pieces rejected" in page.text


def test_names_are_text_wherever_they_stand(tmp_path: Path) -> None:
    evil = "</script><script>alert(1)</script>&<b>'\""
    made = design(
        barrel(), output=OUTPUT, checks={"verify": "none"}, project={"name": "x", "title": evil}
    )
    make(made, tmp_path / "out")
    text = (tmp_path / "out" / REPORT).read_text("utf-8")
    assert "alert(1)" in text
    assert evil not in text
    assert "<b>" not in text.split("<script>")[0]


def test_a_kit_moves_as_its_mechanism_does(moving: Read, bennett: Kit) -> None:
    scene = moving_scene(bennett)
    motion = moving.content["motion"]
    assert motion["design"] == scene.design
    assert motion["values"] == pytest.approx(scene.values_deg, abs=1e-4)
    marks = [mark for mark, _, _ in moving.content["pieces"]]
    for n, piece in enumerate(scene.pieces):
        found = moving.poses[:, marks.index(piece.mark)]
        assert np.abs(found - scene.motions[:, n, :3]).max() < 1e-4
    # In the design pose the pieces stand where the rest of the page has them.
    assert np.abs(moving.poses[motion["design"]] - moving.placements).max() < 1e-4
    links = [n for n in moving.content["numbers"] if n["number"].startswith("LP")]
    assert [n["color"] for n in links] == [css(color) for color in LINK_COLORS[: len(links)]]


def test_a_kit_says_how_far_it_moves_and_which_way_links_go(bennett: Kit) -> None:
    assert moves(bennett) == "It moves freely through 155 degrees, from 6 to 161."
    steps = steps_of(bennett.linkage)
    assert [step.marks[0] for step in steps] == [
        row["part"] for row in bennett.schedules["assembly"]
    ]
    ends = {row["mark"]: row["label_towards"] for row in bennett.schedules["links"]}
    told = [step.title for step in steps if "link " in step.title]
    assert len(told) == 2 * len(bennett.linkage.links)
    for step in steps:
        mark, pin = step.marks[0], step.group.removeprefix("pin ")
        if mark in ends:
            here = ends[mark] == pin
            assert ("this end is the one that the label reads towards" in step.title) == here
            assert here or step.title.endswith(f"towards {ends[mark]}")


def test_the_same_result_is_the_same_page(
    small_job: JobResult, small_design: Design, tmp_path: Path
) -> None:
    again = make(small_design, tmp_path / "again")
    assert (again.folder / REPORT).read_bytes() == (small_job.folder / REPORT).read_bytes()


@pytest.mark.parametrize("lost", ["a piece", "a row", "a problem"])
def test_a_page_on_which_something_is_missing_fails(
    small_design: Design, tmp_path: Path, lost: str
) -> None:
    whole = replace(whole_of(small_design), tables={"bom": [{"number": "BP-001"}]}, problems=("x",))
    (tmp_path / REPORT).write_text(page_html(whole, Subject(), tmp_path), "utf-8")
    assert all(check.passed for check in Html().check_whole(tmp_path, whole))
    fewer = {
        "a piece": replace(whole, shown=whole.shown[1:]),
        "a row": replace(whole, tables={"bom": []}),
        "a problem": replace(whole, problems=()),
    }[lost]
    (tmp_path / REPORT).write_text(page_html(fewer, Subject(), tmp_path), "utf-8")
    assert [check.passed for check in Html().check_whole(tmp_path, whole)].count(False) == 1


def test_the_preview_of_a_kit_has_the_colors_of_its_page(bennett: Kit) -> None:
    from fabrication.pictures.closeup import placed
    from fabrication.solids import mesh_of

    product = bennett.product()
    meshes = {f.number: mesh_of(f.shape, 0.5) for f in product.shown}
    pieces = placed(product.shown, meshes, frozenset(), product.colors)
    links = [piece.kind.shown for piece in pieces if piece.kind.role == "link"]
    assert links == [LINK_COLORS[0], LINK_COLORS[0], LINK_COLORS[1], LINK_COLORS[1]]
