"""report.html and motion.gif: complete, offline, the same each time, and drawn by a browser."""

from __future__ import annotations

import base64
import io
import json
import re
import shutil
import subprocess
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from fabrication.linkage.animation import FRAMES, animation_gif, chosen
from fabrication.linkage.page import (
    ContactNote,
    Group,
    MovingPiece,
    MovingScene,
    Page,
    page_html,
    write_page,
)
from fabrication.specs import TriangleMesh
from fabrication.table import Table

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
        groups=[Group("links <a>", (0.2, 0.4, 0.7)), Group("pins", (0.6, 0.6, 0.6))],
        pieces=[MovingPiece(0, n % 2, f"L-{n:04d}") for n in range(PIECES)],
        motions=motions,
        driver="driving angle",
        values_deg=values,
        design=12,
        touches=[ContactNote(0, np.array([100.0, 0, 5]), "L-0000 meets L-0002")],
    )


def page() -> Page:
    table = Table([{"mark": "L-0000", "length_mm": 100.0, "count": 2, "note": None}])
    return Page(
        "Kit <one>",
        "One & all",
        [("free", "20 to 160 deg")],
        ["a note"],
        ["x failed"],
        {"BOM": table},
    )


def data_of(text: str) -> dict[str, object]:
    found = re.search(r'<script id="scene" type="application/json">(.*?)</script>', text, re.S)
    assert found
    data: dict[str, object] = json.loads(found[1])
    return data


def test_the_page_holds_everything_once_and_asks_for_nothing() -> None:
    text = page_html(page(), scene())
    assert len(text) < 6e6
    assert not re.search(r"""<(script|link|img)[^>]*(src|href)=""", text)
    assert "<h1>Kit &lt;one&gt;</h1>" in text
    assert '<td class="n">100.000</td>' in text
    assert "x failed" in text
    assert text == page_html(page(), scene())
    data = data_of(text)
    assert data["design"] == 12
    assert len(data["bodies"]) == 1  # type: ignore[arg-type]
    assert len(data["instances"]) == PIECES  # type: ignore[arg-type]


def test_the_numbers_arrive_in_single_precision_and_stay_in_the_box() -> None:
    data, given = data_of(page_html(page(), scene())), scene()
    motions = np.frombuffer(base64.b64decode(str(data["motions"])), "<f4")
    motions = motions.reshape(POSES, PIECES, 3, 4)
    assert np.abs(motions - given.motions[:, :, :3]).max() < 1e-5
    body = data["bodies"][0]  # type: ignore[index]
    points = np.frombuffer(base64.b64decode(body["points"]), "<f4").reshape(-1, 3)
    placed = np.einsum("tnij,kj->tnki", motions[..., :3], points) + motions[:, :, None, :, 3]
    box = np.array(data["range"])
    assert (placed.min(axis=(0, 1, 2)) > box[:, 0]).all()
    assert (placed.max(axis=(0, 1, 2)) < box[:, 1]).all()
    assert data["groups"] == [
        {"name": "links <a>", "color": "#3366b2"},
        {"name": "pins", "color": "#999999"},
    ]


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


@pytest.mark.slow
@pytest.mark.skipif(CHROMIUM is None, reason="no Chromium on this machine")
def test_a_browser_draws_it_without_a_network(tmp_path: Path) -> None:
    from PIL import Image

    path, shot = tmp_path / "report.html", tmp_path / "shot.png"
    write_page(path, page(), scene())
    options = (
        "--headless=new --no-sandbox --use-angle=swiftshader --enable-unsafe-swiftshader "
        "--ignore-gpu-blocklist --proxy-server=127.0.0.1:9 --window-size=1000,800 "
        f"--user-data-dir={tmp_path / 'profile'} --virtual-time-budget=8000 --screenshot={shot} "
        "--enable-logging=stderr"
    )
    # The slider is moved as a reader would do it, so that faults of that path show too.
    moved = path.read_text("utf-8").replace(
        "</body>",
        "<script>setTimeout(() => { slider.value = 1; slider.oninput(); }, 3000);</script></body>",
    )
    path.write_text(moved, "utf-8")
    done = subprocess.run(
        [str(CHROMIUM), *options.split(), path.as_uri()],
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    faults = [line for line in done.stderr.splitlines() if "Uncaught" in line]
    assert not faults
    picture = np.asarray(Image.open(shot).convert("RGB")).astype(int)
    blue = (picture[:, :, 2] - picture[:, :, 0] > 60) & (picture[:, :, 2] > 90)
    assert blue[100:560].sum() > 500, "the links of the first group are not to be seen"
