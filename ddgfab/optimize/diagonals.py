"""The net of diagonals of a mesh: another net on the same surface, without tracing.

Where edges follow asymptotic directions, or lie half way between those of a net of translation, no
mesh with these edges has planar faces near the surface; their diagonals are conjugate there.
"""

from __future__ import annotations

import numpy as np

from ddgfab.arguments import checked
from ddgfab.mesh import Floats, Mesh
from ddgfab.optimize.frame import Frame
from ddgfab.optimize.surface import SmoothSurface


@checked
def diagonal_net(mesh: Mesh) -> Mesh:
    """The net of the diagonals of all faces, which meet in the middle of each face.

    Each inner edge becomes a quad between its ends and the middles of its two faces, each edge of
    the boundary a triangle. So the boundary stays as it is, vertices keep their numbers, and
    edges are about 0.7 times as long, faces half as large.

    Returns
    -------
    The vertices of the mesh, then a vertex a face, on the smooth surface that the mesh stands for

    Source: the diagonals of an asymptotic net are conjugate, mathematics.md 1.3.
    """
    frame = Frame.of(mesh)
    small = frame.inside(mesh)
    middles = np.add.reduceat(small.vertices[mesh.corners], mesh.face_start[:-1])
    middles /= mesh.face_sizes[:, None]
    lifted: Floats = SmoothSurface(small).closest(middles)[0]
    points = np.concatenate([mesh.vertices, lifted * frame.unit + frame.center])
    start, end = mesh.corners, mesh.corners[mesh.corner_next]
    middle = mesh.n_vertices + mesh.corner_face
    order = np.argsort(mesh.corner_edge, kind="stable")  # both sides of an edge side by side
    edge = mesh.corner_edge[order]
    first = order[np.flatnonzero(np.diff(edge, prepend=-1))]
    second = np.full(mesh.n_edges, -1)
    again = np.flatnonzero(np.diff(edge, prepend=-1) == 0)
    second[edge[again]] = middle[order[again]]
    faces = [
        [a, b, left] if right < 0 else [a, right, b, left]
        for a, b, left, right in zip(
            start[first].tolist(),
            end[first].tolist(),
            middle[first].tolist(),
            second.tolist(),
            strict=True,
        )
    ]
    return Mesh.build(points, faces)
