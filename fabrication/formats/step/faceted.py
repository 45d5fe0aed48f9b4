"""The solids of a kernel shape as closed triangle meshes, for what two solids share."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from ddgfab.mesh import Floats, extent
from fabrication.specs import TriangleMesh

CHORD_MM: Final = 0.01
"""Greatest distance [mm] of a facet from a curved surface, on solids up to 5 m."""

CHORD_RELATIVE: Final = 2e-6
"""The same on larger solids, relative to their size."""

SAME_RELATIVE: Final = 1e-9
"""Points of neighbouring faces that are nearer, relative to the coordinates, are one."""

_ANGLE: Final = 0.35  # [rad] between neighbouring facets


@dataclass(frozen=True, eq=False)
class FacetedSolid:
    """A solid's mesh [mm], and how far it is from the exact surface: 0 without curved faces."""

    mesh: TriangleMesh
    chord: float


def faceted_solids(shape: Any) -> tuple[FacetedSolid, ...]:
    """The solids of a TopoDS_Shape, in its order."""
    from OCP.TopAbs import TopAbs_ShapeEnum

    return tuple(_faceted(solid) for solid in _below(shape, TopAbs_ShapeEnum.TopAbs_SOLID))


def _faceted(solid: Any) -> FacetedSolid:
    from OCP.Bnd import Bnd_Box
    from OCP.BRep import BRep_Tool
    from OCP.BRepAdaptor import BRepAdaptor_Surface
    from OCP.BRepBndLib import BRepBndLib
    from OCP.BRepMesh import BRepMesh_IncrementalMesh
    from OCP.GeomAbs import GeomAbs_SurfaceType
    from OCP.TopAbs import TopAbs_Orientation, TopAbs_ShapeEnum
    from OCP.TopLoc import TopLoc_Location
    from OCP.TopoDS import TopoDS

    box = Bnd_Box()
    BRepBndLib.Add_s(solid, box)
    size = 0.0 if box.IsVoid() else float(np.sqrt(box.SquareExtent()))
    chord = max(CHORD_MM, CHORD_RELATIVE * size)
    BRepMesh_IncrementalMesh(solid, chord, False, _ANGLE, False)
    points: list[Floats] = []
    triangles, count, curved = [], 0, False
    for found in _below(solid, TopAbs_ShapeEnum.TopAbs_FACE):
        face = TopoDS.Face_s(found)
        curved |= BRepAdaptor_Surface(face).GetType() != GeomAbs_SurfaceType.GeomAbs_Plane
        place = TopLoc_Location()
        facets = BRep_Tool.Triangulation_s(face, place)
        if facets is None:
            continue
        motion = place.Transformation()
        nodes = [facets.Node(i).Transformed(motion) for i in range(1, facets.NbNodes() + 1)]
        corners = [facets.Triangle(i).Get() for i in range(1, facets.NbTriangles() + 1)]
        rows = np.array(corners, dtype=np.int64).reshape(-1, 3) - 1 + count
        if face.Orientation() == TopAbs_Orientation.TopAbs_REVERSED:
            rows = rows[:, ::-1]
        points.append(np.array([(p.X(), p.Y(), p.Z()) for p in nodes]).reshape(-1, 3))
        triangles.append(rows)
        count += len(nodes)
    if not points:
        return FacetedSolid(TriangleMesh(np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int64)), 0.0)
    mesh = _joined(np.concatenate(points), np.concatenate(triangles))
    return FacetedSolid(mesh, chord if curved else 0.0)


def _joined(points: Floats, triangles: Any) -> TriangleMesh:
    """Points of neighbouring faces that coincide within rounding become one."""
    step = SAME_RELATIVE * max(float(np.abs(points).max()), extent(points))
    cells = np.rint(points / step) if step > 0 else points
    _, first, same = np.unique(cells, axis=0, return_index=True, return_inverse=True)
    return TriangleMesh(points[first], same.reshape(-1)[triangles].astype(np.int64))


def _below(shape: Any, kind: Any) -> list[Any]:
    from OCP.TopExp import TopExp_Explorer

    found, explorer = [], TopExp_Explorer(shape, kind)
    while explorer.More():
        found.append(explorer.Current())
        explorer.Next()
    return found
