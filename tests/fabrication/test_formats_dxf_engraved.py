"""Numbers on plates: open lines inside the outline, clear of holes, with an arrow upwards."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from test_formats_dxf import bar, pane, written

from fabrication.drawings.strokes import ROWS, strokes, width_of
from fabrication.formats.dxf.engrave import HEIGHTS, engraved
from fabrication.formats.dxf.read import read_dxf
from fabrication.parts.beam import CrossHole
from fabrication.solids.plate import Plate, plate
from fabrication.specs import Loop


def rectangle(width: float, height: float, angle: float = 0.0) -> Loop:
    corners = np.array([(0.0, 0.0), (width, 0.0), (width, height), (0.0, height)])
    c, s = np.cos(angle), np.sin(angle)
    return Loop(corners @ np.array([(c, s), (-s, c)]), np.zeros(4))


def circle(x: float, y: float, diameter: float) -> Loop:
    r = 0.5 * diameter
    return Loop(np.array([(x + r, y), (x - r, y)]), np.array([-1.0, -1.0]))


def test_every_letter_of_a_number_is_there_and_stays_in_its_cell() -> None:
    for letter in "ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-":
        own = strokes(letter, ROWS)
        assert own
        points = np.concatenate(own)
        assert points.min() >= 0.0
        assert (points.max(axis=0) <= (4.0, 6.0)).all()
    assert len({tuple(np.concatenate(strokes(c, 6.0)).ravel()) for c in "0123456789BNPLFG"}) == 16
    end = np.concatenate(strokes("BP-008", 10.0))[:, 0].max()
    assert end == pytest.approx(width_of("BP-008", 10.0))
    assert len(strokes("ä", 6.0)) == len(strokes("?", 6.0))


@pytest.mark.parametrize("angle", [0.0, 0.4, 1.5, 2.9])
def test_a_number_avoids_holes_and_edges(angle: float) -> None:
    turn = np.array([(np.cos(angle), np.sin(angle)), (-np.sin(angle), np.cos(angle))])
    holes = [(30.0, 20.0, 18.0), (75.0, 20.0, 18.0), (130.0, 12.0, 10.0)]
    loops = [rectangle(300.0, 40.0, angle)]
    loops += [circle(*(np.array([x, y]) @ turn), d) for x, y, d in holes]
    lines = engraved(Plate(8.0, tuple(loops)), "BP-008")
    points = np.concatenate(lines) @ turn.T
    height = np.ptp(points[:, 1])
    assert height == pytest.approx(10.0)
    assert np.ptp(points[:, 0]) == pytest.approx(width_of("BP-008", height))
    assert (points.min(axis=0) >= 0.55 * height).all()
    assert (points.max(axis=0) <= np.array([300.0, 40.0]) - 0.55 * height).all()
    for x, y, diameter in holes:
        away = np.linalg.norm(points - (x, y), axis=1).min()
        assert away > 0.5 * diameter + 0.3 * height


def test_what_does_not_fit_is_smaller_or_left_out() -> None:
    def height(width: float, depth: float) -> float:
        lines = engraved(Plate(5.0, (rectangle(width, depth),)), "BP-008")
        return float(np.ptp(np.concatenate(lines)[:, 1])) if lines else 0.0

    assert height(400.0, 60.0) == pytest.approx(HEIGHTS[0])
    assert height(400.0, 12.0) == pytest.approx(5.0)
    assert height(400.0, 4.0) == height(10.0, 10.0) == 0.0


def test_the_arrow_of_a_bar_points_to_its_outside() -> None:
    made = bar("FL 80x10")
    assert made.boundary is not None
    flat = plate(made.boundary)
    assert flat is not None
    assert flat.up is not None
    with_arrow, without = engraved(flat, "X"), strokes("X", 10.0)
    shaft, head = with_arrow[len(without) :]
    assert (shaft[1] - shaft[0]) / 10.0 == pytest.approx(np.array(flat.up))
    assert head[1] == pytest.approx(shaft[1])
    # The outside of a beam is z; the profile lies from z = -80 to 0, which is the higher side.
    top = flat.loops[0].points @ np.array(flat.up)
    assert (top.min(), top.max()) == (pytest.approx(-80.0), pytest.approx(0.0))


@pytest.mark.parametrize("release", ["R2010", "R12"])
def test_files_have_them_on_their_layer(tmp_path: Path, release: str) -> None:
    steel = bar("FL 80x10", CrossHole(110.0, -40.0, 18.0))
    for made, layer in ((steel, "ENGRAVE"), (pane(), "MARK")):
        path = written(made, tmp_path, release)
        drawn = [one for one in read_dxf(path) if one.layer not in ("CUT", "DETAIL")]
        assert {one.layer for one in drawn} == {layer}
        assert not any(one.closed for one in drawn)
        assert len(drawn) >= len(strokes(made.number, 10.0))
