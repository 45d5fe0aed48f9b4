"""From what a file says to an oriented manifold mesh: mend what can be mended, name the rest."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from ddgfab.io.junctions import check_folded, check_junctions, overlapping
from ddgfab.io.near import near_pairs
from ddgfab.io.raw import RawMesh
from ddgfab.io.weld import SETTINGS, WeldedPolygons, weld, without_neighbors, without_unused
from ddgfab.mesh import Ints, Mesh
from ddgfab.tolerances import COORDINATE_LIMIT, RELATIVE_DEGENERATE, WELD_STEPS


def repair(raw: RawMesh, merge: float | None = None) -> tuple[Mesh, RawMesh, list[str]]:
    """Oriented manifold mesh of a file's polygons, and notes of what was mended.

    Unused vertices are removed, duplicated ones merged (into the one with the lowest id), faces
    turned so that neighbours agree, each component by the majority of its faces. Ids stay in the
    file's order.

    Parameters
    ----------
    merge : distance below which vertices are one, in the unit of the points; None for what the
        digits of the file leave (`weld.weld`), 0 to merge nothing

    Returns
    -------
    The mesh; the polygons it was made of, with their lines and axes; notes.

    Raises
    ------
    MeshError
        No faces, ids out of range, faces that repeat a vertex or have no area, faces given twice,
        edges with more than two faces, vertices where sheets meet, surfaces with one side.
    """
    _check_ranges(raw)
    notes = list(raw.notes)
    _check_repeats(without_neighbors(raw))
    given = len(raw.points)
    raw = without_unused(raw)
    if given > len(raw.points):
        unused = given - len(raw.points)
        notes.append(f"removed {_count(unused, 'vertex', 'vertices')} that no face uses")
    welded = weld(raw, merge)
    notes += _weld_notes(raw, welded)
    raw = welded.raw
    if not len(raw.sizes):
        raise raw.fail(f"the mesh has no faces ({notes[-1]})")
    _check_repeats(raw)
    _check_areas(raw)
    mesh = _mesh(raw)
    mesh, flipped = _orient(raw, mesh)
    check_folded(raw, mesh)
    if flipped:
        notes.append(f"flipped {_count(flipped, 'face', 'faces')} to agree with their neighbours")
    unchecked = check_junctions(raw, mesh)
    notes += [unchecked] if unchecked else []
    split = mesh.split_vertices
    if len(split):
        raise raw.fail(
            f"vertex {split[0]} is not manifold: several sheets meet only there; separate them"
            f"{_unwelded(raw, welded.distance) if merge is None else ''}",
            point=int(split[0]),
        )
    notes += _describe(mesh)
    if merge is None and mesh.components.max() > 0:
        few = _unwelded(raw, welded.distance).strip()
        notes += [few] if few else _narrow_gaps(mesh)
    return mesh, raw, notes


def _some(ids: Ints, most: int = 6) -> str:
    """The first ids, and how many there are more."""
    more = len(ids) - most
    return ", ".join(map(str, ids[:most].tolist())) + (f" and {more} more" if more > 0 else "")


def _count(number: int, one: str, many: str) -> str:
    return f"{number} {one if number == 1 else many}"


def _unwelded(raw: RawMesh, distance: float) -> str:
    """What may be wrong where the digits of a file leave more than was welded."""
    digits = WELD_STEPS * raw.step
    if digits <= distance:
        return ""
    pairs = near_pairs(raw.points, digits)
    if not len(pairs):
        return ""
    a, b = np.sort(pairs[0]).tolist()
    gap = float(np.linalg.norm(raw.points[a] - raw.points[b]))
    return (
        f"\nits numbers have few digits: vertices such as {a} and {b}, {gap:.3g} apart, may be "
        f"one; weld what is nearer than {digits:.3g} ({SETTINGS})"
    )


NARROW: Final = 5e-3
"""Components that come nearer than this part of the median edge may be meant as one."""

NARROW_SIDE: Final = 0.1
"""The same as part of the shortest edge: welding must leave every face its corners."""


def _narrow_gaps(mesh: Mesh) -> list[str]:
    """What may be wrong where components have corners almost at one place."""
    sides = mesh.edge_lengths
    reach = min(NARROW * float(np.median(sides)), NARROW_SIDE * float(sides.min()))
    rim = np.flatnonzero(mesh.boundary_vertex & (mesh.valences > 0))
    component = np.zeros(mesh.n_vertices, dtype=np.int64)
    component[mesh.corners] = mesh.components[mesh.corner_face]
    pairs = rim[near_pairs(mesh.vertices[rim], reach)]
    pairs = pairs[component[pairs[:, 0]] != component[pairs[:, 1]]]
    if len(pairs) < 2:  # an edge, not a corner
        return []
    gaps = np.linalg.norm(mesh.vertices[pairs[:, 0]] - mesh.vertices[pairs[:, 1]], axis=1)
    a, b = np.sort(pairs[gaps.argmax()]).tolist()
    asked = float(f"{1.1 * gaps.max():.2g}")
    return [
        f"components come near each other at {len(pairs)} pairs of vertices, as {a} and {b}, "
        f"{gaps.max():.2g} apart: if they are one, weld what is nearer than {asked:g} ({SETTINGS})"
    ]


def _weld_notes(raw: RawMesh, welded: WeldedPolygons) -> list[str]:
    """What welding changed, with lines where the file has them."""
    notes = []
    if welded.merged:
        notes.append(
            f"merged {_count(welded.merged, 'duplicated vertex', 'duplicated vertices')} "
            f"nearer than {welded.distance:.3g} to another"
        )
    for faces, one, many, what in (
        (welded.dropped_corners, "face", "faces", "repeated a corner, which was dropped"),
        (welded.dropped_faces, "face", "faces", "had fewer than three corners left: removed"),
    ):
        if len(faces):
            first = f"face {faces[0]}{raw.line_of(int(faces[0]))}"
            notes.append(f"{_count(len(faces), one, many)} {what} (first: {first})")
    return notes


def _mesh(raw: RawMesh) -> Mesh:
    start = np.concatenate([[0], np.cumsum(raw.sizes)])
    for array in (raw.points, raw.corners, start):
        array.setflags(write=False)
    return Mesh(raw.points, raw.corners, start)


def _check_ranges(raw: RawMesh) -> None:
    """Finite points, at least one face, ids in range, no vertex twice in a face."""
    if not len(raw.sizes):
        raise raw.fail(f"the mesh has no faces ({len(raw.points)} vertices)")
    bad = np.flatnonzero(~np.isfinite(raw.points).all(axis=1))
    if len(bad):
        raise raw.fail(f"vertex {bad[0]} has a coordinate that is not finite", point=int(bad[0]))
    large = np.flatnonzero((np.abs(raw.points) > COORDINATE_LIMIT).any(axis=1))
    if len(large):
        raise raw.fail(
            f"vertex {large[0]} has a coordinate beyond {COORDINATE_LIMIT:g}", point=int(large[0])
        )
    small = np.flatnonzero(raw.sizes < 3)
    if len(small):
        face = int(small[0])
        raise raw.fail(f"face {face} has {raw.sizes[face]} corners; three are needed", face=face)
    owner = np.repeat(np.arange(len(raw.sizes)), raw.sizes)
    out = np.flatnonzero((raw.corners < 0) | (raw.corners >= len(raw.points)))
    if len(out):
        face = int(owner[out[0]])
        raise raw.fail(
            f"face {face} names vertex {raw.corners[out[0]]} (counting from 0); "
            f"the file has {len(raw.points)} vertices",
            face=face,
        )


def _check_repeats(raw: RawMesh) -> None:
    """No vertex twice in a face, at places that are not neighbours."""
    again = _repeated(raw.corners, np.repeat(np.arange(len(raw.sizes)), raw.sizes))
    if again is not None:
        face, vertex = again
        raise raw.fail(f"face {face} repeats vertex {vertex} (counting from 0)", face=face)


def _repeated(corners: Ints, owner: Ints) -> tuple[int, int] | None:
    """The first face that has a vertex twice, and that vertex."""
    order = np.lexsort((corners, owner))
    same = (np.diff(corners[order]) == 0) & (np.diff(owner[order]) == 0)
    first = np.flatnonzero(same)
    if not len(first):
        return None
    at = order[first[0]]
    return int(owner[at]), int(corners[at])


def _check_areas(raw: RawMesh) -> None:
    """No coinciding neighbours in a face, no face without area."""
    mesh = _mesh(raw)
    ahead = raw.points[raw.corners[mesh.corner_next]] - raw.points[raw.corners]
    length = np.linalg.norm(ahead, axis=1)
    short = np.flatnonzero(length <= RELATIVE_DEGENERATE * mesh.diameter)
    if len(short):
        corner = short[0]
        face = int(mesh.corner_face[corner])
        raise raw.fail(
            f"face {face} has a side of length 0, between vertices {raw.corners[corner]} and "
            f"{raw.corners[mesh.corner_next[corner]]}",
            face=face,
        )
    perimeter = np.add.reduceat(length, mesh.face_start[:-1])
    flat = np.flatnonzero(mesh.face_areas <= RELATIVE_DEGENERATE * perimeter**2)
    if len(flat):
        face = int(flat[0])
        raise raw.fail(
            f"face {face} has no area: its corners lie on a line, or its outline crosses itself "
            f"(perimeter {perimeter[face]:.6g})",
            face=face,
        )


def _orient(raw: RawMesh, mesh: Mesh) -> tuple[Mesh, int]:
    """Faces turned so that neighbours run opposite ways along their edge; how many were turned.

    The double cover of the face graph (each face with both orientations) says everything at once:
    a component whose two lifts are connected has one side only.
    """
    start, end = raw.corners, raw.corners[mesh.corner_next]
    key = np.minimum(start, end) * len(raw.points) + np.maximum(start, end)
    order = np.argsort(key, kind="stable")
    ranked = key[order]
    _check_edges(raw, mesh, order, ranked)
    pair = np.flatnonzero(ranked[1:] == ranked[:-1])
    a, b = order[pair], order[pair + 1]
    clash = start[a] == start[b]
    if not clash.any():
        return mesh, 0
    n = mesh.n_faces
    left, right = mesh.corner_face[a], mesh.corner_face[b]
    cover_from = np.concatenate([left, left + n])
    cover_to = np.concatenate([right + n * clash, right + n * ~clash])
    graph = coo_array((np.ones(len(cover_from)), (cover_from, cover_to)), shape=(2 * n, 2 * n))
    _, label = connected_components(graph, directed=False)
    upper, lower = label[:n], label[n:]
    one_sided = np.flatnonzero(upper == lower)
    if len(one_sided):
        face = int(one_sided[0])
        raise raw.fail(
            f"the component of face {face} has one side only (like a Moebius strip); "
            "cut it open, or take the faces out that close it",
            face=face,
        )
    _, first, component = np.unique(
        np.minimum(upper, lower), return_index=True, return_inverse=True
    )
    differs = upper != upper[first][component]  # from the first face of its component
    against = np.bincount(component, weights=differs)
    flip = differs != (2 * against > np.bincount(component))[component]
    return _flipped(raw, mesh, flip), int(flip.sum())


def _check_edges(raw: RawMesh, mesh: Mesh, order: Ints, ranked: Ints) -> None:
    """At most two faces at an edge, and no face given twice."""
    thrice = np.flatnonzero(ranked[2:] == ranked[:-2])
    if len(thrice):
        corners = order[ranked == ranked[thrice[0]]]
        faces = mesh.corner_face[corners]
        a, b = sorted(mesh.edges[mesh.corner_edge[corners[0]]].tolist())
        raise raw.fail(
            f"edge {a}-{b} is not manifold: faces {_some(faces)} meet "
            f"there; two at most are allowed{overlapping(mesh, int(corners[0]), faces)}",
            face=int(faces[-1]),
        )
    sorted_corners = raw.corners[np.lexsort((raw.corners, mesh.corner_face))]
    seen: dict[bytes, int] = {}
    for face, (i, j) in enumerate(zip(mesh.face_start[:-1], mesh.face_start[1:], strict=True)):
        other = seen.setdefault(sorted_corners[i:j].tobytes(), face)
        if other != face:
            raise raw.fail(f"face {face} has the same vertices as face {other}", face=face)


def _flipped(raw: RawMesh, mesh: Mesh, flip: NDArray[np.bool_]) -> Mesh:
    """The mesh with some faces reversed; their first corner stays first."""
    at = np.arange(len(raw.corners)) - mesh.face_start[mesh.corner_face]
    size = mesh.face_sizes[mesh.corner_face]
    at = np.where(flip[mesh.corner_face], (size - at) % size, at)
    corners = raw.corners[mesh.face_start[mesh.corner_face] + at]
    corners.setflags(write=False)
    return Mesh(mesh.vertices, corners, mesh.face_start)


def _describe(mesh: Mesh) -> list[str]:
    """Facts for a log about a sound mesh: components, closed ones inside out."""
    notes = []
    count = int(mesh.components.max()) + 1
    if count > 1:
        sizes = np.bincount(mesh.components)
        notes.append(f"{count} components, of {sizes.min()} to {sizes.max()} faces")
    open_parts = np.unique(mesh.components[mesh.edge_faces[mesh.boundary_edge, 0]])
    closed = np.setdiff1d(np.arange(count), open_parts)
    if len(closed):
        middle = mesh.vertices.mean(axis=0)
        share = np.einsum("ij,ij->i", mesh.face_centers - middle, mesh.vector_areas)
        inward = [c for c in closed.tolist() if share[mesh.components == c].sum() < 0]
        if inward:
            notes.append(
                f"the faces of {_count(len(inward), 'closed component', 'closed components')} "
                "look inwards"
            )
    return notes
