"""The shells of a triangle mesh, and whether they bound one body: outsides, cavities, overlaps.

A mesh bounds a body where every point has winding number 0 or 1: outsides lie in nothing or in a
cavity, cavities lie in an outside, and no two shells share volume in another way. A single shell
whose sheets lie on one another in one plane is not found; one that goes through itself is.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass
from typing import Final

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from ddgfab.errors import KernelError
from ddgfab.mesh import Floats, Ints
from fabrication.checks.boxes import box_pairs, box_pairs_between
from fabrication.checks.crossing import crossings
from fabrication.checks.overlaps import ClosedMesh, common_depth, covered, plane_distance, touch
from fabrication.specs import TriangleMesh

SAME_DIRECTION: Final = 1e-5
"""Triangles at an edge whose directions differ by less [rad] lie on one another."""

_RAY_TURN: Final = (0.6154, 0.3317, 0.9273)  # Euler angles [rad] of no use to anybody else


@dataclass(frozen=True, eq=False)
class Shells:
    """The shells of a closed mesh.

    Attributes
    ----------
    mesh : all of them, without vertices or edges at which sheets only touch
    volumes : (s,) signed [mm3]; negative for cavities, and for what is inside out
    touching : pairs of shells that touch and share no volume
    problems : what bounds no body, as text; empty for a sound mesh
    union : volume [mm3] of the body, what is covered twice counted once
    """

    mesh: TriangleMesh
    volumes: Floats
    touching: tuple[tuple[int, int], ...]
    problems: tuple[str, ...]
    union: float

    @property
    def cavities(self) -> int:
        """How many shells look inwards."""
        return int((self.volumes < 0).sum())


def unpaired(mesh: TriangleMesh) -> tuple[TriangleMesh, Ints, int, int]:
    """A mesh whose sheets are apart where they only touch at edges.

    At an edge of several triangles those belong together that have material between them.
    Triangles with a repeated vertex go, and those that repeat another one.

    Returns
    -------
    The mesh; (m,) the shell of each triangle; how many sides have no partner; how many triangles
    were there twice.
    """
    tri = mesh.triangles
    tri = tri[(tri != tri[:, [2, 0, 1]]).all(axis=1)]
    sides, others, odd = _pairs(len(mesh.vertices), tri)
    twice = left = 0
    if odd:
        tri, twice = _without_copies(tri)
        sides, others, odd = _pairs(len(mesh.vertices), tri)
        for group in odd:
            pairs = _around(mesh.vertices, tri, group)
            left += len(group) - 2 * len(pairs)
            more = np.array(pairs, dtype=np.int64).reshape(-1, 2)
            sides, others = np.r_[sides, more[:, 0]], np.r_[others, more[:, 1]]
    graph = coo_array((np.ones(len(sides)), (sides // 3, others // 3)), shape=(len(tri),) * 2)
    shell = connected_components(graph, directed=False)[1].astype(np.int64)
    split = TriangleMesh(mesh.vertices, tri)
    if odd and not left:
        split = _cut(split, sides, others)
    return split, shell, left, twice


def _cut(mesh: TriangleMesh, sides: Ints, others: Ints) -> TriangleMesh:
    """Corners share a vertex only where triangles that are partners join them."""
    after, after_other = (3 * (s // 3) + (s % 3 + 1) % 3 for s in (sides, others))
    a, b = np.r_[sides, after], np.r_[after_other, others]
    graph = coo_array((np.ones(len(a)), (a, b)), shape=(mesh.triangles.size,) * 2)
    label = connected_components(graph, directed=False)[1]
    first = np.unique(label, return_index=True)[1]
    vertices = mesh.vertices[mesh.triangles.ravel()[first]]
    return TriangleMesh(vertices, label.reshape(-1, 3).astype(np.int64))


def _without_copies(tri: Ints) -> tuple[Ints, int]:
    """Triangles without those that repeat another, corners in the same sense; how many went."""
    turn = (tri.argmin(axis=1)[:, None] + np.arange(3)) % 3
    first = np.unique(np.take_along_axis(tri, turn, axis=1), axis=0, return_index=True)[1]
    return tri[np.sort(first)], len(tri) - len(first)


def _pairs(count: int, tri: Ints) -> tuple[Ints, Ints, list[Ints]]:
    """Sides (3 * triangle + place) and their partners at edges of two; the sides of all others."""
    start, end = tri.ravel(), tri[:, [1, 2, 0]].ravel()
    key = np.minimum(start, end) * count + np.maximum(start, end)
    order = np.argsort(key, kind="stable")
    ranked = key[order]
    begin = np.flatnonzero(np.r_[True, ranked[1:] != ranked[:-1]][: len(order)])
    ends = np.r_[begin[1:], len(order)]
    two = begin[ends - begin == 2]
    opposite = start[order[two]] == end[order[two + 1]]
    two = two[opposite]
    odd = np.setdiff1d(begin, two, assume_unique=True) if len(two) < len(begin) else two[:0]
    groups = [
        order[at:stop] for at, stop in zip(odd, ends[np.searchsorted(begin, odd)], strict=True)
    ]
    return order[two], order[two + 1], groups


def _around(vertices: Floats, tri: Ints, sides: Ints) -> list[tuple[int, int]]:
    """Pairs (forward, backward) of the sides at one edge with material between them.

    Seen along the edge, material begins at a triangle that runs backward and ends at one that runs
    forward; of triangles in one direction those that end come first.
    """
    corners = tri[sides // 3]
    place = sides % 3
    rows = np.arange(len(sides))
    a, b = corners[rows, place], corners[rows, (place + 1) % 3]
    ahead = a < b
    low, high = (a[0], b[0]) if ahead[0] else (b[0], a[0])
    along = vertices[high] - vertices[low]
    along = along / max(float(np.linalg.norm(along)), np.finfo(np.float64).tiny)
    away = vertices[corners[rows, (place + 2) % 3]] - vertices[low]
    helper = np.eye(3)[np.abs(along).argmin()]
    first = np.cross(along, helper)
    first /= np.linalg.norm(first)
    angle = np.arctan2(away @ np.cross(along, first), away @ first)
    order = np.argsort(angle, kind="stable")
    gaps = np.diff(np.r_[angle[order], angle[order[0]] + 2 * np.pi])
    if (gaps > SAME_DIRECTION).any():  # begin behind a gap, so that no direction is cut in two
        turn = int(np.flatnonzero(gaps > SAME_DIRECTION)[-1]) + 1
        order, gaps = np.roll(order, -turn), np.roll(gaps, -turn)
    group = np.r_[0, np.cumsum(gaps[:-1] > SAME_DIRECTION)]
    order = order[np.lexsort((~ahead[order], group))]
    waiting: list[int] = []
    pairs: list[tuple[int, int]] = []
    done: set[int] = set()
    for side in [*order.tolist(), *order.tolist()]:  # twice: material may lie across the beginning
        if side in done:
            continue
        if not ahead[side]:
            if side not in waiting:
                waiting.append(side)
        elif waiting:
            other = waiting.pop()
            pairs.append((int(sides[side]), int(sides[other])))
            done |= {side, other}
    return pairs


def examine_shells(mesh: TriangleMesh, tolerance: float) -> Shells | int:
    """The shells of a closed mesh and how they lie to each other; an open one: how many sides.

    Shells whose triangles come near each other are intersected by manifold3d; of all others a ray
    says which lies in which.

    Parameters
    ----------
    tolerance : depth [mm] up to which an overlap is rounding of the coordinates
    """
    split, label, left, twice = unpaired(mesh)
    if left or not len(split.triangles):
        return left
    parts = _parts(split, label)
    volumes = np.array([signed_volume(part) for part in parts])
    problems = [f"{twice} triangles are there twice"] if twice else []
    cross = crossings(split)
    own = label[cross[:, 0]] == label[cross[:, 1]]
    if own.any():
        problems.append(f"triangles go through each other at {int(own.sum())} places")
    bodies = [ClosedMesh(part, volume) for part, volume in zip(parts, volumes, strict=True)]
    wild = _wild(bodies)
    if wild:
        named = ", ".join(str(k + 1) for k in sorted(wild)[:3])
        problems.append(f"shell {named}: sheets run together along edges and bound no body")
    near = _contacts(split, label, tolerance)
    inside, shared, touching = defaultdict(list), {}, []
    for a, b in near.tolist():
        if a in wild or b in wild:
            continue
        apart = plane_distance(bodies[a], bodies[b])
        if apart >= -tolerance:
            touching += [(a, b)] if apart <= tolerance else []
            continue
        common, depth = common_depth(bodies[a], bodies[b])
        small, large = sorted((a, b), key=lambda k: abs(volumes[k]))
        if depth <= tolerance:
            touching += [(a, b)] if touch(bodies[a], bodies[b], tolerance) else []
        elif common >= abs(volumes[small]) * (1 - 1e-9) - tolerance * bodies[small].area:
            inside[small].append(large)
        else:
            shared[a, b] = common
    for a, b in _nested(split, label, parts, {tuple(pair) for pair in near.tolist()}):
        inside[a].append(b)
    problems += [
        f"shells {a + 1} and {b + 1} intersect: they share {common:.6g} mm3"
        for (a, b), common in sorted(shared.items())
    ]
    for shell, volume in enumerate(volumes):
        around = inside[shell]
        depth_here = sum(1 if volumes[k] > 0 else -1 for k in around)
        if volume > 0 and depth_here > 0:
            outer = next(k for k in around if volumes[k] > 0)
            problems.append(
                f"shell {shell + 1} lies inside shell {outer + 1} and looks outwards like it: "
                "its volume would count twice; a cavity looks inwards"
            )
        elif volume <= 0 and depth_here != 1 and not any(shell in pair for pair in shared):
            problems.append(
                "inside out or without volume"
                if len(volumes) == 1
                else f"shell {shell + 1} looks inwards and is not a cavity of a body: inside out"
            )
    total = float(volumes.sum())
    if len(volumes) > 1 and problems:
        total = covered([body for k, body in enumerate(bodies) if k not in wild])
    return Shells(split, volumes, tuple(touching), tuple(problems), total)


def _wild(bodies: list[ClosedMesh]) -> set[int]:
    """Places of the bodies that manifold3d does not take: an edge comes twice in one umbrella."""
    found = set()
    for place, body in enumerate(bodies):
        try:
            body.manifold  # noqa: B018 - made here, or refused
        except KernelError:
            found.add(place)
    return found


def signed_volume(mesh: TriangleMesh) -> float:
    """Volume [mm3] by the divergence theorem; negative for a mesh that looks inwards."""
    if not len(mesh.triangles):
        return 0.0
    corners = mesh.vertices[mesh.triangles] - mesh.vertices[mesh.triangles[0, 0]]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return float(np.einsum("ij,ij->", corners[:, 0], cross)) / 6.0


def _parts(mesh: TriangleMesh, label: Ints) -> list[TriangleMesh]:
    """A mesh for each shell; no two share a vertex."""
    if not label.any():
        return [mesh]
    order = np.argsort(label, kind="stable")
    ends = np.cumsum(np.bincount(label))[:-1]
    parts = []
    for rows in np.split(order, ends):
        used, triangles = np.unique(mesh.triangles[rows], return_inverse=True)
        parts.append(TriangleMesh(mesh.vertices[used], triangles.reshape(-1, 3).astype(np.int64)))
    return parts


def _contacts(mesh: TriangleMesh, label: Ints, tolerance: float) -> Ints:
    """(p, 2) pairs of shells with triangles whose bounding boxes meet."""
    count = int(label.max()) + 1
    if count == 1:
        return np.zeros((0, 2), dtype=np.int64)
    corners = mesh.vertices[mesh.triangles]
    pairs = label[box_pairs(corners.min(axis=1) - tolerance, corners.max(axis=1) + tolerance)]
    pairs = np.sort(pairs[pairs[:, 0] != pairs[:, 1]], axis=1)
    keys = np.unique(pairs[:, 0] * count + pairs[:, 1])
    return np.stack([keys // count, keys % count], axis=1)


def _nested(
    mesh: TriangleMesh, label: Ints, parts: list[TriangleMesh], known: set[tuple[int, ...]]
) -> list[tuple[int, int]]:
    """Pairs (inner, outer) of shells whose triangles stay apart: rays upward from one vertex each.

    The shells are turned first, so that no ray meets an edge.
    """
    if len(parts) == 1:
        return []
    turn = _turn()
    corners = mesh.vertices[mesh.triangles] @ turn.T
    points = np.array([part.vertices[0] for part in parts]) @ turn.T
    low, high = corners.min(axis=1), corners.max(axis=1)
    up = points.copy()
    up[:, 2] = np.inf
    ray, tri = box_pairs_between(points, up, low, high).T
    apart = label[tri] != ray
    ray, tri = ray[apart], tri[apart]
    a, b, c = corners[tri].transpose(1, 0, 2)
    at = points[ray]

    def side(p: Floats, q: Floats) -> Floats:
        one, two = q[:, :2] - p[:, :2], at[:, :2] - p[:, :2]
        result: Floats = one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0]
        return result

    areas = np.stack([side(b, c), side(c, a), side(a, b)])
    total = areas.sum(axis=0)
    hit = ((areas > 0).all(axis=0) | (areas < 0).all(axis=0)) & (total != 0)
    heights = np.einsum("kp,kp->p", areas[:, hit], np.stack([a, b, c])[:, hit, 2]) / total[hit]
    above = heights > at[hit, 2]
    count = len(parts)
    keys = (ray[hit] * count + label[tri[hit]])[above]
    found, place = np.unique(keys, return_inverse=True)
    winding = np.bincount(place, weights=np.sign(total[hit][above]), minlength=len(found))
    inner, outer = found // count, found % count
    pairs = zip(inner.tolist(), outer.tolist(), winding.tolist(), strict=True)
    return [(i, j) for i, j, turns in pairs if turns and (min(i, j), max(i, j)) not in known]


def _turn() -> Floats:
    """A rotation that no part is aligned to."""
    result = np.eye(3)
    for axis, angle in enumerate(_RAY_TURN):
        c, s = np.cos(angle), np.sin(angle)
        rows = [k for k in range(3) if k != axis]
        step = np.eye(3)
        step[np.ix_(rows, rows)] = [[c, -s], [s, c]]
        result = step @ result
    return result
