"""Where a mesh lies and which way it looks: up axis, sides of the faces, a local origin."""

from __future__ import annotations

from typing import Final, Literal, get_args

import numpy as np

from ddgfab.errors import MeshError
from ddgfab.mesh import Floats, Mesh, extent

Up = Literal["z", "y", "x", "-z", "-y", "-x"]

FAR: Final = 50.0
"""Coordinates further from the origin than so many sizes of the mesh get a local origin."""

ROUGH: Final = 1e-4
"""Far from the origin, a last digit above this part of the median edge is reported."""

LEANS: Final = 0.5
"""A mesh looks some way when its vector areas add up to more than this part of its area."""

_UP: Final[dict[str, list[int]]] = {"z": [0, 1, 2], "y": [0, 2, 1], "x": [1, 2, 0]}


def upright(points: Floats, up: str) -> Floats:
    """(V, 3) points turned so that an axis of the file becomes z; a rotation, no reflection.

    Raises
    ------
    MeshError
        Another axis than `Up` names.
    """
    if up not in get_args(Up):
        raise MeshError(f'up = "{up}": one of {", ".join(get_args(Up))} is needed')
    if up == "z":
        return points
    order = _UP[up[-1]]
    turned = points[:, order].copy()
    if up[-1] == "y":
        turned[:, 1] *= -1.0  # y to z turns z to -y
    if up.startswith("-"):
        turned[:, 1:] *= -1.0  # then half a turn about x
    return turned


def local_origin(points: Floats) -> Floats:
    """(3,) what to subtract: zero unless the points lie far away; whole powers of ten.

    Doubles lose digits far from the origin: 1e-10 of a metre of survey coordinates, more in CAD
    kernels and viewers, which work in single precision. The power of ten is at most the size of
    the mesh, so that a site's grid stays readable.
    """
    if not len(points):
        return np.zeros(3)
    size = extent(points)
    low = points.min(axis=0)
    if size <= 0 or np.abs(points).max() <= FAR * size:
        return np.zeros(3)
    grid = 10.0 ** np.floor(np.log10(size))
    return np.asarray(np.floor(low / grid) * grid)


def rough_digits(step: float, mesh: Mesh) -> str:
    """The remark on a file far from the origin whose numbers are too short for its place.

    Parameters
    ----------
    step : to what its coordinates are rounded, in the unit of the mesh
    """
    median = float(np.median(mesh.edge_lengths))
    if step <= ROUGH * median:
        return ""
    return (
        f"so far from the origin its numbers are rounded to {step:.3g}, "
        f"{100 * step / median:.2g} % of the median edge: what was lost does not come "
        "back; export it with more digits, or about an origin on the site"
    )


def flipped(mesh: Mesh) -> Mesh:
    """The same faces seen from the other side; their first corner stays first."""
    at = np.arange(len(mesh.corners)) - mesh.face_start[mesh.corner_face]
    size = mesh.face_sizes[mesh.corner_face]
    corners = mesh.corners[mesh.face_start[mesh.corner_face] + (size - at) % size]
    return Mesh.build(mesh.vertices, np.split(corners, mesh.face_start[1:-1]))


def looks(mesh: Mesh) -> tuple[str, ...]:
    """Remarks on a mesh that looks down or lies on its side, with the keys that turn it."""
    areas = mesh.vector_areas
    total = float(np.linalg.norm(areas, axis=1).sum())
    x, y, z = areas.sum(axis=0) / total
    if max(abs(x), abs(y), abs(z)) < LEANS:
        return ()
    if -z >= max(abs(x), abs(y)):
        return (
            "its faces look down: glass would lie under the beams; flip = true in [net] (--flip) "
            "turns them over",
        )
    if abs(z) < 0.2 and abs(y) > LEANS and _like_a_roof(mesh, 1):
        side = "y" if y > 0 else "-y"
        return (
            f'it stands upright, looking along {side}: if {side} is up in the file, up = "{side}" '
            f"in [net] (--up {side}) turns it",
        )
    if abs(z) < 0.2 and abs(x) > LEANS and _like_a_roof(mesh, 0):
        side = "x" if x > 0 else "-x"
        return (
            f'it stands upright, looking along {side}: if {side} is up in the file, up = "{side}" '
            f"in [net] (--up {side}) turns it",
        )
    return ()


def _like_a_roof(mesh: Mesh, axis: int) -> bool:
    """Whether it is lowest across an axis, as roofs are in height."""
    spans = np.ptp(mesh.vertices, axis=0)
    return bool(spans[axis] == spans.min())
