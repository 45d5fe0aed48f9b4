"""The whole way: complete folders, matching ids and volumes, rejected parts, no half jobs."""

from __future__ import annotations

import csv
import hashlib
import json
import os
import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from roofs import barrel

from ddgfab.errors import OutputError
from fabrication.formats.stl import read_stl
from fabrication.gridshell.design import Design, design
from fabrication.gridshell.room import CHORD_MM
from fabrication.job.result import JobResult
from fabrication.job.run import make

pytestmark = pytest.mark.slow


def manifest_of(folder: Path) -> dict:
    return json.loads((folder / "manifest.json").read_text("utf-8"))


def test_every_check_passed(small_job: JobResult) -> None:
    assert small_job.exit_code == 0, small_job.problems
    checks = manifest_of(small_job.folder)["checks"]
    assert checks["failed"] == 0
    assert checks["passed"] > 1000


def test_one_part_for_each_element(small_folder: Path, small_design: Design) -> None:
    mesh = small_design.mesh
    roles = [part["role"] for part in manifest_of(small_folder)["parts"]]
    assert roles.count("beam") == mesh.n_edges
    assert roles.count("node") == mesh.n_vertices
    assert roles.count("panel") == mesh.n_faces


def test_manifest_lists_every_file(small_folder: Path) -> None:
    listed = {record["path"]: record for record in manifest_of(small_folder)["files"]}
    found = {p.relative_to(small_folder).as_posix() for p in small_folder.rglob("*") if p.is_file()}
    assert found == set(listed) | {"manifest.json", "run.json"}
    for name, record in listed.items():
        data = (small_folder / name).read_bytes()
        assert (len(data), hashlib.sha256(data).hexdigest()) == (record["bytes"], record["sha256"])


def test_ids_match_between_schedules_manifest_and_files(small_folder: Path) -> None:
    parts = {part["mark"]: part for part in manifest_of(small_folder)["parts"]}
    rows = {}
    for name in ("panels", "beams", "nodes"):
        with (small_folder / "schedules" / f"{name}.csv").open(encoding="utf-8", newline="") as f:
            rows |= {row["mark"]: row for row in csv.DictReader(f)}
    assert rows.keys() == parts.keys()
    for mark, row in rows.items():
        assert row["number"] == parts[mark]["number"]
        assert float(row["mass_kg"]) == pytest.approx(parts[mark]["mass_kg"], abs=6e-4)
        assert (small_folder / "parts" / "step" / f"{row['number']}.step").exists()
        assert (small_folder / "parts" / "stl" / f"{row['number']}.stl").exists()


def test_volumes_agree_between_manifest_step_and_stl(small_folder: Path) -> None:
    """The sum over all pieces: manifest, STEP read by cadquery, STL within area times chord."""
    import cadquery as cq

    parts = manifest_of(small_folder)["parts"]
    total = sum(part["volume_mm3"] for part in parts)
    assembly = cq.importers.importStep(str(small_folder / "assembly.step"))
    solids = assembly.solids().vals()
    assert len(solids) == len(parts)
    assert sum(s.Volume() for s in solids) == pytest.approx(total, rel=1e-7)
    meshed = bound = 0.0
    for part in parts:
        mesh = read_stl(small_folder / "parts" / "stl" / f"{part['number']}.stl")
        a, b, c = np.moveaxis(mesh.vertices[mesh.triangles], 1, 0)
        cross = np.cross(b - a, c - a)
        meshed += np.einsum("ij,ij->", a, cross) / 6
        bound += 0.5 * np.linalg.norm(cross, axis=1).sum() * CHORD_MM
    assert meshed == pytest.approx(total, abs=bound)


def test_instances_are_shared_and_named(small_folder: Path) -> None:
    import cadquery as cq

    manifest = manifest_of(small_folder)
    marks = {part["mark"] for part in manifest["parts"]}
    assembly = cq.Assembly.importStep(str(small_folder / "assembly.step"))
    names = {name.split("/")[-1] for name in assembly.objects}
    assert marks <= names
    numbers = {part["number"] for part in manifest["parts"]}
    assert len(numbers) < len(marks) / 2  # a barrel repeats itself


