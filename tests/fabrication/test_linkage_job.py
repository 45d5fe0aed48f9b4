"""The whole kit: every file opened again by something else, the same bytes, what fails a check."""

from __future__ import annotations

import json
import re
import runpy
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from ddgfab.errors import InputError, OutputError
from fabrication.formats.step.read import read_step
from fabrication.formats.threemf import read_threemf
from fabrication.job.result import JobResult
from fabrication.job.run import make
from fabrication.linkage.kit import Kit, kit
from fabrication.linkage.printing import PRINTED_CHORD_MM


def test_the_default_kit_moves_through_more_than_120_degrees(bennett: Kit) -> None:
    assert np.degrees(bennett.motion.high - bennett.motion.low) > 120
    assert bennett.motion.proven
    assert bennett.motion.low < bennett.mechanism.design < bennett.motion.high
    assert "free range" in dict(bennett.motion_facts())
    assert repr(bennett).startswith("Kit(bennett: 4 bars on 4 hinges")


def test_the_reference_case_moves_as_an_independent_study_found() -> None:
    """a = 100, alpha = 40 deg, b = 146.2, beta = 70 deg, straight 5 mm bars on two levels.

    The study, with bars that end at the pins, found free arcs of the joint angle 180 deg - phi of
    18 to 174 and 186 to 343 deg at 0.4 mm. Ours have eyes of 10 mm, caps, and links that meet only
    at joints: at one end of each arc bars of one pin meet, and the eye makes that end come sooner.
    """
    arcs = []
    for design in (90.0, 270.0):
        motion = kit("bennett", a_mm=100, alpha_deg=40, beta_deg=70, design_deg=design).motion
        arcs.append(sorted((180 - np.degrees([motion.low, motion.high])) % 360))
    assert arcs[0] == pytest.approx([18, 174], abs=1.5)
    assert arcs[1] == pytest.approx([186, 343], abs=2.5)
    assert 360 - arcs[1][0] == pytest.approx(arcs[0][1], abs=0.1)  # mirror images
    assert 360 - arcs[1][1] == pytest.approx(arcs[0][0], abs=0.1)


def test_the_default_cube_moves_through_more_than_120_degrees() -> None:
    cube = kit("cube")
    assert np.degrees(cube.motion.range) > 120
    assert cube.motion.proven
    assert (cube.mechanism.n_bars, cube.mechanism.n_hinges, cube.mechanism.mobility) == (12, 8, 2)
    linkage, coupon = cube.plates  # the coupon is printed first, on a plate of its own
    loose = {piece.mark for piece in cube.linkage.loose}
    assert not loose & {standing.mark for standing in linkage}
    assert {standing.mark for standing in coupon} <= loose
    assert coupon


def test_asked_for_a_larger_range_other_levels_and_bars_are_tried() -> None:
    wide = kit("bennett", motion={"maximize_range": True})
    plain = kit("bennett")
    assert wide.motion.range >= plain.motion.range
    tried = [note for note in wide.notes if "free through" in note]
    assert len(tried) == 4
    assert sum(note.endswith("(taken)") for note in tried) == 1
    assert not any("free through" in note for note in plain.notes)


def test_a_kit_is_numbers_until_solids_are_asked_for() -> None:
    program = """
import sys
from fabrication import kit
made = kit("bennett")
made.schedules, made.motions([1.0]), made.plates, repr(made)
loaded = [m for m in ("OCP", "build123d", "cadquery", "pyvista") if m in sys.modules]
assert not loaded, loaded
"""
    subprocess.run([sys.executable, "-c", program], check=True, timeout=60)


def test_poses_outside_the_limits_are_refused(bennett: Kit) -> None:
    with pytest.raises(InputError, match="outside its limits"):
        bennett.placed(7.0)


def test_a_bed_that_is_too_small_is_refused_before_anything_is_made() -> None:
    with pytest.raises(InputError, match=r"LP-001 \(L-0000\) lies on 110.* x .* mm; a bed of 100"):
        kit("bennett", printer={"bed_mm": [100.0, 100.0]})


@pytest.mark.slow
def test_the_folder_holds_what_the_design_says(bennett: Kit, kit_job: JobResult) -> None:
    assert kit_job.exit_code == 0, kit_job.problems
    manifest = json.loads((kit_job.folder / "manifest.json").read_text("utf-8"))
    names = {record["path"] for record in manifest["files"]}
    numbers = [family.number for family in bennett.families]
    expected = {f"parts/{kind}/{n}.{kind}" for kind in ("step", "stl", "3mf") for n in numbers}
    expected |= {f"schedules/{name}.csv" for name in ("bom", "links", "hinges", "assembly")}
    expected |= {
        "assembly.step",
        "plates/plate_1.3mf",
        "plates/plate_2.3mf",
        "report.html",
        "preview.png",
        "motion.gif",
    }
    expected |= {"model.glb"}
    assert expected <= names
    assert {
        path.relative_to(kit_job.folder).as_posix() for path in kit_job.folder.rglob("*.*")
    } == {
        *names,
        "manifest.json",
        "run.json",
    }
    assert manifest["checks"]["failed"] == 0
    assert manifest["net"]["mobility"] == 1
    assert manifest["net"]["free_deg"][1] - manifest["net"]["free_deg"][0] > 120
    assert {part["role"] for part in manifest["parts"]} == {"link", "pin", "cap", "coupon"}
    assert len(manifest["parts"]) == len(bennett.linkage.pieces)


