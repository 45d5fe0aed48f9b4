"""Circles and spheres as exact curves in a STEP file."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from ddgfab.circles import Circles, Spheres
from ddgfab.errors import KernelError
from ddgfab.io import atomic_path


def write_step_circles(path: str | Path, curves: Mapping[str, Circles | Spheres]) -> None:
    """Write circles, and three great circles for each sphere, as CIRCLE entities of a STEP file.

    Parameters
    ----------
    curves : circles or spheres [mm] by the name of their kind, in this order in the file

    Raises
    ------
    KernelError
        The kernel refuses a circle or the file.
    OutputError
        The file cannot be written.
    """
    from OCP.BRep import BRep_Builder
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge
    from OCP.gp import gp_Ax2, gp_Circ, gp_Dir, gp_Pnt
    from OCP.IFSelect import IFSelect_RetDone
    from OCP.STEPControl import STEPControl_StepModelType, STEPControl_Writer
    from OCP.TopoDS import TopoDS_Compound

    from fabrication.formats.step.xcaf import mute

    mute()
    builder, whole = BRep_Builder(), TopoDS_Compound()
    builder.MakeCompound(whole)
    for given in curves.values():
        circles = given if isinstance(given, Circles) else given.great_circles()
        for center, normal, radius in zip(
            circles.centers.tolist(), circles.normals.tolist(), circles.radii.tolist(), strict=True
        ):
            axes = gp_Ax2(gp_Pnt(*center), gp_Dir(*normal))
            builder.Add(whole, BRepBuilderAPI_MakeEdge(gp_Circ(axes, radius)).Edge())
    writer = STEPControl_Writer()
    kind = STEPControl_StepModelType.STEPControl_GeometricCurveSet
    with atomic_path(path) as place:
        done = writer.Transfer(whole, kind) == IFSelect_RetDone
        if not done or writer.Write(str(place)) != IFSelect_RetDone:
            raise KernelError(f"{path}: the kernel did not write the circles")