def test_same_input_gives_the_same_bytes(
    small_design: Design, small_folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    again = make(design(barrel(), project={"name": "barrel"}), tmp_path / "barrel").folder
    for path in sorted(small_folder.rglob("*")):
        name = path.relative_to(small_folder)
        if path.suffix in {".csv", ".stl", ".glb"}:
            assert path.read_bytes() == (again / name).read_bytes(), name
    one, two = manifest_of(small_folder), manifest_of(again)
    assert one["parts"] == two["parts"]
    assert one["net"] == two["net"]


def test_parts_beyond_a_limit_are_rejected_not_flattened(tmp_path: Path) -> None:
    mesh = barrel()
    points = mesh.vertices.copy()
    inner = int(np.flatnonzero(~mesh.boundary_vertex)[0])
    points[inner] += 25.0 * mesh.vertex_normals[inner]
    result = make(design(mesh.with_vertices(points)), tmp_path / "bent", anyway=True)
    assert result.exit_code == 1
    manifest = manifest_of(result.folder)
    failed = {
        part["mark"]: part
        for part in manifest["parts"]
        if any(not check["passed"] for check in part["checks"])
    }
    around = {f"P-{face:04d}" for face in mesh.star(inner)[1]}
    assert around <= failed.keys()
    for mark in around:
        assert (result.folder / "rejected" / "step" / f"{failed[mark]['number']}.step").exists()
        assert any(mark in problem for problem in result.problems) or len(around) > 5
    import cadquery as cq

    assembly = cq.Assembly.importStep(str(result.folder / "assembly.step"))
    paths = {tuple(name.split("/")) for name in assembly.objects}
    assert {path[-1] for path in paths if "Rejected" in path[:-1]} >= failed.keys()
    marks = {part["mark"] for part in manifest["parts"]}
    assert not {path[-1] for path in paths if "Rejected" in path[:-1]} & (marks - failed.keys())
    assert marks <= {path[-1] for path in paths}
    for name in ("panels", "beams", "nodes"):
        with (result.folder / "schedules" / f"{name}.csv").open(encoding="utf-8", newline="") as f:
            rows = list(csv.DictReader(f))
        assert {r["mark"] for r in rows if r["status"] == "rejected"} == {
            mark for mark in failed if mark in {r["mark"] for r in rows}
        }
        assert {r["status"] for r in rows} <= {"ok", "rejected"}
    assert manifest["rejected"] == sorted(failed)
    assert f"{len(failed)} parts are rejected" in manifest["notes"][0]


def test_an_interrupted_job_leaves_nothing(small_design: Design, tmp_path: Path) -> None:
    def interrupt(step: str, done: int, of: int) -> None:
        if step == "files of the whole":
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        make(small_design, tmp_path / "out", progress=interrupt)
    assert list(tmp_path.iterdir()) == []


def test_a_foreign_folder_is_not_replaced(small_design: Design, tmp_path: Path) -> None:
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "thesis.txt").write_text("years of work")
    with pytest.raises(OutputError, match="mine"):
        make(small_design, tmp_path / "mine")
    assert (tmp_path / "mine" / "thesis.txt").read_text() == "years of work"
    assert [p.name for p in tmp_path.iterdir()] == ["mine"]


def test_our_folder_is_replaced_whole(small_design: Design, tmp_path: Path) -> None:
    first = make(small_design, tmp_path / "out")
    assert (first.folder / "model.glb").exists()
    again = design(barrel(), project={"name": "barrel"}, output={"formats": ["csv"]})
    plain = make(again, tmp_path / "out")
    assert sorted(p.stem for p in plain.folder.rglob("*.csv")) == sorted(
        [*small_design.schedules, "columns"]
    )
    assert not (plain.folder / "model.glb").exists()
    assert [p.name for p in tmp_path.iterdir()] == ["out"]


@pytest.mark.skipif(os.geteuid() != 0, reason="mounting a small disk needs root")
def test_a_full_disk_ends_in_one_message(small_design: Design, tmp_path: Path) -> None:
    disk = tmp_path / "disk"
    disk.mkdir()
    mounted = subprocess.run(
        ["mount", "-t", "tmpfs", "-o", "size=200k", "tmpfs", str(disk)], capture_output=True
    )
    if mounted.returncode:
        pytest.skip(f"cannot mount a small disk here: {mounted.stderr.decode().strip()}")
    try:
        with pytest.raises(OutputError, match="full"):
            make(small_design, disk / "out")
        assert list(disk.iterdir()) == []
    finally:
        subprocess.run(["umount", str(disk)], check=True)


@pytest.mark.skipif(shutil.which("prusa-slicer") is None, reason="prusa-slicer is not installed")
def test_prusaslicer_finds_every_stl_a_solid(small_folder: Path) -> None:
    """Manifold, one part, and the manifest's volume within what the chord tolerance gives."""
    numbers = {part["number"]: part["volume_mm3"] for part in manifest_of(small_folder)["parts"]}
    for number, volume in numbers.items():
        path = small_folder / "parts" / "stl" / f"{number}.stl"
        done = subprocess.run(
            ["prusa-slicer", "--info", str(path)], capture_output=True, text=True, check=False
        )
        found = dict(re.findall(r"^(\w+) = +(\S+)", done.stdout, flags=re.MULTILINE))
        assert found["manifold"] == "yes", (number, done.stdout)
        assert found["number_of_parts"] == "1", (number, done.stdout)
        assert float(found["volume"]) == pytest.approx(volume, rel=5e-3), number


@pytest.mark.skipif(shutil.which("admesh") is None, reason="admesh is not installed")
def test_admesh_has_nothing_to_mend(small_folder: Path) -> None:
    for path in sorted((small_folder / "parts" / "stl").glob("*.stl")):
        done = subprocess.run(
            ["admesh", str(path)], capture_output=True, text=True, errors="replace", check=False
        )
        for fault in ("degenerate facets", "Edges fixed", "Facets removed", "Facets reversed"):
            counts = re.findall(rf"{fault}\s*:\s*(\d+)", done.stdout, flags=re.IGNORECASE)
            assert counts, (fault, done.stdout)
            assert set(counts) == {"0"}, (path.name, fault, done.stdout)


def test_parts_as_3mf(tmp_path: Path) -> None:
    """Parts alone as 3MF need no kernel; lib3mf reads each back as what was made."""
    result = make(design(barrel(1, 2), output={"formats": ["3mf"]}), tmp_path / "job")
    assert result.exit_code == 0, result.problems
    numbers = {part["number"] for part in result.manifest["parts"]}
    assert {path.stem for path in (tmp_path / "job" / "parts" / "3mf").iterdir()} == numbers
    checks = {check["name"] for part in result.manifest["parts"] for check in part["checks"]}
    assert any("3mf" in name.lower() for name in checks)
