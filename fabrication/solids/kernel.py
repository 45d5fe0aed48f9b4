"""The one door to the CAD kernel: its import with a guard, and boundaries as kernel solids."""

from __future__ import annotations

import math
from functools import lru_cache
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np

from ddgfab.errors import KernelError
from fabrication.boundary import Boundary, Vec, cross_rows
from fabrication.solids.polynomials import PCURVE_ERROR, crossing_poles, wave_basis, wave_degree
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


class _Topology:
    """Kernel vertices and edges of one boundary, shared by its faces."""

    def __init__(self, boundary: Boundary) -> None:
        self.k = load_kernel()
        self.builder = self.k.BRep_Builder()
        self.boundary = boundary
        self.edge_arc: list[int] = boundary.edge_arc.tolist()
        halves = np.stack([boundary.arc_a, boundary.arc_b], axis=1)
        self.arc_size: list[list[float]] = np.sqrt(
            np.einsum("aki,aki->ak", halves, halves)
        ).tolist()
        self.arc_range: list[list[float]] = boundary.arc_range.tolist()
        self.poles = crossing_poles(boundary)
        self._make_edges(boundary)
        self._place(boundary)

    def _make_edges(self, boundary: Boundary) -> None:
        k, build = self.k, self.builder
        forward, backward = [], []
        for point in boundary.points.tolist():
            vertex = k.TopoDS_Vertex()
            build.MakeVertex(vertex, k.gp_Pnt(*point), TOLERANCE)
            forward.append(vertex)
            backward.append(vertex.Reversed())
        first = boundary.points[boundary.edges[:, 0]]
        along = boundary.points[boundary.edges[:, 1]] - first
        lengths = np.sqrt(np.einsum("ei,ei->e", along, along)).tolist()
        normals = cross_rows(boundary.arc_a, boundary.arc_b).tolist()
        centers, majors = boundary.arc_center.tolist(), boundary.arc_a.tolist()
        sizes = self.arc_size
        self.edges: list[TopoDS_Edge] = []
        for arc, (i, j), p, d, length in zip(
            self.edge_arc,
            boundary.edges.tolist(),
            first.tolist(),
            along.tolist(),
            lengths,
            strict=True,
        ):
            if arc < 0:
                curve = k.Geom_Line(k.gp_Pnt(*p), k.gp_Dir(*d))
                begin, end = 0.0, length
            else:
                begin, end = self.arc_range[arc]
                if arc in self.poles:
                    edge = self._edge(self._bezier(arc), forward[i], backward[j], begin, end)
                    self.edges.append(edge)
                    continue
                frame = k.gp_Ax2(
                    k.gp_Pnt(*centers[arc]), k.gp_Dir(*normals[arc]), k.gp_Dir(*majors[arc])
                )
                la, lb = sizes[arc]
                if la - lb <= SAME_RADIUS * la:
                    curve = k.Geom_Circle(frame, la)
                else:
                    curve = k.Geom_Ellipse(frame, la, lb)
            self.edges.append(self._edge(curve, forward[i], backward[j], begin, end))
        self.reversed_edges = [edge.Reversed() for edge in self.edges]

    def _edge(self, curve: Any, start: Any, end: Any, first: float, last: float) -> TopoDS_Edge:
        edge, build = self.k.TopoDS_Edge(), self.builder
        build.MakeEdge(edge, curve, TOLERANCE)
        build.Add(edge, start)
        build.Add(edge, end)
        build.Range(edge, first, last)
        return edge

    def _bezier(self, arc: int) -> Any:
        """The curve of an arc where cylinders cross, with the arc's own parameter."""
        k, rows = self.k, self.poles[arc].tolist()
        poles = k.TColgp_Array1OfPnt(1, len(rows))
        for i, row in enumerate(rows):
            poles.SetValue(i + 1, k.gp_Pnt(*row))
        return k.Geom_BSplineCurve(poles, *self._span(arc, len(rows)))

    def _span(self, arc: int, count: int) -> tuple[Any, Any, int]:
        """Knots, how often each counts, and the degree of a polynomial over an arc's range."""
        knots = self.k.TColStd_Array1OfReal(1, 2)
        knots.SetValue(1, self.arc_range[arc][0])
        knots.SetValue(2, self.arc_range[arc][1])
        counts = self.k.TColStd_Array1OfInteger(1, 2)
        counts.Init(count)
        return knots, counts, count - 1

    def _place(self, boundary: Boundary) -> None:
        """Every coedge's point and direction, or center and half-axes, in its face's frame.

        A frame is xdir, the direction that makes a right hand with it and the axis, and the axis.
        """
        face, edge = boundary.coedge_face, boundary.coedge_edge
        xdir, axis = boundary.face_xdir, boundary.face_axis
        frames = np.stack([xdir, cross_rows(axis, xdir), axis], axis=1)[face]
        arc = boundary.edge_arc[edge]
        curved = (arc >= 0)[:, None]
        start, end = boundary.points[boundary.edges[edge]].transpose(1, 0, 2)
        if len(boundary.arc_center):
            origin = np.where(curved, boundary.arc_center[arc], start)
            one = np.where(curved, boundary.arc_a[arc], end - start)
            two = np.where(curved, boundary.arc_b[arc], 0.0)
        else:
            origin, one, two = start, end - start, np.zeros_like(start)
        stacked = np.stack([origin - boundary.face_origin[face], one, two], axis=1)
        self.placed: list[tuple[Vec, Vec, Vec]] = np.einsum(
            "cij,ckj->cki", frames, stacked
        ).tolist()

    def face(
        self,
        curved: bool,
        frame: tuple[Vec, Vec, Vec],
        radius: float,
        sign: float,
        loops: list[list[int]],
        first: int,
    ) -> TopoDS_Face:
        """The face with its wires, oriented outward; first: number of its first coedge."""
        k, build = self.k, self.builder
        origin, axis, xdir = frame
        ax3 = k.gp_Ax3(k.gp_Pnt(*origin), k.gp_Dir(*axis), k.gp_Dir(*xdir))
        surface = k.Geom_CylindricalSurface(ax3, radius) if curved else k.Geom_Plane(ax3)
        face = k.TopoDS_Face()
        build.MakeFace(face, surface, TOLERANCE)
        place = first
        pcurve = self._on_cylinder if curved else self._on_plane
        for loop in loops:
            wire = k.TopoDS_Wire()
            build.MakeWire(wire)
            for coedge in loop:
                # Inside a reversed face everything is turned over, so it is put in turned over.
                forward = (coedge >= 0) == (sign > 0.0)
                index = coedge if coedge >= 0 else ~coedge
                build.Add(wire, (self.edges if forward else self.reversed_edges)[index])
                curve = pcurve(self.edge_arc[index], place)
                build.UpdateEdge(self.edges[index], curve, face, TOLERANCE)
                place += 1
            wire.Closed(True)
            build.Add(face, wire)
        return face if sign > 0.0 else face.Reversed()

    def _on_plane(self, arc: int, place: int) -> Any:
        """Curve of an edge in a plane's (u, v).

        The kernel does without, but its check, which would project every edge again and again,
        takes half as long with it.
        """
        k, (origin, one, two) = self.k, self.placed[place]
        point = k.gp_Pnt2d(origin[0], origin[1])
        direction = k.gp_Dir2d(one[0], one[1])
        if arc < 0:
            return k.Geom2d_Line(point, direction)
        left = one[0] * two[1] > one[1] * two[0]
        frame = k.gp_Ax22d(point, direction, left)
        la, lb = self.arc_size[arc]
        if la - lb <= SAME_RADIUS * la:
            return k.Geom2d_Circle(frame, la)
        return k.Geom2d_Ellipse(frame, la, lb)

    def _on_cylinder(self, arc: int, place: int) -> Any:
        """Curve of an edge in a cylinder's (u, v), with the edge's own parameter."""
        k, (origin, one, two) = self.k, self.placed[place]
        x, y, v = origin
        if arc < 0:
            u = math.atan2(y, x) % (2.0 * math.pi)
            return k.Geom2d_Line(k.gp_Pnt2d(u, v), k.gp_Dir2d(0.0, 1.0 if one[2] > 0.0 else -1.0))
        if arc in self.poles:
            return self._crossing(arc, place)
        t0, t1 = self.arc_range[arc]
        middle, half = 0.5 * (t0 + t1), 0.5 * (t1 - t0)
        c, s = math.cos(middle), math.sin(middle)
        u = math.atan2(c * one[1] + s * two[1], c * one[0] + s * two[0]) % (2.0 * math.pi)
        turn = 1.0 if one[0] * two[1] > one[1] * two[0] else -1.0
        height = math.hypot(one[2], two[2])
        if height <= PCURVE_ERROR:
            return k.Geom2d_Line(k.gp_Pnt2d(u - turn * middle, v), k.gp_Dir2d(turn, 0.0))
        # (u + turn (t - middle), v + one cos t + two sin t) for t in t0..t1, as a polynomial.
        n = wave_degree(height, half)
        nodes, matrix = wave_basis(n)
        t = middle + half * nodes
        heights = (matrix @ (v + one[2] * np.cos(t) + two[2] * np.sin(t))).tolist()
        poles = k.TColgp_Array1OfPnt2d(1, n + 1)
        for i, h in enumerate(heights):
            poles.SetValue(i + 1, k.gp_Pnt2d(u + turn * half * (2.0 * i / n - 1.0), h))
        return k.Geom2d_BSplineCurve(poles, *self._span(arc, n + 1))

    def _crossing(self, arc: int, place: int) -> Any:
        """A curve where cylinders cross in the (u, v) of one of them, with the arc's parameter."""
        k, n = self.k, len(self.poles[arc]) - 1
        nodes, matrix = wave_basis(n)
        face = self.boundary.coedge_face[place]
        first, last = self.arc_range[arc]
        t = 0.5 * (first + last) + 0.5 * (last - first) * nodes
        away = (
            self.boundary.arc_points(np.array([arc]), t[None])[0] - self.boundary.face_origin[face]
        )
        axis, xdir = self.boundary.face_axis[face], self.boundary.face_xdir[face]
        u = np.arctan2(away @ np.cross(axis, xdir), away @ xdir) % (2.0 * math.pi)
        poles = k.TColgp_Array1OfPnt2d(1, n + 1)
        for i, (x, y) in enumerate((matrix @ np.stack([u, away @ axis], axis=1)).tolist()):
            poles.SetValue(i + 1, k.gp_Pnt2d(x, y))
        return k.Geom2d_BSplineCurve(poles, *self._span(arc, n + 1))


