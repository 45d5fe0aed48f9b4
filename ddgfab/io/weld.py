"""Vertices that are one: how near is near for the digits of a file, and what becomes of faces."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from ddgfab.io.groups import NEAR
from ddgfab.io.near import near_pairs
from ddgfab.io.raw import RawMesh
from ddgfab.mesh import Ints, extent
from ddgfab.tolerances import WELD_COARSE, WELD_FINE, WELD_STEPS

HALVINGS = 30
"""The default distance is halved at most so often until no face collapses."""

SETTINGS = "--weld, [net] weld_mm"
"""How a user sets the distance, for messages."""


@dataclass(frozen=True, eq=False)
class WeldedPolygons:
    """Polygons after welding.

    Attributes
    ----------
    raw : with renumbered points and faces without repeated corners
    distance : vertices nearer than this became one, in the unit of the points
    merged : how many vertices went into another
    dropped_corners, dropped_faces : what repeated itself, and so went; ids of faces as given
    """

    raw: RawMesh
    distance: float
    merged: int
    dropped_corners: Ints
    dropped_faces: Ints


def noise(raw: RawMesh) -> float:
    """Differences of positions up to this come from the digits of the file alone."""
    return min(WELD_STEPS * raw.step, WELD_FINE * extent(raw.points))


def weld(raw: RawMesh, distance: float | None = None) -> WeldedPolygons:
    """One vertex for points nearer than a distance, and no corner twice in a row in a face.

    Chains of near points become one vertex, the one with the lowest id. By default the distance
    follows from the digits of the file: `WELD_STEPS` of its last digit, at least `WELD_FINE` and
    at most `WELD_COARSE` of the size of the mesh, and less where a face would lose a corner.
    Corners that coincide within the digits of the file are dropped; a face left with fewer than
    three goes.

    Parameters
    ----------
    distance : in the unit of the points; None for the default, 0 for corners at
        equal coordinates only

    Raises
    ------
    MeshError
        A face that collapses at the distance that was asked for, or that has a vertex twice at
        places that are not neighbours.
    """
    size = extent(raw.points)
    if distance is not None:
        tiny = min(noise(raw), distance)
        given = _identified(raw, distance, tiny)
        _check_collapse(raw, given, distance, tiny)
        return _joined(raw, given, distance)
    tiny = noise(raw)
    near = float(np.clip(WELD_STEPS * raw.step, WELD_FINE * size, WELD_COARSE * size))
    for _ in range(HALVINGS):
        same = _identified(raw, near, tiny)
        if not _harmed(raw, same, tiny).any():
            return _joined(raw, same, near)
        near /= 2
    return _joined(raw, _identified(raw, 0.0, tiny), 0.0)


def _identified(raw: RawMesh, distance: float, tiny: float) -> Ints:
    """(V,) for each point the lowest id of those that are one with it.

    Neighbors in a face that coincide are one whatever the distance.
    """
    count = len(raw.points)
    near = near_pairs(raw.points, distance) if distance > 0 else np.empty((0, 2), dtype=np.int64)
    after = _next_corner(raw)
    side = np.linalg.norm(raw.points[raw.corners] - raw.points[raw.corners[after]], axis=1)
    close = side <= tiny if len(side) else np.zeros(0, dtype=bool)
    equal = np.stack([raw.corners[close], raw.corners[after[close]]], axis=1)
    pairs = np.concatenate([near, equal])
    graph = coo_array((np.ones(len(pairs)), pairs.T), shape=(count, count))
    label = connected_components(graph, directed=False)[1]
    first = np.unique(label, return_index=True)[1]
    return np.asarray(first[label], dtype=np.int64)


def _next_corner(raw: RawMesh) -> Ints:
    """(C,) the next corner of the same face."""
    start = np.concatenate([[0], np.cumsum(raw.sizes)])
    after = np.arange(1, len(raw.corners) + 1)
    after[start[1:] - 1] = start[:-1]
    return after


def _harmed(raw: RawMesh, same: Ints, tiny: float) -> NDArray[np.bool_]:
    """(C,) corners that become one with the next although they are apart, or with another one."""
    after = _next_corner(raw)
    here, there = raw.corners, raw.corners[after]
    side = np.linalg.norm(raw.points[here] - raw.points[there], axis=1)
    joined = same[here] == same[there]
    harmed = joined & (side > tiny)
    owner = np.repeat(np.arange(len(raw.sizes)), raw.sizes)
    kept = np.flatnonzero(~joined)
    order = np.lexsort((same[here[kept]], owner[kept]))
    ranked = kept[order]
    twice = (np.diff(same[here[ranked]]) == 0) & (np.diff(owner[ranked]) == 0)
    twice &= here[ranked[1:]] != here[ranked[:-1]]  # the file itself repeats: reported elsewhere
    harmed[ranked[1:][twice]] = True
    return np.asarray(harmed, dtype=np.bool_)


def _check_collapse(raw: RawMesh, same: Ints, distance: float, tiny: float) -> None:
    """A distance that was asked for must leave every face three corners."""
    owner = np.repeat(np.arange(len(raw.sizes)), raw.sizes)
    apart = same[raw.corners] != same[raw.corners[_next_corner(raw)]]
    left = np.bincount(owner[apart], minlength=len(raw.sizes))
    harmed = _harmed(raw, same, tiny)
    bad = np.flatnonzero((left < 3) & (np.bincount(owner[harmed], minlength=len(left)) > 0))
    crossed = np.flatnonzero(harmed & apart)
    if len(bad) or len(crossed):
        face = int(bad[0]) if len(bad) else int(owner[crossed[0]])
        raise raw.fail(
            f"face {face} collapses when vertices nearer than {distance:.3g} are one: mend the "
            f"face, or weld less ({SETTINGS})",
            face=face,
        )


def _joined(raw: RawMesh, same: Ints, distance: float) -> WeldedPolygons:
    """Faces on the vertices that stay; points that no face uses any more are gone."""
    owner = np.repeat(np.arange(len(raw.sizes)), raw.sizes)
    corners = same[raw.corners]
    keep = corners != corners[_next_corner(raw)]
    # A face of one point has no corner left to keep; so has one that runs to a point and back.
    left = np.bincount(owner[keep], minlength=len(raw.sizes))
    distinct = np.array([len(set(f.tolist())) for f in np.split(corners, np.cumsum(raw.sizes))[:-1]
                         ]) if (left < 4).any() else left  # fmt: skip
    gone = np.flatnonzero(np.minimum(left, distinct) < 3)
    shrunk = np.setdiff1d(np.flatnonzero(left < raw.sizes), gone)
    keep &= ~np.isin(owner, gone)
    stays = np.setdiff1d(np.arange(len(raw.sizes)), gone)
    merged = len(np.unique(raw.corners)) - len(np.unique(corners))
    lines = raw.face_lines
    raw = replace(
        raw,
        corners=corners[keep],
        sizes=left[stays],
        face_lines=None if lines is None else lines[stays],
        groups=raw.groups.renumbered(same),
    )
    return WeldedPolygons(without_unused(raw), distance, merged, shrunk, gone)


def without_neighbors(raw: RawMesh) -> RawMesh:
    """Faces without the corners that repeat the corner before them; for checks only."""
    keep = raw.corners != raw.corners[_next_corner(raw)]
    owner = np.repeat(np.arange(len(raw.sizes)), raw.sizes)
    sizes = np.bincount(owner[keep], minlength=len(raw.sizes))
    return replace(raw, corners=raw.corners[keep], sizes=sizes)


def without_unused(raw: RawMesh) -> RawMesh:
    """Only points that faces use, in the file's order."""
    used = np.zeros(len(raw.points), dtype=bool)
    used[raw.corners] = True
    if used.all():
        return raw
    keep = np.flatnonzero(used)
    groups = raw.groups
    if groups:
        within = max(noise(raw), NEAR * extent(raw.points[keep]))
        groups = groups.onto(raw.points, keep, within).renumbered(np.cumsum(used) - 1)
    return replace(
        raw,
        points=raw.points[keep],
        groups=groups,
        corners=(np.cumsum(used) - 1)[raw.corners],
        point_lines=None if raw.point_lines is None else raw.point_lines[keep],
        axes=None if raw.axes is None else raw.axes[keep],
    )
