"""motion.gif: the mechanism moving through its range and back, drawn without a display."""

from __future__ import annotations

import io
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from ddgfab.errors import OutputError
from ddgfab.io.atomic import atomic_path
from ddgfab.mesh import Floats
from fabrication.formats.base import Contents, Format, Whole
from fabrication.linkage.moving import MovingScene
from fabrication.pictures.apart import drawn
from fabrication.pictures.preview import camera
from fabrication.specs import Check

ANIMATION: Final = "motion.gif"
"""Name of the file."""

SIZE: Final = (640, 480)
"""Pixels across and down."""

FRAMES: Final = 36
"""Poses from one end of the range to the other, at most; the way back shows them again."""

MILLISECONDS: Final = 60
"""How long a picture stays."""

REST: Final = 6
"""At either end the last picture stays so many times as long."""

COLORS: Final = 64
"""Colors of the GIF's palette."""

_SAMPLES: Final = 2  # drawn so many times finer than shown, each way
_LOOK: Final = {"ambient": 0.45, "diffuse": 0.70, "specular": 0.15, "specular_power": 15}


class Gif(Format):
    """GIF: motion.gif, the scene moving."""

    name = "gif"
    suffixes = (".gif",)

    def __init__(self, scene: MovingScene) -> None:
        self.scene = scene

    def whole_files(self, contents: Contents) -> list[str]:
        """motion.gif."""
        return [ANIMATION]

    def write_whole(self, folder: Path, whole: Whole) -> list[str]:
        """See `write_animation`; a machine without graphics is not a fault of the linkage."""
        try:
            write_animation(folder / ANIMATION, self.scene)
        except OutputError as error:
            return [f"no {ANIMATION}: {error}"]
        return []

    def check_whole(self, folder: Path, whole: Whole) -> list[Check]:
        """Read back: endless, with a picture a pose there and back; equal ones may be one."""
        from PIL import Image

        there = len(chosen(len(self.scene.values_deg)))
        with Image.open(folder / ANIMATION) as picture:
            found, endless = getattr(picture, "n_frames", 1), picture.info.get("loop") == 0
        most = max(1, 2 * there - 2)
        moves = min(most, 2) <= found <= most
        return [Check("gif pictures", endless and moves, float(found), float(most))]


def write_animation(path: Path, scene: MovingScene, *, size: tuple[int, int] = SIZE) -> None:
    """Draw the scene's poses, there and back, as an endless GIF (atomically).

    Raises
    ------
    OutputError
        The file cannot be written, or this machine cannot render; names the packages to install.
    """
    data = animation_gif(scene, size=size)
    with atomic_path(path) as temporary:
        temporary.write_bytes(data)


def animation_gif(scene: MovingScene, *, size: tuple[int, int] = SIZE) -> bytes:
    """The bytes of the GIF; see `write_animation`."""
    return _gif(drawn(_frames, scene, size))


def chosen(count: int) -> NDArray[np.int64]:
    """Which of so many poses are drawn: at most `FRAMES`, evenly, with both ends."""
    return np.unique(np.linspace(0, count - 1, min(count, FRAMES)).round().astype(np.int64))


def _frames(pyvista: Any, scene: MovingScene, size: tuple[int, int]) -> list[NDArray[np.uint8]]:
    """A picture (height, width, 3) for each pose that is drawn."""
    poses = chosen(len(scene.values_deg))
    view = camera(np.concatenate(_all_points(scene, poses)), size)
    fine = [side * _SAMPLES for side in size]
    plotter = pyvista.Plotter(off_screen=True, window_size=fine, lighting="light kit")
    try:
        plotter.set_background("white")
        plotter.disable_anti_aliasing()  # drawn finer instead
        moving = []
        for g, group in enumerate(scene.groups):
            members = [n for n, piece in enumerate(scene.pieces) if piece.group == g]
            if members:
                mesh = pyvista.PolyData(
                    _points(scene, members, int(poses[0])), _faces(scene, members)
                )
                plotter.add_mesh(mesh, color=group.color, smooth_shading=False, **_LOOK)
                moving.append((mesh, members))
        plotter.camera.position = tuple(view.position)
        plotter.camera.focal_point = tuple(view.focus)
        plotter.camera.up = tuple(view.up)
        plotter.camera.view_angle = view.field_deg
        pictures = []
        for pose in poses.tolist():
            for mesh, members in moving:
                mesh.points = _points(scene, members, pose)
            plotter.reset_camera_clipping_range()
            plotter.render()
            pictures.append(np.asarray(plotter.screenshot(return_img=True), dtype=np.uint8))
        return pictures
    finally:
        plotter.close()


def _points(scene: MovingScene, members: Sequence[int], pose: int) -> Floats:
    """Vertices of some pieces in one pose, one piece after another."""
    placed = []
    for n in members:
        motion = scene.motions[pose, n]
        body = scene.bodies[scene.pieces[n].body]
        placed.append(body.vertices @ motion[:3, :3].T + motion[:3, 3])
    points: Floats = np.concatenate(placed).astype(np.float32)
    return points


def _faces(scene: MovingScene, members: Sequence[int]) -> NDArray[np.int64]:
    """Their triangles as pyvista takes them."""
    faces, first = [], 0
    for n in members:
        body = scene.bodies[scene.pieces[n].body]
        faces.append(np.insert(body.triangles + first, 0, 3, axis=1).ravel())
        first += len(body.vertices)
    return np.concatenate(faces)


def _all_points(scene: MovingScene, poses: NDArray[np.int64]) -> list[Floats]:
    """Corners of the boxes of all pieces in all poses: enough to aim the camera."""
    result = []
    for n, piece in enumerate(scene.pieces):
        vertices = scene.bodies[piece.body].vertices
        ends = np.stack([vertices.min(axis=0), vertices.max(axis=0)], axis=1)
        corners = np.stack(np.meshgrid(*ends, indexing="ij"), -1).reshape(-1, 3)
        motions = scene.motions[poses, n]
        placed = np.einsum("tij,kj->tki", motions[:, :3, :3], corners) + motions[:, None, :3, 3]
        result.append(placed.reshape(-1, 3))
    return result


def _gif(pictures: Sequence[NDArray[np.uint8]]) -> bytes:
    """An endless GIF of pictures forwards and backwards, with one palette for all."""
    from PIL import Image

    small = [Image.fromarray(picture).reduce(_SAMPLES) for picture in pictures]
    # The palette is that of a strip of some of them: the colors do not flicker.
    some = small[:: max(1, len(small) // 6)]
    strip = Image.new("RGB", (some[0].width, some[0].height * len(some)))
    for at, picture in enumerate(some):
        strip.paste(picture, (0, at * picture.height))
    palette = strip.quantize(COLORS, Image.Quantize.MEDIANCUT)
    drawn = [picture.quantize(palette=palette, dither=Image.Dither.NONE) for picture in small]
    times = [MILLISECONDS] * len(drawn)
    times[0] = times[-1] = REST * MILLISECONDS
    back = slice(-2, 0, -1)
    stream = io.BytesIO()
    drawn[0].save(
        stream,
        "GIF",
        save_all=True,
        append_images=[*drawn[1:], *drawn[back]],
        duration=[*times, *times[back]],
        loop=0,
        optimize=False,
    )
    return stream.getvalue()
