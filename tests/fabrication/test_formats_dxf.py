"""DXF: audited and measured by ezdxf, compared with the shapes' own numbers."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from gridshell_kinds import KINDS
from roofs import barrel

from ddgfab.errors import InputError
from fabrication.formats.base import Header, Material, Part, Provenance
from fabrication.formats.dxf import FORMAT
from fabrication.formats.report import inspect_file
from fabrication.gridshell.design import design
from fabrication.parts.beam import BeamShape, CrossHole, EndCut
from fabrication.parts.fastener import FASTENER, FastenerShape
from fabrication.parts.node import ReferenceMark
from fabrication.parts.panel import PanelShape
from fabrication.parts.spool import SPOOL, SpoolShape
from fabrication.solids import realise
from fabrication.specs import Family, Kind, Shape
from fabrication.standards.profiles import profile

CORNERS = np.array([[0.0, 0.0], [900.0, 0.0], [850.0, 720.0], [20.0, 650.0]])
MIDDLE = CORNERS.mean(axis=0)
ABOUT = Provenance("roof", Header())


def part(shape: Shape, kind: Kind) -> Part:
    family = Family("XP-001", kind, shape, (), 0.0)
    return Part.of(family, realise(shape, 0.1, solid=False), Material("steel", 7850.0))


def pane(radius: float = 0.0, bevel: float = 0.0) -> Part:
    inner = (CORNERS - MIDDLE) * (1.0 - bevel) + MIDDLE
    return part(PanelShape(12.0, inner, CORNERS, radius), KINDS["panel"])


def bar(name: str = "FL 80x10", *holes: CrossHole, slope: float = 0.2) -> Part:
    cuts = EndCut(40.0, slope), EndCut(1300.0, -0.1)
    return part(BeamShape(profile(name), *cuts, holes), KINDS["beam"])


def written(made: Part, folder: Path, release: str = "R2010") -> Path:
    path = folder / f"{release}.dxf"
    FORMAT.write_part(path, made, Provenance("roof", Header(), {"dxf": {"release": release}}))
    return path


def drawn(path: Path) -> tuple[Any, dict[str, list[np.ndarray]]]:
    """The document by ezdxf, and its outlines by layer; ezdxf flattens arcs as Bezier curves."""
    import ezdxf.filemanagement
    import ezdxf.path

    document = ezdxf.filemanagement.readfile(path)
    outlines: dict[str, list[np.ndarray]] = {}
    for entity in document.modelspace():
        flat = ezdxf.path.make_path(entity).flattening(1e-4)
        outlines.setdefault(entity.dxf.layer, []).append(np.array([[p.x, p.y] for p in flat]))
        assert entity.is_closed == (entity.dxf.layer in ("CUT", "DETAIL"))
        assert entity.dxftype() in ("LWPOLYLINE", "POLYLINE")  # never TEXT
    return document, outlines


def area(ring: np.ndarray) -> float:
    x, y = ring.T
    return float(0.5 * np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))


@pytest.mark.parametrize("release", ["R2010", "R12"])
def test_a_pane_is_its_outline(tmp_path: Path, release: str) -> None:
    document, outlines = drawn(written(pane(), tmp_path, release))
    audit = document.audit()
    assert (audit.errors, audit.fixes) == ([], [])
    assert document.dxfversion == {"R2010": "AC1024", "R12": "AC1009"}[release]
    assert document.units == (4 if release == "R2010" else 0)
    (ring,) = outlines["CUT"]
    # The same quadrilateral, wherever its frame lies: sides in order, and area.
    sides = np.linalg.norm(np.diff(np.vstack([ring[:4], ring[:1]]), axis=0), axis=1)
    wanted = np.linalg.norm(np.roll(CORNERS, -1, axis=0) - CORNERS, axis=1)
    assert any(np.allclose(np.roll(sides, k), wanted, atol=1e-8) for k in range(4))
    assert area(ring) == pytest.approx(area(CORNERS), rel=1e-12)


@pytest.mark.parametrize("release", ["R2010", "R12"])
def test_round_corners_are_arcs(tmp_path: Path, release: str) -> None:
    _, outlines = drawn(written(pane(radius=20.0), tmp_path, release))
    (ring,) = outlines["CUT"]
    sides = np.roll(CORNERS, -1, axis=0) - CORNERS
    turns = [
        math.atan2(a[0] * b[1] - a[1] * b[0], a @ b)
        for a, b in zip(sides, np.roll(sides, -1, axis=0), strict=True)
    ]
    lost = sum(20.0**2 * (math.tan(t / 2.0) - t / 2.0) for t in turns)
    assert area(ring) == pytest.approx(area(CORNERS) - lost, rel=1e-7)
    length = np.linalg.norm(np.diff(ring, axis=0), axis=1).sum()
    straight = np.linalg.norm(sides, axis=1).sum()
    rounded = sum(20.0 * (t - 2.0 * math.tan(t / 2.0)) for t in turns)
    assert length == pytest.approx(straight + rounded, rel=2e-6)


def test_a_flat_bar_has_its_holes_and_mitres(tmp_path: Path) -> None:
    _, outlines = drawn(written(bar("FL 80x10", CrossHole(300.0, -40.0, 13.0)), tmp_path))
    outer, hole = outlines["CUT"]
    assert (area(outer) > 0.0, area(hole) < 0.0) == (True, True)
    assert area(hole) == pytest.approx(-math.pi * 6.5**2, rel=5e-4)
    # A trapezoid: lengths at its top and bottom, z = 0 and -80, times the depth.
    top, bottom = 1260.0, 1260.0 + (-0.1 - 0.2) * -80.0
    assert area(outer) == pytest.approx(0.5 * (top + bottom) * 80.0, rel=1e-9)
    # The hole keeps its distance from the nearer end and side.
    assert np.linalg.norm(outer[:-1] - hole.mean(axis=0), axis=1).min() == pytest.approx(
        math.hypot(260.0, 40.0), abs=3.0
    )


def test_a_bevelled_pane_shows_both_faces(tmp_path: Path) -> None:
    _, outlines = drawn(written(pane(bevel=0.02), tmp_path))
    (cut,), (detail,) = outlines["CUT"], outlines["DETAIL"]
    assert area(cut) == pytest.approx(area(CORNERS), rel=1e-9)
    assert area(detail) == pytest.approx(area(CORNERS) * 0.98**2, rel=1e-9)
    gap = np.linalg.norm(cut[:4].mean(axis=0) - detail[:4].mean(axis=0))
    assert gap < 1e-6  # both lie over each other


def test_a_disc_of_a_node_is_its_strips_and_holes(tmp_path: Path) -> None:
    """Cut twice; the file is compared with the volume of the node, less its core."""
    spool = SpoolShape(
        200.0, 100.0, 10.0, 40.0, -45.0, 35.0, (0.0, 1.9, 4.0), (120.0, 170.0), 13.5,
        ReferenceMark(20.0, 3.0, 1.0),
    )  # fmt: skip
    made = part(spool, SPOOL)
    path = written(made, tmp_path)
    assert all(check.passed for check in FORMAT.check_part(path, made))
    _, outlines = drawn(path)
    outer, *holes = outlines["CUT"]
    assert len(holes) == 6
    assert {round(float(np.hypot(*hole[:-1].mean(axis=0))), 3) for hole in holes} == {120.0, 170.0}
    core = math.pi * 40.0**2 * 60.0 - math.pi * 1.5**2
    net = area(outer) - 6 * math.pi * 6.75**2
    assert 20.0 * net + core == pytest.approx(made.properties.volume, rel=1e-9)
    thinner = part(replace(spool, width=90.0), SPOOL)
    assert not all(check.passed for check in FORMAT.check_part(path, thinner))


def test_only_plates_have_a_file() -> None:
    bolt = FastenerShape("washer", "ISO 7089 13", 0.0, 0.0, 24.0, 13.0, 0.0, 2.5)
    assert FORMAT.takes(pane().family)
    assert FORMAT.takes(bar().family)
    assert not FORMAT.takes(bar("RHS 100x50x4").family)
    assert not FORMAT.takes(bar("T 80x80x9").family)
    assert not FORMAT.takes(Family("FP-001", FASTENER, bolt, (), 0.0))
    made = design(barrel(1, 2)).product()
    assert {f.role for f in made.families if FORMAT.takes(f)} == {"beam", "panel"}


@pytest.mark.parametrize("release", ["R2010", "R12"])
def test_the_same_part_gives_the_same_bytes(tmp_path: Path, release: str) -> None:
    one = written(pane(radius=5.0), tmp_path, release).read_bytes()
    assert written(pane(radius=5.0), tmp_path, release).read_bytes() == one


@pytest.mark.parametrize(
    ("old", "new", "check"),
    [
        (" 70\r\n1\r\n 10", " 70\r\n0\r\n 10", "dxf corners_mm"),
        ("\r\nCUT\r\n100", "\r\nDETAIL\r\n100", "dxf corners_mm"),
        ("LWPOLYLINE", "SPLINE", "dxf outlines"),
        ("\r\nEOF", "\r\n", "dxf readable"),
    ],
)
def test_damage_is_found(tmp_path: Path, old: str, new: str, check: str) -> None:
    made = pane(radius=5.0)
    path = written(made, tmp_path)
    assert all(c.passed for c in FORMAT.check_part(path, made))
    text = path.read_bytes().decode("ascii")
    assert old in text
    path.write_bytes(text.replace(old, new).encode("ascii"))
    assert check in {c.name for c in FORMAT.check_part(path, made) if not c.passed}


def test_a_corner_that_moved_is_found(tmp_path: Path) -> None:
    made, other = pane(), pane(bevel=0.02)
    path = written(other, tmp_path)
    text = path.read_bytes().decode("ascii")
    assert text.count("900.0") >= 1
    path.write_bytes(text.replace("900.0", "900.01", 1).encode("ascii"))
    failed = {c.name: c.value for c in FORMAT.check_part(path, other) if not c.passed}
    assert failed == {"dxf corners_mm": pytest.approx(0.01, rel=1e-6)}
    path = written(made, tmp_path)
    path.write_bytes(path.read_bytes().replace(b"900.0", b"900.01", 1))
    assert {c.name for c in FORMAT.check_part(path, made) if not c.passed} == {
        "dxf corners_mm",
        "dxf volume",
    }


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"", "no DXF file"),
        (b"AutoCAD Binary DXF\r\n\x1a\x00", "binary"),
        (
            b"0\nSECTION\n2\nENTITIES\n0\nLWPOLYLINE\n10\nnan\n0\nEOF\n",
            r"a\.dxf:8: must be a finite",
        ),
        (b"0\nSECTION\n2\nENTITIES\n0\nLWPOLYLINE\n10\n1e99\n0\nEOF\n", "at most 1e.60, not 1e99"),
        (b"x\nSECTION\n", r"a\.dxf:1: a group code"),
        (b"0\nSECTION\n2\nENTITIES\n", "does not end with EOF"),
    ],
)
def test_files_that_are_broken_are_refused(tmp_path: Path, data: bytes, message: str) -> None:
    (tmp_path / "a.dxf").write_bytes(data)
    with pytest.raises(InputError, match=message):
        inspect_file(tmp_path / "a.dxf")


def test_check_tells_of_open_outlines(tmp_path: Path) -> None:
    path = written(pane(), tmp_path)
    assert inspect_file(path).passed
    path.write_bytes(path.read_bytes().replace(b" 70\r\n1\r\n 10", b" 70\r\n0\r\n 10"))
    assert inspect_file(path).problems == ("polyline 1 on CUT is open",)
