"""Pictures of docs/nets.md: every kind of net there at its defaults, drawn off-screen by pyvista.

python docs/make_pictures.py [KIND ...]
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from ddgfab.forms.registry import generate
from ddgfab.mesh import Floats, Ints, Mesh
from ddgfab.offsets import face_offset, vertex_offset

FOLDER = Path(__file__).parent / "nets"
SIZE = (560, 340)
OFFSETS = {"circular": vertex_offset, "conical": face_offset}
LIFT = 0.002
OFFSET_MM = 1000.0
# Towards the camera: right of the roof, behind its foot, above; chosen so that its shape shows.
VIEWS = {
    "canal": (0.35, -1.0, 0.55),
    "canopy": (0.6, 1.0, 0.55),
    "circular": (1.0, -0.25, 0.5),
    "conical": (0.45, -1.0, 0.5),
    "koebe": (0.3, -1.0, 0.35),
    "minimal": (0.35, -1.0, 0.45),
    "monge": (1.0, -0.25, 0.6),
    "moulding": (0.1, -1.0, 0.8),
    "rotational": (0.3, -1.0, 0.45),
    "translation": (0.55, -1.0, 0.5),
}


def surface(points: Floats, mesh: Mesh) -> object:
    """The mesh as pyvista draws it."""
    import pyvista

    sizes = mesh.face_sizes
    faces = np.insert(mesh.corners, mesh.face_start[:-1], sizes)
    return pyvista.PolyData(points, faces=faces)


def picture(kind: str) -> Path:
    """Draw one kind; circular and conical nets with their offset and the node axes between."""
    import pyvista

    mesh = generate(kind)
    show = pyvista.Plotter(off_screen=True, window_size=SIZE, lighting="none")
    show.set_background("white")
    for direction, strength in (((-0.6, -0.8, 1.5), 0.75), ((1.0, 0.2, 0.5), 0.35)):
        show.add_light(
            pyvista.Light(position=direction, intensity=strength, light_type="scene light")
        )
    towards = np.array(VIEWS.get(kind, (0.4, -1.0, 0.55)))
    towards /= np.linalg.norm(towards)
    ahead = LIFT * mesh.diameter * towards  # lines stand clear of the faces that they bound
    show.add_light(pyvista.Light(light_type="headlight", intensity=0.25))
    style = {"ambient": 0.45, "diffuse": 0.6, "specular": 0.1}
    show.add_mesh(
        surface(mesh.vertices, mesh), color="#bcd9dc", backface_params={"color": "#6f8c90"}, **style
    )
    wires(show, mesh.vertices + ahead, mesh.edges, "#39434f", 2.0)
    if kind in OFFSETS:
        moved = OFFSETS[kind](mesh, OFFSET_MM).vertices
        half = part(mesh)
        show.add_mesh(surface(moved, half), color="#e2a26f", opacity=0.3, **style)
        wires(show, moved + ahead, half.edges, "#b4552d", 1.5)
        ends = np.stack([mesh.vertices, moved], axis=1)[np.unique(half.corners)].reshape(-1, 3)
        wires(show, ends, np.arange(len(ends)).reshape(-1, 2), "#b4552d", 1.5)
        frame(show, np.concatenate([mesh.vertices, moved]), towards)
    else:
        frame(show, mesh.vertices, towards)
    show.enable_anti_aliasing("ssaa")
    target = FOLDER / f"{kind}.png"
    show.screenshot(target)
    show.close()
    return target


def part(mesh: Mesh) -> Mesh:
    """The strips of panels at the far end of the first direction, a third of all; all vertices."""
    across = np.argmax(np.diff(mesh.corners[mesh.face_start[:-1]]) > 1) + 1
    strips = mesh.n_faces // across
    far = range(mesh.n_faces - across * (strips // 3), mesh.n_faces)
    return Mesh.build(mesh.vertices, [mesh.face(k) for k in far])


def wires(show: object, points: Floats, edges: Ints, color: str, width: float) -> None:
    """Lines between points."""
    import pyvista

    segments = pyvista.line_segments_from_points(points[edges].reshape(-1, 3))
    show.add_mesh(segments, color=color, line_width=width, lighting=False)  # type: ignore[attr-defined]


def frame(show: object, points: Floats, towards: Floats) -> None:
    """A long lens that holds all points, in the middle of the picture."""
    camera = show.camera  # type: ignore[attr-defined]
    camera.view_angle = 20.0
    right = np.cross([0.0, 0.0, 1.0], towards)
    right /= np.linalg.norm(right)
    up = np.cross(towards, right)
    flat = points @ np.stack([right, up], axis=1)
    middle = 0.5 * (flat.min(axis=0) + flat.max(axis=0))
    half = 0.5 * np.ptp(flat, axis=0) * 1.15
    focus = right * middle[0] + up * middle[1] + towards * (points @ towards).mean()
    reach = max(half[1], half[0] * SIZE[1] / SIZE[0]) / np.tan(np.radians(10.0))
    camera.focal_point = focus
    camera.position = focus + towards * (reach + 0.5 * np.ptp(points @ towards))
    camera.up = (0.0, 0.0, 1.0)
    show.reset_camera_clipping_range()  # type: ignore[attr-defined]


def main() -> None:
    """Draw the kinds named, or all."""
    FOLDER.mkdir(exist_ok=True)
    for kind in sys.argv[1:] or VIEWS:
        path = picture(kind)
        sys.stdout.write(f"{path.name}: {path.stat().st_size // 1024} kB\n")


if __name__ == "__main__":
    main()
