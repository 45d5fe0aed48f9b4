"""A surface as a fine mesh over a traced net: what an optimisation of the net stays near to."""

from __future__ import annotations

from typing import Final

import numpy as np

from ddgfab.arguments import checked
from ddgfab.mesh import Floats, Ints, Mesh
from ddgfab.surfaces.spline import SplineSurface
from ddgfab.trace.mesh import TracedMesh

_LEVELS: Final = 2
"""Each halves the edges: flat pieces of a quarter of an edge are h^2 / 128 R from the surface."""


@checked
def reference_mesh(surface: SplineSurface, traced: TracedMesh, levels: int = _LEVELS) -> Mesh:
    """Quads on the surface that refine the faces of a traced net, its rim on the trimming curves.

    Each face becomes quads round its middle in the parameter plane; the middles of rim edges are
    moved to the trimming curve.
    """
    uv, faces = traced.uv, list(traced.mesh.faces)
    for _ in range(levels):
        uv, faces = _halved(surface, uv, faces)
    return Mesh.build(surface.points(uv), faces)


def _halved(surface: SplineSurface, uv: Floats, faces: list[Ints]) -> tuple[Floats, list[Ints]]:
    mesh = Mesh.build(np.pad(uv, ((0, 0), (0, 1))), faces)
    middles = uv[mesh.edges].mean(axis=1)
    rim = np.flatnonzero(mesh.boundary_edge)
    middles[rim] = _on_trim(surface, uv[mesh.edges[rim]], middles[rim])
    sizes = mesh.face_sizes[:, None]
    centers = np.add.reduceat(uv[mesh.corners], mesh.face_start[:-1]) / sizes
    edge = mesh.n_vertices + mesh.corner_edge
    quads = np.stack(
        [
            mesh.corners,
            edge,
            mesh.n_vertices + mesh.n_edges + mesh.corner_face,
            edge[mesh.corner_previous],
        ],
        axis=1,
    )
    return np.concatenate([uv, middles, centers]), list(quads)


def _on_trim(surface: SplineSurface, ends: Floats, middles: Floats) -> Floats:
    """(n, 2) middles of rim edges moved across the edge to the nearest trimming segment."""
    a, way = surface.trim.starts, surface.trim.ends - surface.trim.starts
    gap = middles[:, None] - a
    part = np.einsum("nsx,sx->ns", gap, way) / np.einsum("sx,sx->s", way, way)
    foot = a + np.clip(part, 0, 1)[..., None] * way
    far = np.linalg.norm(foot - middles[:, None], axis=2)
    nearest = far.argmin(axis=1)
    row = np.arange(len(middles))
    # where a trimming curve is far (edges that cut a corner), the chord itself stays
    close = far[row, nearest] < 0.25 * np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    return np.where(close[:, None], foot[row, nearest], middles)
