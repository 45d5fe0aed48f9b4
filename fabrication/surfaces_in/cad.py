"""Faces of STEP and IGES files as trimmed NURBS surfaces, lengths in millimetres."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Final

import numpy as np

from ddgfab.errors import InputError
from ddgfab.mesh import Floats
from ddgfab.surfaces.spline import SplineSurface
from ddgfab.surfaces.trim import polygon_area
from fabrication.formats.step.apart import apart
from fabrication.formats.step.xcaf import free_labels, read_document

_CURVE_POINTS: Final = 96
"""Points of a curved trimming edge."""
_STRAIGHT: Final = 1e-9
"""A trimming edge is straight when it leaves its chord by less, relative to its length."""


def cad_faces(path: Path) -> list[Any]:
    """The faces of a STEP or IGES file as kernel objects, in the file's order.

    Raises
    ------
    InputError
        A file that is missing or cannot be read, or has no faces.
    """
    from OCP.TopAbs import TopAbs_FACE
    from OCP.TopExp import TopExp_Explorer
    from OCP.TopoDS import TopoDS

    faces = []
    for shape in _shapes(path):
        explorer = TopExp_Explorer(shape, TopAbs_FACE)
        while explorer.More():
            faces.append(TopoDS.Face_s(explorer.Current()))
            explorer.Next()
    if not faces:
        raise InputError("has no faces; surfaces are needed, not curves or meshes", file=str(path))
    return faces


def read_cad_surface(path: Path, face: int | None = None) -> SplineSurface:
    """One face of a STEP or IGES file, read by the CAD kernel in a process of its own.

    Parameters
    ----------
    face : its number, from 0; may be left out where the file has one face

    Raises
    ------
    InputError
        No such face, several faces and none chosen (lists them), or one that is no regular patch;
        a file that the kernel cannot read, or not within the limits of time and memory.
    """
    return apart(_read_surface, path, face)


def _read_surface(path: Path, face: int | None) -> SplineSurface:
    """The same in this process."""
    faces = cad_faces(path)
    if face is None:
        if len(faces) > 1:
            areas = [f"{k} ({_area(shape) / 1e6:.3g} m2)" for k, shape in enumerate(faces[:12])]
            more = "" if len(faces) <= 12 else ", ..."
            raise InputError(
                f"has {len(faces)} faces: {', '.join(areas)}{more}; choose one: --face 0",
                file=str(path),
            )
        face = 0
    if not 0 <= face < len(faces):
        raise InputError(f"has no face {face}; faces are 0 to {len(faces) - 1}", file=str(path))
    return _surface(faces[face], f"{path.name} face {face}")


def _shapes(path: Path) -> list[Any]:
    if path.suffix.lower() in (".step", ".stp"):
        from OCP.XCAFDoc import XCAFDoc_ShapeTool

        document, _ = read_document(path)
        return [XCAFDoc_ShapeTool.GetShape_s(label) for label in free_labels(document)]
    from OCP.IFSelect import IFSelect_ReturnStatus
    from OCP.IGESControl import IGESControl_Reader

    if not path.is_file():
        raise InputError("no such file", file=str(path))
    reader = IGESControl_Reader()
    if reader.ReadFile(str(path)) != IFSelect_ReturnStatus.IFSelect_RetDone:
        raise InputError("is no IGES file that can be read", file=str(path))
    reader.TransferRoots()
    return [reader.OneShape()]


def _area(face: Any) -> float:
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps

    properties = GProp_GProps()
    BRepGProp.SurfaceProperties_s(face, properties)
    return float(properties.Mass())


def _surface(face: Any, name: str) -> SplineSurface:
    """A face as a clamped NURBS patch of degree 2 or more, its trim as polygons."""
    from OCP.BRep import BRep_Tool
    from OCP.BRepBuilderAPI import BRepBuilderAPI_NurbsConvert
    from OCP.BRepTools import BRepTools
    from OCP.Geom import Geom_RectangularTrimmedSurface
    from OCP.GeomConvert import GeomConvert
    from OCP.TopAbs import TopAbs_REVERSED
    from OCP.TopoDS import TopoDS

    face = TopoDS.Face_s(BRepBuilderAPI_NurbsConvert(face, True).Shape())
    bounds = BRepTools.UVBounds_s(face)
    base = BRep_Tool.Surface_s(face)
    u0, u1, v0, v1 = base.Bounds()
    u0, u1 = max(u0, bounds[0]), min(u1, bounds[1])
    v0, v1 = max(v0, bounds[2]), min(v1, bounds[3])
    patch = GeomConvert.SurfaceToBSplineSurface_s(
        Geom_RectangularTrimmedSurface(base, u0, u1, v0, v1)
    )
    if patch.IsUPeriodic():
        patch.SetUNotPeriodic()
    if patch.IsVPeriodic():
        patch.SetVNotPeriodic()
    patch.IncreaseDegree(max(2, patch.UDegree()), max(2, patch.VDegree()))
    count = patch.NbUPoles(), patch.NbVPoles()
    poles, weights = np.zeros((*count, 3)), np.ones(count)
    for i in range(count[0]):
        for j in range(count[1]):
            pole = patch.Pole(i + 1, j + 1)
            poles[i, j] = pole.X(), pole.Y(), pole.Z()
            weights[i, j] = patch.Weight(i + 1, j + 1)
    knots = [
        np.repeat([knot(k + 1) for k in range(number)], [times(k + 1) for k in range(number)])
        for knot, times, number in (
            (patch.UKnot, patch.UMultiplicity, patch.NbUKnots()),
            (patch.VKnot, patch.VMultiplicity, patch.NbVKnots()),
        )
    ]
    loops = _loops(face, [(knots[0][0], knots[0][-1]), (knots[1][0], knots[1][-1])])
    if face.Orientation() == TopAbs_REVERSED:  # the same side as the file's: exchange u and v
        poles, weights = poles.transpose(1, 0, 2), weights.T
        knots = knots[::-1]
        loops = [loop[:, ::-1] for loop in loops]
        degrees = patch.VDegree(), patch.UDegree()
    else:
        degrees = patch.UDegree(), patch.VDegree()
    plain = np.ptp(weights) <= 1e-14 * weights.max()
    return SplineSurface(poles, knots, degrees, None if plain else weights, loops, name=name)


def _loops(face: Any, domain: list[tuple[float, float]]) -> list[Floats]:
    """Trimming loops in the parameter plane, the outer one first."""
    from OCP.BRepAdaptor import BRepAdaptor_Curve2d
    from OCP.BRepTools import BRepTools, BRepTools_WireExplorer
    from OCP.TopAbs import TopAbs_REVERSED, TopAbs_WIRE
    from OCP.TopExp import TopExp_Explorer
    from OCP.TopoDS import TopoDS

    outer = BRepTools.OuterWire_s(face)
    loops: list[Floats] = []
    first = 0
    explorer = TopExp_Explorer(face, TopAbs_WIRE)
    while explorer.More():
        wire = TopoDS.Wire_s(explorer.Current())
        if wire.IsSame(outer):
            first = len(loops)
        parts = []
        edges = BRepTools_WireExplorer(wire, face)
        while edges.More():
            edge = edges.Current()
            curve = BRepAdaptor_Curve2d(edge, face)
            low, high = curve.FirstParameter(), curve.LastParameter()
            points = np.array(
                [
                    (p.X(), p.Y())
                    for p in (
                        curve.Value(t) for t in np.linspace(low, high, _CURVE_POINTS + 1).tolist()
                    )
                ]
            )
            if edge.Orientation() == TopAbs_REVERSED:
                points = points[::-1]
            parts.append(_thinned(points)[:-1])
            edges.Next()
        loop = np.concatenate(parts)
        low_, high_ = np.array(domain).T
        near = 1e-7 * (high_ - low_)
        loop = np.where(np.abs(loop - low_) < near, low_, loop)
        loop = np.where(np.abs(loop - high_) < near, high_, loop)
        loops.append(loop)
        explorer.Next()
    loops.insert(0, loops.pop(first))
    return [loop for k, loop in enumerate(loops) if k == 0 or abs(polygon_area(loop)) > 0]


def _thinned(points: Floats) -> Floats:
    """Both ends of a straight row of points; all points of a curved one."""
    chord = points[-1] - points[0]
    length = float(np.linalg.norm(chord))
    gap = points - points[0]
    off = np.abs(gap[:, 0] * chord[1] - gap[:, 1] * chord[0])
    return points[[0, -1]] if length > 0 and off.max() <= _STRAIGHT * length**2 else points
