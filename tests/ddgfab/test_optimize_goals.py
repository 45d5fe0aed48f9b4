"""optimize: goals by name, movement limits, features."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from ddgfab.errors import InputError, OptimizeError
from ddgfab.grid import grid_mesh
from ddgfab.io import read_mesh
from ddgfab.measures import circular_defect, conical_defect, planarity_percent
from ddgfab.mesh import Mesh
from ddgfab.optimize import TorsionFreeResult, optimize
from ddgfab.optimize.report import comparison, comparison_text


def roof(cells: int = 6) -> Mesh:
    u, v = np.meshgrid(np.arange(cells + 1.0), np.arange(cells + 1.0), indexing="ij")
    return grid_mesh(np.stack([u, v, 0.04 * u * v + 0.1 * np.sin(u)], axis=-1))


def test_each_goal_is_what_it_says() -> None:
    mesh = roof()
    assert planarity_percent(optimize(mesh).mesh).max() < 1e-7
    assert np.degrees(circular_defect(optimize(mesh, "circular").mesh)).max() < 1e-6
    assert np.degrees(conical_defect(optimize(mesh, "conical").mesh)).max() < 1e-6


def test_limit_of_movement_is_worth_more_than_wishes(
    mesh_file: Callable[[str], Path],
) -> None:
    mesh = read_mesh(mesh_file("botanic_garden_bubble.obj")).mesh
    wide = optimize(mesh)
    near = optimize(mesh, max_movement=0.8 * wide.movement_max)
    assert near.movement_max <= 0.8 * wide.movement_max
    assert planarity_percent(near.mesh).max() < 1e-7
    assert near.remarks
    with pytest.raises(OptimizeError, match="furthest") as caught:
        optimize(mesh, max_movement=0.01 * wide.movement_max)
    assert isinstance(caught.value.result, type(wide))
    assert planarity_percent(caught.value.result.mesh).max() < 1e-7


def test_report_of_axes() -> None:
    result = optimize(roof(), "torsion-free", axes_only=True)
    assert isinstance(result, TorsionFreeResult)
    report = comparison(result)
    assert report["movement_max"] == 0
    assert report["torsion_deg_max"] < 1e-6
    assert "lean max" in comparison_text(result)


def test_bad_input() -> None:
    with pytest.raises(InputError, match=r'"round" is unknown; one of planar, circular'):
        optimize(roof(), "round")  # type: ignore[arg-type]
    with pytest.raises(InputError, match="max_movement = -1"):
        optimize(roof(), max_movement=-1)
