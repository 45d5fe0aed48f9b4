"""The preview: camera, close-up and sheet by their geometry; colors in the rendered picture."""

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
from fabrication.gridshell import design as designs
from fabrication.parts.beam import BEAM
from fabrication.parts.node import NODE, NodeShape
from fabrication.parts.panel import PANEL, PanelShape
from fabrication.pictures import closeup, preview, sheet
from fabrication.solids import mesh_of
from fabrication.specs import Family, Instance, TriangleMesh

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
        Family("BP-1", BEAM, SHAPE, (Instance("B-0", at(0, 0, 0)),), 0.0),
        Family("NP-1", NODE, SHAPE, (Instance("N-0", at(600, 0, 0)),), 0.0),
        Family("PP-1", PANEL, SHAPE, (Instance("P-0", at(0, 600, 0)),), 0.0),
    ], meshes


@pytest.mark.parametrize("seed", range(8))
def test_every_point_is_in_the_picture_and_the_model_fills_it(seed: int) -> None:
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(200, 3)) * rng.uniform(0.01, 10, 3) + rng.uniform(-1e5, 1e5, 3)
    view = preview.camera(points, SIZE)
    eye, focus, up = view.position, view.focus, view.up
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


def roof(bays: int = 4) -> designs.Design:
    """A shallow translational roof of bays x bays square panes, 1.5 m wide: every pane is plane."""
    x, y = (1500.0 * axis.ravel() for axis in np.meshgrid(*[np.arange(bays + 1.0)] * 2))
    middle = 750.0 * bays
    z = -((x - middle) ** 2 + (y - middle) ** 2) / 40e3
    at = np.arange((bays + 1) ** 2).reshape(bays + 1, bays + 1)
    rings = [at[:-1, :-1], at[:-1, 1:], at[1:, 1:], at[1:, :-1]]
    return designs.design(
        (np.stack([x, y, z], axis=1), np.stack(rings, -1).reshape(-1, 4).tolist())
    )


def standing(design: designs.Design, failed: tuple[str, ...] = ()) -> list[closeup.PlacedMesh]:
    meshes = {f.number: mesh_of(f.shape, 0.5) for f in design.families}
    return closeup.placed(design.families, meshes, frozenset(failed))


def test_merging_places_every_instance_and_sets_failed_ones_apart() -> None:
    families, meshes = scene()
    pieces = closeup.placed(families, meshes, frozenset({"N-0"}))
    merged = closeup.merged(pieces)
    assert list(merged) == [(BEAM, False), (NODE, True), (PANEL, False)]
    vertices, triangles = merged[NODE, True]
    np.testing.assert_allclose(vertices.min(axis=0), [600, 0, 0])
    assert triangles.max() == len(vertices) - 1
    both, all_triangles = closeup.joined(pieces)
    assert len(both) == 24
    assert all_triangles.max() == 23
    with pytest.raises(OutputError, match="no parts"):
        preview.render([], {})


@pytest.mark.parametrize("azimuth", [0.3, 1.9, 4.0])
def test_the_close_up_opens_the_middle_node_towards_the_eye(azimuth: float) -> None:
    design = roof()
    pieces = standing(design)
    eye = 3000.0 + 30e3 * np.array([np.cos(azimuth), np.sin(azimuth), 0.5])
    near = closeup.closeup(pieces, eye)
    assert near is not None
    node = near.pieces[0]
    middle = design.gridshell.nodes[12]  # of 5 x 5
    np.testing.assert_allclose(node.placement[:3, 3], middle.position, atol=1e-6)
    forms = [p.form for p in near.pieces[1:]]
    assert forms.count("bar") == 4
    assert forms.count("sheet") == 3  # the one before the eye is left out
    axis = node.placement[:3, 2]
    back = near.view.position - near.middle
    distance = np.linalg.norm(back)
    assert np.degrees(np.arcsin(back @ axis / distance)) == pytest.approx(closeup.RISE_DEG)
    assert distance * np.sin(np.radians(near.view.field_deg) / 2) == pytest.approx(near.radius)
    flat = back[:2] / np.linalg.norm(back[:2])
    assert flat @ [np.cos(azimuth), np.sin(azimuth)] > np.cos(np.radians(60))
    # Every other pane is farther from the eye than the node; one before it would be nearer.
    for pane in (p for p in near.pieces if p.form == "sheet"):
        out = pane.vertices.mean(axis=0) - near.middle
        assert out[:2] @ flat < 0.5 * np.linalg.norm(out)
    # One beam is off its seat, along itself, by three quarters of the node's diameter.
    there = {p.vertices.tobytes() for p in pieces}
    moved = [p for p in near.pieces if p.vertices.tobytes() not in there]
    assert [p.form for p in moved] == ["bar"]
    old = next(p for p in pieces if p.placement is moved[0].placement)
    step = (moved[0].vertices - old.vertices).mean(axis=0)
    assert isinstance(middle.shape, NodeShape)
    assert np.linalg.norm(step) == pytest.approx(1.5 * middle.shape.radius, rel=0.02)
    np.testing.assert_allclose(np.cross(step, old.placement[:3, 0]), 0, atol=1e-9)
    assert step @ (old.vertices.mean(axis=0) - near.middle) > 0


