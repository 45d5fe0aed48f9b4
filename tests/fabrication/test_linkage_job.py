"""The whole kit: every file opened again by something else, parts placed through the range."""

from __future__ import annotations

import json
import re
import runpy
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ddgfab.errors import InputError, OutputError
from fabrication.checks.mesh import measure_mesh, to_manifold
from fabrication.formats.step.read import read_step
from fabrication.formats.stl import read_stl
from fabrication.formats.threemf import read_threemf
from fabrication.job.result import JobResult
from fabrication.job.run import make
from fabrication.linkage.kit import Kit, kit
from fabrication.linkage.poses import check_poses
from fabrication.linkage.printing import PRINTED_CHORD_MM
from fabrication.parts.link import LinkShape
from fabrication.specs import TriangleMesh

POSES = 50
FEWER_POSES = 20  # of kits with more pieces; the job has measured some already
COAXIAL_MM = 1e-6
OVERLAP_MM3 = 1e-3  # faces that touch, rounded to the single precision of STL


@pytest.fixture(scope="module")
def bennett() -> Kit:
    return kit("bennett")


@pytest.fixture(scope="module")
def made(bennett: Kit, tmp_path_factory: pytest.TempPathFactory) -> JobResult:
    return make(bennett, tmp_path_factory.mktemp("kits") / "bennett")


def meshes_of(folder: Path) -> dict[str, TriangleMesh]:
    return {path.stem: read_stl(path) for path in sorted((folder / "parts/stl").glob("*.stl"))}


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
    assert len(cube.plates) == 1


def test_asked_for_a_larger_range_other_levels_and_bars_are_tried() -> None:
    wide = kit("bennett", motion={"maximize_range": True})
    plain = kit("bennett")
    assert wide.motion.range >= plain.motion.range
    tried = [note for note in wide.notes if "free through" in note]
    assert len(tried) == 4
    assert sum(note.endswith("(taken)") for note in tried) == 1
    assert not any("free through" in note for note in plain.notes)


def test_placements_follow_the_kinematics(bennett: Kit) -> None:
    angles = bennett.angles(7)
    motions = bennett.motions(angles)
    links = bennett.linkage.links
    poses = bennett.mechanism.poses(angles)
    for link in links:
        for end, hinge in enumerate(link.hinges):
            point, axis = bore(link.shape, end, bennett, link.mark)
            placed = motions[link.mark]
            assert np.abs(np.cross(placed[:, :3, :3] @ axis, poses.axes[:, hinge])).max() < 1e-12
            away = placed[:, :3, :3] @ point + placed[:, :3, 3] - poses.points[:, hinge]
            along = np.einsum("ti,ti->t", away, poses.axes[:, hinge])
            off = away - along[:, None] * poses.axes[:, hinge]
            assert np.abs(off).max() < COAXIAL_MM
    assert np.abs(motions["L-0000"] - motions["L-0000"][0]).max() < 1e-12  # bar 0 is held


def bore(shape: Any, end: int, bennett: Kit, mark: str) -> tuple[np.ndarray, np.ndarray]:
    """A point of the axis of a bore and its direction, in the frame of the part number's shape.

    The piece's own end lies at either end of a shape that is shared.
    """
    piece = next(p for p in bennett.linkage.pieces if p.mark == mark)
    family = next(f for f in bennett.families if mark in [i.mark for i in f.instances])
    instance = next(i for i in family.instances if i.mark == mark)
    assert isinstance(shape, LinkShape)
    point = np.array([shape.length * end, 0, 0, 1.0])
    axis = np.array([0, -np.sin(shape.twist) * end, np.cos(shape.twist * end), 0])
    change = np.linalg.inv(instance.placement) @ piece.placement
    return (change @ point)[:3], (change @ axis)[:3]


