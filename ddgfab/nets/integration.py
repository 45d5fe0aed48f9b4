"""Vertices of a mesh from the vectors of its edges, and whether the edges close."""

from __future__ import annotations

import numpy as np

from ddgfab.errors import DegenerateError, InputError, MeshError
from ddgfab.mesh import Floats, Mesh, extent
from ddgfab.quads import finite
from ddgfab.trees import tree_sums

CLOSING = 1e-9
"""Edges close when none misses by more than this part of the diameter."""


def integrate(mesh: Mesh, edges: Floats, closing: float = CLOSING) -> tuple[Floats, float]:
    """Vertices (V, 3) of mean zero from edge vectors (E, 3), and how far the worst edge misses.

    Raises
    ------
    InputError
        Edge vectors of another shape, or that are not finite.
    MeshError
        Several components.
    DegenerateError
        An edge misses by more than `closing` times the diameter, or this is zero.
    """
    if edges.shape != mesh.edge_vectors.shape:
        raise InputError(f"edge vectors have shape {edges.shape}; expected {(mesh.n_edges, 3)}")
    finite(edges, "edge vectors")
    used = mesh.valences > 0
    start, end = mesh.edges.T
    points, reached = tree_sums(mesh.n_vertices, start, end, edges, int(used.argmax()))
    lost = np.flatnonzero(used & ~reached)
    if len(lost):
        raise MeshError(
            f"disconnected: no edges lead from vertex {int(used.argmax())} to vertex {lost[0]}; "
            "take one component at a time"
        )
    points[used] -= points[used].mean(axis=0)
    miss = np.linalg.norm(points[end] - points[start] - edges, axis=1)
    worst = int(miss.argmax())
    diameter = extent(points[used])
    if not diameter > 0:
        raise DegenerateError("the edge vectors have no length: all vertices would be one point")
    if not miss[worst] <= closing * diameter:
        raise DegenerateError(
            f"the net does not close: edge {worst} misses by {miss[worst] / diameter:.1e} of the "
            f"diameter (limit {closing:g})\n"
            "it is not s-isothermic, or not simply connected with a period of this size: cut it "
            "open or take a simply connected piece"
        )
    return points, float(miss[worst] / diameter)
