"""Shapes as solids: exact boundary, two volumes, triangle mesh, kernel solid. Knows no kind.

Only `solid_of`, and what is noted below of shapes without an exact boundary, load the CAD kernel.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from fabrication.boundary import Boundary, Cut
from fabrication.solids.integrals import properties
from fabrication.solids.kernel import is_valid, kernel_properties, load_kernel, solid_from
from fabrication.solids.tessellation import CHORD, tessellate
from fabrication.specs import Properties, Shape, TriangleMesh

if TYPE_CHECKING:
    from OCP.TopoDS import TopoDS_Solid

__all__ = [
    "CHORD",
    "Boundary",
    "Realised",
    "boundary_of",
    "comparison_mesh",
    "genus_of",
    "is_valid",
    "kernel_properties",
    "load_kernel",
    "mesh_of",
    "properties_of",
    "realise",
    "second_volume_of",
    "solid_from",
    "solid_of",
    "volume_of",
]


def boundary_of(shape: Shape) -> Boundary | None:
    """Exact boundary of a shape in its own frame; None where that needs other curves.

    None: a radial hole in the round surface of a node, and a coped end on an arc that turns back
    sideways.

    Raises
    ------
    DetailError
        The shape is impossible: cuts that cross, seats, holes or corners that do not fit.
    """
    geometry = shape.geometry()
    return geometry if isinstance(geometry, Boundary) else None


def second_volume_of(shape: Shape) -> float:
    """Volume [mm3] straight from the shape's numbers: independent of boundary, mesh and kernel.

    Trusts the shape; `boundary_of` is what finds an impossible one.
    """
    return shape.second_volume()


def volume_of(shape: Shape) -> float:
    """Volume [mm3]: of the exact boundary, or by quadrature without one. Never loads the kernel.

    Raises
    ------
    DetailError
        The shape is impossible.
    """
    boundary = boundary_of(shape)
    return shape.second_volume() if boundary is None else properties(boundary).volume


def genus_of(shape: Shape) -> int:
    """Number of handles (through openings); never loads the kernel.

    Raises
    ------
    DetailError
        The shape is impossible.
    """
    return shape.geometry().genus


def solid_of(shape: Shape) -> TopoDS_Solid:
    """Kernel solid of a shape in its own frame: one closed, outward oriented shell.

    Raises
    ------
    DetailError
        The shape is impossible.
    KernelError
        The kernel is missing, of another build, or fails.
    """
    return _solid(shape.geometry())


def _solid(geometry: Boundary | Cut) -> TopoDS_Solid:
    if isinstance(geometry, Boundary):
        return solid_from(geometry)
    from fabrication.solids.booleans import cut_solid

    return cut_solid(geometry)


def properties_of(shape: Shape) -> Properties:
    """Volume [mm3], area [mm2] and centroid [mm] in closed form.

    Without an exact boundary, area and centroid are the kernel's.

    Raises
    ------
    DetailError
        The shape is impossible.
    KernelError
        The kernel is needed and missing, of another build, or fails.
    """
    geometry = shape.geometry()
    if isinstance(geometry, Boundary):
        return properties(geometry)
    return _measured(shape, _solid(geometry))


def _measured(shape: Shape, solid: TopoDS_Solid) -> Properties:
    """Area and centroid of a cut solid by the kernel, its volume by quadrature."""
    measured = kernel_properties(solid, adaptive=True)
    return Properties(shape.second_volume(), measured.area, measured.centroid)


def mesh_of(shape: Shape, chord: float = CHORD) -> TriangleMesh:
    """Watertight outward triangle mesh within `chord` [mm] of the exact surface.

    Without an exact boundary it is the kernel's mesh.

    Raises
    ------
    DetailError
        The shape is impossible.
    KernelError
        The kernel is needed and missing, of another build, or fails.
    """
    geometry = shape.geometry()
    if isinstance(geometry, Boundary):
        return tessellate(geometry, chord)
    from fabrication.solids.booleans import kernel_mesh

    return kernel_mesh(_solid(geometry), chord)


def comparison_mesh(shape: Shape, chord: float = CHORD) -> TriangleMesh:
    """Closed outward mesh whose faces are within `chord` [mm] of the exact ones; no kernel.

    For checks of parts against each other. With an exact boundary it is `mesh_of`; without one,
    edges of cuts may be off by more than the chord where faces meet at small angles.

    Raises
    ------
    DetailError
        The shape is impossible.
    KernelError
        The cut leaves nothing.
    """
    geometry = shape.geometry()
    if isinstance(geometry, Boundary):
        return tessellate(geometry, chord)
    from fabrication.solids.faceted_cut import faceted_cut

    return faceted_cut(geometry, chord)


@dataclass(frozen=True, eq=False)
class Realised:
    """Everything about a shape, from one description: boundary where it is exact, solid if made."""

    boundary: Boundary | None
    solid: Any
    properties: Properties
    mesh: TriangleMesh
    genus: int


def realise(shape: Shape, chord: float = CHORD, *, solid: bool = True) -> Realised:
    """Boundary, kernel solid, properties, mesh and genus of a shape, each made once.

    Without `solid` the kernel is loaded only for shapes that have no exact boundary.

    Raises
    ------
    DetailError
        The shape is impossible.
    KernelError
        The kernel is needed and missing, of another build, or fails.
    """
    geometry = shape.geometry()
    if isinstance(geometry, Boundary):
        return Realised(
            geometry,
            solid_from(geometry) if solid else None,
            properties(geometry),
            tessellate(geometry, chord),
            geometry.genus,
        )
    from fabrication.solids.booleans import kernel_mesh

    body = _solid(geometry)
    measured = _measured(shape, body)
    return Realised(None, body, measured, kernel_mesh(body, chord), geometry.genus)
