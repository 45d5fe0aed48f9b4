"""Short versions of the attacks in this folder; for the long ones see benchmarks/README.md."""

from __future__ import annotations

import os
from pathlib import Path

import kills
import pytest
import step_files

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(os.name != "posix", reason="kills and limits of processes are POSIX's"),
]


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
