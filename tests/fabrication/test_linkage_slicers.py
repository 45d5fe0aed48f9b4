"""What slicers and menders of meshes say of the files of a kit."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from linkage_cases import meshes_of

from fabrication.checks.mesh import measure_mesh
from fabrication.job.result import JobResult
from fabrication.linkage.kit import Kit


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("prusa-slicer") is None, reason="PrusaSlicer is not installed")
def test_prusaslicer_accepts_every_file_and_slices_the_plate(
    bennett: Kit, kit_job: JobResult, tmp_path: Path
) -> None:
    meshes = meshes_of(kit_job.folder)
    paths = sorted([*kit_job.folder.rglob("*.stl"), *kit_job.folder.rglob("parts/3mf/*.3mf")])
    for path, said in zip(paths, info(*paths), strict=True):
        assert said.count("manifold = yes") == said.count("number_of_parts =  1") == 1, path
        volume = float(re.findall(r"volume = ([\d.]+)", said)[0])
        assert volume == pytest.approx(measure_mesh(meshes[path.stem]).volume, rel=1e-4)
    plate = kit_job.folder / "plates" / "plate_1.3mf"
    standing = bennett.plates[0]
    (said,) = info(plate)
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


def info(*paths: Path) -> list[str]:
    """What PrusaSlicer tells of each file, in one start of it."""
    words = ["prusa-slicer", "--info", *map(str, paths)]
    done = subprocess.run(words, capture_output=True, text=True, check=True, timeout=120)
    told = dict.fromkeys((path.name for path in paths), "")
    parts = re.split(r"^\[(.*)\]$", done.stdout, flags=re.MULTILINE)[1:]
    for name, text in zip(parts[::2], parts[1::2], strict=True):  # one a body
        told[Path(name).name] += text
    assert len(told) == len(paths)
    return list(told.values())


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("admesh") is None, reason="admesh is not installed")
def test_admesh_has_nothing_to_mend(kit_job: JobResult) -> None:
    for path in sorted(kit_job.folder.rglob("*.stl")):
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
