"""STEP files by OCCT's own XCAF writer: the second route that ours is compared with."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from fabrication.formats.step.records import StepProduct, product_name
from fabrication.formats.step.text import encoded
from fabrication.formats.step.xcaf import mute, new_document
from fabrication.solids import solid_from


def set_name(label: Any, name: str) -> None:
    from OCP.TCollection import TCollection_ExtendedString
    from OCP.TDataStd import TDataStd_Name

    TDataStd_Name.Set_s(label, TCollection_ExtendedString(name, True))


def location(placement: np.ndarray) -> Any:
    from OCP.gp import gp_Trsf
    from OCP.TopLoc import TopLoc_Location

    motion = gp_Trsf()
    motion.SetValues(*(float(x) for x in placement[:3].ravel()))
    return TopLoc_Location(motion)


def write_by_xcaf(
    path: Path,
    products: Sequence[StepProduct],
    instances: Sequence[tuple[str, str, np.ndarray]],
    *,
    name: str,
    schema: str = "AP214",
) -> None:
    from OCP.IFSelect import IFSelect_ReturnStatus
    from OCP.Interface import Interface_Static
    from OCP.STEPCAFControl import STEPCAFControl_Writer
    from OCP.STEPControl import STEPControl_StepModelType
    from OCP.XCAFDoc import XCAFDoc_DocumentTool

    mute()
    document = new_document()
    shapes = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    root = shapes.NewShape()
    set_name(root, name)
    labels = {product.number: add_product(document, product) for product in products}
    groups = {}
    for kind in dict.fromkeys(product.kind for product in products):
        group = groups[kind] = shapes.NewShape()
        set_name(group, kind.title)
        set_name(shapes.AddComponent(root, group, location(np.eye(4))), kind.title)
    kinds = {product.number: product.kind for product in products}
    for number, mark, placement in instances:
        component = shapes.AddComponent(groups[kinds[number]], labels[number], location(placement))
        set_name(component, mark)
    shapes.UpdateAssemblies()
    writer = STEPCAFControl_Writer()
    Interface_Static.SetCVal_s(
        "write.step.schema", {"AP214": "AP214IS", "AP242": "AP242DIS"}[schema]
    )
    Interface_Static.SetIVal_s("write.surfacecurve.mode", 0)
    for switch in (
        writer.SetNameMode,
        writer.SetColorMode,
        writer.SetLayerMode,
        writer.SetPropsMode,
        writer.SetMaterialMode,
    ):
        switch(True)
    assert writer.Transfer(document, STEPControl_StepModelType.STEPControl_AsIs)
    assert writer.Write(str(path)) == IFSelect_ReturnStatus.IFSelect_RetDone


def add_product(document: Any, product: StepProduct) -> Any:
    from OCP.gp import gp_Pnt
    from OCP.Quantity import Quantity_Color, Quantity_TypeOfColor
    from OCP.TCollection import TCollection_ExtendedString, TCollection_HAsciiString
    from OCP.XCAFDoc import (
        XCAFDoc_Area,
        XCAFDoc_Centroid,
        XCAFDoc_ColorType,
        XCAFDoc_DocumentTool,
        XCAFDoc_Volume,
    )

    assert product.boundary is not None
    assert product.material is not None
    main = document.Main()
    label = XCAFDoc_DocumentTool.ShapeTool_s(main).AddShape(solid_from(product.boundary), False)
    set_name(label, product_name(product.number))
    color = Quantity_Color(*product.kind.color, Quantity_TypeOfColor.Quantity_TOC_sRGB)
    XCAFDoc_DocumentTool.ColorTool_s(main).SetColor(
        label, color, XCAFDoc_ColorType.XCAFDoc_ColorGen
    )
    XCAFDoc_DocumentTool.LayerTool_s(main).SetLayer(
        label, TCollection_ExtendedString(product.kind.layer), True
    )
    XCAFDoc_DocumentTool.MaterialTool_s(main).SetMaterial(
        label,
        TCollection_HAsciiString(encoded(product.material.name)),
        TCollection_HAsciiString(""),
        product.material.density / 1000.0,
        TCollection_HAsciiString("density"),
        TCollection_HAsciiString("POSITIVE_RATIO_MEASURE"),
    )
    XCAFDoc_Volume.Set_s(label, product.properties.volume)
    XCAFDoc_Area.Set_s(label, product.properties.area)
    XCAFDoc_Centroid.Set_s(label, gp_Pnt(*product.properties.centroid))
    return label
