"""Discrete minimal surfaces: duals of Koebe nets."""

from __future__ import annotations

from ddgfab.nets.minimal.net import MinimalNet, catenoid, enneper, helicoid, minimal_surface
from ddgfab.nets.minimal.periodic import scherk, schwarz_d, schwarz_p, schwarz_p_cell

__all__ = [
    "MinimalNet",
    "catenoid",
    "enneper",
    "helicoid",
    "minimal_surface",
    "scherk",
    "schwarz_d",
    "schwarz_p",
    "schwarz_p_cell",
]
