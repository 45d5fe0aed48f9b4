"""What goes into a STEP file besides geometry: products, header, materials, colours, layers."""

from __future__ import annotations

import os
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Any, Final, Literal

from fabrication.solids.boundary import Boundary
from fabrication.specs import Properties, Role

Schema = Literal["AP214", "AP242"]

COLOURS: Final[dict[str, tuple[float, float, float]]] = {
    "beam": (0.33, 0.36, 0.40),
    "node": (0.80, 0.42, 0.16),
    "panel": (0.45, 0.72, 0.74),
    "link": (0.20, 0.45, 0.70),
    "pin": (0.62, 0.64, 0.67),
    "cap": (0.90, 0.62, 0.15),
    "spacer": (0.86, 0.84, 0.78),
    "coupon": (0.55, 0.70, 0.40),
    "failed": (0.85, 0.10, 0.10),
}
"""sRGB colours of the roles, and of pieces that failed a check, 0..1."""

FAILED: Final = "failed"
"""The key in `COLOURS` of pieces that failed a check."""

GROUPS: Final[dict[str, str]] = {
    "beam": "Beams",
    "node": "Nodes",
    "panel": "Panels",
    "link": "Links",
    "pin": "Pins",
    "cap": "Caps",
    "spacer": "Spacers",
    "coupon": "Coupons",
}
"""Sub-assemblies of the roles, in the order in which they appear."""

LAYERS: Final[dict[str, str]] = {role: name.upper() for role, name in GROUPS.items()}
"""Layers of the roles."""


@dataclass(frozen=True)
class Header:
    """Who made the file. Empty fields are written as they are."""

    author: str = ""
    organisation: str = ""
    description: str = ""


@dataclass(frozen=True)
class Material:
    """A material: its name and density [kg/m3]."""

    name: str
    density: float


@dataclass(frozen=True, eq=False)
class Product:
    """A part number: its role, geometry in its own frame, properties and material.

    The geometry is the exact boundary where there is one (much faster to write); only where there
    is none, the kernel solid is looked at.
    """

    number: str
    role: Role
    solid: Any
    properties: Properties
    material: Material | None = None
    boundary: Boundary | None = None


def time_stamp() -> str:
    """Now, or SOURCE_DATE_EPOCH where it is set (ISO 8601, UTC, seconds)."""
    epoch = os.environ.get("SOURCE_DATE_EPOCH", "")
    moment = datetime.fromtimestamp(int(epoch), UTC) if epoch.isdigit() else datetime.now(UTC)
    return moment.strftime("%Y-%m-%dT%H:%M:%S")
