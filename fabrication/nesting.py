"""Rectangles nested on stock sheets by guillotine cuts, as glass is cut: which piece goes where.

Two-dimensional cutting stock. The rectangles are packed by `rectpack`, whose guillotine packers
split what is left of a sheet by cuts from edge to edge (Jylanki 2010); of several rules the one
that needs the fewest sheets is kept. This is a heuristic, so the number of sheets is an estimate
from above; `least_sheets` is one from below. Lengths in mm.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from itertools import product
from typing import Any, Final

GRID: Final = 100
"""The packer counts in hundredths of a millimetre: whole numbers never overlap by rounding."""

BATCH: Final = 1000
"""More pieces are nested in batches that have large and small ones alike: the time grows with the
square of a batch, and each takes a sheet too many at most."""

RULES: Final = ("GuillotineBafMinas", "GuillotineBafSas", "GuillotineBssfMaxas")
"""Which free rectangle is taken, and how what is left of it is split: names of rectpack. Free
rectangles are not merged: a piece across two of them could not be cut from edge to edge."""

FEW: Final = 400
"""With more pieces only the first rule is tried."""


@dataclass(frozen=True)
class SheetStock:
    """What rectangles are cut from.

    width, height : of a sheet [mm]
    trim : cut off each edge of a sheet [mm]
    gap : land between two pieces [mm]
    """

    width: float
    height: float
    trim: float = 0.0
    gap: float = 0.0

    @property
    def land(self) -> tuple[float, float]:
        """What pieces may cover [mm]."""
        return self.width - 2.0 * self.trim, self.height - 2.0 * self.trim

    def takes(self, width: float, height: float) -> bool:
        """Whether a rectangle fits on a sheet, as it is or turned.

        >>> SheetStock(6000.0, 3210.0, trim=20.0).takes(3180.0, 1000.0)
        True
        """
        need = sorted((_units(width), _units(height)))
        have = sorted(map(_down, self.land))
        return all(side <= room for side, room in zip(need, have, strict=True))


@dataclass(frozen=True)
class Nested:
    """A rectangle on a sheet.

    piece : its place in the list given
    x, y : its lower left corner [mm], from that of the sheet
    turned : whether its width lies along the sheet's height
    """

    piece: int
    x: float
    y: float
    turned: bool


@dataclass(frozen=True)
class Nesting:
    """All sheets with their pieces, and the pieces that are larger than a sheet."""

    sheets: tuple[tuple[Nested, ...], ...]
    left: tuple[int, ...]


def nest(sizes: Sequence[tuple[float, float]], stock: SheetStock) -> Nesting:
    """Sheets for rectangles (width, height) of some sizes; the same sizes give the same sheets."""
    fitting = [k for k, size in enumerate(sizes) if stock.takes(*size)]
    left = tuple(k for k, size in enumerate(sizes) if not stock.takes(*size))
    fitting.sort(key=lambda k: (-sizes[k][0] * sizes[k][1], -max(sizes[k]), k))
    batches = max(1, math.ceil(len(fitting) / BATCH))
    sheets: list[tuple[Nested, ...]] = []
    for n in range(batches):
        own = fitting[n::batches]
        if own:
            sheets += _packed(own, sizes, stock)
    return Nesting(tuple(sheets), left)


def least_sheets(sizes: Sequence[tuple[float, float]], stock: SheetStock) -> int:
    """A number of sheets that no nesting goes below: the area, or pieces of which no two fit.

    Pieces whose smaller sides are more than half of the sheet's larger one are alone on theirs.

    >>> least_sheets([(60.0, 60.0)] * 3, SheetStock(100.0, 100.0))
    3
    """
    wide, high = (side + stock.gap for side in stock.land)
    grown = [(a + stock.gap, b + stock.gap) for a, b in sizes if stock.takes(a, b)]
    area = math.fsum(a * b for a, b in grown) / (wide * high)
    alone = sum(2.0 * min(pair) > max(wide, high) + 2.0 / GRID for pair in grown)
    return max(math.ceil(area - 1e-9), alone)


def _packed(
    own: Sequence[int], sizes: Sequence[tuple[float, float]], stock: SheetStock
) -> list[tuple[Nested, ...]]:
    """The sheets of some pieces by the rule that needs the fewest, and leaves the last emptiest."""
    import rectpack

    rules = RULES if len(own) <= FEW else RULES[:1]
    orders = (rectpack.SORT_AREA, rectpack.SORT_LSIDE, rectpack.SORT_SSIDE)
    tried = product(rules, orders if len(own) <= FEW else orders[:1])
    best: tuple[tuple[int, float], Any] | None = None
    for rule, order in tried:
        packer = rectpack.newPacker(
            mode=rectpack.PackingMode.Offline,
            bin_algo=rectpack.PackingBin.BBF,
            pack_algo=partial(getattr(rectpack, rule), merge=False),
            sort_algo=order,
            rotation=True,
        )
        for k in own:
            packer.add_rect(*(_units(side + stock.gap) for side in sizes[k]), rid=k)
        packer.add_bin(*(_down(side + stock.gap) for side in stock.land), count=math.inf)
        packer.pack()
        last = min(page.used_area() for page in packer)
        if best is None or (len(packer), last) < best[0]:
            best = ((len(packer), last), packer)
    assert best is not None
    sheets: list[list[Nested]] = [[] for _ in range(len(best[1]))]
    for sheet, x, y, width, _, k in sorted(best[1].rect_list(), key=lambda found: found[5]):
        turned = width != _units(sizes[k][0] + stock.gap)
        at = (stock.trim + x / GRID, stock.trim + y / GRID)
        sheets[sheet].append(Nested(k, *at, turned))
    return [tuple(sorted(sheet, key=lambda place: (place.x, place.y))) for sheet in sheets]


def _units(length: float) -> int:
    return math.ceil(GRID * length - 1e-6)


def _down(length: float) -> int:
    return math.floor(GRID * length + 1e-6)
