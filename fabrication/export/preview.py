"""preview.png: the structure from three quarters above, glass translucent, without a display."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np

from ddgfab.errors import OutputError
from ddgfab.io.atomic import atomic_path
from ddgfab.mesh import Floats, Ints
from fabrication.export.step import COLOURS, FAILED, GROUPS
from fabrication.specs import Family, TriangleMesh

SIZE: Final = (1600, 1000)
"""Pixels across and down."""

ELEVATION_DEG: Final = 28.0
"""Height of the camera above the horizon [deg]."""

FIELD_DEG: Final = 26.0
"""Vertical field of view [deg]: long enough a lens that straight members look straight."""

GLASS: Final = 0.32
"""Opacity of a pane; its far side is not drawn."""

NOTEBOOK_CHORD: Final = 0.5
"""Chord tolerance [mm] of meshes that are made only to be looked at."""

_LOOK: Final[dict[str, dict[str, float]]] = {
    "beam": {"ambient": 0.28, "diffuse": 0.75, "specular": 0.25, "specular_power": 20},
    "node": {"ambient": 0.45, "diffuse": 0.80, "specular": 0.30, "specular_power": 20},
    "panel": {"ambient": 0.50, "diffuse": 0.55, "specular": 0.35, "specular_power": 40},
    FAILED: {"ambient": 0.45, "diffuse": 0.70, "specular": 0.10, "specular_power": 10},
}
_PANE: Final = (0.42, 0.76, 0.78)  # deeper than the role's colour, as it is mixed with white
_MARGIN: Final = 1.06  # how much wider than the model the picture is
_FLAT: Final = 0.08  # a model lower than this part of its width is looked at from higher up
_DROP: Final = 0.02  # how far the ground lies below the model, as a part of its height
_SHADOW: Final = 0.86  # grey of the ground where the sun does not reach, 1 is white
_ADVICE: Final = "; on Linux without a display VTK needs libEGL or libOSMesa (apt install libegl1)"


def write_preview(
    path: Path,
    families: Sequence[Family],
    meshes: Mapping[str, TriangleMesh],
    failed: Collection[str] = (),
    *,
    size: tuple[int, int] = SIZE,
) -> None:
    """Render the placed parts to a PNG (atomically).

    Parameters
    ----------
    families : part numbers with their instances
    meshes : by part number, the mesh in the part's frame [mm]
    failed : marks of pieces that are shown in red
    size : pixels across and down

    Raises
    ------
    OutputError
        The file cannot be written, or this machine cannot render; says what to install.
    """
    picture = render(families, meshes, failed, size=size)
    with atomic_path(path) as temporary:
        temporary.write_bytes(picture)


def render(
    families: Sequence[Family],
    meshes: Mapping[str, TriangleMesh],
    failed: Collection[str] = (),
    *,
    size: tuple[int, int] = SIZE,
) -> bytes:
    """The bytes of a PNG; see `write_preview`.

    Raises
    ------
    OutputError
        There is nothing to show, or this machine cannot render.
    """
    merged = merged_by_look(families, meshes, failed)
    if not merged:
        raise OutputError("no parts to render")
    try:
        import pyvista

        with pyvista.vtk_verbosity(
            "off"
        ):  # it grumbles about a missing X server, then does without
            return _rendered(pyvista, merged, size)
    except ImportError as error:
        raise OutputError(f"rendering needs pyvista: pip install pyvista ({error})") from error
    except (RuntimeError, OSError, AttributeError) as error:
        raise OutputError(f"this machine cannot render ({error}){_ADVICE}") from error


def preview_png(families: Sequence[Family]) -> bytes:
    """A PNG of parts that are only specs yet, for notebooks; loads no CAD kernel.

    Raises
    ------
    OutputError
        As `render`.
    """
    from fabrication.solids import mesh_of

    return render(families, {f.number: mesh_of(f.shape, NOTEBOOK_CHORD) for f in families})


def merged_by_look(
    families: Sequence[Family], meshes: Mapping[str, TriangleMesh], failed: Collection[str] = ()
) -> dict[str, tuple[Floats, Ints]]:
    """Placed vertices and triangles of all pieces that look the same, by role or "failed"."""
    pieces: dict[str, list[tuple[Floats, Ints]]] = {look: [] for look in (*GROUPS, FAILED)}
    for family in families:
        mesh = meshes[family.number]
        for instance in family.instances:
            look: str = FAILED if instance.mark in failed else family.role
            motion = instance.placement
            placed = mesh.vertices @ motion[:3, :3].T + motion[:3, 3]
            pieces[look].append((placed, mesh.triangles))
    merged: dict[str, tuple[Floats, Ints]] = {}
    for look, parts in pieces.items():
        if parts:
            sizes = [len(vertices) for vertices, _ in parts]
            shift = np.repeat(np.cumsum([0, *sizes[:-1]]), [len(t) for _, t in parts])
            triangles = np.concatenate([t for _, t in parts]) + shift[:, None]
            merged[look] = (np.concatenate([v for v, _ in parts]), triangles)
    return merged


def camera(points: Floats, size: tuple[int, int] = SIZE) -> tuple[Floats, Floats, Floats]:
    """Position, focal point and up vector from which all (n, 3) points fit the picture.

    Looks along the model's broad side turned by a third of a right angle, from 28 degrees up, and
    from higher for a model that is nearly flat.
    """
    low, high = points.min(axis=0), points.max(axis=0)
    centred = points - (low + high) / 2
    width = float(np.linalg.norm((high - low)[:2]))
    flat = float(high[2] - low[2]) < _FLAT * width
    rise = np.radians(ELEVATION_DEG * (1.6 if flat else 1.0))
    # The long axis in plan; the eye stands on the side that faces the reader (towards -y, +x).
    _, axes = np.linalg.eigh(centred[:, :2].T @ centred[:, :2])
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
    return middle + back * distance, middle, np.array([0.0, 0.0, 1.0])


def _rendered(pyvista: Any, merged: dict[str, tuple[Floats, Ints]], size: tuple[int, int]) -> bytes:
    """Draw the merged meshes off-screen and return the PNG."""
    import io

    from PIL import Image

    ground = _ground(merged)
    every = np.concatenate([vertices for vertices, _ in (*merged.values(), ground)])
    plotter = pyvista.Plotter(off_screen=True, window_size=list(size), lighting="none")
    try:
        plotter.set_background("white")
        plotter.enable_anti_aliasing("ssaa")
        for look, (vertices, triangles) in merged.items():
            plotter.add_mesh(
                _poly_data(pyvista, vertices, triangles),
                color=_PANE if look == "panel" else COLOURS[look],
                opacity=GLASS if look == "panel" else 1.0,
                culling="back" if look == "panel" else None,
                smooth_shading=False,
                **_LOOK[look],
            )
        if "beam" in merged:  # at least a pixel wide, also where a thin bar is seen from its edge
            plotter.add_mesh(
                _poly_data(pyvista, *merged["beam"]),
                color=COLOURS["beam"],
                style="wireframe",
                line_width=1,
                lighting=False,
            )
        plotter.add_mesh(_poly_data(pyvista, *ground), color=[_SHADOW] * 3, lighting=False)
        position, focus, up = camera(every, size)
        for offset, strength in (((0.9, -0.6, 1.6), 0.85), ((-1.2, -0.8, 0.6), 0.35)):
            light = pyvista.Light(light_type="scene light", intensity=strength)
            light.positional = False
            light.position = tuple(focus + np.linalg.norm(position - focus) * np.array(offset))
            light.focal_point = tuple(focus)
            plotter.add_light(light)
        plotter.camera.position = tuple(position)
        plotter.camera.focal_point = tuple(focus)
        plotter.camera.up = tuple(up)
        plotter.camera.view_angle = FIELD_DEG
        plotter.reset_camera_clipping_range()
        image = plotter.screenshot(return_img=True)
    finally:
        plotter.close()
    stream = io.BytesIO()
    Image.fromarray(np.asarray(image)).save(stream, format="PNG", optimize=False)
    return stream.getvalue()


def _poly_data(pyvista: Any, vertices: Floats, triangles: Ints) -> Any:
    """A PolyData of triangles."""
    faces = np.hstack([np.full((len(triangles), 1), 3), triangles])
    return pyvista.PolyData(vertices.astype(np.float32), faces.ravel())


def _ground(merged: dict[str, tuple[Floats, Ints]]) -> tuple[Floats, Ints]:
    """All parts flattened on the ground a little below the model: the shadow of a high sun."""
    vertices = np.concatenate([v for v, _ in merged.values()])
    counts = [len(v) for v, _ in merged.values()]
    starts = np.cumsum([0, *counts[:-1]])
    triangles = np.concatenate(
        [t + start for start, (_, t) in zip(starts, merged.values(), strict=True)]
    )
    low, high = vertices[:, 2].min(), vertices[:, 2].max()
    vertices[:, 2] = low - _DROP * (high - low)
    return vertices, triangles
