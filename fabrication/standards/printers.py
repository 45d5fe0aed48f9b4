"""Printers: what each can make, from ``printers.toml``."""

from __future__ import annotations

from dataclasses import dataclass, fields
from functools import cache
from typing import Any, Literal

from ddgfab.errors import ProjectError
from ddgfab.suggest import nearest
from fabrication.standards.data import table


@dataclass(frozen=True)
class Printer:
    """A preset; lengths in mm, clearances a side.

    Attributes
    ----------
    key, name : in the data file, and for people
    process : "fdm", "sla" or "sls"
    layer : usual layer height
    clearance : between a pin and a bore that turns on it
    axial_gap : between two faces that slide past each other
    press : between a pin and the bore of a cap that is pressed on it
    wall : least wall around a bore
    stroke : least width of strokes and gaps of text
    text_depth : usual depth of text
    hole : least diameter of a bore
    metal_pin, printed_pin : usual diameter of a metal pin, least of a printed one
    material, density : and kg/m3
    coupon : clearances that the coupon tries
    source : where the numbers come from
    """

    key: str
    name: str
    process: Literal["fdm", "sla", "sls"]
    layer: float
    clearance: float
    axial_gap: float
    press: float
    wall: float
    stroke: float
    text_depth: float
    hole: float
    metal_pin: float
    printed_pin: float
    material: str
    density: float
    coupon: tuple[float, ...]
    source: str


def printer_keys() -> tuple[str, ...]:
    """The presets, the default one first."""
    return tuple(table("printers"))


@cache
def printer(key: str) -> Printer:
    """A preset by its key, such as "fdm-0.4".

    Raises
    ------
    ProjectError
        There is no such preset; the known ones are named.
    """
    known: dict[str, dict[str, Any]] = table("printers")
    if key not in known:
        near = nearest(key, known) or list(known)
        raise ProjectError(f'there is no printer "{key}"; near: {", ".join(near)}')
    data = {name.name: known[key][name.name] for name in fields(Printer) if name.name != "key"}
    return Printer(**(data | {"key": key, "coupon": tuple(map(float, data["coupon"]))}))