def test_a_kit_is_numbers_until_solids_are_asked_for() -> None:
    program = """
import sys
from fabrication import kit
made = kit("bennett")
made.schedules, made.motions([1.0]), made.plates, repr(made)
loaded = [m for m in ("OCP", "build123d", "cadquery", "pyvista", "plotly") if m in sys.modules]
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
def test_the_folder_holds_what_the_design_says(bennett: Kit, made: JobResult) -> None:
    assert made.exit_code == 0, made.problems
    manifest = json.loads((made.folder / "manifest.json").read_text("utf-8"))
    names = {record["path"] for record in manifest["files"]}
    numbers = [family.number for family in bennett.families]
    expected = {f"parts/{kind}/{n}.{kind}" for kind in ("step", "stl", "3mf") for n in numbers}
    expected |= {f"schedules/{name}.csv" for name in ("bom", "links", "hinges", "assembly")}
    expected |= {"assembly.step", "plates/plate_1.3mf", "report.html", "preview.png", "motion.gif"}
    expected |= {"model.glb"}
    assert expected <= names
    assert {path.relative_to(made.folder).as_posix() for path in made.folder.rglob("*.*")} == {
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
def test_the_assembly_is_named_colored_and_placed(bennett: Kit, made: JobResult) -> None:
    content = read_step(made.folder / "assembly.step")
    placed = {i.mark: (f.number, i.placement) for f in bennett.placed() for i in f.instances}
    assert {name for _, name, _ in content.instances} == set(placed)
    for product, name, motion in content.instances:
        assert product == placed[name][0]
        assert np.abs(motion - placed[name][1]).max() < 1e-6
    assert len(content.products) == len(bennett.placed())  # instances share their product


@pytest.mark.slow
def test_bores_of_the_step_files_are_coaxial_with_the_pins(bennett: Kit, made: JobResult) -> None:
    """Cylinder axes read back from the kernel, placed at 50 poses, against the pins' own axes."""
    axes = {
        path.stem: cylinders(path) for path in sorted((made.folder / "parts/step").glob("*.step"))
    }
    angles = bennett.angles(POSES)
    motions, poses = bennett.motions(angles), bennett.mechanism.poses(angles)
    settings = bennett.linkage.settings
    number = {i.mark: f.number for f in bennett.families for i in f.instances}
    checked = 0
    for hinge, stack in enumerate(bennett.linkage.stacks):
        point, axis = poses.points[:, hinge], poses.axes[:, hinge]
        for item in stack:
            radius = {"link": settings.bore, "pin": settings.pin_diameter}.get(item.kind.role)
            if radius is None:
                continue
            gaps = []
            for at, way, found in axes[number[item.mark]]:
                if abs(2 * found - radius) > 1e-6:
                    continue
                placed = motions[item.mark]
                here = placed[:, :3, :3] @ at + placed[:, :3, 3] - point
                off = here - np.einsum("ti,ti->t", here, axis)[:, None] * axis
                tilt = np.cross(placed[:, :3, :3] @ way, axis)
                gaps.append(max(np.abs(off).max(), np.abs(tilt).max() * settings.eye_height))
            assert min(gaps) < COAXIAL_MM
            checked += 1
    assert checked == 12  # four pins, and two eyes on each


def cylinders(path: Path) -> list[tuple[np.ndarray, np.ndarray, float]]:
    """Point of the axis, direction and radius of every cylindrical face of a STEP file."""
    from OCP.BRepAdaptor import BRepAdaptor_Surface
    from OCP.GeomAbs import GeomAbs_SurfaceType
    from OCP.TopAbs import TopAbs_ShapeEnum
    from OCP.TopExp import TopExp_Explorer
    from OCP.TopoDS import TopoDS
    from OCP.XCAFDoc import XCAFDoc_ShapeTool

    from fabrication.formats.step.xcaf import free_labels, read_document

    document, _ = read_document(path)
    found = []
    for label in free_labels(document):
        explorer = TopExp_Explorer(
            XCAFDoc_ShapeTool.GetShape_s(label), TopAbs_ShapeEnum.TopAbs_FACE
        )
        while explorer.More():
            surface = BRepAdaptor_Surface(TopoDS.Face_s(explorer.Current()))
            if surface.GetType() == GeomAbs_SurfaceType.GeomAbs_Cylinder:
                cylinder = surface.Cylinder()
                line = cylinder.Axis()
                at, way = line.Location(), line.Direction()
                found.append(
                    (
                        np.array([at.X(), at.Y(), at.Z()]),
                        np.array([way.X(), way.Y(), way.Z()]),
                        cylinder.Radius(),
                    )
                )
            explorer.Next()
    return found


@pytest.mark.slow
def test_read_back_meshes_never_meet_on_the_way(bennett: Kit, made: JobResult) -> None:
    """50 poses through the free range: no common volume of any pair, and the clearances kept."""
    meshes = meshes_of(made.folder)
    angles = bennett.angles(POSES)
    found = check_poses(bennett, meshes, angles)
    assert len(found) == len(bennett.linkage.pieces) - 2  # without the coupon and its pin
    assert all(check.passed for checks in found.values() for check in checks)
    solids = {number: to_manifold(mesh) for number, mesh in meshes.items()}
    motions = bennett.motions(angles)
    marks = list(motions)
    number = {i.mark: f.number for f in bennett.families for i in f.instances}
    for t in range(POSES):
        bodies = [solids[number[m]].transform(motions[m][t][:3]) for m in marks]
        for i, one in enumerate(bodies):
            for two in bodies[:i]:
                assert (one ^ two).volume() < OVERLAP_MM3


