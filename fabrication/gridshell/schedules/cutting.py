"""The cut list: which beams and nodes come out of which bar of stock, and what it takes in all."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Final

from fabrication.cutting import Bar, Stock, cut_from_stock
from fabrication.formats.tables import Legend
from fabrication.gridshell.schedules.common import Row, bars_of
from fabrication.specs import Family, Profile, Role
from fabrication.standards.profiles import stock_lengths

BARS: Final = Legend(
    title="Cut list by stock",
    about="a bar of stock, and the beams, nodes or posts that come out of it",
    meanings={
        "profile": "cross-section of the bar; of nodes and posts round or tube, with the diameter",
        "stock_mm": "length of the bar as it is bought; empty: no stock is long enough for the "
        "beam, to be spliced or ordered by length",
        "quantity": "how many pieces come out of the bar",
        "used_mm": "lengths to saw of these pieces, over all; bars are cut square, mitres after it",
        "rest_mm": "what is left of the bar after its cuts and the trim of both ends",
        "cuts": "mark and length to saw [mm] of each piece, the longest first",
        "marks": "the pieces",
    },
    totals=("quantity", "stock_mm", "used_mm", "rest_mm"),
    unprinted=("marks",),
)

STOCK: Final = Legend(
    title="Stock to buy",
    about="bars of one profile and length: how many, and how much of them is waste",
    meanings={
        "profile": "cross-section of the bars; of nodes and posts round or tube, with the diameter",
        "material": "what it is made of: grade and treatment as the project states them",
        "stock_mm": "length of a bar as it is bought; empty: by length",
        "bars": "how many bars",
        "quantity": "how many pieces come out of them",
        "used_mm": "lengths to saw of these pieces, over all",
        "bought_mm": "length of all these bars",
        "waste_percent": "what is bought and not used, of what is bought",
        "least_bars": "fewest bars of the longest stock from which all beams of the profile could "
        "be cut (bound of Martello and Toth 1990), whatever the order of cuts",
        "marks": "the pieces that are cut from them",
    },
    totals=("bars", "quantity", "used_mm", "bought_mm"),
    unprinted=("marks",),
)


TRANSPORT_MM: Final = 12_000.0
"""Longer stock [mm] is not taken by itself: a lorry's bed is 13.6 m long (Directive 96/53/EC)."""

OF_NO_STANDARD: Final = (6000.0, 12000.0)
"""Lengths [mm] of stock for a profile of a free polygon."""


def usual_lengths(section: Profile) -> tuple[float, ...]:
    """Lengths [mm] in which a profile is usually delivered, up to `TRANSPORT_MM`."""
    found = stock_lengths(section)
    known = OF_NO_STANDARD if found is None else found[0]
    return tuple(length for length in known if length <= TRANSPORT_MM)


ROUND_MM: Final = (6000.0,)
"""Length [mm] in which round bars and tubes for nodes are usually delivered, as flat bars."""


def cut_rows(
    families: Sequence[Family], stock: Callable[[Role], Stock], material: Callable[[Family], str]
) -> tuple[list[Row], list[Row]]:
    """Rows of the bars, and of the stock to buy, by profile.

    Parameters
    ----------
    stock : what bars of a role are cut from
    material : what pieces of a part number are made of
    """
    pieces: dict[tuple[Role, str, str], list[tuple[str, float]]] = {}
    for family in families:
        for profile, length in bars_of(family.shape):
            own = pieces.setdefault((family.role, profile, material(family)), [])
            own += [(instance.mark, length) for instance in family.instances]
    bars, bought = [], []
    for (role, profile, made_of), found in sorted(pieces.items()):
        found.sort()
        cutting = cut_from_stock([length for _, length in found], stock(role))
        bars += [_bar_row(profile, bar, found) for bar in cutting.bars]
        by_length: dict[float | None, list[Bar]] = {}
        for bar in cutting.bars:
            by_length.setdefault(bar.length, []).append(bar)
        for bought_as, alike in sorted(by_length.items(), key=lambda item: item[0] or 0.0):
            used = sum(found[k][1] for bar in alike for k in bar.pieces)
            total = used if bought_as is None else bought_as * len(alike)
            bought.append(
                {
                    "profile": profile,
                    "material": made_of,
                    "stock_mm": bought_as,
                    "bars": len(alike),
                    "quantity": sum(len(bar.pieces) for bar in alike),
                    "used_mm": used,
                    "bought_mm": total,
                    "waste_percent": 100.0 * (1.0 - used / total),
                    "least_bars": cutting.bound,
                    "marks": " ".join(found[k][0] for bar in alike for k in bar.pieces),
                }
            )
    return bars, bought


def _bar_row(profile: str, bar: Bar, found: Sequence[tuple[str, float]]) -> Row:
    own = [found[k] for k in bar.pieces]
    return {
        "profile": profile,
        "stock_mm": bar.length,
        "quantity": len(own),
        "used_mm": sum(length for _, length in own),
        "rest_mm": bar.rest,
        "cuts": ", ".join(f"{mark} {length:.1f}" for mark, length in own),
        "marks": " ".join(mark for mark, _ in own),
    }
