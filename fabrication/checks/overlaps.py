"""Volume that placed bodies share, whatever clearance was asked for.

Boxes find the pairs that could meet, planes along their faces keep most of them apart, manifold3d
intersects what is left.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Final

import numpy as np

from ddgfab.errors import KernelError
from ddgfab.mesh import Floats, Ints
from fabrication.checks.boxes import box_pairs
from fabrication.checks.crossing import crossed
from fabrication.checks.mesh import to_manifold
from fabrication.specs import Placement, TriangleMesh

PLANES: Final = 64
"""So many planes of either body are tried as planes between the two; those of most area."""

RIGID: Final = 1e-6
"""How far the squares of a placement may be from those of a rotation."""

ROUNDING_MM: Final = 1e-6
"""Overlaps of less depth [mm] come from the rounding of coordinates in double precision."""


@dataclass(frozen=True, eq=False)
class ClosedMesh:
    """A closed mesh [mm] with what is known of it; one that looks inwards is turned over."""

    mesh: TriangleMesh
    volume: float
    name: str = ""

    @cached_property
    def faces(self) -> tuple[Floats, Floats]:
        """(j, 3) unit normals of its triangles as seen from outside, and (j,) their areas [mm2]."""
        corners = self.mesh.vertices[self.mesh.triangles]
        cross = crossed(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        length = np.sqrt(np.einsum("ij,ij->i", cross, cross))
        sign = 1.0 if self.volume >= 0 else -1.0
        return sign * cross / np.where(length > 0, length, np.inf)[:, None], length / 2

    @property
    def area(self) -> float:
        """Of its surface [mm2]."""
        return float(self.faces[1].sum())

    @cached_property
    def planes(self) -> tuple[Floats, Floats]:
        """(j, 3) normals of its largest faces, and (j,) how far the body reaches along each."""
        normals, areas = self.faces
        _, first, which = np.unique(
            np.rint(normals * 1e6), axis=0, return_index=True, return_inverse=True
        )
        order = np.argsort(-np.bincount(which.ravel(), weights=areas), kind="stable")[:PLANES]
        chosen = normals[first[order]]
        return chosen, (self.mesh.vertices @ chosen.T).max(axis=0)

    @cached_property
    def manifold(self) -> Any:
        """As a manifold3d body.

        Raises
        ------
        KernelError
            The mesh is not a closed manifold.
        """
        triangles = self.mesh.triangles if self.volume >= 0 else self.mesh.triangles[:, ::-1]
        made = to_manifold(TriangleMesh(self.mesh.vertices, np.ascontiguousarray(triangles)))
        if made.status().name != "NoError":
            raise KernelError(
                f"{self.name or 'a body'}: its mesh is not a closed manifold ({made.status().name})"
            )
        return made


@dataclass(frozen=True)
class Overlap:
    """Two placed bodies (places in the list) that share volume [mm3], and how deep [mm]."""

    pair: tuple[int, int]
    volume: float
    depth: float


def overlaps(
    bodies: Sequence[ClosedMesh],
    owner: Ints,
    placements: Floats,
    tolerances: Floats,
    group: Ints | None = None,
) -> list[Overlap]:
    """Every pair of placed bodies that share volume, in their order.

    Parameters
    ----------
    owner : (n,) which body each placed one is
    placements : (n, 4, 4) motions, rigid or not
    tolerances : (b,) by body, how far [mm] its mesh may be from what it stands for; the depth up
        to which an overlap is none is the sum of both, and `ROUNDING_MM`
    group : (n,) placed bodies of one group are not compared with each other

    Raises
    ------
    KernelError
        A mesh is not a closed manifold.
    """
    if not len(owner):
        return []
    tolerances = np.asarray(tolerances)[owner]
    bodies, owner, placements = _rigid(bodies, owner, placements)
    low, high = np.empty((len(owner), 3)), np.empty((len(owner), 3))
    for row, (k, at) in enumerate(zip(owner, placements, strict=True)):
        points = bodies[k].mesh.vertices @ at[:3, :3].T + at[:3, 3]
        low[row], high[row] = points.min(axis=0), points.max(axis=0)
    found = []
    for a, b in box_pairs(low, high).tolist():
        if group is not None and group[a] == group[b]:
            continue
        one, two = bodies[owner[a]], bodies[owner[b]]
        tolerance = ROUNDING_MM + float(tolerances[a] + tolerances[b])
        motion = np.linalg.inv(placements[a]) @ placements[b]
        if plane_distance(one, two, motion) >= -tolerance:
            continue
        volume, depth = common_depth(one, two, motion)
        if depth > tolerance:
            found.append(Overlap((a, b), volume, depth))
    return found


def _rigid(
    bodies: Sequence[ClosedMesh], owner: Ints, placements: Floats
) -> tuple[list[ClosedMesh], Ints, Floats]:
    """The same with rigid motions only: what is scaled or mirrored gets a body of its own."""
    turn = placements[:, :3, :3]
    square = np.einsum("nki,nkj->nij", turn, turn)
    bent = np.abs(square - np.eye(3)).max(axis=(1, 2)) > RIGID
    factor = volume_factor(placements)
    bent |= factor < 0
    every, owner, placements = list(bodies), owner.copy(), placements.copy()
    for row in np.flatnonzero(bent):
        body, at = every[owner[row]], placements[row]
        det = float(factor[row])
        triangles = body.mesh.triangles if det > 0 else body.mesh.triangles[:, ::-1]
        mesh = TriangleMesh(
            body.mesh.vertices @ at[:3, :3].T + at[:3, 3], np.ascontiguousarray(triangles)
        )
        owner[row], placements[row] = len(every), np.eye(4)
        every.append(ClosedMesh(mesh, body.volume * abs(det), body.name))
    return every, owner, placements


def volume_factor(placements: Floats) -> Floats:
    """(n,) factor on volumes of (n, 4, 4) placements, negative for mirrored ones, 0 for flat ones.

    By products: `numpy.linalg.det` warns of a division by zero where a placement is flat.
    """
    rows = placements[:, :3, :3]
    return np.asarray(np.einsum("ni,ni->n", np.cross(rows[:, 0], rows[:, 1]), rows[:, 2]))


def plane_distance(one: ClosedMesh, two: ClosedMesh, motion: Placement | None = None) -> float:
    """Lower bound [mm] on the distance of two bodies by planes along their faces.

    Parameters
    ----------
    motion : (4, 4) where the second stands in the frame of the first
    """
    at = np.eye(4) if motion is None else motion
    normals, reach = one.planes
    points = two.mesh.vertices @ at[:3, :3].T + at[:3, 3]
    best = float(((normals @ points.T).min(axis=1) - reach).max())
    normals, reach = two.planes
    points = (one.mesh.vertices - at[:3, 3]) @ at[:3, :3]
    return max(best, float(((normals @ points.T).min(axis=1) - reach).max()))


def common_depth(
    one: ClosedMesh, two: ClosedMesh, motion: Placement | None = None
) -> tuple[float, float]:
    """Volume [mm3] that two bodies share, and its depth [mm].

    The depth is that of a slab of this volume and surface: exact for a thin one and less than the
    true depth for others.
    """
    other = two.manifold if motion is None else two.manifold.transform(motion[:3])
    common = one.manifold ^ other
    area = float(common.surface_area())
    volume = float(common.volume())
    return volume, 2.0 * volume / area if area > 0 else 0.0


def touch(one: ClosedMesh, two: ClosedMesh, tolerance: float) -> bool:
    """Whether two bodies come nearer to each other than a tolerance [mm]."""
    return float(one.manifold.min_gap(two.manifold, 2 * tolerance)) <= tolerance


def covered(bodies: Sequence[ClosedMesh]) -> float:
    """Volume [mm3] that bodies cover, what they share counted once.

    One that looks inwards is taken off those larger than it.
    """
    import manifold3d

    if not bodies:
        return 0.0
    volumes = np.array([body.volume for body in bodies])
    order = np.argsort(-np.abs(volumes), kind="stable")
    whole = manifold3d.Manifold()
    for run in np.split(order, np.flatnonzero(np.diff(volumes[order] > 0)) + 1):
        group = [whole, *(bodies[k].manifold for k in run)]
        adds = volumes[run[0]] > 0
        kind = manifold3d.OpType.Add if adds else manifold3d.OpType.Subtract
        whole = manifold3d.Manifold.batch_boolean(group, kind)
    return float(whole.volume())
