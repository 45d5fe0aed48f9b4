"""motion.gif: the same each time, there and back."""

from __future__ import annotations

import io
import shutil
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from fabrication.linkage.animation import FRAMES, animation_gif, chosen
from fabrication.linkage.moving import Group, MovingPiece, MovingScene
from fabrication.specs import TriangleMesh

CORNERS = np.array([[0.0, 0, 0], [100, 0, 0], [0, 10, 0], [0, 0, 10]])
TRIANGLES = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
POSES, PIECES = 50, 3
CHROMIUM = shutil.which("chromium") or shutil.which("google-chrome")


def scene() -> MovingScene:
    values = np.linspace(20.0, 160.0, POSES)
    motions = np.tile(np.eye(4), (POSES, PIECES, 1, 1))
    for t, value in enumerate(np.radians(values)):
        for n in range(PIECES):
            c, s = np.cos(value * n / 2), np.sin(value * n / 2)
            motions[t, n, :2, :2] = [[c, -s], [s, c]]
            motions[t, n, 2, 3] = 15 * n
    return MovingScene(
        bodies=[TriangleMesh(CORNERS, TRIANGLES)],
        groups=[Group("LP-001", (0.2, 0.4, 0.7)), Group("HP-001", (0.6, 0.6, 0.6))],
        pieces=[MovingPiece(0, n % 2, f"L-{n:04d}") for n in range(PIECES)],
        motions=motions,
        driver="driving angle",
        values_deg=values,
        design=12,
    )


def test_frames_are_chosen_evenly_with_both_ends() -> None:
    assert chosen(3).tolist() == [0, 1, 2]
    assert (chosen(61)[0], chosen(61)[-1], len(chosen(61))) == (0, 60, FRAMES)


@pytest.mark.slow
def test_the_animation_goes_there_and_back() -> None:
    from PIL import Image

    given = scene()
    short = replace(given, motions=given.motions[::10], values_deg=given.values_deg[::10], design=1)
    data = animation_gif(short, size=(160, 120))
    assert data == animation_gif(short, size=(160, 120))
    picture = Image.open(io.BytesIO(data))
    assert (picture.n_frames, picture.size) == (8, (160, 120))
    frames = []
    for at in range(8):
        picture.seek(at)
        frames.append(np.asarray(picture.convert("RGB")).astype(int))
    assert [int(np.abs(frames[k] - frames[-k]).max()) for k in (1, 2, 3)] == [0, 0, 0]
    assert all((np.abs(a - b).max(axis=2) > 60).sum() > 50 for a, b in pairwise(frames))
    for frame in frames:
        drawn = frame.min(axis=2) < 200
        edges = np.concatenate([drawn[0], drawn[-1], drawn[:, 0], drawn[:, -1]])
        assert drawn.any()
        assert not edges.any()
