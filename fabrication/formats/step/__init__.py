"""STEP files as manufacturers need them: named, colored, layered, with validation properties.

StepProduct = part number, component instance = piece mark. All is written as text
(`fabrication.formats.step.direct`); the kernel is asked only for the geometry of parts without an
exact boundary.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ddgfab.io.atomic import atomic_write
from fabrication.formats.base import Header, Material
from fabrication.formats.step.direct import assembly_bytes, part_bytes
from fabrication.formats.step.records import Schema, StepProduct, time_stamp
from fabrication.specs import Placement

__all__ = [
    "Header",
    "Material",
    "Schema",
    "StepProduct",
    "assembly_bytes",
    "location",
    "part_bytes",
    "time_stamp",
    "write_assembly",
    "write_part",
]


def write_part(
    path: Path, product: StepProduct, *, header: Header | None = None, schema: Schema = "AP214"
) -> None:
    """Write one part number as a STEP file (atomically); see `part_bytes`.

    Raises
    ------
    OutputError
        The file cannot be written.
    DdgError
        As `part_bytes`.
    """
    with atomic_write(path) as file:
        file.write(part_bytes(product, path.name, header=header, schema=schema))


def write_assembly(
    path: Path,
    products: Sequence[StepProduct],
    instances: Iterable[tuple[str, str, Placement]],
    *,
    name: str,
    header: Header | None = None,
    schema: Schema = "AP214",
) -> None:
    """Write the whole as true instances (atomically); see `assembly_bytes`.

    Raises
    ------
    OutputError
        The file cannot be written.
    DdgError
        As `assembly_bytes`.
    """
    data = assembly_bytes(
        products, instances, name=name, file_name=path.name, header=header, schema=schema
    )
    with atomic_write(path) as file:
        file.write(data)


def location(placement: Placement) -> Any:
    """A (4, 4) rigid motion as a TopLoc_Location."""
    from OCP.gp import gp_Trsf
    from OCP.TopLoc import TopLoc_Location

    motion = gp_Trsf()
    motion.SetValues(*(float(x) for x in np.asarray(placement)[:3].ravel()))
    return TopLoc_Location(motion)
