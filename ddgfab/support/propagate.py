"""Support structures on a quad patch from data at its boundary, and node axes from beam planes."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.arguments import checked
from ddgfab.errors import DegenerateError, InputError
from ddgfab.mesh import Floats, Mesh, unit
from ddgfab.tolerances import RELATIVE_DEGENERATE


@checked
def propagate_axes(
    points: ArrayLike, first: ArrayLike, along: ArrayLike, across: ArrayLike
) -> Floats:
    """(M + 1, N + 1, 3) unit node axes of a torsion-free structure on a net, planar or not.

    One axis at a corner (2 freedoms) and one angle for each further vertex of the two boundary
    lines through it: the dimension M + N + 2 of the family. Inside, the axis at x12 lies in the
    plane of edge x1-x12 with the axis at x1, and in that of x2-x12 with the axis at x2.

    Parameters
    ----------
    points : (M + 1, N + 1, 3), quads of any shape
    first : (3,) axis at points[0, 0], of any length
    along : (M,) turn [rad] of the axis from (i, 0) to (i + 1, 0), in the plane of edge and axis,
        positive towards the edge; 0: the axes are parallel
    across : (N,) the same from (0, j) to (0, j + 1)

    Raises
    ------
    InputError
        Shapes that do not match.
    DegenerateError
        An axis along its edge, or planes that coincide; names the vertex and the sine.

    Source: Pottmann, Liu, Wallner, Bobenko, Wang 2007, section 2; mathematics.md 10.3.
    """
    x = np.asarray(points, dtype=np.float64)
    turns = np.asarray(along, dtype=np.float64), np.asarray(across, dtype=np.float64)
    start = np.asarray(first, dtype=np.float64)
    if x.ndim != 3 or x.shape[2] != 3 or start.shape != (3,) or not start.any():
        raise InputError(f"points {x.shape} and axis {start.tolist()}: (M + 1, N + 1, 3) and (3,)")
    for axis, turn in enumerate(turns):
        if turn.shape != (x.shape[axis] - 1,):
            raise InputError(
                f"turns {turn.shape} in direction {axis}: ({x.shape[axis] - 1},) needed"
            )
    axes = np.empty_like(x)
    axes[0, 0] = unit(start)
    for k, turn in enumerate(turns[0].tolist()):
        axes[k + 1, 0] = _turned(axes[k, 0], x[k + 1, 0] - x[k, 0], turn, (k + 1, 0))
    for k, turn in enumerate(turns[1].tolist()):
        axes[0, k + 1] = _turned(axes[0, k], x[0, k + 1] - x[0, k], turn, (0, k + 1))
    m, n = x.shape[0] - 1, x.shape[1] - 1
    for diagonal in range(2, m + n + 1):
        i = np.arange(max(1, diagonal - n), min(m, diagonal - 1) + 1)
        j = diagonal - i
        beside, below = axes[i, j - 1], axes[i - 1, j]
        planes = (
            unit(np.cross(unit(x[i, j] - x[i, j - 1]), beside)),
            unit(np.cross(unit(x[i, j] - x[i - 1, j]), below)),
        )
        line = np.cross(*planes)
        sine = np.linalg.norm(line, axis=1)
        bad = np.flatnonzero(sine <= RELATIVE_DEGENERATE)
        if len(bad):
            vertex = int(i[bad[0]]), int(j[bad[0]])
            raise DegenerateError(
                f"vertex {vertex}: the planes of its two edges coincide (sine "
                f"{sine[bad[0]]:.1e}, limit {RELATIVE_DEGENERATE:g}); its axis is not determined",
                cell=vertex,
            )
        side = np.einsum("kx,kx->k", line, beside + below)
        axes[i, j] = line / np.where(side < 0, -sine, sine)[:, None]
    return axes


def _turned(axis: Floats, edge: Floats, turn: float, vertex: tuple[int, int]) -> Floats:
    """An axis turned in its plane with an edge."""
    along = unit(edge)
    out = along - (along @ axis) * axis
    sine = float(np.linalg.norm(out))
    if sine <= RELATIVE_DEGENERATE:
        raise DegenerateError(
            f"vertex {vertex}: the axis before it runs along the edge (sine {sine:.1e}, limit "
            f"{RELATIVE_DEGENERATE:g})",
            cell=vertex,
        )
    return np.asarray(np.cos(turn) * axis + np.sin(turn) * out / sine)


@checked
def node_torsion(mesh: Mesh, planes: ArrayLike) -> tuple[Floats, Floats]:
    """How far the beam planes at each vertex are from sharing a line, and the line nearest to it.

    Parameters
    ----------
    planes : (E, 3) unit normals n(e) of the planes pi(e) through the edges

    Returns
    -------
    (V,) smallest singular value of the unit normals at each vertex (0: the planes share a line;
    with fewer than three edges always), and (V, 3) that line, on the side of the vertex normals.

    Raises
    ------
    InputError
        Planes of the wrong shape.

    Source: mathematics.md 10.2.
    """
    given = np.asarray(planes, dtype=np.float64)
    if given.shape != (mesh.n_edges, 3):
        raise InputError(f"planes have shape {given.shape}; expected {(mesh.n_edges, 3)}")
    normals = unit(given)
    value, axes = np.zeros(mesh.n_vertices), np.zeros((mesh.n_vertices, 3))
    for valence in np.unique(mesh.valences[mesh.valences > 0]).tolist():
        ids = np.flatnonzero(mesh.valences == valence)
        edges = mesh.star_edges[mesh.star_start[ids, None] + np.arange(valence)]
        singular, rows = np.linalg.svd(normals[edges])[1:]
        axes[ids] = rows[:, 2]
        if valence > 2:
            value[ids] = singular[:, 2]
    outward = np.einsum("vx,vx->v", axes, mesh.vertex_normals)
    return value, axes * np.where(outward < 0, -1.0, 1.0)[:, None]
