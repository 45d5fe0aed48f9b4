"""What goes into a STEP file besides geometry: products, the time."""

from __future__ import annotations

import os
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Any, Literal

from fabrication.boundary import Boundary
from fabrication.formats.base import Material
from fabrication.formats.step.attributes import Attribute
from fabrication.specs import Kind, Properties

Schema = Literal["AP214", "AP242"]


def product_name(number: str) -> str:
    """The name of the product that has a part number as its id.

    It ends in letters: FreeCAD, which shows names, counts up the digits that a name ends in, and
    would call the second copy of BP-001 by the number of another part, BP-002.
    """
    return f"{number} part"


@dataclass(frozen=True, eq=False)
class StepProduct:
    """A part number: its kind, geometry in its own frame, properties, material and attributes.

    The geometry is the exact boundary where there is one (much faster to write); only where there
    is none, the kernel solid is looked at.
    """

    number: str
    kind: Kind
    solid: Any
    properties: Properties
    material: Material | None = None
    boundary: Boundary | None = None
    attributes: tuple[Attribute, ...] = ()


def time_stamp() -> str:
    """Now, or SOURCE_DATE_EPOCH where it is set (ISO 8601, UTC, seconds)."""
    epoch = os.environ.get("SOURCE_DATE_EPOCH", "")
    moment = datetime.fromtimestamp(int(epoch), UTC) if epoch.isdigit() else datetime.now(UTC)
    return moment.strftime("%Y-%m-%dT%H:%M:%S")
