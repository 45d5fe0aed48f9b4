"""The few shapes whose boundary has other curves: one multi-tool cut of the kernel.

A coped end on a profile with round corners, a radial hole into the bore, a radial hole in the
round surface. Everything else of such a part comes from the exact boundary of its blank.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ddgfab.errors import KernelError
from ddgfab.mesh import Floats
from fabrication.solids.beam import beam_boundary, check_ends, ends_of, hole_walls
from fabrication.solids.boundary import Boundary
from fabrication.solids.builder import Vec, add, scale
from fabrication.solids.kernel import load_kernel, solid_from
from fabrication.solids.node import drills, node_boundary
from fabrication.solids.section import segments
from fabrication.specs import BeamShape, EndCut, NodeShape, TriangleMesh

if TYPE_CHECKING:
    from OCP.TopoDS import TopoDS_Solid

OVERLAP = 1.0
"""How far [mm] a tool reaches beyond what it cuts."""

MESH_ANGLE = 0.5
"""Greatest angle [rad] between neighbouring facets of the kernel's mesh."""

MESH_MERGE = 1e-6
"""Mesh points of neighbouring faces nearer than this [mm] are one: they sample one edge."""

MESH_SHARE = 0.5
"""Part of the chord tolerance that the kernel's mesher is given: it overshoots."""


def beam_blank(shape: BeamShape) -> Boundary:
    """Exact boundary of a beam whose coped ends still reach, flat, to the coping axes.

    Raises
    ------
    DetailError
        The beam itself is impossible (cuts that cross, holes that do not fit).
    """
    loops = [segments(loop) for loop in shape.profile.loops]
    check_ends(shape, loops)
    for hole in shape.holes:
        hole_walls(shape, hole, loops)

    def flat(cut: EndCut, outward: float) -> EndCut:
        if cut.radius is None:
            return cut
        return EndCut(cut.x + outward * cut.radius * math.hypot(1.0, cut.slope), cut.slope)

    return beam_boundary(replace(shape, start=flat(shape.start, -1.0), end=flat(shape.end, 1.0)))


def _tool(origin: Vec, axis: Vec, xdir: Vec, radius: float, height: float) -> Any:
    """A solid cylinder from its foot."""
    k = load_kernel()
    frame = k.gp_Ax2(k.gp_Pnt(*origin), k.gp_Dir(*axis), k.gp_Dir(*xdir))
    return k.BRepPrimAPI_MakeCylinder(frame, radius, height).Shape()


def beam_solid(shape: BeamShape) -> TopoDS_Solid:
    """Kernel solid of a beam with round corners and coped ends."""
    blank = beam_blank(shape)
    tools = []
    for end in ends_of(shape):
        if end.radius is None:
            continue
        n = end.stretch
        away: Vec = (end.outward / n, 0.0, -end.outward * end.slope / n)
        axis: Vec = (end.slope / n, 0.0, 1.0 / n)
        origin = add((end.at, 0.0, 0.0), away, end.radius)
        reach = (blank.points - np.array(origin)) @ np.array(axis)
        low, high = float(reach.min()) - OVERLAP, float(reach.max()) + OVERLAP
        tools.append(_tool(add(origin, axis, low), axis, away, end.radius, high - low))
    return _cut(solid_from(blank), tools)


def node_solid(shape: NodeShape) -> TopoDS_Solid:
    """Kernel solid of a node with radial holes into its bore or in its round surface."""
    tools = []
    for drill in drills(shape):
        if drill.exact:
            continue
        foot = 0.0 if drill.bottom is None else drill.bottom
        c, s = math.cos(drill.hole.azimuth), math.sin(drill.hole.azimuth)
        direction: Vec = (c, s, 0.0)
        origin = add((0.0, 0.0, drill.hole.z), scale(direction, foot))
        height = shape.radius + OVERLAP - foot
        tools.append(_tool(origin, direction, (0.0, 0.0, 1.0), drill.hole.diameter / 2, height))
    return _cut(solid_from(node_boundary(shape, blank=True)), tools)


def _cut(blank: TopoDS_Solid, tools: list[Any]) -> TopoDS_Solid:
    """What is left of a blank, in one cut; raises `KernelError` unless that is one solid."""
    k = load_kernel()
    arguments, others = k.TopTools_ListOfShape(), k.TopTools_ListOfShape()
    arguments.Append(blank)
    for tool in tools:
        others.Append(tool)
    cut = k.BRepAlgoAPI_Cut()
    cut.SetArguments(arguments)
    cut.SetTools(others)
    cut.Build()
    solids = []
    explorer = k.TopExp_Explorer(cut.Shape(), k.TopAbs_ShapeEnum.TopAbs_SOLID)
    while explorer.More():
        solids.append(k.TopoDS.Solid(explorer.Current()))
        explorer.Next()
    if not cut.IsDone() or len(solids) != 1:
        raise KernelError(
            f"the kernel's cut left {len(solids)} solids instead of one; check the part's "
            f"dimensions, or use flat ends and blind holes on seats, which need no cut"
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
