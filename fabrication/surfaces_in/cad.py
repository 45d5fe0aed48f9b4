"""Faces of STEP and IGES files as trimmed NURBS surfaces, lengths in millimetres."""

from __future__ import annotations

from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ddgfab.errors import InputError
from ddgfab.mesh import Floats
from ddgfab.surfaces.spline import SplineSurface
from ddgfab.surfaces.trim import polygon_area
from fabrication.formats.step.apart import apart
from fabrication.formats.step.xcaf import components, free_labels, get_name, read_document
from fabrication.surfaces_in.choice import FaceChoice, chosen, patch_name
from fabrication.surfaces_in.damage import check_spline_surfaces
from fabrication.surfaces_in.loops import CURVE_POINTS, closed_loop, thinned


class CadFace(NamedTuple):
    """A face as a kernel object, and its names: its own, then those of the bodies it belongs to."""

    shape: Any
    names: tuple[str, ...]


def cad_faces(path: Path) -> list[CadFace]:
    """The faces of a STEP or IGES file, in the file's order.

    Raises
    ------
    InputError
        A file that is missing or cannot be read, or has no faces; spline surfaces whose knots or
        weights are out of order.
    """
    if path.suffix.lower() in (".step", ".stp"):
        faces = _step_faces(path)
        check_spline_surfaces(path.read_text(encoding="latin-1"), str(path))
    else:
        faces = [CadFace(face, ()) for face in _faces_of(_iges_shape(path))]
    if not faces:
        raise InputError("has no faces; surfaces are needed, not curves or meshes", file=str(path))
    return faces


def read_cad_surfaces(path: Path, faces: FaceChoice = None) -> list[SplineSurface]:
    """Faces of a STEP or IGES file, read by the CAD kernel in a process of its own.

    Parameters
    ----------
    faces : see `chosen`

    Raises
    ------
    InputError
        No such face, several faces and none chosen (lists them), or one that is not a regular
        patch; a file that the kernel cannot read, or not within the limits of time and memory.
    """
    return apart(_read_surfaces, path, faces)


def read_cad_surface(path: Path, face: int | str | None = None) -> SplineSurface:
    """One face of a STEP or IGES file; it may be left out where the file has one.

    Raises
    ------
    InputError
        As `read_cad_surfaces`.
    """
    return read_cad_surfaces(path, face)[0]


def _read_surfaces(path: Path, faces: FaceChoice) -> list[SplineSurface]:
    """The same in this process."""
    found = cad_faces(path)
    names = [face.names for face in found]
    numbers = chosen(names, [_area(face.shape) for face in found], faces, str(path))
    return [
        _surface(found[k].shape, patch_name(path.name, k, names[k] if len(found) > 1 else ()))
        for k in numbers
    ]


def _step_faces(path: Path) -> list[CadFace]:
    """Faces of a STEP file with the names of ADVANCED_FACE, of products and of their uses."""
    from OCP.Interface import Interface_Static
    from OCP.STEPCAFControl import STEPCAFControl_Reader
    from OCP.TDF import TDF_LabelSequence
    from OCP.TopLoc import TopLoc_Location
    from OCP.XCAFDoc import XCAFDoc_ShapeTool

    STEPCAFControl_Reader()  # the kernel knows its settings from its first reader on
    Interface_Static.SetIVal_s("read.stepcaf.subshapes.name", 1)
    document, _ = read_document(path)
    found: list[CadFace] = []

    def walk(label: Any, place: Any, names: tuple[str, ...]) -> None:
        own = get_name(label)
        names = (own, *names) if own and own not in names else names
        if XCAFDoc_ShapeTool.IsAssembly_s(label):
            for use, target in components(label):
                again = get_name(use)
                more = (again, *names) if again and again not in names else names
                walk(target, place.Multiplied(XCAFDoc_ShapeTool.GetLocation_s(use)), more)
            return
        shape = XCAFDoc_ShapeTool.GetShape_s(label)
        parts = TDF_LabelSequence()
        XCAFDoc_ShapeTool.GetSubShapes_s(label, parts)
        named = [
            (XCAFDoc_ShapeTool.GetShape_s(parts.Value(i)), get_name(parts.Value(i)))
            for i in range(1, parts.Length() + 1)
        ]
        for face in _faces_of(shape):
            of_face = tuple(name for part, name in named if name and part.IsSame(face))
            found.append(CadFace(face.Moved(place), (*of_face, *names)))

    for label in free_labels(document):
        walk(label, TopLoc_Location(), ())
    return found


def _faces_of(shape: Any) -> list[Any]:
    from OCP.TopAbs import TopAbs_FACE
    from OCP.TopExp import TopExp_Explorer
    from OCP.TopoDS import TopoDS

    faces = []
    explorer = TopExp_Explorer(shape, TopAbs_FACE)
    while explorer.More():
        faces.append(TopoDS.Face_s(explorer.Current()))
        explorer.Next()
    return faces


def _iges_shape(path: Path) -> Any:
    from OCP.IFSelect import IFSelect_ReturnStatus
    from OCP.IGESControl import IGESControl_Reader

    if not path.is_file():
        raise InputError("no such file", file=str(path))
    reader = IGESControl_Reader()
    if reader.ReadFile(str(path)) != IFSelect_ReturnStatus.IFSelect_RetDone:
        raise InputError("is not an IGES file that can be read", file=str(path))
    reader.TransferRoots()
    return reader.OneShape()


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
    periodic = patch.IsUPeriodic() or patch.IsVPeriodic()
    patch.SetUNotPeriodic()
    patch.SetVNotPeriodic()
    if periodic:  # its knots reach beyond the period: cut to it, with clamped ends
        patch.Segment(u0, u1, v0, v1)
    for axis, degree, knots in (
        ("u", patch.UDegree(), [patch.UKnot(k + 1) for k in range(patch.NbUKnots())]),
        ("v", patch.VDegree(), [patch.VKnot(k + 1) for k in range(patch.NbVKnots())]),
    ):
        if degree == 1 and len(knots) > 2:
            raise InputError(
                f"{name}: degree 1 along {axis} with {len(knots) - 2} knots inside, the first at "
                f"{axis} = {knots[1]:.6g}: it is creased there, and creases have no curvature\n"
                "rebuild it as a cubic surface, or split it at its creases"
            )
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
                        curve.Value(t) for t in np.linspace(low, high, CURVE_POINTS + 1).tolist()
                    )
                ]
            )
            if edge.Orientation() == TopAbs_REVERSED:
                points = points[::-1]
            parts.append(thinned(points))
            edges.Next()
        loops.append(closed_loop(parts, domain))
        explorer.Next()
    loops.insert(0, loops.pop(first))
    return [loop for k, loop in enumerate(loops) if k == 0 or abs(polygon_area(loop)) > 0]
