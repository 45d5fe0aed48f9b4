"""STEP files read back by the CAD kernel, and the checks of one part number's file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final

import numpy as np

from ddgfab.errors import InputError
from ddgfab.mesh import Floats
from fabrication.checks.solid import SolidReport, inspect_solid
from fabrication.formats.step.coaxial import cylinders_of
from fabrication.formats.step.faceted import FacetedSolid, faceted_solids
from fabrication.formats.step.records import product_name
from fabrication.formats.step.xcaf import (
    components,
    free_labels,
    get_name,
    layers_by_tag,
    read_document,
)
from fabrication.specs import Check

FILE_VOLUME_RELATIVE: Final = 1e-6
"""How far a volume read back may be from the one written, relative to it: STEP's digits, and the
reader's own curves on cylinders (5.6e-8 on a coped tee, 2.6e-7 on a part made by booleans)."""

STEP_UNIT: Final = "millimetre"
"""The length unit of every STEP file that we write, as OCCT's reader names it."""


@dataclass(frozen=True, eq=False)
class StepProduct:
    """A product read back: its name, what the kernel says of its shape.

    Solids and hollow cylinders (`coaxial.cylinders_of`) are there if asked for.
    """

    name: str
    report: SolidReport
    solids: tuple[FacetedSolid, ...] = ()
    cylinders: Floats = field(default_factory=lambda: np.zeros((0, 7)))


@dataclass(frozen=True, eq=False)
class StepContent:
    """A STEP file read back.

    products : one for each distinct part
    instances : (product name, component name, (4, 4) placement in the root's frame)
    product_of : for each instance the place of its product
    unit : length unit of the file, "millimetre" for ours; several are joined by commas
    layers : names of the layers of each component's shape, by the component's name
    """

    products: tuple[StepProduct, ...]
    instances: tuple[tuple[str, str, Floats], ...]
    unit: str
    layers: Mapping[str, frozenset[str]] = field(default_factory=dict)
    product_of: tuple[int, ...] = ()


def read_step(
    path: Path, *, validate: bool = True, facets: bool = False, holes: bool = False
) -> StepContent:
    """Read a STEP file with OCCT's XCAF reader and measure each product once.

    Without `validate` the products go without BRepCheck; with `facets` they have their solids as
    meshes, with `holes` their hollow cylinders.

    The reader mends small faults on the way (tolerances, a shell that is inside out), so a product
    is called valid as this reader sees it.

    Raises
    ------
    InputError
        Missing, truncated or not STEP.
    """
    document, units = read_document(path)
    products: dict[str, StepProduct] = {}
    instances: list[tuple[str, str, Floats]] = []
    tags: list[str] = []
    for label in free_labels(document):
        _walk(
            label, np.eye(4), get_name(label), products, instances, tags, (validate, facets, holes)
        )
    layers = layers_by_tag(document)
    of_mark = {
        mark: layers.get(tag, frozenset())
        for (_, mark, _), tag in zip(instances, tags, strict=True)
    }
    order = {tag: place for place, tag in enumerate(products)}
    return StepContent(
        tuple(products.values()),
        tuple(instances),
        ", ".join(units),
        of_mark,
        tuple(order[tag] for tag in tags),
    )


def check_step_part(
    path: Path, *, number: str, volume: float, relative: float = FILE_VOLUME_RELATIVE
) -> list[Check]:
    """The checks of one part number's STEP file, read back.

    Parameters
    ----------
    number : the part number, of which the product has its name
    volume : [mm3] of the solid that was written

    Returns
    -------
    Checks "file readable", and if it is, "file one solid", "file valid" (closed, BRepCheck),
    "file name", "file unit", "file volume" (relative deviation).
    """
    try:
        content = read_step(path)
    except InputError as error:
        return [Check("file readable", False, str(error))]
    solids = sum(product.report.solids for product in content.products)
    total = sum(product.report.volume for product in content.products)
    sound = all(p.report.valid and p.report.closed for p in content.products)
    names = ", ".join(product.name for product in content.products)
    deviation = abs(total - volume) / max(abs(volume), 1e-300)
    wanted = product_name(number)
    return [
        Check("file readable", True),
        Check("file one solid", solids == 1 == len(content.products), float(solids), 1.0),
        Check("file valid", bool(content.products) and sound),
        Check("file name", names == wanted, names, wanted),
        Check("file unit", content.unit == STEP_UNIT, content.unit, STEP_UNIT),
        Check("file volume", total > 0 and deviation <= relative, deviation, relative),
    ]


def _walk(
    label: Any,
    motion: Floats,
    name: str,
    products: dict[str, StepProduct],
    instances: list[tuple[str, str, Floats]],
    tags: list[str],
    wanted: tuple[bool, bool, bool],
) -> None:
    """Collect products, placed instances and the tags of their shapes below a label."""
    from OCP.XCAFDoc import XCAFDoc_ShapeTool

    if XCAFDoc_ShapeTool.IsAssembly_s(label):
        for component, target in components(label):
            placed = motion @ matrix(XCAFDoc_ShapeTool.GetLocation_s(component))
            _walk(target, placed, get_name(component), products, instances, tags, wanted)
        return
    product = get_name(label)
    instances.append((product, name, motion))
    entry = str(label.Tag())
    tags.append(entry)
    if entry not in products:
        shape = XCAFDoc_ShapeTool.GetShape_s(label)
        validate, facets, holes = wanted
        report = inspect_solid(shape, validate=validate)
        solids = faceted_solids(shape) if facets else ()
        hollow = cylinders_of(shape) if holes else np.zeros((0, 7))
        products[entry] = StepProduct(product, report, solids, hollow)


def matrix(location: Any) -> Floats:
    """The (4, 4) matrix of a TopLoc_Location."""
    motion = location.Transformation()
    result = np.eye(4)
    result[:3] = [[motion.Value(i, j) for j in range(1, 5)] for i in range(1, 4)]
    return result
