"""Sheets of panes: complete, legible, and of the same numbers as shape and schedule."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from roofs import hexagons
from sheet_checks import faults, measured, whole_of

from fabrication.drawings.sheet import Sheet
from fabrication.formats.base import Whole
from fabrication.formats.sheets import FORMAT
from fabrication.formats.sheets.parts import sheets_of_parts
from fabrication.gridshell.design import design


@pytest.fixture(scope="module")
def shell() -> tuple[Whole, list[Sheet]]:
    made = design(hexagons(), panel={"corner_radius_mm": 10.0})
    whole = whole_of(made)
    return whole, [
        sheet for group, sheet in sheets_of_parts(whole) if group == "Panels" and sheet.views
    ]


def test_nothing_overlaps_or_leaves_the_frame(shell: tuple[Whole, list[Sheet]]) -> None:
    _, sheets = shell
    assert len(sheets) >= 2
    for sheet in sheets:
        assert faults(sheet) == []


def test_dimensions_are_true_and_those_of_the_schedule(shell: tuple[Whole, list[Sheet]]) -> None:
    whole, sheets = shell
    assert whole.tables is not None
    for sheet in sheets:
        row = next(row for row in whole.tables["panels"] if row["number"] == sheet.subject)
        names = [dimension.name for dimension in sheet.dimensions]
        for k in range(1, 7):
            assert names.count(f"edge_{k}_mm") == names.count(f"angle_{k}_deg") == 1
        assert {"diagonal_13_mm", "diagonal_to_4_mm", "diagonal_to_5_mm", "thickness_mm"} <= {
            *names
        }
        for dimension in sheet.dimensions:
            assert dimension.value == pytest.approx(row[dimension.name], abs=1e-9)
            found = measured(sheet, dimension)
            assert found == pytest.approx(dimension.value, rel=1e-9)
            places = 2 if dimension.name.endswith("_deg") else 1
            assert dimension.text.text.rstrip("°") == f"{dimension.value:.{places}f}"


def test_the_numbers_on_a_sheet_give_the_pane_back(shell: tuple[Whole, list[Sheet]]) -> None:
    """Sides and the diagonals from corner 1 fix a polygon: built of what is written, to 0.1 mm."""
    whole, sheets = shell
    for sheet in sheets:
        said = {d.name: float(d.text.text.rstrip("°")) for d in sheet.dimensions}
        diagonals = [said["edge_1_mm"], said["diagonal_13_mm"]]
        diagonals += [said["diagonal_to_4_mm"], said["diagonal_to_5_mm"], said["edge_6_mm"]]
        corners, turn = [0j, complex(diagonals[0])], 0.0
        for k in range(2, 6):
            before, after, side = diagonals[k - 2], diagonals[k - 1], said[f"edge_{k}_mm"]
            turn += math.acos((before**2 + after**2 - side**2) / (2 * before * after))
            corners.append(after * complex(math.cos(turn), math.sin(turn)))
        built = np.array([[c.real, c.imag] for c in corners])
        outer = whole.parts[sheet.subject].shape.outer  # type: ignore[attr-defined]
        between = np.linalg.norm(built[:, None] - built[None], axis=-1)
        wanted = np.linalg.norm(outer[:, None] - outer[None], axis=-1)
        assert between == pytest.approx(wanted, abs=1.5)
        for k, (a, b, c) in enumerate(
            zip(np.roll(built, 1, 0), built, np.roll(built, -1, 0), strict=True)
        ):
            cosine = (a - b) @ (c - b) / np.linalg.norm(a - b) / np.linalg.norm(c - b)
            assert math.degrees(math.acos(cosine)) == pytest.approx(
                said[f"angle_{k + 1}_deg"], abs=0.1
            )


def test_the_same_structure_gives_the_same_bytes(
    shell: tuple[Whole, list[Sheet]], tmp_path: Path
) -> None:
    whole, _ = shell
    for name in ("one", "two"):
        (tmp_path / name).mkdir()
        assert FORMAT.write_whole(tmp_path / name, whole) == []
    files = sorted(path.name for path in (tmp_path / "one" / "sheets").iterdir())
    groups = ["all", "beams", "erection", "nesting", "nodes", "overview", "panels"]
    assert files == [f"{name}.pdf" for name in groups]
    for name in files:
        one, two = ((tmp_path / n / "sheets" / name).read_bytes() for n in ("one", "two"))
        assert one == two
