"""What the boundary may do, which vertices stay, and which faces cannot be planar then."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, Literal, TypeAlias, get_args

import numpy as np
from numpy.typing import NDArray

from ddgfab.errors import InputError
from ddgfab.measures import planarity_percent
from ddgfab.mesh import Floats, Ints, Mesh, unit
from ddgfab.optimize.frame import element_ids

Boundary: TypeAlias = Literal["free", "glide", "fixed"]
"""What boundary vertices may do: move, glide along the boundary as it is, or nothing."""

_CORNER: Final = np.radians(30.0)
"""The boundary has a corner, which does not glide, where it turns by more than this [rad]."""


@dataclass(frozen=True, eq=False)
class Constraints:
    """Vertices that stay, and whether the boundary glides.

    Attributes
    ----------
    fixed : (n,) ids of vertices that stay, corners of a gliding boundary included
    glide : whether the rest of the boundary stays on the boundary curve
    """

    fixed: Ints
    glide: bool

    @staticmethod
    def of(
        mesh: Mesh, fixed: Sequence[int] | Ints = (), boundary: Boundary = "free"
    ) -> Constraints:
        """What is asked for.

        Raises
        ------
        InputError
            An id out of range, an unknown boundary.
        """
        if boundary not in get_args(Boundary):
            raise InputError(f'boundary = "{boundary}"; one of {", ".join(get_args(Boundary))}')
        ids = element_ids(fixed, mesh.n_vertices, "fixed vertex")
        if boundary == "fixed":
            ids = np.union1d(ids, np.flatnonzero(mesh.boundary_vertex))
        elif boundary == "glide":
            ids = np.union1d(ids, rim_corners(mesh))
        return Constraints(ids, boundary == "glide")


def rim_corners(mesh: Mesh) -> Ints:
    """Ids of boundary vertices where the boundary turns by more than 30 deg."""
    ends = mesh.edges[mesh.boundary_edge]
    along = unit(mesh.vertices[ends[:, 1]] - mesh.vertices[ends[:, 0]])
    total = np.zeros_like(mesh.vertices)
    np.add.at(total, ends.ravel(), np.repeat(along, 2, axis=0))
    # |sum of two unit directions| = 2 cos(half the turn)
    sharp = np.linalg.norm(total, axis=1) < 2 * np.cos(_CORNER / 2)
    return np.flatnonzero(mesh.boundary_vertex & sharp)


def impossible_faces(mesh: Mesh, fixed: Ints, flat_percent: float) -> tuple[Ints, Floats]:
    """Faces that stay skew because their fixed corners are not coplanar.

    Returns
    -------
    ids of the faces, and for each how far its fixed corners alone are from a plane [%, spread
    across their plane of least squares over their mean distance from each other]
    """
    stays: NDArray[np.bool_] = np.zeros(mesh.n_vertices, dtype=bool)
    stays[fixed] = True
    on = stays[mesh.corners]
    count = np.add.reduceat(on.astype(np.int64), mesh.face_start[:-1])
    faces = np.flatnonzero(count > 3)
    if not len(faces):
        return faces, np.zeros(0)
    corners = [face[stays[face]] for face in (mesh.face(f) for f in faces.tolist())]
    polygons = Mesh(
        mesh.vertices,
        np.concatenate(corners),
        np.concatenate([[0], np.cumsum([len(c) for c in corners])]),
    )
    skew = planarity_percent(polygons)
    bad = skew > flat_percent
    return faces[bad], skew[bad]
