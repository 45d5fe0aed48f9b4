"""The notions of curvature that the example compares tend to the smooth values with order two."""

from __future__ import annotations

import runpy
from pathlib import Path

import numpy as np
import pytest

EXAMPLE = Path(__file__).resolve().parents[2] / "examples" / "06_curvatures.py"


def test_orders_of_the_notions() -> None:
    errors = runpy.run_path(str(EXAMPLE))["errors"]
    coarse, fine = errors(16), errors(32)
    assert set(coarse) == {"Steiner", "skew quads", "cotangent, angles"}
    for name, first in coarse.items():
        orders = np.log2(np.array(first) / fine[name])
        assert orders == pytest.approx(2.0, abs=0.1), name
        assert max(fine[name]) < 2e-3, name
