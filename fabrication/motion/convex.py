"""Bodies for collision: convex pieces that move with the bars of a mechanism; arrays only.

A piece is the hull of a few points, swept by a flat disc and by a ball: a bar's prism (points), an
eye, pin or head (two points on the axis and a disc), a capsule (two points and a ball). So parts
are covered exactly but for bores and labels, which only remove material. Every piece also lies in
a capsule of its own, which serves for the cheap tests.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.errors import InputError
from ddgfab.linkages import Mechanism
from ddgfab.mesh import Floats, Ints


@dataclass(frozen=True, eq=False)
class ConvexPiece:
    """A convex body: hull of `points`, plus a disc across `axis`, plus a ball. Millimetres.

    points : (k, 3)
    disc : radius of the disc
    axis : (3,) unit normal of the disc
    ball : radius of the ball
    eye : hinge about whose axis the piece is a body of revolution, or -1
    """

    points: Floats
    disc: float = 0.0
    axis: Floats = field(default_factory=lambda: np.array([0.0, 0.0, 1.0]))
    ball: float = 0.0
    eye: int = -1


@dataclass(frozen=True, eq=False)
class Body:
    """A rigid part for collision: a link in its bar's frame, or a fitting in its hinge's frame.

    mark : its name
    bar : the bar whose frame the pieces are in, or -1
    hinge : the hinge whose frame (origin on the foot point, z the axis) the pieces are in, or -1
    pieces : convex pieces; those of a fitting are bodies of revolution about z, those of a link
        other than its eyes stay outside the pins
    """

    mark: str
    pieces: tuple[ConvexPiece, ...]
    bar: int = -1
    hinge: int = -1


def cylinder(start: ArrayLike, end: ArrayLike, radius: float, *, eye: int = -1) -> ConvexPiece:
    """A flat-ended cylinder between two points."""
    points = np.array([start, end], dtype=np.float64)
    axis = points[1] - points[0]
    length = float(np.linalg.norm(axis))
    if not length > 0:
        raise InputError(f"a cylinder from {points[0]} to {points[1]} has no length")
    return ConvexPiece(points, disc=float(radius), axis=axis / length, eye=eye)


def capsule(start: ArrayLike, end: ArrayLike, radius: float) -> ConvexPiece:
    """A round-ended cylinder between two points."""
    return ConvexPiece(np.array([start, end], dtype=np.float64), ball=float(radius))


def hull(points: ArrayLike) -> ConvexPiece:
    """The convex hull of (k, 3) points."""
    return ConvexPiece(np.array(points, dtype=np.float64))


@dataclass(frozen=True, eq=False)
class ConvexPieces:
    """All pieces of all bodies in frames of bars, padded into arrays.

    points : (n, k, 3) in the frame of `bar`; shorter lists repeat their first one
    disc, ball : (n,); axis : (n, 3)
    bar : (n,) the bar it moves with
    body : (n,) which body
    eye : (n,) hinge about which it is a body of revolution, or -1
    segment, radius : (n, 2, 3), (n,) a capsule around the piece
    reach : (n, 2) greatest distance of its points from the two hinges of its bar
    """

    points: Floats
    disc: Floats
    axis: Floats
    ball: Floats
    bar: Ints
    body: Ints
    eye: Ints
    segment: Floats
    radius: Floats
    reach: Floats

    @staticmethod
    def build(mechanism: Mechanism, bodies: Sequence[Body]) -> ConvexPieces:
        """From bodies in frames of bars and hinges.

        Raises
        ------
        InputError
            A body in no frame or in two, a bar or hinge that does not exist, a body without pieces.
        """
        rows, bars, owners = [], [], []
        for number, body in enumerate(bodies):
            bar, move = _carrier(mechanism, body)
            if not body.pieces:
                raise InputError(f"{body.mark}: a body without pieces cannot collide")
            for piece in body.pieces:
                eye = body.hinge if body.hinge >= 0 else piece.eye
                points = piece.points @ move[:3, :3].T + move[:3, 3]
                rows.append((points, piece.disc, move[:3, :3] @ piece.axis, piece.ball, eye))
                bars.append(bar)
                owners.append(number)
        longest = max(len(row[0]) for row in rows)
        points = np.stack([np.vstack([r[0], *[r[0][:1]] * (longest - len(r[0]))]) for r in rows])
        disc, ball = (np.array([row[k] for row in rows]) for k in (1, 3))
        axis = np.stack([row[2] for row in rows])
        carrier = np.array(bars)
        segment, radius = _around(points, disc, axis, ball)
        far = np.zeros((len(rows), 2, 3))
        far[:, 1, 0] = mechanism.lengths[carrier]
        away = np.linalg.norm(points[:, :, None] - far[:, None], axis=-1).max(axis=1)
        return ConvexPieces(
            points,
            disc,
            axis,
            ball,
            carrier,
            np.array(owners),
            np.array([row[4] for row in rows]),
            segment,
            radius,
            away + (disc + ball)[:, None],
        )

    def __len__(self) -> int:
        return len(self.points)

    def support(self, which: Ints, directions: Floats) -> Floats:
        """(p, 3) the farthest point of each core (without its ball) along (p, 3) directions."""
        points = self.points[which]
        best = np.einsum("pkc,pc->pk", points, directions).argmax(axis=1)
        out = points[np.arange(len(which)), best]
        axis = self.axis[which]
        flat = _across(directions, axis)
        size = np.linalg.norm(flat, axis=1, keepdims=True)
        # Twice: what is left of a direction along the axis is rounding, with a part along the axis.
        flat = _across(flat / np.where(size > 0, size, 1.0), axis)
        size = np.linalg.norm(flat, axis=1)
        scale = np.where(size > 0, self.disc[which] / np.where(size > 0, size, 1.0), 0.0)
        return np.asarray(out + scale[:, None] * flat)


def _across(vectors: Floats, axes: Floats) -> Floats:
    """The parts of (p, 3) vectors perpendicular to unit axes."""
    return np.asarray(vectors - np.einsum("pc,pc->p", vectors, axes)[:, None] * axes)


def _carrier(mechanism: Mechanism, body: Body) -> tuple[int, Floats]:
    """The bar a body moves with and the motion from the body's frame to that bar's."""
    if (body.bar >= 0) == (body.hinge >= 0):
        raise InputError(f"{body.mark}: a body lies in the frame of a bar or of a hinge")
    if body.bar >= mechanism.n_bars or body.hinge >= mechanism.n_hinges:
        raise InputError(f"{body.mark}: there is no bar {body.bar} or hinge {body.hinge}")
    move = np.eye(4)
    if body.bar >= 0:
        return body.bar, move
    bar = int(np.argmax((mechanism.bars == body.hinge).any(axis=1)))
    if mechanism.bars[bar, 1] == body.hinge:
        c, s = np.cos(mechanism.twists[bar]), np.sin(mechanism.twists[bar])
        move[1:3, 1:3] = [[c, -s], [s, c]]
        move[0, 3] = mechanism.lengths[bar]
    return bar, move


def _around(points: Floats, disc: Floats, axis: Floats, ball: Floats) -> tuple[Floats, Floats]:
    """Capsules around pieces: along the axis of those with a disc, else along their longest way."""
    middle = (points.max(axis=1) + points.min(axis=1)) / 2
    away = points - middle[:, None]
    # The long axis of a prism rather than its diagonal: the largest principal direction.
    _, vectors = np.linalg.eigh(np.einsum("nki,nkj->nij", away, away))
    way = np.where((disc > 0)[:, None], axis, vectors[:, :, -1])
    along = np.einsum("nki,ni->nk", away, way)
    low, high = along.min(axis=1), along.max(axis=1)
    middle = middle + ((low + high) / 2)[:, None] * way
    half = (high - low) / 2
    segment = middle[:, None] + np.stack([-half, half], axis=1)[:, :, None] * way[:, None]
    across = points - middle[:, None]
    across -= np.einsum("nki,ni->nk", across, way)[:, :, None] * way[:, None]
    return segment, np.linalg.norm(across, axis=2).max(axis=1) + disc + ball
