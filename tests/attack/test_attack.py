"""Short versions of the attacks in this folder; for the long ones see benchmarks/README.md."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import disks
import export_files
import kills
import mesh_files
import projects
import pytest
import rhino_files
import step_files
import structures
from watch import Watch, limited

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(os.name != "posix", reason="kills and limits of processes are POSIX's"),
]


@pytest.mark.parametrize(
    ("attack", "seeds", "least"),
    [
        (mesh_files.attack, range(400), 80),
        (projects.attack, range(300), 60),
        (export_files.attack, range(210), 100),
        (structures.attack, range(3), 3),
    ],
    ids=["meshes", "projects", "exports", "structures"],
)
@pytest.mark.filterwarnings("error")
def test_inputs_that_are_changed_end_with_a_result_or_a_message(
    attack: Callable[[Watch, int, Path], None], seeds: range, least: int, tmp_path: Path
) -> None:
    watch = Watch()
    with limited():
        for seed in seeds:
            attack(watch, seed, tmp_path)
    assert watch.bad == []
    assert watch.outcomes["passed"] >= least


def test_damaged_rhino_files_end_with_a_message(tmp_path: Path) -> None:
    pytest.importorskip("rhino3dm")
    watch = Watch()
    with limited():
        for seed in range(8):
            rhino_files.attack(watch, seed, tmp_path)
    assert watch.bad == []
    assert watch.outcomes["refused"] > 0
    (tmp_path / "a.3dm").write_bytes(rhino_files.sound_file())
    assert rhino_files.read_mesh(tmp_path / "a.3dm").mesh.n_faces == 5


@pytest.mark.skipif(os.name != "posix" or os.geteuid() != 0, reason="mounting needs root")
def test_full_disks_leave_what_was_there(tmp_path: Path) -> None:
    watch = Watch()
    try:
        with disks.disk(tmp_path / "try", 4096):
            pass
    except PermissionError as error:
        pytest.skip(f"cannot mount here: {error}")
    with limited(disks.DRAWING):
        for seed in range(4):
            disks.attack(watch, seed, tmp_path)
    assert watch.bad == []
    assert watch.outcomes["refused"] > 0


def test_damaged_step_files_end_with_a_message(tmp_path: Path) -> None:
    outcomes = step_files.attack(0, 150, tmp_path, trace=True)
    bad = {kind: n for kind, n in outcomes.items() if kind.startswith(("FOREIGN", "SLOW"))}
    assert bad == {}
    assert outcomes["crashed"] > 0 or not step_files.SEGV.exists()
    assert outcomes["faults told"] > 0
    assert outcomes["not a readable STEP"] > 0


def test_killed_jobs_leave_a_whole_folder(tmp_path: Path) -> None:
    outcomes = kills.attack(12, tmp_path)
    assert {kind for kind in outcomes if kind.startswith("FAILED")} == set()
    assert outcomes["whole"] > 0
