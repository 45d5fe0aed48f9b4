"""`--dry-run`: the files and parts that a job then has, its exit code, and nothing written."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from roofs import barrel
from typer.testing import CliRunner

from ddgfab.io import write_obj
from ddgfab.mesh import Mesh
from fabrication import kit
from fabrication.cli import app
from fabrication.gridshell.design import design
from fabrication.job.plan import plan_job
from fabrication.job.result import JobResult

ROOT = Path(__file__).resolve().parents[2]


def run(*words: object) -> tuple[int, str]:
    result = CliRunner().invoke(app, [str(word) for word in words])
    return result.exit_code, result.output


@pytest.fixture
def roof(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    write_obj(tmp_path / "roof.obj", barrel())
    return tmp_path


def test_a_plan_names_the_files_and_parts_of_the_job(small_job: JobResult, tmp_path: Path) -> None:
    plan = plan_job(design(barrel(), project={"name": "barrel"}).product(), tmp_path / "out")
    manifest = small_job.manifest
    assert set(plan.files) == {record["path"] for record in manifest["files"]}
    assert plan.pieces == len(manifest["parts"])
    assert plan.numbers == len({part["number"] for part in manifest["parts"]})
    assert plan.problems == ()
    assert not plan.replaces
    again = plan_job(design(barrel(), project={"name": "barrel"}).product(), small_job.folder)
    assert again.replaces
    assert not (tmp_path / "out").exists()


@pytest.mark.slow
def test_a_plan_names_the_files_of_a_kit(tmp_path: Path) -> None:
    made = kit("bennett", motion={"poses": 5})
    from fabrication import make

    result = make(made, tmp_path / "kit")
    plan = plan_job(made.product(), tmp_path / "again")
    assert set(plan.files) == {record["path"] for record in result.manifest["files"]}
    assert plan.pieces == len(result.manifest["parts"])


def test_an_optimized_net_has_its_picture(roof: Path) -> None:
    plan = plan_job(design(roof / "roof.obj", optimize={"goal": "planar"}).product())
    assert "optimized.png" in plan.files
    assert plan.folder == Path("outputs/roof")


def test_the_command_writes_nothing_and_counts(roof: Path) -> None:
    code, said = run("make", "roof.obj", "-o", "out", "--dry-run", "--formats", "step,csv")
    assert code == 0, said
    numbers = re.search(r"^(\d+) parts of (\d+) part numbers$", said, re.MULTILINE)
    assert numbers is not None
    assert f"parts/step/: {numbers[2]} files: BP-001.step to PP-" in said
    plan = plan_job(design(roof / "roof.obj", output={"formats": ["step", "csv"]}).product())
    assert len([path for path in plan.files if path.startswith("parts/")]) == int(numbers[2])
    assert f"dry run: {len(plan.files)} files would be written to out" in said
    assert [path.name for path in roof.iterdir()] == ["roof.obj"]


def test_a_plan_says_the_notes_of_the_job(roof: Path) -> None:
    """Glass below the beams and a profile that lies flat are no surprise of the job itself."""
    mesh = barrel()
    turned = [face[::-1].tolist() for face in mesh.faces]
    write_obj(roof / "down.obj", Mesh.build(mesh.vertices, turned))
    code, text = run("make", "down.obj", "--dry-run", "--set", "beam.profile=RHS 60x120x5")
    assert code == 0
    assert "note: its faces look down" in text
    notes = design("down.obj", beam={"profile": "RHS 60x120x5"}).product().notes
    assert len(notes) > 1
    assert all(f"note: {note}" in text for note in notes)


def test_exit_codes_are_those_of_the_job(roof: Path) -> None:
    tight = ["--dry-run", "--set", "checks.min_angle_deg=100"]
    code, said = run("make", "roof.obj", *tight)
    assert code == 2
    assert "nothing was made" in said
    code, said = run("make", "roof.obj", *tight, "--anyway")
    assert code == 1
    assert "FAILED least angle" in said
    assert run("make", "roof.obj", "--dry-run", "--formats", "dwg")[0] == 2
    (roof / "full").mkdir()
    (roof / "full" / "thesis.txt").write_text("x")
    for place in ("full", "roof.obj", "roof.obj/out", "/"):
        code, said = run("make", "roof.obj", "-o", place, "--dry-run")
        assert code == 2, place
        assert "fault" not in said
        again = run("make", "roof.obj", "-o", place, "--formats", "csv", "--jobs", 1)
        assert again[0] == 2, place
    assert sorted(path.name for path in roof.iterdir()) == ["full", "roof.obj"]


def test_a_linkage_too(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    code, said = run("linkage", "--dry-run", "--formats", "stl,3mf")
    assert code == 0, said
    assert "free range: " in said
    assert "plates/: 2 files: plate_1.3mf, plate_2.3mf" in said
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("command", ["make", "linkage"])
def test_no_kernel_and_no_process(command: str, tmp_path: Path) -> None:
    program = f"""
import json, sys
from multiprocessing import active_children
from fabrication.cli import app
try:
    app([{command!r}, "--dry-run", "-q", "--jobs", "2"])
except SystemExit as done:
    heavy = ("OCP", "build123d", "cadquery", "pyvista", "vtkmodules")
    found = [name for name in heavy if name in sys.modules]
    print(json.dumps([done.code, found, len(active_children())]))
"""
    done = subprocess.run(
        [sys.executable, "-c", program],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        env={"PYTHONPATH": str(ROOT)},
        check=False,
    )
    assert json.loads(done.stdout.splitlines()[-1]) == [0, [], 0], done.stderr
    assert list(tmp_path.iterdir()) == []


def test_more_cells_have_smaller_twists() -> None:
    """The README shows 5 x 5; the twists that fit 3 x 3 make larger nets meet themselves."""
    from fabrication.linkage.kinds import KNetLinkage

    assert KNetLinkage().twists_deg == (20, 20)
    assert KNetLinkage(cells=(2, 3)).twists_deg == (20, 20)
    assert KNetLinkage(cells=(5, 5)).twists_deg == (12, 12)
    assert KNetLinkage(cells=(2, 6)).twists_deg == (10, 10)
    assert KNetLinkage(cells=(5, 5), deltas_deg=(20, 15)).twists_deg == (20, 15)
    assert np.allclose(KNetLinkage(cells=(5, 5)).net().deltas[0], np.radians(12))


@pytest.mark.slow
def test_a_knet_of_5_x_5_as_the_readme_shows(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    code, said = run("linkage", "knet", "--set", "linkage.cells=[5,5]", "--dry-run")
    assert code == 0, said
    assert "25 isograms" in said
