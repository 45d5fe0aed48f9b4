"""STEP files as manufacturers want them: named, coloured, layered, with validation properties.

Product = part number, component instance = piece mark. What has an exact boundary is written as
text (`fabrication.export.stepdirect`), without the CAD kernel; the rest with OCCT's XCAF.
"""

from __future__ import annotations

import io
import threading
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np

from ddgfab.errors import KernelError
from ddgfab.io.atomic import atomic_write
from fabrication.export.stepdirect import assembly_text, part_text
from fabrication.export.steprecords import (
    COLOURS,
    FAILED,
    GROUPS,
    LAYERS,
    Header,
    Material,
    Product,
    Schema,
    time_stamp,
)
from fabrication.export.steptext import coloured, encoded, mended_density, renumbered
from fabrication.export.version import originating_system
from fabrication.export.xcaf import mute, new_document, set_name
from fabrication.specs import Placement

__all__ = [
    "COLOURS",
    "FAILED",
    "GROUPS",
    "LAYERS",
    "Header",
    "Material",
    "Product",
    "Schema",
    "assembly_bytes",
    "location",
    "part_bytes",
    "time_stamp",
    "write_assembly",
    "write_part",
]

_SCHEMA_OPTION: Final[dict[str, str]] = {"AP214": "AP214IS", "AP242": "AP242DIS"}
# The kernel's settings for writing are global to the process, so one file is written at a time.
_WRITING: Final = threading.Lock()


def part_bytes(
    product: Product, file_name: str, *, header: Header | None = None, schema: Schema = "AP214"
) -> bytes:
    """One part number as a STEP file: text where it has a boundary, else by OCCT.

    Raises
    ------
    KernelError
        OCCT refused the solid.
    """
    header = header or Header()
    if product.boundary is not None:
        return part_text(
            product.boundary,
            number=product.number,
            role=product.role,
            properties=product.properties,
            file_name=file_name,
            header=header,
            material=product.material,
            schema=schema,
        )
    document = new_document()
    _add_product(document, product)
    return _document_bytes(document, file_name, header, schema)


def write_part(
    path: Path, product: Product, *, header: Header | None = None, schema: Schema = "AP214"
) -> None:
    """Write one part number as a STEP file (atomically); see `part_bytes`.

    Raises
    ------
    OutputError
        The file cannot be written.
    """
    with atomic_write(path) as file:
        file.write(part_bytes(product, path.name, header=header, schema=schema))


def assembly_bytes(
    products: Sequence[Product],
    instances: Iterable[tuple[str, str, Placement]],
    *,
    name: str,
    file_name: str,
    header: Header | None = None,
    schema: Schema = "AP214",
) -> bytes:
    """The whole as true instances: one shape a part number, many placements.

    The instances hang in one sub-assembly a role (Beams, Nodes, Panels) under the root `name`.

    Parameters
    ----------
    products : written as text when all have boundaries; else all need their solids
    instances : (part number, piece mark, (4, 4) placement [mm]) of every piece

    Raises
    ------
    KernelError
        An instance of an unknown part number, or OCCT refused.
    """
    header = header or Header()
    if products and all(product.boundary is not None for product in products):
        return assembly_text(
            products, instances, name=name, file_name=file_name, header=header, schema=schema
        )
    return _document_bytes(_assembly_document(products, instances, name), file_name, header, schema)


