"""Pictures of meshes side by side, colored by numbers at vertices or faces, with marked points."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np

from ddgfab.io.atomic import atomic_path
from ddgfab.mesh import Floats, Ints, Mesh
from fabrication.pictures.apart import drawn
from fabrication.pictures.preview import camera
from fabrication.pictures.sheet import png
from fabrication.specs import Color

SIZE: Final = (2000, 900)
"""Pixels across and down, of all meshes side by side."""

EVEN: Final = "viridis"
"""Scale of colors from nothing to much: even to the eye, also in print."""
BOTH_SIDES: Final = "coolwarm"
"""Scale of colors from one side to the other, gray between."""

_PLAIN: Final = (0.82, 0.84, 0.86)
_MARK: Final = (0.85, 0.1, 0.1)
_MARK_PART: Final = 0.012
"""Radius of a mark, as a part of the size of the mesh."""
_WHOLE: Final = 100.0
"""From this value on the scale shows whole numbers."""


@dataclass(frozen=True, eq=False)
class FieldPlot:
    """A mesh of a picture.

    Attributes
    ----------
    values : a number a vertex (V,), a number a face (F,), or None: plain
    title : of the scale, with the unit
    span : least and greatest number of the scale; by default 0 to the greatest, or both sides
        alike where there are negative ones
    marks : (k, 3) points that are shown as balls, with their captions
    lines : ids of edges that are drawn thick, in `line_color`
    """

    mesh: Mesh
    values: Floats | None = None
    title: str = ""
    span: tuple[float, float] | None = None
    marks: Floats | None = None
    captions: tuple[str, ...] = ()
    lines: Ints | None = None
    line_color: Color = (0.0, 0.0, 0.0)


def write_panels(path: Path, panels: Sequence[FieldPlot], *, size: tuple[int, int] = SIZE) -> None:
    """Render meshes side by side, all from the same side. Written atomically as PNG.

    Raises
    ------
    OutputError
        The file cannot be written, or this machine cannot render; says what to install.
    """
    picture = drawn(_rendered, panels, size)
    with atomic_path(path) as temporary:
        temporary.write_bytes(picture)


def _rendered(pyvista: Any, panels: Sequence[FieldPlot], size: tuple[int, int]) -> bytes:
    plotter = pyvista.Plotter(
        off_screen=True, window_size=list(size), shape=(1, len(panels)), border=False
    )
    view = camera(panels[0].mesh.vertices, (size[0] // len(panels), size[1]))
    try:
        for column, panel in enumerate(panels):
            plotter.subplot(0, column)
            plotter.set_background("white")
            _add(pyvista, plotter, panel)
            plotter.camera.position = tuple(view.position)
            plotter.camera.focal_point = tuple(view.focus)
            plotter.camera.up = tuple(view.up)
            plotter.camera.view_angle = view.field_deg * 1.25  # room for the scale below
            plotter.camera.SetWindowCenter(0.0, -0.1)
            plotter.reset_camera_clipping_range()
        return png(np.asarray(plotter.screenshot(return_img=True), dtype=np.uint8))
    finally:
        plotter.close()


def _add(pyvista: Any, plotter: Any, panel: FieldPlot) -> None:
    mesh = panel.mesh
    faces = np.insert(mesh.corners, mesh.face_start[:-1], mesh.face_sizes)
    surface = pyvista.PolyData(mesh.vertices.astype(np.float64), faces)
    shade = {"show_edges": True, "edge_color": (0.25, 0.25, 0.25), "ambient": 0.35, "diffuse": 0.65}
    if panel.values is None:
        plotter.add_mesh(surface, color=_PLAIN, **shade)
    else:
        low, high = _span(panel)
        data = surface.point_data if len(panel.values) == mesh.n_vertices else surface.cell_data
        data[panel.title] = panel.values
        plotter.add_mesh(
            surface,
            scalars=panel.title,
            cmap=BOTH_SIDES if low < 0 else EVEN,
            clim=(low, high),
            nan_color=_PLAIN,
            scalar_bar_args={
                "color": "black",
                "n_labels": 4,
                "title": f"{panel.title}\n ",  # an empty line between the title and the labels
                "fmt": "%.0f" if max(abs(low), abs(high)) >= _WHOLE else "%.3g",
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
    if panel.lines is not None and len(panel.lines):
        ends = mesh.edges[panel.lines]
        cells = np.column_stack([np.full(len(ends), 2), ends]).ravel()
        thick = pyvista.PolyData(mesh.vertices.astype(np.float64), lines=cells)
        plotter.add_mesh(thick, color=panel.line_color, line_width=4)
    if panel.marks is not None and len(panel.marks):
        for point in panel.marks:
            ball = pyvista.Sphere(radius=_MARK_PART * mesh.diameter, center=point)
            plotter.add_mesh(ball, color=_MARK, ambient=0.4)
        if panel.captions:
            plotter.add_point_labels(
                panel.marks,
                list(panel.captions),
                font_size=22,
                text_color="black",
                shape_color="white",
                shape_opacity=0.8,
                show_points=False,
                always_visible=True,
            )


def _span(panel: FieldPlot) -> tuple[float, float]:
    if panel.span is not None:
        return panel.span
    values = np.asarray(panel.values)[np.isfinite(np.asarray(panel.values))]
    top = float(np.abs(values).max(initial=0.0))
    top = top if top > 0 else 1.0
    return (-top, top) if (values < 0).any() else (0.0, top)
