"""Shapes as solids: exact boundary, closed-form volume, triangle mesh, kernel solid.

Only `solid_of`, and what is said below of shapes without an exact boundary, load the CAD kernel.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from fabrication.linkspecs import LinkShape, PinShape, RingShape
from fabrication.solids.beam import beam_boundary, beam_is_exact
from fabrication.solids.boundary import Boundary
from fabrication.solids.coupon import coupon_boundary, coupon_volume
from fabrication.solids.kernel import is_valid, kernel_properties, load_kernel, solid_from
from fabrication.solids.link import link_boundary, link_volume
from fabrication.solids.node import drills, node_boundary, node_is_exact
from fabrication.solids.panel import panel_boundary
from fabrication.solids.pin import pin_boundary, pin_volume, ring_boundary, ring_volume
from fabrication.solids.properties import properties
from fabrication.solids.quadrature import beam_volume, node_volume, panel_volume
from fabrication.solids.tessellate import CHORD, tessellate
from fabrication.specs import (
    BeamShape,
    LinkageShape,
    NodeShape,
    PanelShape,
    Properties,
    Shape,
    TriangleMesh,
)

if TYPE_CHECKING:
    from OCP.TopoDS import TopoDS_Solid

__all__ = [
    "CHORD",
    "Boundary",
    "Realised",
    "boundary_of",
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

    None: a coped end on a profile with round corners, a radial hole into the bore or in the round
    surface of a node.

    Raises
    ------
    DetailError
        The shape is impossible: cuts that cross, seats, holes or corners that do not fit.
    """
    if isinstance(shape, BeamShape):
        return beam_boundary(shape) if beam_is_exact(shape) else None
    if isinstance(shape, NodeShape):
        return node_boundary(shape) if node_is_exact(shape) else None
    if isinstance(shape, PanelShape):
        return panel_boundary(shape)
    return _linkage_boundary(shape)


def _linkage_boundary(shape: LinkageShape) -> Boundary:
    """Exact boundary of a part of a linkage; there always is one."""
    if isinstance(shape, LinkShape):
        return link_boundary(shape)
    if isinstance(shape, PinShape):
        return pin_boundary(shape)
    if isinstance(shape, RingShape):
        return ring_boundary(shape)
    return coupon_boundary(shape)


def _blank_of(shape: BeamShape | NodeShape) -> Boundary:
    """Exact boundary of a shape before its cuts by the kernel; checks the whole shape."""
    from fabrication.solids.booleans import beam_blank

    if isinstance(shape, BeamShape):
        return beam_blank(shape)
    return node_boundary(shape, blank=True)


def second_volume_of(shape: Shape) -> float:
    """Volume [mm3] straight from the shape's numbers: independent of boundary, mesh and kernel.

    Trusts the shape; `boundary_of` is what finds an impossible one.
    """
    if isinstance(shape, BeamShape):
        return beam_volume(shape)
    if isinstance(shape, NodeShape):
        return node_volume(shape)
    if isinstance(shape, PanelShape):
        return panel_volume(shape)
    if isinstance(shape, LinkShape):
        return link_volume(shape)
    if isinstance(shape, PinShape):
        return pin_volume(shape)
    if isinstance(shape, RingShape):
        return ring_volume(shape)
    return coupon_volume(shape)


def volume_of(shape: Shape) -> float:
    """Volume [mm3]: of the exact boundary, or by quadrature without one. Never loads the kernel.

    Raises
    ------
    DetailError
        The shape is impossible.
    """
    boundary = boundary_of(shape)
    if boundary is not None:
        return properties(boundary).volume
    assert isinstance(shape, BeamShape | NodeShape)
    _blank_of(shape)
    return second_volume_of(shape)


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
    boundary = boundary_of(shape)
    if boundary is not None:
        return properties(boundary)
    measured = kernel_properties(solid_of(shape), adaptive=True)
    return Properties(second_volume_of(shape), measured.area, measured.centroid)


def solid_of(shape: Shape) -> TopoDS_Solid:
    """Kernel solid of a shape in its own frame: one closed, outward oriented shell.

    Raises
    ------
    DetailError
        The shape is impossible.
    KernelError
        The kernel is missing, of another build, or fails.
    """
    boundary = boundary_of(shape)
    if boundary is not None:
        return solid_from(boundary)
    from fabrication.solids.booleans import beam_solid, node_solid

    if isinstance(shape, BeamShape):
        return beam_solid(shape)
    assert isinstance(shape, NodeShape)
    return node_solid(shape)


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
    boundary = boundary_of(shape)
    if boundary is not None:
        return tessellate(boundary, chord)
    from fabrication.solids.booleans import kernel_mesh

    return kernel_mesh(solid_of(shape), chord)


def genus_of(shape: Shape) -> int:
    """Number of handles (through openings); never loads the kernel.

    Raises
    ------
    DetailError
        The shape is impossible.
    """
    boundary = boundary_of(shape)
    if boundary is not None:
        return boundary.genus
    assert isinstance(shape, BeamShape | NodeShape)
    # A cope changes no handle, nor does a blind hole; each hole into the bore adds one.
    genus = _blank_of(shape).genus
    if isinstance(shape, NodeShape):
        genus += sum(drill.bottom is None for drill in drills(shape))
    return genus


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
    boundary = boundary_of(shape)
    if boundary is not None:
        return Realised(
            boundary,
            solid_from(boundary) if solid else None,
            properties(boundary),
            tessellate(boundary, chord),
            boundary.genus,
        )
    from fabrication.solids.booleans import kernel_mesh

    body = solid_of(shape)
    measured = kernel_properties(body, adaptive=True)
    exact = Properties(second_volume_of(shape), measured.area, measured.centroid)
    return Realised(None, body, exact, kernel_mesh(body, chord), genus_of(shape))
