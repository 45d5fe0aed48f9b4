"""Glass on stock: nothing overlaps, every sheet can be cut from edge to edge, bounds hold."""

from __future__ import annotations

import math
import random
from itertools import combinations

import numpy as np
import pytest
from detailing_cases import dome, hexagons

from ddgfab.errors import ProjectError
from fabrication import design
from fabrication.gridshell.schedules import schedules
from fabrication.nesting import BATCH, Nesting, SheetStock, least_sheets, nest
from fabrication.parts.panel import PANEL
from fabrication.project.shop import GlassStockSettings
from fabrication.solids.polygon import least_rectangle_turn

Box = tuple[float, float, float, float]
STOCK = SheetStock(6000.0, 3210.0, trim=20.0, gap=15.0)
NEAR = 0.011
"""The packer counts in hundredths of a millimetre."""


def boxes(found: Nesting, sizes: list[tuple[float, float]]) -> list[list[Box]]:
    sheets = []
    for sheet in found.sheets:
        own = []
        for place in sheet:
            w, h = sizes[place.piece][:: -1 if place.turned else 1]
            own.append((place.x, place.y, place.x + w, place.y + h))
        sheets.append(own)
    return sheets


def cut_from_edge_to_edge(own: list[Box], gap: float) -> bool:
    """Whether cuts through the whole of what is left part all rectangles."""
    if len(own) < 2:
        return True
    for axis in (0, 1):
        ordered = sorted(own, key=lambda box: box[axis])
        reach = -math.inf
        for k, box in enumerate(ordered):
            if k and box[axis] >= reach + gap - NEAR:
                return cut_from_edge_to_edge(ordered[:k], gap) and cut_from_edge_to_edge(
                    ordered[k:], gap
                )
            reach = max(reach, box[axis + 2])
    return False


def apart(one: np.ndarray, two: np.ndarray) -> float:
    """Greatest distance of two convex polygons along a normal of a side: negative: they overlap."""
    best = -math.inf
    for a, b in ((one, two), (two, one)):
        along = np.roll(a, -1, axis=0) - a
        normals = np.column_stack([along[:, 1], -along[:, 0]])
        normals /= np.linalg.norm(normals, axis=1)[:, None]
        best = max(best, float(((b @ normals.T).min(axis=0) - (a @ normals.T).max(axis=0)).max()))
    return best


def some(seed: int, count: int) -> list[tuple[float, float]]:
    chance = random.Random(seed)
    return [(chance.uniform(150, 2600), chance.uniform(150, 1700)) for _ in range(count)]


def test_the_test_of_cuts_refuses_a_pinwheel() -> None:
    wheel = [(0, 0, 2, 1), (2, 0, 3, 2), (1, 2, 3, 3), (0, 1, 1, 3)]
    assert not cut_from_edge_to_edge([tuple(map(float, box)) for box in wheel], 0.0)
    assert cut_from_edge_to_edge([(0.0, 0.0, 1.0, 2.0), (1.0, 0.0, 2.0, 1.0)], 0.0)


@pytest.mark.parametrize("seed", range(6))
def test_rectangles_keep_gap_and_trim_and_can_be_cut_from_edge_to_edge(seed: int) -> None:
    sizes = some(seed, 30 + 40 * seed)
    found = nest(sizes, STOCK)
    placed = sorted(place.piece for sheet in found.sheets for place in sheet)
    assert placed == list(range(len(sizes)))
    for own in boxes(found, sizes):
        for x0, y0, x1, y1 in own:
            assert min(x0, y0) >= STOCK.trim - NEAR
            assert x1 <= STOCK.width - STOCK.trim + NEAR
            assert y1 <= STOCK.height - STOCK.trim + NEAR
        for a, b in combinations(own, 2):
            room = max(b[0] - a[2], a[0] - b[2], b[1] - a[3], a[1] - b[3])
            assert room >= STOCK.gap - NEAR
        assert cut_from_edge_to_edge(own, STOCK.gap)
    assert least_sheets(sizes, STOCK) <= len(found.sheets) <= 1.35 * least_sheets(sizes, STOCK) + 1
    assert nest(sizes, STOCK) == found


def test_sheets_that_are_filled_exactly_and_pieces_that_are_too_large() -> None:
    stock = SheetStock(1000.0, 500.0, trim=10.0, gap=20.0)
    halves = [(480.0, 480.0)] * 6
    assert len(nest(halves, stock).sheets) == 3 == least_sheets(halves, stock)
    sizes = [(480.01, 980.0), (480.02, 980.02), (980.0, 480.0), (480.0, 980.0)]
    found = nest(sizes, stock)
    assert found.left == (0, 1)
    assert len(found.sheets) == 2
    assert nest([], stock) == Nesting((), ())


def test_many_pieces_are_nested_in_batches_that_lose_little() -> None:
    sizes = [(a / 4.0, b / 4.0) for a, b in some(1, 2 * BATCH + 7)]
    found = nest(sizes, STOCK)
    assert sorted(p.piece for sheet in found.sheets for p in sheet) == list(range(len(sizes)))
    assert len(found.sheets) <= 1.2 * least_sheets(sizes, STOCK)


