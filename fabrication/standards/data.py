"""Reads the standards' data files; each is parsed once."""

from __future__ import annotations

import tomllib
from functools import cache
from importlib.resources import files
from typing import Any, Final

KG_PER_MM3: Final = 1e-9
"""A density [kg/m3] times this is in kg/mm3."""


@cache
def table(name: str) -> dict[str, Any]:
    """The data file ``fabrication/standards/<name>.toml`` as a dictionary."""
    return tomllib.loads(files(__package__).joinpath(f"{name}.toml").read_text(encoding="utf-8"))


def node_diameters(kind: str) -> tuple[float, ...]:
    """Ascending outside diameters [mm] of round bar ("cylinder") or hollow section ("tube")."""
    return tuple(float(value) for value in sorted(table("nodes")[kind]["diameters"]))


def plates() -> tuple[float, ...]:
    """Ascending thicknesses [mm] of steel plate that are kept in stock."""
    return tuple(float(value) for value in table("plates")["thicknesses"])


def density(material: str) -> float:
    """Density [kg/m3] of "steel" or "glass"."""
    return float(table("materials")[material]["density"])


def mass_kg(volume: float, density: float) -> float:
    """Mass [kg] of a volume [mm3] of a density [kg/m3]."""
    return volume * density * KG_PER_MM3


def stock_size() -> tuple[float, float]:
    """Smaller and larger side [mm] of the largest stock sheet of float glass (EN 572-2)."""
    small, large = table("materials")["glass"]["max_size"]
    return float(small), float(large)
