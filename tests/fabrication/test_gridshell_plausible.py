"""What is unlikely of a design is told, or refused, as the project says: both ways."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ddgfab.errors import InputError
from ddgfab.io import write_mesh
from ddgfab.mesh import Mesh
from fabrication import design
from fabrication.gridshell.plausible import looks_inward
from fabrication.standards.data import table


def vault(size: float, cells: int = 2) -> Mesh:
    """Planar quads of a translation net; edges about `size` [mm] long."""
    t = size * (np.arange(cells + 1) - cells / 2)
    u, v = np.meshgrid(t, t, indexing="ij")
    z = -(u**2 + v**2) / (12.0 * size)
    points = np.stack([u, v, z], axis=-1).reshape(-1, 3)
    i = np.arange(cells)[:, None] * (cells + 1) + np.arange(cells)
    faces = np.stack([i, i + cells + 1, i + cells + 2, i + 1], axis=-1).reshape(-1, 4)
    return Mesh.build(points, faces.tolist())


def cube(inward: bool) -> Mesh:
    corners = [[x, y, z] for x in (0, 2000) for y in (0, 2000) for z in (0, 2000)]
    faces = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    return Mesh.build(corners, [face[::-1] for face in faces] if inward else faces)


def told(mesh: Mesh | None, **sections: Any) -> list[str]:
    source = {} if mesh is None else {"source": mesh}
    return [n for n in design(**source, **sections).source.notes if n.startswith("unlikely")]


UNLIKELY = {
    "single bars of 20 m": (20e3, {}, "a beam of 2.0"),
    "panes too large": (20e3, {"panel": {"max_size_mm": [9e4, 9e4]}}, "a pane with a side of"),
    "panes too small": (150.0, {"panel": {"gap_mm": 60.0}}, "a pane with a side of"),
    "thin glass": (1500.0, {"panel": {"thickness_mm": 0.001}}, "glass of 0.001 mm is under 2 mm"),
    "thick glass": (1500.0, {"panel": {"thickness_mm": 300.0}}, "glass of 300 mm is over 120 mm"),
    "a wide gap": (1500.0, {"panel": {"gap_mm": 350.0}}, "a gap of 350 mm between panes is over"),
    "panes far off": (1500.0, {"panel": {"offset_mm": 900.0}}, "panes 900 mm above"),
    "panes far below": (1500.0, {"panel": {"offset_mm": -900.0}}, "panes -900 mm above"),
    "beams far off": (1500.0, {"beam": {"eccentricity_mm": -800.0}}, "beams -800 mm above"),
    "heavy bars": (1500.0, {"beam": {"density": 78500.0}}, "7.85e+04 kg/m3 is over"),
    "light glass": (1500.0, {"panel": {"density": 2.5}}, "panes of 2.5 kg/m3 is under"),
    "slender bars": (9000.0, {"beam": {"profile": "FL 20x8"}}, "times as long as its profile"),
}


@pytest.mark.parametrize("name", UNLIKELY)
def test_unlikely_quantities_are_told_with_limit_and_source(name: str) -> None:
    size, sections, text = UNLIKELY[name]
    found = told(vault(size), **sections)
    (note,) = [note for note in found if text in note]
    assert ": " in note[10:]  # a source stands behind the limit
    with pytest.raises(InputError) as caught:
        design(vault(size), **sections, checks={"plausibility": "fail"})
    assert text in str(caught.value)
    assert not told(vault(size), **sections, checks={"plausibility": "ignore"})


@pytest.mark.parametrize(
    ("profile", "length", "limit"),
    [
        ("FL 150x15", 11.9e3, None),
        ("FL 150x15", 12.6e3, "is over 12000 mm: FL 150x15: bars are rolled"),
        ("T 100x100x11", 12.6e3, "is over 12000 mm: T 100x100x11: bars are rolled"),
        ("RHS 200x100x8", 12.6e3, None),
        ("RHS 200x100x8", 13.9e3, "is over 13600 mm: a semi-trailer"),
        ("SHS 120x6", 13.9e3, "is over 13600 mm: a semi-trailer"),
        ([[-40, -100], [40, -100], [40, 100], [-40, 100]], 13.9e3, "is over 13600 mm"),
    ],
)
def test_bars_are_compared_with_the_stock_of_their_profile(
    profile: Any, length: float, limit: str | None
) -> None:
    panel = {"max_size_mm": [3e4, 3e4]}
    found = told(vault(length), beam={"profile": profile}, panel=panel)
    found = [note for note in found if "between its nodes is over" in note or "nodes (" in note]
    if limit is None:
        assert found == []
    else:
        assert len(found) == 1
        assert limit in found[0]


def test_the_gap_is_compared_with_the_pane() -> None:
    (gap,) = told(vault(400.0), panel={"gap_mm": 95.0})
    assert "the gap of 95 mm is over a fifth" in gap


def test_likely_designs_have_no_such_notes() -> None:
    assert told(None) == []
    for size in (800.0, 1500.0, 3000.0):
        assert told(vault(size)) == []


def test_edges_of_1500_km_are_refused_as_those_of_a_millimetre_are(tmp_path: Path) -> None:
    for size in (1.5e9, 1.5):
        write_mesh(tmp_path / "a.obj", vault(size))
        with pytest.raises(InputError, match=r"no gridshell has edges"):
            design(tmp_path / "a.obj")


def test_a_closed_net_that_looks_inwards_is_told() -> None:
    assert looks_inward(cube(inward=True))
    assert not looks_inward(cube(inward=False))
    assert not looks_inward(vault(1500.0))
    with pytest.raises(InputError, match="look inwards"):
        design(
            cube(inward=True),
            support={"kind": "central"},
            panel={"kind": "none"},
            checks={"plausibility": "fail"},
        )


def test_every_limit_has_a_source_and_two_sides() -> None:
    for rule in table("plausible").values():
        assert rule["low"] < rule["high"]
        assert len(rule["source"]) > 30
        assert "{value}" in rule["what"]


def test_each_profile_of_a_structure_has_its_own_stock() -> None:
    """Hollow sections inside, flat bars at the boundary: only these are too long at 12.6 m."""
    tables = [
        {"profile": "RHS 120x60x6"},
        {"where": "boundary", "profile": "FL 150x15"},
    ]
    found = told(vault(12.6e3), beam=tables, panel={"max_size_mm": [3e4, 3e4]})
    (note,) = [note for note in found if "between its nodes" in note]
    assert "FL 150x15: bars are rolled" in note
