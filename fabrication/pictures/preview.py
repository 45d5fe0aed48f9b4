"""preview.png: the structure from three quarters above with a node close up, without a display."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np

from ddgfab.errors import OutputError
from ddgfab.io.atomic import atomic_path
from ddgfab.mesh import Floats, Ints
from fabrication.formats.base import FAILED_COLOR
from fabrication.pictures.apart import drawn
from fabrication.pictures.closeup import (
    REACH,
    Closeup,
    PlacedMesh,
    View,
    closeup,
    joined,
    merged,
    placed,
)
from fabrication.pictures.sheet import Pixels, compose, png
from fabrication.specs import Color, Family, Finish, Kind, TriangleMesh

SIZE: Final = (1600, 1000)
"""Pixels across and down."""

ELEVATION_DEG: Final = 28.0
"""Height of the camera above the horizon [deg]."""

FIELD_DEG: Final = 26.0
"""Vertical field of view [deg]: long enough a lens that straight members look straight."""

NODE_SEEN: Final = 0.03
"""Nodes wider than this part of the picture need no close-up."""

NOTEBOOK_CHORD: Final = 0.5
"""Chord tolerance [mm] of meshes that are made only to be looked at."""

_LOOK: Final[dict[Finish, dict[str, float]]] = {
    "matte": {"ambient": 0.35, "diffuse": 0.75, "specular": 0.20, "specular_power": 20},
    "bright": {"ambient": 0.45, "diffuse": 0.75, "specular": 0.25, "specular_power": 20},
    "glass": {"ambient": 0.52, "diffuse": 0.52, "specular": 0.12, "specular_power": 6},
    "plastic": {"ambient": 0.35, "diffuse": 0.75, "specular": 0.10, "specular_power": 8},
}
_FAILED: Final = {"ambient": 0.45, "diffuse": 0.70, "specular": 0.10, "specular_power": 10}
_GLASS: Final = 0.42  # opacity of a pane; its far side is not drawn
_GLASS_NEAR: Final = 0.30  # the same in the close-up
_LIGHTS: Final = (((-0.8, 1.1, 0.6), 0.80), ((1.2, 0.3, 0.6), 0.35))  # right, up, back; strength
_SAMPLES: Final = 2  # drawn so many times finer than shown, each way
_MARGIN: Final = 1.06  # how much wider than the model the picture is
_FLAT: Final = 0.08  # a model lower than this part of its width is looked at from higher up
_DROP: Final = 0.02  # how far the ground lies below the model, as a part of its height
_DOT: Final = 5.0  # a node is at least so many of the 1600 pixels wide
_FINE: Final = 0.008  # nodes narrower than this part of the picture are seen as such dots
_LINE: Final = 0.8  # lines along beams are so much darker
_CREASE_DEG: Final = 25.0  # edges sharper than this are drawn in the close-up


def write_preview(
    path: Path,
    families: Sequence[Family],
    meshes: Mapping[str, TriangleMesh],
    failed: Collection[str] = (),
    colors: Mapping[str, Color] | None = None,
    *,
    size: tuple[int, int] = SIZE,
) -> None:
    """Render the placed parts to a PNG (atomically).

    Parameters
    ----------
    families : part numbers with their instances
    meshes : by part number, the mesh in the part's frame [mm]
    failed : marks of pieces that are shown in red
    colors : by part number, where its pieces have another color than their kind (sRGB, 0 to 1)
    size : pixels across and down

    Raises
    ------
    OutputError
        The file cannot be written, or this machine cannot render; names the packages to install.
    """
    picture = render(families, meshes, failed, colors, size=size)
    with atomic_path(path) as temporary:
        temporary.write_bytes(picture)


def render(
    families: Sequence[Family],
    meshes: Mapping[str, TriangleMesh],
    failed: Collection[str] = (),
    colors: Mapping[str, Color] | None = None,
    *,
    size: tuple[int, int] = SIZE,
) -> bytes:
    """The bytes of a PNG; see `write_preview`.

    Raises
    ------
    OutputError
        There is nothing to show, or this machine cannot render.
    """
    pieces = placed(families, meshes, frozenset(failed), colors or {})
    if not pieces:
        raise OutputError("no parts to render")
    return drawn(_rendered, pieces, size)


def preview_png(
    families: Sequence[Family],
    colors: Mapping[str, Color] | None = None,
    *,
    size: tuple[int, int] = SIZE,
) -> bytes:
    """A PNG of parts that are only specs yet, for notebooks; loads no CAD kernel.

    Raises
    ------
    OutputError
        As `render`.
    """
    from fabrication.solids import mesh_of

    meshes = {f.number: mesh_of(f.shape, NOTEBOOK_CHORD) for f in families}
    return render(families, meshes, colors=colors, size=size)


def camera(points: Floats, size: tuple[int, int] = SIZE) -> View:
    """The view in which all (n, 3) points fit the picture.

    Looks along the model's broad side turned by a third of a right angle, from 28 degrees up, and
    from higher for a model that is nearly flat.
    """
    low, high = points.min(axis=0), points.max(axis=0)
    centered = points - (low + high) / 2
    width = float(np.linalg.norm((high - low)[:2]))
    flat = float(high[2] - low[2]) < _FLAT * width
    rise = np.radians(ELEVATION_DEG * (1.6 if flat else 1.0))
    # The long axis in plan; the eye stands on the side that faces the reader (towards -y, +x).
    _, axes = np.linalg.eigh(centered[:, :2].T @ centered[:, :2])
    along = axes[:, 1] * (1.0 if axes[0, 1] >= 0 else -1.0)
    turn = np.arctan2(along[1], along[0]) - np.pi / 2 + np.radians(30.0)
    back = np.array(
        [np.cos(rise) * np.cos(turn), np.cos(rise) * np.sin(turn), np.sin(rise)]
    )  # from the model to the eye
    right = np.array([-np.sin(turn), np.cos(turn), 0.0])
    up = np.cross(back, right)
    tangent = np.tan(np.radians(FIELD_DEG) / 2) / _MARGIN
    middle, distance = (low + high) / 2, 0.0
    for _ in range(3):  # the picture's middle depends on the distance; converges at once
        seen = (points - middle) @ np.stack([right, up, back], axis=1)
        distance = max(
            float((np.abs(seen[:, 0]) / (tangent * size[0] / size[1]) + seen[:, 2]).max()),
            float((np.abs(seen[:, 1]) / tangent + seen[:, 2]).max()),
        )
        depth = distance - seen[:, 2]
        across, above = seen[:, 0] / depth, seen[:, 1] / depth
        middle = (
            middle
            + right * distance * (across.max() + across.min()) / 2
            + up * distance * (above.max() + above.min()) / 2
        )
    return View(middle + back * distance, middle, np.array([0.0, 0.0, 1.0]), FIELD_DEG)


def _rendered(pyvista: Any, pieces: Sequence[PlacedMesh], size: tuple[int, int]) -> bytes:
    """Draw model, shadow and close-up off-screen and return the PNG."""
    ground = _ground(joined(pieces))
    view = camera(np.concatenate([*(p.vertices for p in pieces), ground[0]]), size)
    near = closeup(pieces, view.position)
    node = _width_seen(near, view, size) / size[0] if near else 1.0
    fine = (size[0] * _SAMPLES, size[1] * _SAMPLES)
    scene = _far_scene(pyvista, pieces, size) if node < _FINE else _near_scene(pyvista, pieces)
    model = _shot(pyvista, scene, view, fine)
    flat = {"color": "black", "lighting": False}
    shade = _shot(pyvista, [(_poly_data(pyvista, *ground), flat)], view, size)
    if near is None or node > NODE_SEEN:
        return png(compose(model, shade, size))
    detail = _near_scene(pyvista, near.pieces)

    def lens(diameter: int) -> Pixels:
        return _shot(pyvista, detail, near.view, (diameter * _SAMPLES, diameter * _SAMPLES))

    return png(compose(model, shade, size, lens, _pixel(view, near.middle, size)))


def _shot(
    pyvista: Any, actors: Sequence[tuple[Any, dict[str, Any]]], view: View, size: tuple[int, int]
) -> Pixels:
    """One picture of (mesh, look) pairs on white, (height, width, 3)."""
    plotter = pyvista.Plotter(off_screen=True, window_size=list(size), lighting="none")
    try:
        plotter.set_background("white")
        plotter.disable_anti_aliasing()  # drawn finer instead, which costs half as much
        for mesh, look in actors:
            plotter.add_mesh(mesh, **look)
        right, up, back = _axes(view)
        for (x, y, z), strength in _LIGHTS:
            light = pyvista.Light(light_type="scene light", intensity=strength)
            light.positional = False
            light.position = tuple(view.focus + x * right + y * up + z * back)
            light.focal_point = tuple(view.focus)
            plotter.add_light(light)
        plotter.camera.position = tuple(view.position)
        plotter.camera.focal_point = tuple(view.focus)
        plotter.camera.up = tuple(view.up)
        plotter.camera.view_angle = view.field_deg
        plotter.reset_camera_clipping_range()
        return np.asarray(plotter.screenshot(return_img=True), dtype=np.uint8)
    finally:
        plotter.close()


def _far_scene(
    pyvista: Any, pieces: Sequence[PlacedMesh], size: tuple[int, int]
) -> list[tuple[Any, dict[str, Any]]]:
    """Meshes and looks of parts that are hardly wider than a pixel: nodes are dots."""
    actors = []
    for (kind, failed), (vertices, triangles) in merged(pieces).items():
        mesh = _poly_data(pyvista, vertices, triangles)
        actors.append((mesh, _appearance(kind, failed, _GLASS)))
        if kind.form == "bar":  # at least a pixel wide, also where a thin one is seen from its edge
            line = {"style": "wireframe", "line_width": _SAMPLES, "lighting": False}
            ink = [_LINE * channel for channel in _color(kind, failed)]
            actors.append((mesh, {"color": ink, **line}))
        if kind.form == "joint":
            dots = [p.vertices.mean(axis=0) for p in pieces if (p.kind, p.failed) == (kind, failed)]
            cloud = pyvista.PolyData(np.array(dots, dtype=np.float32))
            width = _DOT * _SAMPLES * size[0] / SIZE[0]
            dot = {"point_size": width, "render_points_as_spheres": True, "lighting": False}
            actors.append((cloud, {"color": _color(kind, failed), **dot}))
    return actors


def _near_scene(pyvista: Any, pieces: Sequence[PlacedMesh]) -> list[tuple[Any, dict[str, Any]]]:
    """Meshes and looks of parts that are seen large: with drawn edges."""
    actors = []
    for (kind, failed), (vertices, triangles) in merged(pieces).items():
        mesh = _poly_data(pyvista, vertices, triangles)
        actors.append((mesh, _appearance(kind, failed, _GLASS_NEAR)))
        edges = mesh.clean().extract_feature_edges(
            _CREASE_DEG, non_manifold_edges=False, manifold_edges=False
        )
        dark = 0.55 if kind.finish == "glass" else 0.35
        ink = [dark * channel for channel in _color(kind, failed)]
        actors.append((edges, {"color": ink, "line_width": 1.5 * _SAMPLES, "lighting": False}))
    return actors


def _color(kind: Kind, failed: bool) -> Color:
    """The color in which pieces of a kind are shown, or those that failed a check."""
    return FAILED_COLOR if failed else kind.shown or kind.color


def _appearance(kind: Kind, failed: bool, glass: float) -> dict[str, Any]:
    """Arguments of `add_mesh` for pieces of a kind; panes are seen through."""
    pane = {"opacity": glass, "culling": "back"} if kind.finish == "glass" else {}
    look = _FAILED if failed else _LOOK[kind.finish]
    return {"color": _color(kind, failed), "smooth_shading": False, **look, **pane}


def _poly_data(pyvista: Any, vertices: Floats, triangles: Ints) -> Any:
    """A PolyData of triangles."""
    faces = np.hstack([np.full((len(triangles), 1), 3), triangles])
    return pyvista.PolyData(vertices.astype(np.float32), faces.ravel())


def _ground(model: tuple[Floats, Ints]) -> tuple[Floats, Ints]:
    """All parts flattened on the ground a little below the model: the shadow of a high sun."""
    vertices, triangles = model[0].copy(), model[1]
    low, high = vertices[:, 2].min(), vertices[:, 2].max()
    vertices[:, 2] = low - _DROP * (high - low)
    return vertices, triangles


def _axes(view: View) -> tuple[Floats, Floats, Floats]:
    """Unit vectors to the right, up and back to the eye."""
    back = view.position - view.focus
    back = back / np.linalg.norm(back)
    right = np.cross(view.up, back)
    right = right / np.linalg.norm(right)
    return right, np.cross(back, right), back


def _pixel(view: View, point: Floats, size: tuple[int, int]) -> tuple[float, float]:
    """Where a point is in the picture, from its upper left corner."""
    right, up, back = _axes(view)
    seen = point - view.position
    scale = size[1] / 2 / np.tan(np.radians(view.field_deg) / 2) / -float(seen @ back)
    return size[0] / 2 + scale * float(seen @ right), size[1] / 2 - scale * float(seen @ up)


def _width_seen(near: Closeup, view: View, size: tuple[int, int]) -> float:
    """Pixels across the node of the close-up in the whole picture."""
    right, _, _ = _axes(view)
    half = near.radius / REACH * right
    return _pixel(view, near.middle + half, size)[0] - _pixel(view, near.middle - half, size)[0]
