"""The bound between samples against exact distances of moving bodies: sound, and nearly tight.

A disc and a small ball, both as placed, spun and moved, have their distance in closed form; where
the second derivative of that distance is one single term of the bound K of `margin`, the bound is
nearly reached, so that any of its terms taken smaller contradicts the distance.
"""

from __future__ import annotations

import numpy as np
import pytest

from ddgfab.linkages import bennett
from ddgfab.linkages.frames import angular_velocity
from ddgfab.mesh import Floats
from fabrication.motion.contacts import PairMotions, PlacedPairs, gaps, margin
from fabrication.motion.convex import Body, ConvexPiece, ConvexPieces, capsule, cylinder, hull

BALL = 0.02


def rotation(vector: Floats) -> Floats:
    """(3, 3) rotation by a vector: its length the angle [rad]; Rodrigues."""
    angle = float(np.linalg.norm(vector))
    if angle == 0.0:
        return np.eye(3)
    x, y, z = vector / angle
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * cross @ cross


def arrays(pieces: list[ConvexPiece]) -> ConvexPieces:
    """Each piece as a body of its own in the frame of some bar; frames are given with the pairs."""
    mechanism = bennett(100.0, np.radians(40), beta=np.radians(70))
    return ConvexPieces.build(
        mechanism, [Body(f"P{k}", (piece,), bar=0) for k, piece in enumerate(pieces)]
    )


def one_pair(frames: Floats) -> PlacedPairs:
    """(2, 4, 4) frames as one pair."""
    return PlacedPairs(
        np.array([0]),
        np.array([1]),
        frames[:1, :3, :3],
        frames[1:, :3, :3],
        frames[:1, :3, 3],
        frames[1:, :3, 3],
    )


def point_to_disc(point: Floats, normal: Floats, radius: float) -> float:
    """Distance of a point from a disc about the origin."""
    height = float(point @ normal)
    aside = float(np.linalg.norm(point - height * normal))
    return float(np.hypot(height, max(0.0, aside - radius)))


@pytest.mark.parametrize(
    ("height", "speed", "pull"),
    [
        pytest.param(0.3, 0.9, 0.0, id="Coriolis term 2 w v"),
        pytest.param(60.0, 0.0, 0.0, id="turning term w^2 d"),
        pytest.param(3.0, 0.0, 4.0, id="acceleration of the ball"),
    ],
)
@pytest.mark.parametrize("swapped", [False, True])
def test_the_margin_is_sound_and_nearly_tight(
    height: float, speed: float, pull: float, swapped: bool
) -> None:
    """A disc of radius 1 turns with w about an axis in it; a ball is above its middle.

    The ball moves along the disc, across the axis, so that it comes nearer to the turning plane:
    its distance from it is u(s).b(s) = height cos(w s) - speed s sin(w s) - pull s^2 / 2 cos(w s).
    At the middle its rate is 0, so that all that the bound takes off is K half^2 / 2.
    """
    half, spin = 1.0, 0.02
    for seed in range(6):
        own = rotation(np.random.default_rng(seed).normal(size=3))
        normal, across = own[:, 2], own[:, 0]
        axis = np.cross(normal, across)  # turns the normal towards `across`
        frames = np.tile(np.eye(4), (2, 1, 1))
        frames[0, :3, :3] = own
        frames[1, :3, 3] = height * normal
        disc = ConvexPiece(np.zeros((1, 3)), disc=1.0)
        ball = capsule([0, 0, 0], [0, 0, 0], BALL)
        spins = np.stack([spin * axis, spin * axis])  # a ball may turn as it likes
        speeds = np.stack([np.zeros(3), -speed * across])
        # Points of the disc: w^2 radius; of the ball about its middle: w^2 BALL.
        pulls = np.array([spin**2, pull + spin**2 * BALL])
        order = [1, 0] if swapped else [0, 1]
        motions = PairMotions(
            *(spins[[k]] for k in order),
            *(speeds[[k]] for k in order),
            *(pulls[[k]] for k in order),
            np.array([half]),
        )
        pairs = one_pair(frames[order])
        pieces = arrays([[disc, ball][k] for k in order])
        towards = -normal if swapped else normal
        bound = float(margin(pieces, pairs, motions, towards[None])[0])
        least = np.inf
        for s in np.linspace(-half, half, 201):
            at = (height - 0.5 * pull * s * s) * normal - speed * s * across
            turned = rotation(spin * s * axis) @ normal
            least = min(least, point_to_disc(at, turned, 1.0) - BALL)
        assert bound <= least + 1e-12
        taken = height - BALL - least
        assert height - BALL - bound < 1.15 * taken + 0.002


def test_margins_of_random_motions_never_exceed_sampled_distances() -> None:
    """Capsules, cylinders and hulls on random screws with accelerated origins."""
    rng = np.random.default_rng(7)
    close = 0
    for _ in range(150):
        pieces = arrays([_any_piece(rng), _any_piece(rng)])
        frames = np.tile(np.eye(4), (2, 1, 1))
        for k in (0, 1):
            frames[k, :3, :3] = rotation(rng.normal(size=3))
        frames[1, :3, 3] = rng.normal(size=3) * rng.uniform(3.0, 8.0)
        spins, speeds, rates = (rng.normal(size=(2, 3)) * size for size in (0.5, 2.0, 1.0))
        half = float(rng.uniform(0.02, 0.2))
        # |p''| <= |origin''| + w^2 |p - origin|
        reach = np.linalg.norm(pieces.points, axis=2).max(axis=1) + pieces.disc + pieces.ball
        pulls = np.linalg.norm(rates, axis=1) + np.linalg.norm(spins, axis=1) ** 2 * reach
        values = (spins, speeds, pulls)
        motions = PairMotions(*(v[k : k + 1] for v in values for k in (0, 1)), np.array([half]))
        pairs = one_pair(frames)
        found = gaps(pieces, pairs)
        bound = float(margin(pieces, pairs, motions, found.normal)[0])
        least = np.inf
        for s in np.linspace(-half, half, 9):
            moved = frames.copy()
            for k in (0, 1):
                moved[k, :3, :3] = rotation(s * spins[k]) @ frames[k, :3, :3]
                moved[k, :3, 3] += s * speeds[k] + 0.5 * s * s * rates[k]
            least = min(least, float(gaps(pieces, one_pair(moved)).gap[0]))
        if found.gap[0] > 0.1:
            assert bound <= least + 2e-4
            close += bound > 0.5 * least > 0
    assert close > 50


def test_rotation_is_the_flow_of_its_spin() -> None:
    """The helper above against the angular velocity that mechanisms use."""
    spin = np.array([0.3, -0.2, 0.5])
    frames = np.eye(4)[None].copy()
    frames[0, :3, :3] = rotation(0.7 * spin)
    rates = np.zeros((1, 4, 4))
    step = 1e-6
    rates[0, :3, :3] = (rotation((0.7 + step) * spin) - rotation((0.7 - step) * spin)) / (2 * step)
    assert angular_velocity(frames, rates)[0] == pytest.approx(spin, abs=1e-8)


def _any_piece(rng: np.random.Generator) -> ConvexPiece:
    a, b = rng.uniform(-1.5, 1.5, (2, 3))
    match int(rng.integers(3)):
        case 0:
            return capsule(a, b, float(rng.uniform(0.1, 0.5)))
        case 1:
            return cylinder(a, b, float(rng.uniform(0.2, 1.0)))
        case _:
            return hull(rng.uniform(-1.5, 1.5, (6, 3)))
