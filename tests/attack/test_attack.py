"""Short versions of the attacks in this folder; for the long ones see benchmarks/README.md."""

from __future__ import annotations

import os
import random
from collections.abc import Callable
from pathlib import Path

import commands
import disks
import export_files
import hypothesis
import kills
import known
import limits
import mesh_files
import projects
import pytest
import rhino_files
import step_files
import structures
import sweep
from hypothesis import strategies as st
from watch import Watch, limited

from fabrication.gridshell.project import Project
from fabrication.linkage.project import KITS

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


# --- the command line: every command, every option, every setting --------------------------------
def test_what_is_tried_is_what_there_is() -> None:
    """A new section or command is there by itself; settings have values that pass and that fail."""
    there = {(s.product, s.section) for s in known.settings()}
    for product, model in {"gridshell": Project, **KITS}.items():
        assert {(product, name) for name in model.model_fields if name != "file"} <= there
    assert set(commands.SOUND) <= set(known.commands())
    assert set(limits.LINES) == set(known.commands())
    names = {option.name for option in known.commands()["trace"]}
    assert {"", "--face", "--curves", "--no-picture", "-q"} <= names
    assert "--debug" not in names
    low = next(s for s in known.settings() if (s.section, s.key) == ("checks", "min_angle_deg"))
    assert {0, 120, 120.5, -0.5} <= set(low.values)


@pytest.mark.filterwarnings("error")
def test_every_setting_with_every_value_is_taken_or_refused(tmp_path: Path) -> None:
    """As values, and as texts behind --set."""
    watch = Watch()
    with limited():
        for seed in range(len(known.settings())):
            sweep.attack(watch, seed, tmp_path, deep=False)
            sweep.typed(watch, seed)
    assert watch.bad == []
    assert watch.outcomes["passed"] > watch.outcomes["refused"] > 1000


@pytest.mark.filterwarnings("error")
def test_settings_that_are_taken_make_a_design_or_a_message(tmp_path: Path) -> None:
    watch = Watch()
    with limited():
        for seed in range(5, len(known.settings()), 47):
            sweep.attack(watch, seed, tmp_path, absurd=16)
    assert watch.bad == []


@pytest.mark.filterwarnings("error")
def test_command_lines_end_with_a_result_or_a_message(tmp_path: Path) -> None:
    outcomes = Watch()

    @hypothesis.settings(
        max_examples=50,
        deadline=None,
        derandomize=True,
        database=None,
        suppress_health_check=list(hypothesis.HealthCheck),
    )
    @hypothesis.given(st.randoms(use_true_random=False))
    def run(rng: random.Random) -> None:
        words = commands.command_line(rng)
        outcomes.call(words, lambda: commands.judge(words, tmp_path), commands.SECONDS)
        assert outcomes.bad == []

    with limited(commands.MEMORY):
        run()
    assert outcomes.outcomes["passed"] > 0
    assert outcomes.outcomes["refused"] > 0


def test_commands_short_of_memory_end_with_a_message(tmp_path: Path) -> None:
    """Sizes in which the renderer, or the kernel, finds no more memory."""
    outcomes = limits.attack(2, tmp_path, seed=8)
    assert {kind for kind in outcomes if kind.startswith("FAILED")} == set()


def test_commands_that_are_stopped_leave_nothing(tmp_path: Path) -> None:
    outcomes = limits.attack(2, tmp_path, signals=True, seed=5)
    assert {kind for kind in outcomes if kind.startswith("FAILED")} == set()