def solid_from(boundary: Boundary) -> TopoDS_Solid:
    """The kernel solid of a boundary: shared vertices and edges, outward faces, no healing.

    Raises
    ------
    KernelError
        The kernel is missing or of another build.
    """
    topology = _Topology(boundary.major_first())
    builder, k = topology.builder, topology.k
    shell = k.TopoDS_Shell()
    builder.MakeShell(shell)
    first = 0
    for curved, origin, axis, xdir, radius, sign, loops in zip(
        boundary.face_cylinder.tolist(),
        boundary.face_origin.tolist(),
        boundary.face_axis.tolist(),
        boundary.face_xdir.tolist(),
        boundary.face_radius.tolist(),
        boundary.face_sign.tolist(),
        boundary.face_loops(),
        strict=True,
    ):
        frame = (origin, axis, xdir)
        builder.Add(shell, topology.face(curved, frame, radius, sign, loops, first))
        first += sum(map(len, loops))
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
    center = bulk.CentreOfMass()
    return Properties(bulk.Mass(), skin.Mass(), (center.X(), center.Y(), center.Z()))


def is_valid(solid: TopoDS_Solid) -> bool:
    """Whether the kernel's own check (BRepCheck) finds nothing wrong."""
    return bool(load_kernel().BRepCheck_Analyzer(solid).IsValid())