@pytest.mark.parametrize("turn", [0.3, -1.2, 1.5, 3.0])
def test_the_larger_side_of_the_least_rectangle_lies_along_x_when_turned_back(turn: float) -> None:
    box = np.array([[0.0, 0.0], [5.0, 0.0], [5.0, 2.0], [0.0, 2.0]])
    c, s = math.cos(turn), math.sin(turn)
    angle = float(least_rectangle_turn(box @ np.array([[c, s], [-s, c]])))
    assert math.sin(angle - turn) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize(
    ("panel", "plies"),
    [
        ({}, {(1, 12.0): 1}),
        ({"build_up": "8/16Ar/6.6.2", "edge": "mitred"}, {(1, 8.0): 1, (2, 6.0): 2}),
        ({"build_up": "8.6.2", "corner_radius_mm": 5.0}, {(1, 8.0): 1, (1, 6.0): 1}),
    ],
)
def test_plies_of_panes_lie_on_stock_without_overlap(
    panel: dict[str, object], plies: dict[tuple[int, float], int]
) -> None:
    """By the corners of the panes themselves, turned and moved as the list says."""
    shell = dome().detail(panel=panel, stock={"glass_mm": [2000, 2600], "glass_gap_mm": 12})
    tables = schedules(shell)
    corners = {}
    for piece in shell.pieces:
        if piece.kind == PANEL:
            corners[piece.mark] = np.concatenate([piece.shape.inner, piece.shape.outer])
    numbers = {row["mark"]: row["number"] for row in tables["panels"]}
    own_shape = {}  # lists are about the shape of the part number
    for mark in sorted(corners):
        own_shape.setdefault(numbers[mark], corners[mark])
    rows = list(tables["nesting"])
    assert len(rows) == len(corners) * sum(plies.values())
    lying: dict[tuple[int, float, int], list[np.ndarray]] = {}
    for row in rows:
        angle = math.radians(row["turn_deg"])
        c, s = math.cos(angle), math.sin(angle)
        turned = own_shape[numbers[row["mark"]]] @ np.array([[c, s], [-s, c]])
        assert np.ptp(turned, axis=0) == pytest.approx([row["width_mm"], row["height_mm"]])
        placed = turned - turned.min(axis=0) + [row["x_mm"], row["y_mm"]]
        origin = [row["origin_x_mm"], row["origin_y_mm"]]
        assert turned + origin == pytest.approx(placed)
        assert placed.min() >= 20.0 - NEAR
        assert (placed.max(axis=0) <= np.array([2600.0, 2000.0]) - 20.0 + NEAR).all()
        key = (row["pane"], row["ply_mm"], row["sheet"])
        count = len(placed) // 2
        lying.setdefault(key, []).extend([placed[:count], placed[count:]])
    for own in lying.values():
        for (i, one), (j, two) in combinations(enumerate(own), 2):
            if i // 2 != j // 2:
                assert apart(one, two) >= 12.0 - NEAR
    glass = list(tables["glass"])
    assert {(row["pane"], row["ply_mm"]): row["plies"] for row in glass} == plies
    for row in glass:
        mine = [key for key in lying if key[:2] == (row["pane"], row["ply_mm"])]
        assert row["sheets"] == len(mine) >= row["least_sheets"] > 0
        area = math.fsum(tables["panels"].column("area_m2")) * row["plies"]
        assert row["area_m2"] == pytest.approx(area)
        assert row["bought_m2"] == pytest.approx(len(mine) * 2.0 * 2.6)
        assert row["fill_percent"] == pytest.approx(100.0 * area / row["bought_m2"])
        assert row["basis"].startswith("estimate")


def test_panes_of_any_sides_and_structures_without_panes() -> None:
    tables = schedules(hexagons().detail(panel={"offset_mm": 60.0}))
    assert len(tables["nesting"]) == len(tables["panels"])
    assert "glass" not in schedules(dome().detail(panel={"kind": "none"}))


def test_a_pane_larger_than_the_stock_is_named_with_the_stock_that_takes_it() -> None:
    case = dome()
    with pytest.raises(ProjectError) as caught:
        design(case.mesh, axes=case.axes, stock={"glass_mm": [500, 2000]})
    text = str(caught.value)
    assert "P-00" in text
    assert "500 x 2000 mm less [stock] glass_trim_mm = 20" in text
    assert "460 x 1960 mm" in text
    size = text.partition('--set "stock.glass_mm=[')[2].partition("]")[0]
    made = design(
        case.mesh, axes=case.axes, stock={"glass_mm": [float(side) for side in size.split(", ")]}
    )
    assert sum(made.schedules["glass"].column("larger")) == 0


@pytest.mark.parametrize(
    ("stock", "message"),
    [
        ({"glass_mm": [100, 200], "glass_trim_mm": 50}, "glass_trim_mm = 50 at both edges"),
        ({"glass_trim_mm": 2000}, "less than 1605"),
        ({"glass_mm": [0, 200]}, "glass_mm"),
        ({"glass_mm": [3210]}, "glass_mm"),
        ({"glass_gap_mm": -1}, "glass_gap_mm"),
    ],
)
def test_wrong_stock_of_glass_is_named(stock: dict[str, object], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        GlassStockSettings.model_validate(stock)
