"""Node axes that a mesh file carries: those of its own geometry, of length one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ddgfab.io.header import geometry_digest
from ddgfab.io.place import upright
from ddgfab.io.raw import RawMesh
from ddgfab.mesh import Floats


def own_axes(raw: RawMesh) -> RawMesh:
    """The same without node axes where they belong to another geometry, with a note.

    Vertex normals without the comment never come as axes (the parsers leave them out): other
    programs write them for light and shade.
    """
    if raw.axes is None and raw.axes_of is None:
        return raw
    if raw.axes is None:
        why = "but not for every vertex"
    elif raw.axes_of is None:
        why = "without the digest of the mesh that they belong to"
    elif not len(raw.points) or not np.isfinite(raw.points).all():
        why = "and coordinates that are not finite"
    elif raw.axes_of != geometry_digest(raw.points, raw.corners, raw.sizes):
        why = "of another geometry: vertices or faces were changed after they were written"
    else:
        return raw
    note = f"the file has node axes {why}; they are not used"
    return replace(raw, axes=None, axes_of=None, notes=[*raw.notes, note])


def unit_axes(axes: Floats | None, up: str) -> Floats | None:
    """Axes of length one, turned as the mesh; None where a vertex has none."""
    if axes is None:
        return None
    with np.errstate(over="ignore"):  # an infinite length is none
        length = np.linalg.norm(axes, axis=1)
    if not (np.isfinite(length) & (length > 0)).all():
        return None
    return upright(axes / length[:, None], up)
