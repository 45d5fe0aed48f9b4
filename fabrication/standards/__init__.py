"""Profiles, bolts, node stock, materials, printers: data files with sources, and their loaders."""

from fabrication.standards.data import (
    bolt_end_distance,
    bolt_hole,
    bolt_least_distance,
    density,
    mass_kg,
    node_diameters,
    stock_size,
)
from fabrication.standards.printers import Printer, printer, printer_keys
from fabrication.standards.profiles import lying, polygon, profile

__all__ = [
    "Printer",
    "bolt_end_distance",
    "bolt_hole",
    "bolt_least_distance",
    "density",
    "lying",
    "mass_kg",
    "node_diameters",
    "polygon",
    "printer",
    "printer_keys",
    "profile",
    "stock_size",
]
