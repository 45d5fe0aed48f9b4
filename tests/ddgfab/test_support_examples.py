"""The geometry examples run as a user would run them, without loading the CAD kernel."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("01_canopy.py", "SupportStructure(offset"),
        ("02_support_structure.py", "Prop. 5.2"),
        ("06_curvatures.py", "cotangent, angles"),
        ("07_minimal_surface.py", "edge offset: distance of vertex"),
    ],
)
def test_example_runs(name: str, said: str) -> None:
    program = (
        f"import runpy, sys; runpy.run_path(r'{ROOT / 'examples' / name}', run_name='__main__')"
    )
    program += "; assert 'OCP' not in sys.modules"
    done = subprocess.run(
        [sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert said in done.stdout