def write_assembly(
    path: Path,
    products: Sequence[Product],
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


def _assembly_document(
    products: Sequence[Product], instances: Iterable[tuple[str, str, Placement]], name: str
) -> Any:
    """An XCAF document of the whole."""
    from OCP.TopLoc import TopLoc_Location
    from OCP.XCAFDoc import XCAFDoc_DocumentTool

    document = new_document()
    shapes = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    root = shapes.NewShape()
    set_name(root, name)
    labels = {product.number: _add_product(document, product) for product in products}
    roles = {product.number: product.role for product in products}
    groups: dict[str, Any] = {}
    for role in sorted(set(roles.values()), key=list(GROUPS).index):
        groups[role] = shapes.NewShape()
        set_name(groups[role], GROUPS[role])
        set_name(shapes.AddComponent(root, groups[role], TopLoc_Location()), GROUPS[role])
    for number, mark, placement in instances:
        if number not in labels:
            raise KernelError(f"piece {mark} is an instance of {number}, which has no solid")
        label = shapes.AddComponent(groups[roles[number]], labels[number], location(placement))
        set_name(label, mark)
    shapes.UpdateAssemblies()
    return document


def _add_product(document: Any, product: Product) -> Any:
    """Label of a part number with name, layer, material and validation properties.

    Colours follow in the text (`fabrication.export.steptext`), found by the layers.
    """
    from OCP.gp import gp_Pnt
    from OCP.TCollection import TCollection_ExtendedString, TCollection_HAsciiString
    from OCP.XCAFDoc import (
        XCAFDoc_Area,
        XCAFDoc_Centroid,
        XCAFDoc_DocumentTool,
        XCAFDoc_Volume,
    )

    main = document.Main()
    label = XCAFDoc_DocumentTool.ShapeTool_s(main).AddShape(product.solid, False)
    set_name(label, product.number)
    XCAFDoc_DocumentTool.LayerTool_s(main).SetLayer(
        label, TCollection_ExtendedString(LAYERS[product.role]), True
    )
    if product.material is not None:
        XCAFDoc_DocumentTool.MaterialTool_s(main).SetMaterial(
            label,
            TCollection_HAsciiString(encoded(product.material.name)),
            TCollection_HAsciiString(""),
            product.material.density / 1000.0,  # OCCT writes grams per cubic centimetre
            TCollection_HAsciiString("density"),
            TCollection_HAsciiString("POSITIVE_RATIO_MEASURE"),
        )
    XCAFDoc_Volume.Set_s(label, product.properties.volume)
    XCAFDoc_Area.Set_s(label, product.properties.area)
    XCAFDoc_Centroid.Set_s(label, gp_Pnt(*product.properties.centroid))
    return label


def _document_bytes(document: Any, file_name: str, header: Header, schema: Schema) -> bytes:
    """The STEP text of a document."""
    from OCP.IFSelect import IFSelect_ReturnStatus
    from OCP.Interface import Interface_Static
    from OCP.STEPCAFControl import STEPCAFControl_Writer
    from OCP.STEPControl import STEPControl_StepModelType

    with _WRITING:
        mute()
        writer = STEPCAFControl_Writer()  # the settings exist only after a writer does
        Interface_Static.SetCVal_s("write.step.schema", _SCHEMA_OPTION[schema])
        Interface_Static.SetCVal_s("write.step.unit", "MM")
        Interface_Static.SetIVal_s("write.surfacecurve.mode", 0)
        for switch in (
            writer.SetNameMode,
            writer.SetLayerMode,
            writer.SetPropsMode,
            writer.SetMaterialMode,
        ):
            switch(True)
        if not writer.Transfer(document, STEPControl_StepModelType.STEPControl_AsIs):
            raise KernelError(f"{file_name}: OCCT cannot translate the shapes to STEP")
        _fill_header(writer.ChangeWriter().Model(), file_name, header)
        stream = io.BytesIO()
        if writer.WriteStream(stream) != IFSelect_ReturnStatus.IFSelect_RetDone:
            raise KernelError(f"{file_name}: OCCT cannot write the STEP text")
    colours = {layer: COLOURS[role] for role, layer in LAYERS.items()}
    return coloured(mended_density(renumbered(stream.getvalue())), colours)


def _fill_header(model: Any, file_name: str, header: Header) -> None:
    """FILE_DESCRIPTION and FILE_NAME of a STEP model."""
    from OCP.APIHeaderSection import APIHeaderSection_MakeHeader
    from OCP.TCollection import TCollection_HAsciiString

    def text(value: str) -> Any:
        return TCollection_HAsciiString(encoded(value))

    section = APIHeaderSection_MakeHeader(model)
    section.SetName(text(file_name))
    section.SetTimeStamp(text(time_stamp()))
    section.SetAuthorValue(1, text(header.author))
    section.SetOrganizationValue(1, text(header.organisation))
    section.SetOriginatingSystem(text(originating_system()))
    section.SetDescriptionValue(1, text(header.description or file_name))
    section.Apply(model)
