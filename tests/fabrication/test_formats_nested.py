"""Glass on stock as sheets and DXF: read back by ezdxf, and looked at for faults."""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import replace
from pathlib import Path

import ezdxf
import numpy as np
import pytest
from detailing_cases import dome
from ezdxf import path as outlines
from sheet_checks import faults, whole_of

from fabrication import design
from fabrication.formats.base import Whole
from fabrication.formats.dxf import FORMAT, NESTED
from fabrication.formats.sheets import FORMAT as SHEETS
from fabrication.formats.sheets.nesting import nesting_sheets


@pytest.fixture(scope="module", params=[{}, {"edge": "mitred", "corner_radius_mm": 20.0}])
def whole(request: pytest.FixtureRequest) -> Whole:
    case = dome(3, 3)
    panel = {"build_up": "8/16Ar/6.6.2", **request.param}
    stock = {"glass_mm": [2000, 3210]}
    return whole_of(design(case.mesh, axes=case.axes, panel=panel, stock=stock))


def polygon_area(points: np.ndarray) -> float:
    x, y = points.T
    return abs(0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1)))


@pytest.mark.parametrize("release", ["R2010", "R12"])
def test_the_layout_as_dxf_has_every_ply_at_its_place(
    whole: Whole, release: str, tmp_path: Path
) -> None:
    about = replace(whole.about, options={"dxf": {"release": release}})
    whole = replace(whole, about=about)
    FORMAT.write_whole(tmp_path, whole)
    assert all(check.passed for check in FORMAT.check_whole(tmp_path, whole))
    document = ezdxf.readfile(tmp_path / NESTED)
    assert not document.audit().errors
    found: Counter[str] = Counter()
    areas, panes_at, stock = [], [], []
    for entity in document.modelspace().query("LWPOLYLINE POLYLINE"):
        closed = entity.closed if entity.dxftype() == "LWPOLYLINE" else entity.is_closed
        found[entity.dxf.layer] += bool(closed)
        assert closed or entity.dxf.layer in ("MARK", "STOCK")
        if entity.dxf.layer in ("CUT", "STOCK") and closed:
            points = np.array([(v.x, v.y) for v in outlines.make_path(entity).flattening(1e-4)])
            if entity.dxf.layer == "CUT":
                areas.append(polygon_area(points))
                panes_at.append((points.min(axis=0), points.max(axis=0)))
            else:
                assert polygon_area(points) == pytest.approx(2000.0 * 3210.0)
                stock.append((points.min(axis=0), points.max(axis=0)))
    rows = (whole.tables or {})["nesting"]
    assert found["CUT"] == len(rows) == 27
    assert found["STOCK"] == sum(row["sheets"] for row in (whole.tables or {})["glass"])
    panes = [part.shape for part in whole.parts.values() if part.kind.role == "panel"]
    larger = not all(np.array_equal(pane.inner, pane.outer) for pane in panes)
    area = math.fsum(row["area_m2"] for row in (whole.tables or {})["glass"]) * 1e6
    # the outer face is the larger one of a convex shell; arcs of bevelled panes are chords
    assert sum(areas) == pytest.approx(area, rel=1e-5 if larger else 1e-7)
    for low, high in panes_at:  # every outline is on one sheet, 20 mm from its edges
        inside = [
            box for box in stock if (low >= box[0] + 19.98).all() and (high <= box[1] - 19.98).all()
        ]
        assert len(inside) == 1


def test_the_layout_as_sheets_has_every_mark_and_no_fault(whole: Whole) -> None:
    sheets = [sheet for _, sheet in nesting_sheets(whole)]
    for sheet in sheets:
        assert faults(sheet) == []
    shown = Counter(text.text for sheet in sheets for text in sheet.texts())
    for row in (whole.tables or {})["panels"]:
        assert shown[row["mark"]] == 3  # one ply of 8 mm, two of 6 mm
    titles = [text for text in shown if text.startswith("pane ")]
    assert len(titles) == sum(row["sheets"] for row in (whole.tables or {})["glass"])


def test_the_layout_is_among_the_sheets_and_the_files(whole: Whole, tmp_path: Path) -> None:
    SHEETS.write_whole(tmp_path, whole)
    assert (tmp_path / "sheets" / "nesting.pdf").read_bytes().startswith(b"%PDF-")
    assert all(check.passed for check in SHEETS.check_whole(tmp_path, whole))
