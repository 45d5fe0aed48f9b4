"""The sheet of a shape that says nothing of its own: three views, and its size over all."""

from __future__ import annotations

from fabrication.boundary import Vec
from fabrication.drawings.lengths import Length
from fabrication.drawings.views import Drawing, View
from fabrication.specs import TriangleMesh


def overall_drawing(mesh: TriangleMesh) -> Drawing:
    """From the front, from above and from the left, in first-angle projection."""
    x0, y0, z0 = mesh.vertices.min(axis=0).tolist()
    x1, y1, z1 = mesh.vertices.max(axis=0).tolist()
    x: Vec = (1.0, 0.0, 0.0)
    y: Vec = (0.0, 1.0, 0.0)
    z: Vec = (0.0, 0.0, 1.0)
    long = Length("", (x0, y0, z0), (x1, y0, z0), "across", "below")
    high = Length("", (x0, y0, z0), (x0, y0, z1), "up", "left")
    deep = Length("", (x0, y0, z0), (x0, y1, z0), "across", "below")
    return Drawing(
        (
            View("front", x, z, (long, high)),
            View("from above", x, y, row=-1),
            View("from the left", (0.0, -1.0, 0.0), z, (deep,), column=1),
        )
    )
