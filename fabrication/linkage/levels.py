"""Levels along the hinges: which bar sits above which on every pin.

A bar has the same level at both ends, so it slants least and turned parts stay congruent. Bars that
share a pin need different levels: a proper coloring of the bars, kept constant along the strips of
a net where it can be, so that a strip stays one part number.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import permutations, product
from typing import Final

import numpy as np

from ddgfab.errors import DetailError
from ddgfab.linkages import Mechanism
from ddgfab.mesh import Ints

STEPS: Final = 200_000
"""How many trials a coloring of strips may take before it counts as not found."""

MOST_ORDERS: Final = 5
"""Colors of which every order is a choice; of more only the first found and its turns are."""


def bars_at(mechanism: Mechanism) -> list[list[int]]:
    """The bars on each hinge, in order."""
    at: list[list[int]] = [[] for _ in range(mechanism.n_hinges)]
    for bar, hinges in enumerate(mechanism.bars.tolist()):
        for hinge in hinges:
            at[hinge].append(bar)
    return at


def neighbours_of(mechanism: Mechanism, groups: Ints) -> list[set[int]]:
    """For each group of bars the groups that it shares a pin with; itself where its own bars do."""
    near: list[set[int]] = [set() for _ in range(int(groups.max()) + 1)]
    for bars in bars_at(mechanism):
        for i, one in enumerate(bars):
            for two in bars[:i]:
                near[groups[one]].add(int(groups[two]))
                near[groups[two]].add(int(groups[one]))
    return near


def coloring(near: Sequence[set[int]], colors: int, order: Sequence[int]) -> list[int] | None:
    """A color of each node that differs from its neighbours', by backtracking; None without one.

    The nodes are taken where least choice is left, ties in the order given; a new color is tried
    only after the colors in use, so equal solutions are not found again. A node beside itself has
    none.
    """
    if any(k in others for k, others in enumerate(near)):
        return None
    found = [-1] * len(near)
    rank = {node: place for place, node in enumerate(order)}
    trials = 0

    def place(used: int, left: set[int]) -> bool:
        nonlocal trials
        if not left:
            return True
        taken = {node: {found[k] for k in near[node] if found[k] >= 0} for node in left}
        node = min(left, key=lambda k: (-len(taken[k]), rank[k]))
        for color in range(min(used + 1, colors)):
            trials += 1
            if trials > STEPS:
                return False
            if color in taken[node]:
                continue
            found[node] = color
            if place(max(used, color + 1), left - {node}):
                return True
        found[node] = -1
        return False

    return found if place(0, set(order)) else None


def bar_coloring(mechanism: Mechanism, colors: int) -> list[int] | None:
    """A color of each bar that differs at every pin, by chains of two colors; None without one.

    Always found where the colors are as many as the most bars on a pin and every closed chain of
    bars is even, as on all nets of quads (Koenig's theorem).
    """
    at: list[dict[int, int]] = [{} for _ in range(mechanism.n_hinges)]
    found = [-1] * mechanism.n_bars
    for bar, (i, j) in enumerate(mechanism.bars.tolist()):
        free = [[c for c in range(colors) if c not in at[h]] for h in (i, j)]
        if not free[0] or not free[1]:
            return None
        common = [c for c in free[0] if c in free[1]]
        color = common[0] if common else free[0][0]
        if not common:
            other, hinge, chain = free[1][0], j, []
            want = color
            while want in at[hinge]:
                chain.append(at[hinge][want])
                hinge = int(mechanism.bars[chain[-1]].sum()) - hinge
                want = other if want == color else color
                if hinge == i:
                    return None
            for member in chain:
                for h in mechanism.bars[member].tolist():
                    if at[h].get(found[member]) == member:
                        del at[h][found[member]]
            for member in chain:
                found[member] = other if found[member] == color else color
                for h in mechanism.bars[member].tolist():
                    at[h][found[member]] = member
        found[bar] = color
        at[i][color] = at[j][color] = bar
    return found


def even_levels(mechanism: Mechanism, most: int) -> Iterator[Ints]:
    """Choices of levels (E, 2) from 0, the same at both ends of a bar, fewest levels first.

    Strips are kept on one level where that takes no more levels than the fullest pin has bars, or
    where nothing else is left; turning all levels over gives nothing new and is left out.

    Raises
    ------
    DetailError
        A pin has more bars than there may be levels; it is named.
    """
    counts = [len(bars) for bars in bars_at(mechanism)]
    if max(counts) > most:
        pin = int(np.argmax(counts))
        raise DetailError(
            f"H-{pin:04d}: {counts[pin]} bars share this pin, and there are {most} levels; "
            f"allow {counts[pin]} levels"
        )
    strips = np.unique(mechanism.strips, return_inverse=True)[1]
    near = neighbours_of(mechanism, strips)
    for colors in range(max(counts), most + 1):
        by_strip = coloring(near, colors, range(len(near)))
        if by_strip is not None:
            bars = np.array(by_strip)[strips]
        else:
            by_bar = bar_coloring(mechanism, colors)
            if by_bar is None:
                continue
            bars = np.array(by_bar)
        orders: Iterator[tuple[int, ...]] = permutations(range(colors))
        if colors > MOST_ORDERS:
            orders = iter([tuple(range(colors))])
        for order in orders:
            if order[0] <= order[-1]:
                level = np.array(order)[bars]
                yield np.stack([level, level], axis=1)
        return
    raise DetailError(
        f"no assignment of {most} levels keeps all bars on a pin apart; allow more levels"
    )


def slanted_levels(mechanism: Mechanism) -> Iterator[Ints]:
    """All choices (E, 2) with two levels a pin, for linkages of two bars a pin.

    Most bars then climb from one level to the other, which lets some linkages fold farther.
    """
    at = bars_at(mechanism)
    if any(len(bars) != 2 for bars in at) or len(at) > 8:
        return
    for order in product((0, 1), repeat=len(at) - 1):
        levels = np.zeros((mechanism.n_bars, 2), dtype=np.int64)
        for hinge, (bars, first) in enumerate(zip(at, (0, *order), strict=True)):
            for k, bar in enumerate(bars):
                end = mechanism.bars[bar].tolist().index(hinge)
                levels[bar, end] = (k + first) % 2
        yield levels
