"""Lists of a kit beside its parts: rods that metal pins are cut from, and an estimate of costs."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, Final

from fabrication.cutting import Stock, cut_from_stock
from fabrication.linkage.legends import RODS
from fabrication.linkage.links import Linkage
from fabrication.linkage.schedules import is_printed
from fabrication.parts.pin import PIN
from fabrication.project.statements import LEGEND, Statements
from fabrication.table import Table

if TYPE_CHECKING:
    from fabrication.linkage.project import KitProject

ROD_MM: Final = (1000.0,)
"""Usual length of rods of silver steel and stainless steel [mm] (DIN 175: 1 and 2 m)."""

ROD_TOLERANCE: Final = "ISO 286 h9"
"""Tolerance of drawn and ground rods."""


def kit_lists(
    linkage: Linkage, masses: Mapping[str, float], project: KitProject
) -> dict[str, Table]:
    """Tables "order", and "rods" and "costs" where there are metal pins and rates."""
    rods = rod_rows(linkage, project.stock.stock(ROD_MM))
    found = {"order": Table(order_rows(linkage, project), "order", LEGEND)}
    if rods:
        found["rods"] = Table(rods, "rods", RODS)
    return {**found, **project.rates.table(_quantities(linkage, masses))}


def order_rows(linkage: Linkage, project: KitProject) -> list[dict[str, Any]]:
    """What holds for all printed parts, and for all pins."""
    settings = linkage.settings
    printer, own = settings.printer, Statements("printed parts", "printer", project.printer)
    parts = Statements("printed parts", "parts", project.parts)
    pins = Statements("pins", "parts", project.parts)
    cut = Statements("pins", "stock", project.stock)
    rows = [
        own.row("printer", f"{printer.key}: {printer.name}", "preset"),
        own.row("layers", f"{printer.layer:g} mm", "preset"),
        own.row("material", f"{printer.material}; listed masses are of solid parts", "preset"),
        parts.row(
            "bores that turn",
            f"diameter {settings.bore:g} mm, {settings.clearance:g} mm a side round the pin; try "
            "the coupon first",
            "clearance_mm",
        ),
        parts.row("bores of caps", f"{settings.press:g} mm a side round the pin", "press_mm"),
    ]
    if is_printed(PIN, settings):
        return [*rows, pins.row("made of", f"printed, {printer.material}", "pin")]
    rod = f"round steel rod, diameter {settings.pin_diameter:g} mm, {ROD_TOLERANCE}"
    return [
        *rows,
        pins.row("made of", rod, "pin"),
        pins.row("ends", "cut square, deburred", "pin"),
        cut.row("cut list: width of a cut", f"{project.stock.kerf_mm:g} mm", "kerf_mm"),
    ]


def rod_rows(linkage: Linkage, stock: Stock) -> list[dict[str, Any]]:
    """A row a rod; none where pins are printed."""
    pins: dict[float, list[tuple[str, float]]] = {}
    for pin in linkage.pins:
        if not is_printed(PIN, linkage.settings):
            pins.setdefault(pin.shape.diameter, []).append((pin.mark, pin.shape.length))
    rows = []
    for diameter, found in sorted(pins.items()):
        for rod in cut_from_stock([length for _, length in found], stock).bars:
            own = [found[k] for k in rod.pieces]
            rows.append(
                {
                    "diameter_mm": diameter,
                    "stock_mm": rod.length,
                    "quantity": len(own),
                    "used_mm": math.fsum(length for _, length in own),
                    "rest_mm": rod.rest,
                    "cuts": ", ".join(f"{mark} {length:.1f}" for mark, length in own),
                    "marks": " ".join(mark for mark, _ in own),
                }
            )
    return rows


def _quantities(linkage: Linkage, masses: Mapping[str, float]) -> Iterator[tuple[str, str, float]]:
    """What [rates] are for: name of the rate, what it is, and how much of it there is."""
    printed = [family for family in linkage.families if is_printed(family.kind, linkage.settings)]
    mass = math.fsum(masses[family.number] * len(family.instances) for family in printed)
    yield "kg", f"printed parts, {linkage.settings.printer.material}, solid", mass
    if not is_printed(PIN, linkage.settings):
        yield "cut", "ends of metal pins", 2.0 * len(linkage.pins)
