"""The one door to the CAD kernel: its import with a guard, and boundaries as kernel solids."""

from __future__ import annotations

import math
from functools import lru_cache
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np

from ddgfab.errors import KernelError
from ddgfab.mesh import Floats
from fabrication.solids.boundary import Boundary
from fabrication.solids.builder import Vec, add, cross, dot, scale
from fabrication.specs import Properties

if TYPE_CHECKING:
    from OCP.TopoDS import TopoDS_Edge, TopoDS_Face, TopoDS_Solid

KERNEL_VERSION = "7.9.3"
"""The kernel that build123d 0.12 and cadquery 2.8 share."""

REPAIR = "pip install --force-reinstall --no-deps cadquery-ocp==7.9.3.1.1"
"""What puts the right build of the kernel back."""

TOLERANCE = 1e-7
"""Tolerance [mm] of vertices, edges and faces in the kernel: its Precision::Confusion."""

ADAPTIVE = 1e-6
"""Relative accuracy asked of the kernel's adaptive quadrature, which then does much better."""

SAME_RADIUS = 1e-12
"""Half-axes that differ by less than this part make a circle."""

PCURVE_DEGREE = 13
"""Degree of the polynomial that stands for a wave of up to half a turn in a cylinder's (u, v):
off by less than 1e-10 of its height."""


@lru_cache(maxsize=1)
def load_kernel() -> SimpleNamespace:
    """The kernel's classes that this package uses.

    Raises
    ------
    KernelError
        The kernel is missing or of another build; the message holds the repair.
    """
    try:
        import OCP
        from OCP import (
            Bnd,
            BRep,
            BRepAlgoAPI,
            BRepBndLib,
            BRepCheck,
            BRepGProp,
            BRepMesh,
            BRepPrimAPI,
            Geom,
            Geom2d,
            GProp,
            TColgp,
            TColStd,
            TopAbs,
            TopExp,
            TopLoc,
            TopoDS,
            TopTools,
            gp,
        )
    except ImportError as error:
        raise KernelError(f"the CAD kernel cannot be loaded: {error}\nrepair: {REPAIR}") from error
    version = str(getattr(OCP, "__version__", "unknown"))
    if not version.startswith(KERNEL_VERSION):
        raise KernelError(
            f"the CAD kernel is build {version}, not {KERNEL_VERSION}: another package replaced it"
            f"\nrepair: {REPAIR}"
        )
    names: dict[str, Any] = {}
    for module in (
        Bnd, BRep, BRepAlgoAPI, BRepBndLib, BRepCheck, BRepGProp, BRepMesh, BRepPrimAPI, Geom,
        Geom2d, GProp, TColgp, TColStd, TopAbs, TopExp, TopLoc, TopoDS, TopTools, gp,
    ):  # fmt: skip
        names |= {k: v for k, v in vars(module).items() if not k.startswith("__")}
    return SimpleNamespace(**names)


@lru_cache(maxsize=1)
def _wave_basis() -> tuple[Floats, Floats]:
    """Interpolation nodes on -1..1, and the matrix from values there to Bernstein coefficients."""
    n = PCURVE_DEGREE
    nodes = np.cos((np.arange(n + 1) + 0.5) * math.pi / (n + 1))
    s = (nodes + 1.0) / 2.0
    bernstein = np.array([math.comb(n, k) * s**k * (1.0 - s) ** (n - k) for k in range(n + 1)]).T
    # Exact ends: the curve must meet the vertices.
    bernstein[0], bernstein[-1] = np.eye(n + 1)[-1], np.eye(n + 1)[0]
    nodes[0], nodes[-1] = 1.0, -1.0
    return nodes, np.linalg.inv(bernstein)


