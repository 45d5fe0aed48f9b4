"""A picture of an optimization: the input, and the result with its distance and creases."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Final

import numpy as np

from ddgfab.errors import OutputError
from ddgfab.io.atomic import atomic_path
from ddgfab.mesh import Ints, Mesh
from ddgfab.optimize import Change
from fabrication.pictures.preview import ADVICE, camera
from fabrication.pictures.sheet import png

SIZE: Final = (2000, 900)
"""Pixels across and down, of input and result side by side."""

COLORS: Final = "viridis"
"""Scale of colors: even to the eye, also in print and to the color-blind."""

CREASE_DEG: Final = 10.0
"""Edges whose dihedral angle changed by more [deg] are drawn as creases."""

_CREASE_COLOR: Final = (0.85, 0.1, 0.1)
_PLAIN: Final = (0.82, 0.84, 0.86)
_WHOLE_MM: Final = 100.0
"""From this distance [mm] on the scale shows whole millimetres."""


def write_change(path: Path, change: Change, *, size: tuple[int, int] = SIZE) -> None:
    """Render the input, and beside it the result colored by its distance from the surface [mm].

    Edges that became creases are drawn thick. Written atomically as PNG.

    Raises
    ------
    OutputError
        The file cannot be written, or this machine cannot render; says what to install.
    """
    try:
        import pyvista

        with pyvista.vtk_verbosity("off"):
            picture = _rendered(pyvista, change, size)
    except ImportError as error:
        raise OutputError(f"rendering needs pyvista: pip install pyvista ({error})") from error
    except (RuntimeError, OSError, AttributeError) as error:
        raise OutputError(f"this machine cannot render ({error}){ADVICE}") from error
    with atomic_path(path) as temporary:
        temporary.write_bytes(picture)


def _surface(pyvista: Any, mesh: Mesh) -> Any:
    faces = np.insert(mesh.corners, mesh.face_start[:-1], mesh.face_sizes)
    return pyvista.PolyData(mesh.vertices.astype(np.float64), faces)


def _lines(pyvista: Any, mesh: Mesh, edges: Ints) -> Any:
    ends = mesh.edges[edges]
    cells = np.column_stack([np.full(len(ends), 2), ends]).ravel()
    return pyvista.PolyData(mesh.vertices.astype(np.float64), lines=cells)


def _rendered(pyvista: Any, change: Change, size: tuple[int, int]) -> bytes:
    plotter = pyvista.Plotter(off_screen=True, window_size=list(size), shape=(1, 2), border=False)
    view = camera(change.before.vertices, (size[0] // 2, size[1]))
    shade = {"show_edges": True, "edge_color": (0.25, 0.25, 0.25), "ambient": 0.35, "diffuse": 0.65}
    try:
        for column, mesh in enumerate((change.before, change.after)):
            plotter.subplot(0, column)
            plotter.set_background("white")
            surface = _surface(pyvista, mesh)
            if column == 0:
                plotter.add_mesh(surface, color=_PLAIN, **shade)
            else:
                _add_result(pyvista, plotter, change, surface, shade)
            plotter.camera.position = tuple(view.position)
            plotter.camera.focal_point = tuple(view.focus)
            plotter.camera.up = tuple(view.up)
            plotter.camera.view_angle = view.field_deg * 1.25  # room for the scale below
            plotter.camera.SetWindowCenter(0.0, -0.1)
            plotter.reset_camera_clipping_range()
        return png(np.asarray(plotter.screenshot(return_img=True), dtype=np.uint8))
    finally:
        plotter.close()


def _add_result(
    pyvista: Any, plotter: Any, change: Change, surface: Any, shade: dict[str, Any]
) -> None:
    title = "distance [mm]"
    surface.point_data[title] = change.from_surface
    top = float(change.from_surface.max())
    plotter.add_mesh(
        surface,
        scalars=title,
        cmap=COLORS,
        clim=(0.0, top if top > 0 else 1.0),
        scalar_bar_args={
            "color": "black",
            "n_labels": 4,
            "title": f"{title}\n ",  # an empty line between the title and the labels
            "fmt": "%.0f" if top >= _WHOLE_MM else "%.3g",
            "title_font_size": 20,
            "label_font_size": 20,
            "vertical": False,  # below the model, which may reach to the right margin
            "position_x": 0.25,
            "position_y": 0.02,
            "width": 0.5,
            "height": 0.07,
        },
        **shade,
    )
    creased = np.flatnonzero(np.degrees(change.creases) > CREASE_DEG)
    if len(creased):
        lines = _lines(pyvista, change.after, creased)
        plotter.add_mesh(lines, color=_CREASE_COLOR, line_width=4)
