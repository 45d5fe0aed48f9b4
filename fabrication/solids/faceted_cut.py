"""Meshes of cut parts for comparisons: the mesh of the blank less prisms, without the CAD kernel.

The kernel cuts and meshes a coped hollow section within 2e-4 mm in seconds; this takes
milliseconds. What is written to files is the kernel's mesh, whose vertices lie on the surface.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from ddgfab.errors import KernelError
from fabrication.boundary import Cut, Tool
from fabrication.solids.tessellation import MAX_STEP, tessellate
from fabrication.specs import TriangleMesh

if TYPE_CHECKING:
    from manifold3d import Manifold


def faceted_cut(cut: Cut, chord: float) -> TriangleMesh:
    """Closed mesh of a blank less its tools; blank and tools are within a chord [mm] of theirs.

    Raises
    ------
    KernelError
        Nothing is left.
    """
    import manifold3d

    bodies = [_manifold(tessellate(cut.blank, chord)), *(_prism(t, chord) for t in cut.tools)]
    left = manifold3d.Manifold.batch_boolean(bodies, manifold3d.OpType.Subtract)
    if left.status() != manifold3d.Error.NoError or left.is_empty():
        raise KernelError(
            f"the cut left no solid ({left.status().name}); check the part's dimensions, "
            "or take a shape that needs no cut"
        )
    mesh = left.to_mesh64()
    vertices = np.array(mesh.vert_properties[:, :3], dtype=np.float64)
    return TriangleMesh(vertices, np.array(mesh.tri_verts, dtype=np.int64))


def _prism(tool: Tool, chord: float) -> Manifold:
    """A regular prism in a tool's cylinder, its sides within a chord [mm] of it."""
    import manifold3d

    step = min(MAX_STEP, 2.0 * math.acos(max(0.0, 1.0 - chord / tool.radius)))
    body = manifold3d.Manifold.cylinder(
        tool.height, tool.radius, tool.radius, math.ceil(2.0 * math.pi / step)
    )
    axis, across = np.array(tool.axis), np.array(tool.xdir)
    axis = axis / np.linalg.norm(axis)
    across = across - (across @ axis) * axis
    across = across / np.linalg.norm(across)
    return body.transform(np.stack([across, np.cross(axis, across), axis, tool.foot], axis=1))


def _manifold(mesh: TriangleMesh) -> Any:
    import manifold3d

    return manifold3d.Manifold(
        manifold3d.Mesh64(
            np.ascontiguousarray(mesh.vertices, dtype=np.float64),
            np.ascontiguousarray(mesh.triangles, dtype=np.uint64),
        )
    )
