"""A picture of how far a mesh has moved: colors on its faces, with a scale in millimetres."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Final

import numpy as np

from ddgfab.errors import OutputError
from ddgfab.io.atomic import atomic_path
from ddgfab.mesh import Floats, Mesh
from fabrication.pictures.preview import ADVICE, camera
from fabrication.pictures.sheet import png

SIZE: Final = (1600, 1000)
"""Pixels across and down."""

COLORS: Final = "viridis"
"""Scale of colors: even to the eye, also in print and to the color-blind."""


WHOLE_MM: Final = 100.0
"""From this movement [mm] on the scale shows whole millimetres."""


def write_deviation(
    path: Path, mesh: Mesh, movement: Floats, *, size: tuple[int, int] = SIZE
) -> None:
    """Render a mesh colored by the movement of its vertices to a PNG (atomically).

    Parameters
    ----------
    mesh : after the movement [mm]
    movement : (V,) distance [mm] of each vertex from where it was
    size : pixels across and down

    Raises
    ------
    OutputError
        The file cannot be written, or this machine cannot render; names the packages to install.
    """
    try:
        import pyvista

        with pyvista.vtk_verbosity("off"):
            picture = _rendered(pyvista, mesh, movement, size)
    except ImportError as error:
        raise OutputError(f"rendering needs pyvista: pip install pyvista ({error})") from error
    except (RuntimeError, OSError, AttributeError) as error:
        raise OutputError(f"this machine cannot render ({error}){ADVICE}") from error
    with atomic_path(path) as temporary:
        temporary.write_bytes(picture)


def _rendered(pyvista: Any, mesh: Mesh, movement: Floats, size: tuple[int, int]) -> bytes:
    faces = np.concatenate([np.concatenate([[len(face)], face]) for face in mesh.faces])
    surface = pyvista.PolyData(mesh.vertices.astype(np.float32), faces)
    surface.point_data["movement [mm]"] = movement
    top = float(movement.max())
    plotter = pyvista.Plotter(off_screen=True, window_size=list(size))
    try:
        plotter.set_background("white")
        plotter.enable_anti_aliasing("ssaa")
        plotter.add_mesh(
            surface,
            scalars="movement [mm]",
            cmap=COLORS,
            clim=(0.0, top if top > 0 else 1.0),
            show_edges=True,
            edge_color=(0.25, 0.25, 0.25),
            ambient=0.5,
            diffuse=0.55,
            scalar_bar_args={
                "color": "black",
                "n_labels": 5,
                "fmt": "%.0f" if top >= WHOLE_MM else "%.3g",
                "title_font_size": 20,
                "label_font_size": 20,
                "vertical": True,
                "position_x": 0.9,
                "position_y": 0.5,
                "width": 0.05,
                "height": 0.42,
            },
        )
        view = camera(mesh.vertices, size)
        plotter.camera.position = tuple(view.position)
        plotter.camera.focal_point = tuple(view.focus)
        plotter.camera.up = tuple(view.up)
        plotter.camera.view_angle = view.field_deg * 1.15  # room for the scale
        plotter.reset_camera_clipping_range()
        return png(np.asarray(plotter.screenshot(return_img=True), dtype=np.uint8))
    finally:
        plotter.close()