@pytest.mark.slow
@pytest.mark.parametrize(
    "settings",
    [
        {"source": "cube", "parts": {"pin": "printed", "label": "embossed"}},
        {"source": "knet", "cells": [2, 3], "longest_mm": 70.0},
        {"source": "crab", "rings": 3},
    ],
    ids=lambda settings: settings["source"],
)
def test_other_kits_never_meet_on_the_way_either(settings: dict[str, Any], tmp_path: Path) -> None:
    made = kit(**settings, output={"formats": ["stl"]})
    result = make(made, tmp_path / "kit")
    assert result.exit_code == 0, result.problems
    found = check_poses(made, meshes_of(result.folder), made.angles(FEWER_POSES))
    failed = [check for checks in found.values() for check in checks if not check.passed]
    assert not failed


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
def test_beyond_the_range_the_pose_check_finds_the_contact(bennett: Kit, made: JobResult) -> None:
    meshes = meshes_of(made.folder)
    contact = bennett.motion.contacts[0]
    end = contact.t + (0.1 if contact.t > bennett.mechanism.design else -0.1)
    found = check_poses(bennett, meshes, np.array([end]))
    clashes = {mark for mark, checks in found.items() if not all(c.passed for c in checks)}
    assert clashes & set(contact.marks)


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
@pytest.mark.skipif(shutil.which("prusa-slicer") is None, reason="PrusaSlicer is not installed")
def test_prusaslicer_accepts_every_file_and_slices_the_plate(
    bennett: Kit, made: JobResult, tmp_path: Path
) -> None:
    meshes = meshes_of(made.folder)
    paths = sorted([*made.folder.rglob("*.stl"), *made.folder.rglob("parts/3mf/*.3mf")])
    for path in paths:
        said = info(path)
        assert said.count("manifold = yes") == said.count("number_of_parts =  1") == 1, path
        volume = float(re.findall(r"volume = ([\d.]+)", said)[0])
        assert volume == pytest.approx(measure_mesh(meshes[path.stem]).volume, rel=1e-4)
    plate = made.folder / "plates" / "plate_1.3mf"
    standing = bennett.plates[0]
    said = info(plate)
    assert said.count("manifold = yes") == len(standing)
    volumes = sorted(measure_mesh(bennett.printed[s.part].mesh).volume for s in standing)
    found = sorted(float(v) for v in re.findall(r"volume = ([\d.]+)", said))
    assert found == pytest.approx(volumes, rel=1e-4)
    code = tmp_path / "plate.gcode"
    subprocess.run(
        [
            "prusa-slicer",
            "-g",
            "--dont-arrange",
            "--bed-shape",
            "0x0,220x0,220x220,0x220",
            "-o",
            str(code),
            str(plate),
        ],
        capture_output=True,
        check=True,
        timeout=300,
    )
    reached = np.array(re.findall(r"G1 X([\d.-]+) Y([\d.-]+) .*E", code.read_text()), dtype=float)
    assert len(reached) > 10_000
    assert reached.min() > 0  # with the skirt, which is drawn 6 mm off
    assert reached.max() < 220


def info(path: Path) -> str:
    return subprocess.run(
        ["prusa-slicer", "--info", str(path)],
        capture_output=True,
        text=True,
        check=True,
        timeout=60,
    ).stdout


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("admesh") is None, reason="admesh is not installed")
def test_admesh_has_nothing_to_mend(made: JobResult) -> None:
    for path in sorted(made.folder.rglob("*.stl")):
        said = subprocess.run(
            ["admesh", str(path)], capture_output=True, text=True, errors="replace"
        ).stdout
        counts = re.findall(
            r"(?:Edges fixed|Facets removed|Facets added|Facets reversed|"
            r"Backwards edges|Normals fixed|Degenerate facets)\s*:\s*(\d+)",
            said,
        )
        assert len(counts) == 7, said
        assert set(counts) == {"0"}, said


@pytest.mark.slow
def test_the_same_kit_gives_the_same_files(
    bennett: Kit, made: JobResult, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    again = make(bennett, tmp_path / "again")
    one, two = (
        {r["path"]: r["sha256"] for r in result.manifest["files"]} for result in (made, again)
    )
    # STEP headers hold the time, unless SOURCE_DATE_EPOCH is set.
    stable = [path for path in one if not path.endswith(".step")]
    assert {path: one[path] for path in stable} == {path: two[path] for path in stable}


@pytest.mark.slow
def test_plates_hold_every_printed_piece(bennett: Kit, made: JobResult) -> None:
    content = read_threemf(made.folder / "plates" / "plate_1.3mf")
    printed = {part.number: len(part.marks) for part in bennett.printed}
    assert dict(zip((b.name for b in content.bodies), content.placed, strict=True)) == printed
    assert not any(number.startswith("HP") for number in printed)  # rods are bought


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
