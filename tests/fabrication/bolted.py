"""Finds for every bolt of a folder its holes, from assembly.step and bolts.csv alone."""

from __future__ import annotations

import csv
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np


def placed_shapes(path: Path) -> Iterator[tuple[str, Any]]:
    """Mark and placed kernel shape of every component of an assembly."""
    from OCP.IFSelect import IFSelect_ReturnStatus
    from OCP.STEPCAFControl import STEPCAFControl_Reader
    from OCP.TCollection import TCollection_ExtendedString
    from OCP.TDataStd import TDataStd_Name
    from OCP.TDF import TDF_Label, TDF_LabelSequence
    from OCP.TDocStd import TDocStd_Document
    from OCP.TopLoc import TopLoc_Location
    from OCP.XCAFDoc import XCAFDoc_DocumentTool, XCAFDoc_ShapeTool

    document = TDocStd_Document(TCollection_ExtendedString("XmlXCAF"))
    reader = STEPCAFControl_Reader()
    reader.SetNameMode(True)
    assert reader.ReadFile(str(path)) == IFSelect_ReturnStatus.IFSelect_RetDone
    assert reader.Transfer(document)

    def walk(label: Any, location: Any) -> Iterator[tuple[str, Any]]:
        parts = TDF_LabelSequence()
        XCAFDoc_ShapeTool.GetComponents_s(label, parts)
        for k in range(1, parts.Length() + 1):
            part, target, name = parts.Value(k), TDF_Label(), TDataStd_Name()
            XCAFDoc_ShapeTool.GetReferredShape_s(part, target)
            part.FindAttribute(TDataStd_Name.GetID_s(), name)
            here = location.Multiplied(XCAFDoc_ShapeTool.GetLocation_s(part))
            if XCAFDoc_ShapeTool.IsAssembly_s(target):
                yield from walk(target, here)
            else:
                shape = XCAFDoc_ShapeTool.GetShape_s(target)
                yield str(name.Get().ToExtString()), shape.Located(here)

    roots = TDF_LabelSequence()
    XCAFDoc_DocumentTool.ShapeTool_s(document.Main()).GetFreeShapes(roots)
    for k in range(1, roots.Length() + 1):
        yield from walk(roots.Value(k), TopLoc_Location())


def cylinders(shape: Any) -> list[tuple[np.ndarray, np.ndarray, float]]:
    """Point, direction and diameter of every cylinder face, where the shape is placed."""
    from OCP.BRepAdaptor import BRepAdaptor_Surface
    from OCP.GeomAbs import GeomAbs_SurfaceType
    from OCP.TopAbs import TopAbs_ShapeEnum
    from OCP.TopExp import TopExp_Explorer
    from OCP.TopoDS import TopoDS

    found = []
    faces = TopExp_Explorer(shape, TopAbs_ShapeEnum.TopAbs_FACE)
    while faces.More():
        surface = BRepAdaptor_Surface(TopoDS.Face_s(faces.Current()))
        faces.Next()
        if surface.GetType() == GeomAbs_SurfaceType.GeomAbs_Cylinder:
            cylinder = surface.Cylinder()
            at, along = cylinder.Axis().Location(), cylinder.Axis().Direction()
            found.append(
                (
                    np.array([at.X(), at.Y(), at.Z()]),
                    np.array([along.X(), along.Y(), along.Z()]),
                    2 * cylinder.Radius(),
                )
            )
    return found


def off_axis(folder: Path) -> dict[str, float]:
    """By bolt, how far [mm] its two holes are from one axis; infinite where one is missing.

    Measured across the axis of the node's hole, at the seat and 50 mm to either side.
    """
    of_mark = {mark: cylinders(shape) for mark, shape in placed_shapes(folder / "assembly.step")}
    result = {}
    with (folder / "schedules" / "bolts.csv").open(encoding="utf-8") as stream:
        for row in csv.DictReader(stream):
            seat = np.array([float(row[f"{c}_mm"]) for c in "xyz"])
            along = np.array([float(row[f"axis_{c}"]) for c in "xyz"])
            axes = []
            for piece, column in (("node", "node_hole_mm"), ("beam", "beam_hole_mm")):
                near = []
                for point, direction, diameter in of_mark[row[piece]]:
                    if abs(diameter - float(row[column])) > 1e-3:
                        continue
                    if abs(direction @ along) < 0.9:
                        continue
                    at = seat + np.outer([-50.0, 0.0, 50.0], along)
                    t = (at - point) @ along / (direction @ along)
                    pierced = point + t[:, None] * direction
                    near.append((np.linalg.norm(pierced - at, axis=1).max(), pierced))
                axes.append(min(near, key=lambda entry: entry[0])[1] if near else None)
            one, two = axes
            if one is None or two is None:
                result[row["mark"]] = float("inf")
            else:
                result[row["mark"]] = float(np.linalg.norm(one - two, axis=1).max())
    return result
