"""Profiles, fasteners, node stock, materials, printers: data files with sources, loaders."""

from fabrication.standards.data import (
    density,
    mass_kg,
    node_diameters,
    plates,
    stock_size,
)
from fabrication.standards.printers import Printer, printer, printer_keys
from fabrication.standards.profiles import lying, polygon, profile, stock_lengths

__all__ = [
    "Printer",
    "density",
    "lying",
    "mass_kg",
    "node_diameters",
    "plates",
    "polygon",
    "printer",
    "printer_keys",
    "profile",
    "stock_lengths",
    "stock_size",
]