def test_no_close_up_without_nodes_or_beams_and_one_from_straight_above() -> None:
    pieces = standing(roof(2))
    eye = np.array([9e3, 2e3, 8e3])
    assert closeup.closeup([p for p in pieces if p.form != "joint"], eye) is None
    assert closeup.closeup([p for p in pieces if p.form != "bar"], eye) is None
    node = next(p for p in pieces if p.form == "joint")
    only = [node, min((p for p in pieces if p.form == "bar"), key=lambda p: distance(p, node))]
    near = closeup.closeup(only, np.array([0.0, 0.0, 1e5]))
    assert near is not None
    assert len(near.pieces) == 2
    above = closeup.closeup(only, near.middle + 1e4 * node.placement[:3, 2])
    assert above is not None
    assert np.isfinite(above.view.position).all()


def distance(piece: closeup.PlacedMesh, node: closeup.PlacedMesh) -> float:
    return float(np.linalg.norm(piece.vertices - node.placement[:3, 3], axis=1).min())


MODEL, NEAR = (40, 90, 200), (250, 120, 0)  # plain colors that are easily told apart


def composed(fill: Any) -> tuple[np.ndarray, np.ndarray, float]:
    """A picture of a plain model where fill(x, y) of 0..1: masks of model and ring, its shares."""
    size, fine = (320, 200), 2
    y, x = np.mgrid[0 : size[1] * fine, 0 : size[0] * fine]
    model = np.full((*x.shape, 3), 255, dtype=np.uint8)
    model[fill((x + 0.5) / size[0] / fine, (y + 0.5) / size[1] / fine)] = MODEL
    shade = np.full((size[1], size[0], 3), 255, dtype=np.uint8)
    asked: list[int] = []

    def lens(diameter: int) -> np.ndarray:
        asked.append(diameter)
        return np.full((2 * diameter, 2 * diameter, 3), NEAR, dtype=np.uint8)

    whole = sheet.compose(model, shade, size, lens, (160.0, 100.0))
    assert whole.shape == (size[1], size[0], 3)
    assert len(asked) == 1
    assert asked[0] >= round(min(sheet.LENSES) * size[1])
    drawn = (model == MODEL).all(axis=2).mean()
    return near_to(whole, MODEL), near_to(whole, NEAR), float(drawn)


def near_to(picture: np.ndarray, color: tuple[int, int, int]) -> np.ndarray:
    return np.asarray((np.abs(picture.astype(int) - color) < 12).all(axis=2))


@pytest.mark.parametrize(
    ("fill", "right", "low"),
    [
        (lambda x, y: (y > 0.45 + 0.4 * (x < 0.5)) & (y < 0.93) & (x > 0.05), False, False),
        (lambda x, y: (y < 0.5) & (y > 0.05) & (x > 0.05) & (x < 0.95), True, False),
        (lambda x, y: (x < 0.55) & (x > 0.05) & (y > 0.05) & (y < 0.95), True, False),
        (lambda x, y: (x + y < 1.0) & (x > 0.05) & (y > 0.05), True, True),
    ],
)
def test_the_ring_goes_where_there_is_room(fill: Any, right: bool, low: bool) -> None:
    model, ring, drawn = composed(fill)
    rows, columns = np.nonzero(ring)
    assert (columns.mean() > 160) == right
    assert (rows.mean() > 100) == low
    assert 0.9 * drawn < model.mean() < 1.02 * drawn  # as large as before, hidden nowhere


def test_a_model_without_room_beside_it_becomes_smaller() -> None:
    model, ring, drawn = composed(lambda x, y: (abs(x - 0.5) < 0.46) & (abs(y - 0.5) < 0.46))
    assert 0.3 * drawn < model.mean() < 0.9 * drawn
    assert ring.mean() > 0.06  # a ring of 0.42 of the height has 0.087 of the picture
    for mask in (model, ring):
        assert not mask[[0, -1]].any()
        assert not mask[:, [0, -1]].any()
    with pytest.raises(RuntimeError, match="empty"):
        composed(lambda x, y: x < 0)


