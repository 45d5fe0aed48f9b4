"""The preview: the camera holds the whole model, roles have their colours, no display needed."""

from __future__ import annotations

import io
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ddgfab.errors import OutputError
from fabrication.export import preview
from fabrication.specs import Family, Instance, PanelShape, TriangleMesh

SIZE = (400, 250)
SHAPE = PanelShape(1.0, np.zeros((4, 2)), np.zeros((4, 2)))


def block(x: float, y: float, z: float) -> TriangleMesh:
    corners = np.array([[i, j, k] for i in (0, x) for j in (0, y) for k in (0, z)], dtype=float)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return TriangleMesh(
        corners, np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])
    )


def at(x: float, y: float, z: float) -> np.ndarray:
    placement = np.eye(4)
    placement[:3, 3] = x, y, z
    return placement


def scene() -> tuple[list[Family], dict[str, TriangleMesh]]:
    meshes = {
        "BP-1": block(400, 400, 100),
        "NP-1": block(400, 400, 100),
        "PP-1": block(400, 400, 9),
    }
    return [
        Family("BP-1", "beam", SHAPE, (Instance("B-0", at(0, 0, 0)),), 0.0),
        Family("NP-1", "node", SHAPE, (Instance("N-0", at(600, 0, 0)),), 0.0),
        Family("PP-1", "panel", SHAPE, (Instance("P-0", at(0, 600, 0)),), 0.0),
    ], meshes


@pytest.mark.parametrize("seed", range(8))
def test_every_point_is_in_the_picture_and_the_model_fills_it(seed: int) -> None:
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(200, 3)) * rng.uniform(0.01, 10, 3) + rng.uniform(-1e5, 1e5, 3)
    eye, focus, up = preview.camera(points, SIZE)
    forward = (focus - eye) / np.linalg.norm(focus - eye)
    right = np.cross(forward, up)
    right /= np.linalg.norm(right)
    seen = points - eye
    depth = seen @ forward
    assert (depth > 0).all()
    tangent = np.tan(np.radians(preview.FIELD_DEG) / 2)
    across = np.abs(seen @ right) / depth / (tangent * SIZE[0] / SIZE[1])
    above = np.abs(seen @ np.cross(right, forward)) / depth / tangent
    reach = max(across.max(), above.max())
    assert 0.8 < reach < 1.0
    assert 0.3 < -forward[2] < 0.8  # from above, 17 to 53 degrees


def test_merging_places_every_instance_and_sets_failed_ones_apart() -> None:
    families, meshes = scene()
    merged = preview.merged_by_look(families, meshes, {"N-0"})
    assert list(merged) == ["beam", "panel", "failed"]
    vertices, triangles = merged["failed"]
    np.testing.assert_allclose(vertices.min(axis=0), [600, 0, 0])
    assert triangles.max() == len(vertices) - 1
    with pytest.raises(OutputError, match="no parts"):
        preview.render([], {})


@pytest.mark.slow
def test_roles_are_seen_in_their_colours_without_a_display(tmp_path: Path) -> None:
    program = (
        f"import sys; sys.path[:0] = [{str(Path(__file__).parent)!r}, "
        f"{str(Path(__file__).parents[2])!r}]\n"
        "import test_export_preview as t; from pathlib import Path\n"
        f"t.preview.write_preview(Path({str(tmp_path / 'a.png')!r}), *t.scene(), size=t.SIZE)\n"
    )
    env = {k: v for k, v in os.environ.items() if k not in ("DISPLAY", "WAYLAND_DISPLAY")}
    done = subprocess.run(
        [sys.executable, "-c", program], env=env, capture_output=True, text=True, timeout=120
    )
    if "cannot render" in done.stderr:
        pytest.skip(f"no off-screen rendering here: {done.stderr.splitlines()[-1]}")
    assert done.returncode == 0, done.stderr
    assert (done.stdout, done.stderr) == ("", "")
    image = picture((tmp_path / "a.png").read_bytes())
    assert image.shape == (SIZE[1], SIZE[0], 3)
    red, green, blue = (image[..., i].astype(int) for i in range(3))
    orange = (red > 1.5 * blue) & (red > 60)
    grey = (abs(red - blue) < 40) & (red < 140)
    glass = (green > red + 12) & (blue > red + 12)
    white = image.min(axis=2) > 250
    for colour in (orange, grey, glass):
        assert colour.mean() > 0.01
    assert white.mean() > 0.2
    assert white[[0, -1]].all()
    assert white[:, [0, -1]].all()


def picture(data: bytes) -> np.ndarray:
    from PIL import Image

    return np.asarray(Image.open(io.BytesIO(data)).convert("RGB"))


def test_a_machine_that_cannot_render_is_told_what_to_install(monkeypatch: Any) -> None:
    def broken(*_: Any) -> bytes:
        raise RuntimeError("no GL")

    monkeypatch.setattr(preview, "_rendered", broken)
    with pytest.raises(OutputError, match="libEGL"):
        preview.render(*scene())
    monkeypatch.setitem(sys.modules, "pyvista", None)
    with pytest.raises(OutputError, match="pip install pyvista"):
        preview.render(*scene())
