"""Profiles, bolts, node stock and materials: data files with their sources, and their loader."""

from fabrication.standards.data import (
    bolt_end_distance,
    bolt_hole,
    bolt_least_distance,
    density,
    nearest,
    node_diameters,
    stock_size,
)
from fabrication.standards.profiles import polygon, profile

__all__ = [
    "bolt_end_distance",
    "bolt_hole",
    "bolt_least_distance",
    "density",
    "nearest",
    "node_diameters",
    "polygon",
    "profile",
    "stock_size",
]
