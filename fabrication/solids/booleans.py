"""The few shapes whose boundary has other curves: one multi-tool cut of the kernel.

Everything else of such a part comes from the exact boundary of its blank.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from ddgfab.errors import KernelError
from ddgfab.mesh import Floats
from fabrication.boundary import Cut
from fabrication.solids.kernel import load_kernel, solid_from
from fabrication.specs import TriangleMesh

if TYPE_CHECKING:
    from OCP.TopoDS import TopoDS_Solid

MESH_ANGLE: Final = 0.5
"""Greatest angle [rad] between neighbouring facets of the kernel's mesh."""

MESH_MERGE: Final = 1e-6
"""Mesh points of neighbouring faces nearer than this [mm] are one: they sample one edge."""

MESH_SHARE: Final = 0.5
"""Part of the chord tolerance that the kernel's mesher is given: it overshoots."""


def cut_solid(cut: Cut) -> TopoDS_Solid:
    """Kernel solid of a blank less its tools, in one cut.

    Raises
    ------
    KernelError
        The kernel is missing or of another build, or what is left is not one solid.
    """
    k = load_kernel()
    arguments, others = k.TopTools_ListOfShape(), k.TopTools_ListOfShape()
    arguments.Append(solid_from(cut.blank))
    for tool in cut.tools:
        frame = k.gp_Ax2(k.gp_Pnt(*tool.foot), k.gp_Dir(*tool.axis), k.gp_Dir(*tool.xdir))
        others.Append(k.BRepPrimAPI_MakeCylinder(frame, tool.radius, tool.height).Shape())
    operation = k.BRepAlgoAPI_Cut()
    operation.SetArguments(arguments)
    operation.SetTools(others)
    operation.Build()
    solids = []
    explorer = k.TopExp_Explorer(operation.Shape(), k.TopAbs_ShapeEnum.TopAbs_SOLID)
    while explorer.More():
        solids.append(k.TopoDS.Solid(explorer.Current()))
        explorer.Next()
    if not operation.IsDone() or len(solids) != 1:
        raise KernelError(
            f"the kernel's cut left {len(solids)} solids instead of one; check the part's "
            f"dimensions, or take a shape that needs no cut"
        )
    return solids[0]


def kernel_mesh(solid: TopoDS_Solid, chord: float) -> TriangleMesh:
    """The kernel's mesh of a solid within a chord [mm], with shared vertices.

    Leaves its triangulation in the solid.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import cKDTree

    k = load_kernel()
    k.BRepMesh_IncrementalMesh(solid, MESH_SHARE * chord, False, MESH_ANGLE, False)
    points: list[tuple[float, float, float]] = []
    triangles: list[tuple[int, int, int]] = []
    explorer = k.TopExp_Explorer(solid, k.TopAbs_ShapeEnum.TopAbs_FACE)
    while explorer.More():
        face = k.TopoDS.Face(explorer.Current())
        location = k.TopLoc_Location()
        patch = k.BRep_Tool.Triangulation_s(face, location)
        if patch is None:
            raise KernelError("the kernel could not mesh a face of a cut part")
        move, base = location.Transformation(), len(points) - 1
        for i in range(1, patch.NbNodes() + 1):
            p = patch.Node(i).Transformed(move)
            points.append((p.X(), p.Y(), p.Z()))
        turned = face.Orientation() == k.TopAbs_Orientation.TopAbs_REVERSED
        for i in range(1, patch.NbTriangles() + 1):
            a, b, c = patch.Triangle(i).Get()
            triangles.append(
                (base + a, base + c, base + b) if turned else (base + a, base + b, base + c)
            )
        explorer.Next()
    vertices: Floats = np.array(points)
    pairs = cKDTree(vertices).query_pairs(MESH_MERGE, output_type="ndarray")
    n = len(vertices)
    graph = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(n, n))
    labels = connected_components(graph, directed=False)[1]
    _, first = np.unique(labels, return_index=True)
    merged = labels[np.array(triangles)]
    whole = (merged != np.roll(merged, 1, axis=1)).all(axis=1)
    return TriangleMesh(vertices[first], merged[whole].astype(np.int64))
