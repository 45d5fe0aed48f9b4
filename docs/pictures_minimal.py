"""Pictures of docs/minimal.md: minimal surfaces beside circle patterns and Koebe polyhedra.

python docs/pictures_minimal.py [NAME ...]
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

from ddgfab.circles import Circles
from ddgfab.mesh import Floats, Mesh
from ddgfab.nets import SIsothermic, piece
from ddgfab.nets.koebe import KoebePolyhedron, koebe
from ddgfab.nets.koebe.solids import dual_solid, goldberg, triangle_cells
from ddgfab.nets.minimal import (
    MinimalNet,
    catenoid,
    enneper,
    helicoid,
    scherk,
    schwarz_d,
    schwarz_p_cell,
)
from ddgfab.nets.minimal.periodic import scherk_koebe, schwarz_koebe

FOLDER = Path(__file__).parent / "minimal"
PANEL = (320, 330)
GLASS, BACK, LINE, WARM, PALE = "#bcd9dc", "#6f8c90", "#39434f", "#b4552d", "#f1ede4"
STYLE = {"ambient": 0.45, "diffuse": 0.6, "specular": 0.1}
VIEW = np.array([0.45, -1.0, 0.5])
Mask = NDArray[np.bool_]

# Name: the surface; the Koebe polyhedron and which of its faces are dualised (None: the surface's
# own Gauss image); the view.
Whole = Callable[[], tuple[KoebePolyhedron, Mask]]
GALLERY: dict[str, tuple[Callable[[], MinimalNet], Whole | None, tuple[float, float, float]]] = {
    "enneper": (lambda: enneper((12, 12), 1.1 / 12), None, (0.6, -1.0, 0.55)),
    "catenoid": (lambda: catenoid(20, (-4, 4)), None, (0.45, -1.0, 0.5)),
    "helicoid": (lambda: helicoid(20, (-4, 4), 24), None, (0.25, -1.0, 0.3)),
    "scherk": (lambda: scherk(10, 3), lambda: upper(scherk_koebe(10)), (0.6, -1.0, 0.3)),
    "schwarz_p": (lambda: schwarz_p_cell(6).net, lambda: all_of(schwarz_koebe(6)), (1.0, 0.6, 0.5)),
    "schwarz_d": (lambda: schwarz_d(8), lambda: top(schwarz_koebe(8)), (0.9, -0.7, 0.5)),
}


def upper(solid: KoebePolyhedron) -> tuple[KoebePolyhedron, Mask]:
    """With the quads above the equator."""
    return solid, (solid.mesh.face_centers[:, 2] > 0) & (solid.mesh.face_sizes == 4)


def all_of(solid: KoebePolyhedron) -> tuple[KoebePolyhedron, Mask]:
    """With all faces."""
    return solid, np.ones(solid.mesh.n_faces, dtype=bool)


def top(solid: KoebePolyhedron) -> tuple[KoebePolyhedron, Mask]:
    """With the last side of a cube."""
    return solid, np.arange(solid.mesh.n_faces) * 6 >= 5 * solid.mesh.n_faces


def surface(mesh: Mesh) -> Any:
    """The mesh as pyvista draws it."""
    import pyvista

    faces = np.insert(mesh.corners, mesh.face_start[:-1], mesh.face_sizes)
    return pyvista.PolyData(mesh.vertices, faces=faces)


def rings(circles: Circles) -> Floats:
    """Segments (2 K, 3) of circles."""
    points = circles.points(40)
    return np.stack([points, np.roll(points, -1, axis=1)], axis=2).reshape(-1, 3)


def lit(show: Any) -> None:
    """White ground and three lights."""
    import pyvista

    show.set_background("white")
    for direction, strength in (((-0.6, -0.8, 1.5), 0.75), ((1.0, 0.2, 0.5), 0.35)):
        show.add_light(
            pyvista.Light(position=direction, intensity=strength, light_type="scene light")
        )
    show.add_light(pyvista.Light(light_type="headlight", intensity=0.25))


def frame(show: Any, points: Floats, towards: Floats, aspect: float) -> None:
    """A long lens that holds all points, in the middle of the picture."""
    towards = towards / np.linalg.norm(towards)
    right = np.cross([0.0, 0.0, 1.0], towards)
    right /= np.linalg.norm(right)
    up = np.cross(towards, right)
    flat = points @ np.stack([right, up], axis=1)
    middle = 0.5 * (flat.min(axis=0) + flat.max(axis=0))
    half = 0.5 * np.ptp(flat, axis=0) * 1.1
    camera = show.camera
    camera.view_angle = 20.0
    focus = right * middle[0] + up * middle[1] + towards * (points @ towards).mean()
    reach = max(half[1], half[0] / aspect) / np.tan(np.radians(10.0))
    camera.focal_point = focus
    camera.position = focus + towards * (reach + 0.5 * np.ptp(points @ towards))
    camera.up = (0.0, 0.0, 1.0)
    show.reset_camera_clipping_range()


def draw_mesh(show: Any, mesh: Mesh, towards: Floats, color: str = GLASS) -> None:
    """Faces and, a little nearer to the eye, edges."""
    import pyvista

    show.add_mesh(surface(mesh), color=color, backface_params={"color": BACK}, **STYLE)
    ahead = 0.004 * mesh.diameter * towards / np.linalg.norm(towards)
    lines = pyvista.line_segments_from_points((mesh.vertices + ahead)[mesh.edges].reshape(-1, 3))
    show.add_mesh(lines, color=LINE, line_width=1.3, lighting=False)


def draw_circles(show: Any, net: SIsothermic, towards: Floats, *, filled: bool) -> None:
    """Incircles in one color, circles of the vertices in another, on the unit sphere."""
    import pyvista

    ahead = 0.004 * towards / np.linalg.norm(towards)
    if filled:
        ball = pyvista.Sphere(radius=0.985, theta_resolution=90, phi_resolution=90)
        show.add_mesh(ball, color=PALE, lighting=False)
    pairs = [(net.incircles, LINE, 1.3)]
    if net.vertex_circles is not None:
        pairs.append((net.vertex_circles, WARM, 1.0))
    for circles, color, width in pairs:
        lines = pyvista.line_segments_from_points(rings(circles) * 1.001 + ahead)
        show.add_mesh(lines, color=color, line_width=width, lighting=False)


def panel(draw: Callable[[Any], None], points: Floats, towards: Floats) -> Any:
    """One drawing as an image: three lights, a long lens that holds the points."""
    import pyvista
    from PIL import Image

    show = pyvista.Plotter(off_screen=True, window_size=PANEL, lighting="none")
    lit(show)
    draw(show)
    frame(show, points, towards, PANEL[0] / PANEL[1])
    show.enable_anti_aliasing("ssaa")
    image = show.screenshot(None, return_img=True)
    show.close()
    return Image.fromarray(image)


def finished(panels: list[Any], name: str) -> Path:
    """Panels side by side as a file with few colors, so that it stays small."""
    from PIL import Image

    whole = Image.new("RGB", (PANEL[0] * len(panels), PANEL[1]), "white")
    for k, image in enumerate(panels):
        whole.paste(image, (PANEL[0] * k, 0))
    target = FOLDER / f"{name}.png"
    FOLDER.mkdir(exist_ok=True)
    whole.quantize(128).save(target, optimize=True)
    return target


def picture(name: str) -> Path:
    """Circle pattern, Koebe polyhedron (what is dualised in color), minimal surface."""
    make, whole, view = GALLERY[name]
    net, towards = make(), np.array(view)
    ball = np.array([*np.eye(3), *-np.eye(3)])
    if whole is None:
        solid, mesh, mask = net.gauss, net.gauss.mesh, None
    else:
        polyhedron, mask = whole()
        solid, mesh = polyhedron.net(), polyhedron.mesh

    def polyhedron_drawing(show: Any) -> None:
        if mask is not None and not mask.all():
            draw_mesh(show, piece(mesh, ~mask).mesh, VIEW, PALE)
        draw_mesh(show, mesh if mask is None else piece(mesh, mask).mesh, VIEW)

    return finished(
        [
            panel(lambda show: draw_circles(show, solid, VIEW, filled=True), ball, VIEW),
            panel(polyhedron_drawing, ball, VIEW),
            panel(lambda show: draw_mesh(show, net.mesh, towards), net.mesh.vertices, towards),
        ],
        name,
    )


def polyhedra() -> Path:
    """Three polyhedra with both packings of circles."""
    points = np.random.default_rng(11).normal(size=(70, 3))
    points /= np.linalg.norm(points, axis=1)[:, None]
    triangles = ConvexHull(points).simplices.astype(np.int64)
    out = np.linalg.det(points[triangles]) < 0
    triangles[out] = triangles[out][:, ::-1]
    panels = []
    for rough in (
        goldberg(3),
        triangle_cells("octahedron", 4),
        dual_solid(Mesh.build(points, triangles)),
    ):
        solid = koebe(rough).aligned(rough.vertices)

        def drawing(show: Any, solid: KoebePolyhedron = solid) -> None:
            draw_mesh(show, solid.mesh, VIEW)
            draw_circles(show, solid.net(), 8 * VIEW, filled=False)

        panels.append(panel(drawing, solid.mesh.vertices, VIEW))
    return finished(panels, "polyhedra")


def main() -> None:
    """Draw the pictures named, or all."""
    for name in sys.argv[1:] or ["polyhedra", *GALLERY]:
        path = polyhedra() if name == "polyhedra" else picture(name)
        sys.stdout.write(f"{path.name}: {path.stat().st_size // 1024} kB\n")


if __name__ == "__main__":
    main()