class _Topology:
    """Kernel vertices and edges of one boundary, shared by its faces."""

    def __init__(self, boundary: Boundary) -> None:
        self.k = load_kernel()
        self.boundary = boundary
        self.builder = self.k.BRep_Builder()
        self.ends = boundary.edges.tolist()
        self.points: list[Vec] = [(x, y, z) for x, y, z in boundary.points.tolist()]
        self.edge_arc = boundary.edge_arc.tolist()
        self.arcs = [
            self._major_first(
                (c[0], c[1], c[2]), (a[0], a[1], a[2]), (b[0], b[1], b[2]), t[0], t[1]
            )
            for c, a, b, t in zip(
                boundary.arc_centre.tolist(),
                boundary.arc_a.tolist(),
                boundary.arc_b.tolist(),
                boundary.arc_range.tolist(),
                strict=True,
            )
        ]
        self.vertices = []
        for point in self.points:
            vertex = self.k.TopoDS_Vertex()
            self.builder.MakeVertex(vertex, self.k.gp_Pnt(*point), TOLERANCE)
            self.vertices.append(vertex)
        self.reversed_vertices = [vertex.Reversed() for vertex in self.vertices]
        self.edges = [self._edge(e) for e in range(len(self.ends))]
        self.reversed_edges = [edge.Reversed() for edge in self.edges]

    @staticmethod
    def _major_first(
        c: Vec, a: Vec, b: Vec, t0: float, t1: float
    ) -> tuple[Vec, Vec, Vec, float, float, float, float]:
        """The arc with its longer half-axis first, and both lengths."""
        la, lb = math.sqrt(dot(a, a)), math.sqrt(dot(b, b))
        if lb <= la:
            return c, a, b, t0, t1, la, lb
        return c, b, scale(a, -1.0), t0 - math.pi / 2.0, t1 - math.pi / 2.0, lb, la

    def _edge(self, index: int) -> TopoDS_Edge:
        k = self.k
        i, j = self.ends[index]
        if self.edge_arc[index] < 0:
            p, q = self.points[i], self.points[j]
            along = add(q, p, -1.0)
            first, last = 0.0, math.sqrt(dot(along, along))
            curve = k.Geom_Line(k.gp_Pnt(*p), k.gp_Dir(*along))
        else:
            c, a, b, first, last, la, lb = self.arcs[self.edge_arc[index]]
            frame = k.gp_Ax2(k.gp_Pnt(*c), k.gp_Dir(*cross(a, b)), k.gp_Dir(*a))
            if la - lb <= SAME_RADIUS * la:
                curve = k.Geom_Circle(frame, la)
            else:
                curve = k.Geom_Ellipse(frame, la, lb)
        edge = k.TopoDS_Edge()
        self.builder.MakeEdge(edge, curve, TOLERANCE)
        self.builder.Add(edge, self.vertices[i])
        self.builder.Add(edge, self.reversed_vertices[j])
        self.builder.Range(edge, first, last)
        return edge

    def face(
        self,
        curved: bool,
        frame: tuple[Vec, Vec, Vec],
        radius: float,
        sign: float,
        loops: list[list[int]],
    ) -> TopoDS_Face:
        """The face with its wires, oriented outward."""
        k = self.k
        origin, axis, xdir = frame
        ax3 = k.gp_Ax3(k.gp_Pnt(*origin), k.gp_Dir(*axis), k.gp_Dir(*xdir))
        surface = k.Geom_CylindricalSurface(ax3, radius) if curved else k.Geom_Plane(ax3)
        face = k.TopoDS_Face()
        self.builder.MakeFace(face, surface, TOLERANCE)
        for loop in loops:
            wire = k.TopoDS_Wire()
            self.builder.MakeWire(wire)
            for coedge in loop:
                # Inside a reversed face everything is turned over, so it is put in turned over.
                forward = (coedge >= 0) == (sign > 0.0)
                index = coedge if coedge >= 0 else ~coedge
                self.builder.Add(wire, (self.edges if forward else self.reversed_edges)[index])
                if curved:
                    self._pcurve(index, face, frame, radius)
            self.builder.Add(face, wire)
        return face if sign > 0.0 else face.Reversed()

    def _pcurve(
        self, index: int, face: TopoDS_Face, frame: tuple[Vec, Vec, Vec], radius: float
    ) -> None:
        """Give an edge its curve in a cylinder face's (u, v), with the edge's own parameter."""
        k = self.k
        origin, axis, xdir = frame
        ydir = cross(axis, xdir)
        if self.edge_arc[index] < 0:
            p, q = (add(self.points[i], origin, -1.0) for i in self.ends[index])
            u = math.atan2(dot(p, ydir), dot(p, xdir)) % (2.0 * math.pi)
            v = dot(p, axis)
            curve = k.Geom2d_Line(
                k.gp_Pnt2d(u, v), k.gp_Dir2d(0.0, 1.0 if dot(q, axis) > v else -1.0)
            )
        else:
            c, a, b, t0, t1, _, _ = self.arcs[self.edge_arc[index]]
            middle = 0.5 * (t0 + t1)
            radial = add(scale(a, math.cos(middle)), b, math.sin(middle))
            u = math.atan2(dot(radial, ydir), dot(radial, xdir)) % (2.0 * math.pi)
            turn = 1.0 if dot(cross(a, b), axis) > 0.0 else -1.0
            v, va, vb = dot(add(c, origin, -1.0), axis), dot(a, axis), dot(b, axis)
            if abs(va) + abs(vb) <= TOLERANCE * 1e-3:
                curve = k.Geom2d_Line(k.gp_Pnt2d(u - turn * middle, v), k.gp_Dir2d(turn, 0.0))
            else:
                curve = self._wave(u, turn, (v, va, vb), t0, t1)
        self.builder.UpdateEdge(self.edges[index], curve, face, TOLERANCE)

    def _wave(
        self, u: float, turn: float, wave: tuple[float, float, float], t0: float, t1: float
    ) -> Any:
        """Curve (u + turn (t - middle), v + va cos t + vb sin t) for t in t0..t1."""
        k, n = self.k, PCURVE_DEGREE
        nodes, matrix = _wave_basis()
        half, middle = 0.5 * (t1 - t0), 0.5 * (t0 + t1)
        t = middle + half * nodes
        heights = (matrix @ (wave[0] + wave[1] * np.cos(t) + wave[2] * np.sin(t))).tolist()
        poles = k.TColgp_Array1OfPnt2d(1, n + 1)
        for i, v in enumerate(heights):
            poles.SetValue(i + 1, k.gp_Pnt2d(u + turn * half * (2.0 * i / n - 1.0), v))
        knots = k.TColStd_Array1OfReal(1, 2)
        knots.SetValue(1, t0)
        knots.SetValue(2, t1)
        counts = k.TColStd_Array1OfInteger(1, 2)
        counts.Init(n + 1)
        return k.Geom2d_BSplineCurve(poles, knots, counts, n)