@pytest.mark.slow
def test_the_assembly_is_named_colored_and_placed(bennett: Kit, kit_job: JobResult) -> None:
    content = read_step(kit_job.folder / "assembly.step")
    placed = {i.mark: (f.number, i.placement) for f in bennett.placed() for i in f.instances}
    assert {name for _, name, _ in content.instances} == set(placed)
    for product, name, motion in content.instances:
        assert product == f"{placed[name][0]} part"
        assert np.abs(motion - placed[name][1]).max() < 1e-6
    assert len(content.products) == len(bennett.placed())  # instances share their product


@pytest.mark.slow
def test_the_example_program(capsys: pytest.CaptureFixture[str]) -> None:
    examples = Path(__file__).resolve().parents[2] / "examples"
    runpy.run_path(str(examples / "05_linkage.py"), run_name="__main__")
    said = capsys.readouterr().out
    assert "1 degree of freedom, free from" in said
    assert "2 x LP-001: 90.000 mm, right hand" in said
    assert "12 solids on a foot" in said


@pytest.mark.slow
def test_the_program_in_the_documentation(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    text = (Path(__file__).resolve().parents[2] / "docs" / "linkages.md").read_text("utf-8")
    (program,) = re.findall(r"```python\n(.*?)```", text, flags=re.DOTALL)
    monkeypatch.chdir(tmp_path)
    exec(compile(program, "linkages.md", "exec"), {})
    assert (tmp_path / "out" / "toy" / "manifest.json").exists()


@pytest.mark.slow
def test_a_kit_that_fails_a_check_says_so(bennett: Kit, tmp_path: Path) -> None:
    """A range that is claimed too wide: the parts meet at its ends, and the job tells which."""
    output = bennett.project.output.model_copy(update={"formats": ("csv", "html")})
    wide = replace(bennett.motion, high=np.radians(172))
    claimed = replace(
        bennett,
        project=bennett.project.model_copy(update={"output": output}),
        moved=replace(bennett.moved, motion=wide),
    )
    result = make(claimed, tmp_path / "claimed")
    assert result.exit_code == 1
    assert any("clearance to links: " in line for line in result.problems), result.problems
    assert result.manifest["checks"]["failed"] > 0
    assert "FAILED clearance to links" in (tmp_path / "claimed" / "report.html").read_text("utf-8")


@pytest.mark.slow
def test_the_same_kit_gives_the_same_files(
    bennett: Kit, kit_job: JobResult, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    again = make(bennett, tmp_path / "again")
    one, two = (
        {r["path"]: r["sha256"] for r in result.manifest["files"]} for result in (kit_job, again)
    )
    # STEP headers hold the time, unless SOURCE_DATE_EPOCH is set.
    stable = [path for path in one if not path.endswith(".step")]
    assert {path: one[path] for path in stable} == {path: two[path] for path in stable}


@pytest.mark.slow
def test_plates_hold_every_printed_piece(bennett: Kit, kit_job: JobResult) -> None:
    plates = [read_threemf(path) for path in sorted((kit_job.folder / "plates").iterdir())]
    standing = [
        (body.name, count)
        for content in plates
        for body, count in zip(content.bodies, content.placed, strict=True)
    ]
    assert sorted(standing) == sorted((part.number, len(part.marks)) for part in bennett.printed)
    assert not any(number.startswith("HP") for number, _ in standing)  # rods are bought


@pytest.mark.slow
def test_solids_in_hand_at_any_pose(bennett: Kit) -> None:
    compound = bennett.to_build123d(np.radians(60))
    assert [group.label for group in compound.children] == ["Links", "Pins", "Caps"]
    links = compound.children[0].children
    motions = bennett.motions(np.array([np.radians(60)]))
    for solid in links:
        family = next(f for f in bennett.families if solid.label in [i.mark for i in f.instances])
        mesh = next(p.mesh for p in bennett.printed if p.number == family.number)
        placed = mesh.vertices @ motions[solid.label][0, :3, :3].T + motions[solid.label][0, :3, 3]
        box = solid.bounding_box()
        low, high = np.array(list(box.min)), np.array(list(box.max))
        assert np.abs(low - placed.min(axis=0)).max() < 2 * PRINTED_CHORD_MM
        assert np.abs(high - placed.max(axis=0)).max() < 2 * PRINTED_CHORD_MM
    assembly = bennett.to_cadquery()
    assert assembly.objects["L-0003"].metadata["number"] == "LP-002"


@pytest.mark.slow
def test_fewer_formats_and_a_folder_of_somebody_else(bennett: Kit, tmp_path: Path) -> None:
    output = bennett.project.output.model_copy(update={"formats": ("stl", "csv")})
    few = replace(bennett, project=bennett.project.model_copy(update={"output": output}))
    result = make(few, tmp_path / "few")
    assert result.exit_code == 0
    endings = {path.suffix for path in result.folder.rglob("*.*")}
    assert endings == {".stl", ".csv", ".json", ".png"}
    (tmp_path / "taken").mkdir()
    (tmp_path / "taken" / "mine.txt").write_text("mine")
    with pytest.raises(OutputError, match="not an output folder of ddgfab"):
        make(bennett, tmp_path / "taken")
    assert [path.name for path in (tmp_path / "taken").iterdir()] == ["mine.txt"]
