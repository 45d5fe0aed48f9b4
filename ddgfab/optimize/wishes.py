"""Repetition as a soft wish beside any goal: edges of few lengths, panels of few shapes.

At every step pieces are clustered (`cluster_shapes`), and each is drawn to the shape of its
cluster. No piece has to take it: how far they come depends on the weight, and what it costs in
distance is found by a run without the wish (`price`). Fewer kinds of pieces within a tolerance, at
the price of letting others go, are the goal "families".

Source: Fu, Lai, He, Cohen-Or 2010, K-set tilable surfaces (idea).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np

from ddgfab.errors import InputError
from ddgfab.mesh import Floats, Mesh
from ddgfab.optimize.problem import Following, Term, mean_edge
from ddgfab.optimize.repetition import (
    Clusters,
    Piece,
    Pieces,
    cluster_shapes,
    pieces,
)
from ddgfab.optimize.result import OptimizeResult, Repetition, WishPrice
from ddgfab.optimize.terms.edges import Lengths

EQUAL_WEIGHT: Final = 3.0
"""Weight by default: lengths come visibly nearer, and most designs stay within the limits."""


@dataclass(frozen=True)
class Wishes:
    """What is wished for besides a goal.

    Attributes
    ----------
    edges : number of lengths that edges are drawn to; 0: none
    panels : number of shapes that panels are drawn to; 0: none
    weight : against that of the distance from the surface, 1
    """

    edges: int = 0
    panels: int = 0
    weight: float = EQUAL_WEIGHT

    def __post_init__(self) -> None:
        for name, count in (("equal_edges", self.edges), ("equal_panels", self.panels)):
            if count < 0:
                raise InputError(f"{name} = {count}: a number of kinds, 1 or more; 0 is no wish")
        if not (self.weight > 0 and np.isfinite(self.weight)):
            raise InputError(f"equal_weight = {self.weight:g}: must be positive")

    def __bool__(self) -> bool:
        return bool(self.edges or self.panels)

    def _kinds(self) -> Iterator[tuple[Piece, int]]:
        if self.edges:
            yield "edge", self.edges
        if self.panels:
            yield "panel", self.panels

    def terms(self, mesh: Mesh) -> tuple[Following, ...]:
        """Soft terms on a mesh whose mean edge is one."""
        return tuple(
            RepeatedPieces(pieces=group, kinds=count, weight=self.weight)
            for of, kinds in self._kinds()
            for group, count in _shared(mesh, of, kinds)
        )

    def refuse(self, mesh: Mesh) -> None:
        """Raise InputError where a mesh has fewer pieces than kinds."""
        for of, kinds in self._kinds():
            there = mesh.n_edges if of == "edge" else mesh.n_faces
            if kinds > there:
                raise InputError(
                    f"equal_{of}s = {kinds}: the mesh has {there} {of}s; ask for fewer kinds"
                )

    def price(self, plain: OptimizeResult, wished: OptimizeResult) -> WishPrice:
        """What came of the wishes, and what they cost, against a result without them."""
        meshes = (wished.original, plain.mesh, wished.mesh)
        return WishPrice(
            plain.status == "converged",
            plain.change.distance_mean,
            plain.change.distance_max,
            tuple(
                Repetition(
                    of,
                    kinds,
                    tuple(_spread(m, of, kinds)[0] for m in meshes),
                    tuple(_spread(m, of, kinds)[1] for m in meshes),
                )
                for of, kinds in self._kinds()
            ),
        )


@dataclass(frozen=True, eq=False, kw_only=True)
class RepeatedPieces:
    """Pieces near the shapes of their clusters, found anew at every step.

    A piece counts one, however many distances make its shape.
    """

    pieces: Pieces
    kinds: int
    weight: float = 1.0
    name: str = "repetition"

    def at(self, x: Floats) -> Term:
        """The term with the clusters of the unknowns x."""
        group = self.pieces
        points = x[: 3 * (1 + int(group.corners.max()))].reshape(-1, 3)
        found = _clusters(group, points, self.kinds)
        ends = group.corners[:, group.pairs].reshape(-1, 2)
        target = found.targets.ravel()
        return Lengths(
            name=self.name,
            index=(3 * ends[..., None] + np.arange(3)).reshape(len(ends), -1),
            factor=1.0 / np.sqrt(len(group.pairs)),
            weight=self.weight,
            low=target,
            high=target,
        )


def _clusters(group: Pieces, points: Floats, kinds: int) -> Clusters:
    return cluster_shapes(group.distances(points), group.turns, kinds)


def _shared(mesh: Mesh, of: Piece, kinds: int) -> Iterator[tuple[Pieces, int]]:
    """The pieces of each number of corners, and how many of the kinds are theirs: one at least."""
    groups = pieces(mesh, of)
    total = sum(len(group.ids) for group in groups)
    for group in groups:
        yield group, min(len(group.ids), max(1, round(kinds * len(group.ids) / total)))


def _spread(mesh: Mesh, of: Piece, kinds: int) -> tuple[float, float]:
    """How far distances are from those of the clusters, in mean edges: root mean square, most."""
    off = [
        (group.distances(mesh.vertices) - _clusters(group, mesh.vertices, count).targets).ravel()
        for group, count in _shared(mesh, of, kinds)
    ]
    away = np.abs(np.concatenate(off)) / mean_edge(mesh)
    return float(np.sqrt((away**2).mean())), float(away.max())