def _triples(rows: Floats) -> list[Vec]:
    return [(x, y, z) for x, y, z in rows.tolist()]


def solid_from(boundary: Boundary) -> TopoDS_Solid:
    """The kernel solid of a boundary: shared vertices and edges, outward faces, no healing.

    Raises
    ------
    KernelError
        The kernel is missing or of another build.
    """
    topology = _Topology(boundary)
    builder, k = topology.builder, topology.k
    shell = k.TopoDS_Shell()
    builder.MakeShell(shell)
    for curved, origin, axis, xdir, radius, sign, loops in zip(
        boundary.face_cylinder.tolist(),
        _triples(boundary.face_origin),
        _triples(boundary.face_axis),
        _triples(boundary.face_xdir),
        boundary.face_radius.tolist(),
        boundary.face_sign.tolist(),
        boundary.face_loops(),
        strict=True,
    ):
        builder.Add(shell, topology.face(curved, (origin, axis, xdir), radius, sign, loops))
    shell.Closed(True)
    solid = k.TopoDS_Solid()
    builder.MakeSolid(solid)
    builder.Add(solid, shell)
    return solid


def kernel_properties(solid: TopoDS_Solid, *, adaptive: bool = False) -> Properties:
    """Volume, area and centroid as the kernel measures them.

    Its plain quadrature is exact to rounding on what has an exact boundary, and off by some 1e-6
    on parts that were cut by booleans; `adaptive` gives 1e-10 there, at four times the cost.
    """
    k = load_kernel()
    bulk, skin = k.GProp_GProps(), k.GProp_GProps()
    accuracy = (ADAPTIVE,) if adaptive else ()
    k.BRepGProp.VolumeProperties_s(solid, bulk, *accuracy)
    k.BRepGProp.SurfaceProperties_s(solid, skin, *accuracy)
    centre = bulk.CentreOfMass()
    return Properties(bulk.Mass(), skin.Mass(), (centre.X(), centre.Y(), centre.Z()))


def is_valid(solid: TopoDS_Solid) -> bool:
    """Whether the kernel's own check (BRepCheck) finds nothing wrong."""
    return bool(load_kernel().BRepCheck_Analyzer(solid).IsValid())
