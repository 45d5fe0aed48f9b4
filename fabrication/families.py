"""Families: congruent pieces share a part number, and its shape is made once.

Congruent means: a rigid motion that keeps the top side up takes one onto the other, corners within
a tolerance. Beams of a symmetric profile may be turned end for end; panels and nodes about their
normal or axis. Reflections, and parts turned upside down, count as different: glass has an outer
surface, and nodes and beams carry theirs. Pieces beyond a limit share no number with good ones.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from scipy.spatial import cKDTree

from ddgfab.errors import InputError
from ddgfab.mesh import Floats, Ints
from fabrication.specs import Family, Instance, Kind, Piece, Shape

TIE: Final = 1e-6
"""Variants whose deviations differ by less [mm] count as equal, and the first is taken."""

CELL: Final = 0.01
"""Side of the cells that gather near copies before neighbours are searched, per tolerance."""

LEAST_RADIUS: Final = 1e-9
"""Search radius [mm] when the tolerance is zero."""

SEARCH: Final = 3.0
"""Pieces without another within this many tolerances are alone; covers changes of alignment."""


def families(pieces: Sequence[Piece], tolerance: float = 0.1) -> tuple[Family, ...]:
    """Part numbers of the pieces: kind by kind, as they come, in the order of first members.

    Each piece joins the first family whose first member it matches; the first member's shape is
    the family's. An instance's placement is for that shape; it differs from the piece's own where
    the piece was turned. Costs near-linear time: one search tree for each kind of piece.

    Parameters
    ----------
    tolerance : greatest distance [mm] of a characteristic point (corner, rim point, hole) of a
        member from where the family's shape puts it

    Raises
    ------
    InputError
        Two kinds have one prefix, so that their part numbers would be the same.
    """
    groups: dict[Kind, dict[tuple[Any, ...], list[int]]] = {}
    for index, piece in enumerate(pieces):
        good = all(check.passed for check in piece.checks)
        group = groups.setdefault(piece.kind, defaultdict(list))
        group[good, type(piece.shape), piece.shape.key()].append(index)
    _check_prefixes(list(groups))
    result: list[Family] = []
    for kind, by_key in groups.items():
        found: list[tuple[list[int], list[Instance], float]] = []
        for members in by_key.values():
            found += _group([pieces[i] for i in members], members, tolerance)
        found.sort(key=lambda entry: entry[0][0])
        for number, (indices, instances, deviation) in enumerate(found, 1):
            result.append(
                Family(
                    number=f"{kind.prefix}-{number:03d}",
                    kind=kind,
                    shape=pieces[indices[0]].shape,
                    instances=tuple(instances),
                    deviation=deviation,
                )
            )
    return tuple(result)


def _check_prefixes(kinds: Sequence[Kind]) -> None:
    first: dict[str, Kind] = {}
    for kind in kinds:
        other = first.setdefault(kind.prefix, kind)
        if other is not kind:
            raise InputError(
                f'the kinds "{other.role}" and "{kind.role}" both have part numbers '
                f"{kind.prefix}-001, ...: give one of them another prefix"
            )


def _group(
    pieces: Sequence[Piece], indices: Sequence[int], tolerance: float
) -> list[tuple[list[int], list[Instance], float]]:
    """Families among pieces of one key: their indices, instances and greatest deviations."""
    shapes: list[Shape] = [piece.shape for piece in pieces]
    variants = shapes[0].variants(shapes)
    found = cluster(variants.points, tolerance)
    members: dict[int, list[int]] = defaultdict(list)
    for k, leader in enumerate(found.leader.tolist()):
        members[leader].append(k)
    result = []
    for leader, own in members.items():
        instances = []
        for k in own:
            placement = pieces[k].placement
            if k != leader:
                turn = variants.frame(leader, int(found.variant[k]))
                placement = placement @ np.linalg.inv(variants.frame(k, 0)) @ turn
                placement.setflags(write=False)
            instances.append(Instance(pieces[k].mark, placement))
        deviation = float(found.deviation[own].max())
        result.append(([indices[k] for k in own], instances, deviation))
    return result


@dataclass(frozen=True, eq=False)
class Clusters:
    """leader (N,) of each piece, the leader's variant (N,) it matches, deviation (N,) [mm]."""

    leader: Ints
    variant: Ints
    deviation: Floats


def cluster(points: Floats, tolerance: float) -> Clusters:
    """Greedy leaders: in order, every piece not yet taken leads those that match it.

    Parameters
    ----------
    points : (N, m, P, d) characteristic points [mm] of N pieces in the frames of their m variants;
        a piece k matches a leader where its variant 0 agrees with any of the leader's
    """
    n, m = points.shape[:2]
    features = points.reshape(n, m, -1)
    leader, variant = np.full(n, -1), np.zeros(n, dtype=np.int64)
    deviation = np.zeros(n)
    radius = max(tolerance, LEAST_RADIUS)
    alone = _alone(features, radius)
    tree = cKDTree(features[:, 0])
    for i in range(n):
        if leader[i] >= 0:
            continue
        leader[i] = i
        if alone[i]:
            continue
        near = tree.query_ball_point(features[i], radius, p=np.inf)
        hits = np.unique(np.concatenate([np.array(h, dtype=np.int64) for h in near]))
        hits = hits[leader[hits] < 0]
        if not len(hits):
            continue
        apart = np.linalg.norm(points[i][:, None] - points[None, hits, 0], axis=-1).max(axis=-1)
        best = np.argmax(apart <= apart.min(axis=0) + TIE, axis=0)  # the first of equal ones
        distance = apart[best, np.arange(len(hits))]
        fits = distance <= radius
        taken = hits[fits]
        leader[taken], variant[taken], deviation[taken] = i, best[fits], distance[fits]
    return Clusters(leader, variant, deviation)


def _alone(features: Floats, radius: float) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    """(N,) pieces that no variant of themselves brings near another piece."""
    n, m = features.shape[:2]
    cells = np.round(features[:, 0] / (CELL * radius))
    _, first, counts = np.unique(cells, axis=0, return_index=True, return_counts=True)
    alone = np.zeros(n, dtype=bool)
    single = first[counts == 1]
    alone[single] = True
    if len(single) == 0 or len(first) == 1:
        return alone
    tree = cKDTree(features[first, 0])
    for v in range(m):
        _, found = tree.query(
            features[single, v], k=2, p=np.inf, distance_upper_bound=SEARCH * radius
        )
        owner = np.append(first, -1)[found]  # beyond the bound the tree answers its size
        alone[single] &= ((owner == single[:, None]) | (owner < 0)).all(axis=1)
    return alone
