"""Bars cut from stock: which pieces come out of which bar, how much is left, and what is the least.

One-dimensional cutting stock. The pieces are taken by best fit decreasing, and by filling one bar
after the other as full as it gets (minimum bin slack, Gupta and Ho 1999, with the longest piece
that is left in every bar: Fleszar and Hindi 2002); the better of the two is kept. The least number
of bars is the bound L2 of Martello and Toth (1990). Lengths in mm.
"""

from __future__ import annotations

import math
from bisect import bisect_left, insort
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

TRIES: Final = 500
"""So many fillings of a bar are looked at."""

MANY: Final = 3000
"""More pieces are taken by best fit alone: filling bar after bar takes the square of their "
"number."""

EXACT: Final = 1e-6
"""A filling that leaves less [mm] is full; a piece may be longer than the stock by less."""


@dataclass(frozen=True)
class Stock:
    """What bars are cut from.

    lengths : of the bars that can be had [mm], ascending
    kerf : what a cut takes [mm]
    trim : cut off each end of a bar [mm]
    """

    lengths: tuple[float, ...]
    kerf: float = 0.0
    trim: float = 0.0

    def room(self, length: float) -> float:
        """How much of a bar there is for pieces, each with one cut."""
        return length - 2 * self.trim + self.kerf


@dataclass(frozen=True)
class Bar:
    """A bar of stock and its pieces, by their place in the list given, the longest first.

    length : of the stock [mm]; None where a piece is longer than all stock
    rest : what is left of it [mm]
    """

    length: float | None
    pieces: tuple[int, ...]
    rest: float


@dataclass(frozen=True)
class Cutting:
    """All bars, and the least number of bars of the longest stock that could do.

    The bound does not count pieces that are longer than all stock.
    """

    bars: tuple[Bar, ...]
    bound: int


def cut_from_stock(lengths: Sequence[float], stock: Stock) -> Cutting:
    """Bars for pieces of some lengths; every piece comes out of one bar.

    A bar that is not full is cut from the shortest stock that takes its pieces.
    """
    longest = max(stock.lengths)
    room = stock.room(longest)
    sizes = [length + stock.kerf for length in lengths]
    order = sorted(range(len(sizes)), key=lambda k: (-sizes[k], k))
    fitting = [k for k in order if sizes[k] <= room + EXACT]
    found = [_best_fit(fitting, sizes, room)]
    if len(fitting) <= MANY:
        found.append(_fullest(fitting, sizes, room))
    bars = min(
        found,
        key=lambda bars: (len(bars), sum(_shortest(bar, sizes, stock) for bar in bars)),
    )
    made = [_bar(bar, lengths, sizes, stock) for bar in bars]
    too_long = [Bar(None, (k,), 0.0) for k in order if sizes[k] > room + EXACT]
    bound = least_bars([sizes[k] for k in fitting], room)
    return Cutting((*too_long, *made), bound)


def least_bars(sizes: Sequence[float], room: float) -> int:
    """A number of bins that no packing of sizes goes below: L2 of Martello and Toth (1990).

    >>> least_bars([6.0, 6.0, 6.0], 10.0), least_bars([4.0, 4.0, 4.0], 10.0)
    (3, 2)
    """
    ordered = sorted(sizes)
    if not ordered:
        return 0
    sums = [0.0]
    for size in ordered:
        sums.append(sums[-1] + size)

    def above(limit: float) -> int:
        """Place of the first size that is more than a limit."""
        return bisect_left(ordered, limit + EXACT)

    best = math.ceil(sums[-1] / room - EXACT)
    half = above(room / 2)
    for small in {0.0, *(size for size in ordered if size <= room / 2 + EXACT)}:
        large, low = above(room - small), bisect_left(ordered, small - EXACT)
        alone = len(ordered) - large
        between = max(large - half, 0)
        middle = sums[min(half, large)] - sums[min(low, half)]
        free = between * room - (sums[large] - sums[min(half, large)])
        best = max(best, alone + between + max(0, math.ceil((middle - free) / room - EXACT)))
    return best


def _best_fit(order: Sequence[int], sizes: Sequence[float], room: float) -> list[list[int]]:
    """Each piece, the longest first, into the fullest bar that takes it."""
    bars: list[list[int]] = []
    rests: list[tuple[float, int]] = []  # ascending
    for k in order:
        at = bisect_left(rests, (sizes[k] - EXACT, -1))
        if at == len(rests):
            bars.append([k])
            insort(rests, (room - sizes[k], len(bars) - 1))
        else:
            rest, best = rests.pop(at)
            bars[best].append(k)
            insort(rests, (rest - sizes[k], best))
    return bars


def _fullest(order: Sequence[int], sizes: Sequence[float], room: float) -> list[list[int]]:
    """One bar after the other, the longest piece first and then what fills it best."""
    left = list(order)
    bars = []
    while left:
        first = left[0]
        rest = room - sizes[first]
        chosen = _fill(left[1:], sizes, rest)
        bars.append([first, *chosen])
        taken = {first, *chosen}
        left = [k for k in left if k not in taken]
    return bars


def _fill(left: Sequence[int], sizes: Sequence[float], room: float) -> list[int]:
    """Pieces, the longest first, that leave least of a room; the best of `TRIES` fillings."""
    best: list[int] = []
    least = room
    tries = 0
    downwards = [-sizes[k] for k in left]
    stack: list[tuple[int, float, tuple[int, ...]]] = [(0, room, ())]
    while stack and tries < TRIES and least > EXACT:
        start, rest, chosen = stack.pop()
        place = bisect_left(downwards, -(rest + EXACT), lo=start)  # the longest that still fits
        tries += 1
        if place == len(left):
            if rest < least:
                least, best = rest, list(chosen)
            continue
        same = place
        while same < len(left) and sizes[left[same]] == sizes[left[place]]:
            same += 1
        stack.append((same, rest, chosen))  # without pieces of this length
        if rest < least:
            least, best = rest, list(chosen)
        stack.append((place + 1, rest - sizes[left[place]], (*chosen, left[place])))
    return best


def _shortest(bar: Sequence[int], sizes: Sequence[float], stock: Stock) -> float:
    """The shortest stock that takes a bar's pieces."""
    needed = sum(sizes[k] for k in bar) - EXACT
    fits = [length for length in sorted(stock.lengths) if stock.room(length) >= needed]
    return fits[0] if fits else max(stock.lengths)


def _bar(bar: Sequence[int], lengths: Sequence[float], sizes: Sequence[float], stock: Stock) -> Bar:
    length = _shortest(bar, sizes, stock)
    used = 2 * stock.trim + sum(sizes[k] for k in bar)
    return Bar(length, tuple(bar), max(0.0, length - used))