ROLES = "orange", "steel", "glass"


def hues(image: np.ndarray) -> dict[str, np.ndarray]:
    red, green, blue = (image[..., i].astype(int) for i in range(3))
    return {
        "orange": (red > 1.5 * blue) & (red > 60) & (green > 0.3 * red),
        "steel": (abs(red - green) < 25) & (blue >= red) & (blue - red < 45) & (red < 140),
        "glass": (green > red + 12) & (blue > red + 12) & (green > 150),
        "red": (red > 1.3 * green) & (abs(green - blue) < 0.12 * red),
    }


def picture(data: bytes) -> np.ndarray:
    from PIL import Image

    return np.asarray(Image.open(io.BytesIO(data)).convert("RGB"))


def in_a_fresh_interpreter(lines: str) -> None:
    """Run a program that knows this module as t, without a display; it must say nothing."""
    folders = [str(Path(__file__).parent), str(Path(__file__).parents[2])]
    program = f"import sys; sys.path[:0] = {folders!r}\n"
    program += f"import test_pictures_preview as t; from pathlib import Path\n{lines}\n"
    env = {k: v for k, v in os.environ.items() if k not in ("DISPLAY", "WAYLAND_DISPLAY")}
    done = subprocess.run(
        [sys.executable, "-c", program], env=env, capture_output=True, text=True, timeout=120
    )
    if "cannot render" in done.stderr:
        pytest.skip(f"no off-screen rendering here: {done.stderr.splitlines()[-1]}")
    assert done.returncode == 0, done.stderr
    assert (done.stdout, done.stderr) == ("", "")


@pytest.mark.slow
def test_roles_are_seen_in_their_colors_without_a_display(tmp_path: Path) -> None:
    file = tmp_path / "a.png"
    in_a_fresh_interpreter(f"t.preview.write_preview(Path({str(file)!r}), *t.scene(), size=t.SIZE)")
    image = picture(file.read_bytes())
    assert image.shape == (SIZE[1], SIZE[0], 3)
    seen = hues(image)
    for role in ROLES:
        assert seen[role].mean() > 0.01, role
    assert seen["red"].mean() < 0.001
    white = image.min(axis=2) > 250
    assert white.mean() > 0.2
    assert white[[0, -1]].all()
    assert white[:, [0, -1]].all()


@pytest.mark.slow
def test_a_roof_has_a_close_up_in_which_node_beams_and_glass_are_told_apart(
    tmp_path: Path,
) -> None:
    files = [tmp_path / name for name in ("with.png", "without.png", "failed.png")]
    in_a_fresh_interpreter(
        f"""
import os
from fabrication.processes import expendable
expendable()  # draws in this process
with_it, without, failed = (Path(f) for f in {[str(f) for f in files]!r})
roof = t.roof(12)
with_it.write_bytes(roof._repr_png_())
assert not {{"OCP", "cadquery", "build123d"}} & set(sys.modules)
meshes = {{f.number: t.mesh_of(f.shape, 0.5) for f in roof.families}}
marks = {{piece.mark for piece in roof.gridshell.panels[:40]}}
t.preview.write_preview(failed, roof.families, meshes, marks)
t.preview.closeup = lambda *_: None
without.write_bytes(roof._repr_png_())
"""
    )
    image, plain, failed = (picture(f.read_bytes()) for f in files)
    assert image.shape == (preview.SIZE[1], preview.SIZE[0], 3)
    seen, bare = hues(image), hues(plain)
    assert seen["orange"].mean() > 10 * max(bare["orange"].mean(), 1e-4)
    # The orange of the node is in one place, and all roles are around it.
    rows, columns = np.nonzero(seen["orange"])
    y, x = int(np.median(rows)), int(np.median(columns))
    inset = np.s_[max(y - 150, 0) : y + 150, max(x - 150, 0) : x + 150]
    for role in ROLES:
        assert seen[role][inset].mean() > 0.02, role
    red = hues(failed)["red"].mean()
    assert red > 0.01
    assert hues(image)["red"].mean() < 0.1 * red


def test_a_machine_that_cannot_render_is_told_what_to_install(monkeypatch: Any) -> None:
    def broken(*_: Any) -> bytes:
        raise RuntimeError("no GL")

    monkeypatch.setattr("fabrication.pictures.apart.is_expendable", lambda: True)
    monkeypatch.setattr(preview, "_rendered", broken)
    with pytest.raises(OutputError, match="libEGL"):
        preview.render(*scene())
    monkeypatch.setitem(sys.modules, "pyvista", None)
    with pytest.raises(OutputError, match="pip install pyvista"):
        preview.render(*scene())
