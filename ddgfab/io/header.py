"""What our mesh files state of themselves in comments: the unit, and whether normals are axes."""

from __future__ import annotations

import hashlib
import re
from typing import Final

import numpy as np

from ddgfab.errors import InputError
from ddgfab.io.units import FACTORS
from ddgfab.mesh import Floats, Ints, Mesh

AXES_NOTE: Final = "normals: node axes"
"""Comment of files whose vertex normals are the axes of the nodes (ddgfab.support). A digest of
the geometry follows it (`geometry_digest`): the axes are those of this mesh and of no other."""

_STATED: Final = re.compile(re.escape(AXES_NOTE) + r"; geometry ([0-9a-f]{32})\b")

HEAD: Final = 60
"""Comments are looked for in so many lines from the start."""

WIDTH: Final = 1000
"""So many characters of a line are looked at."""


def comments_of(text: str, mark: str) -> str:
    """The comments in the first lines of a text file, joined."""
    found = []
    at = 0
    for _ in range(HEAD):
        end = text.find("\n", at)
        line = text[at : min(end if end >= 0 else len(text), at + WIDTH)]
        before, sign, comment = line.partition(mark)
        if sign and (mark == "#" or not before.strip()):
            found.append(comment[:WIDTH].strip())
        if end < 0:
            break
        at = end + 1
    return "\n".join(found)


def header_lines(mesh: Mesh, units: str | None, axes: Floats | None) -> list[str]:
    """Comments to write; checks what is to be written.

    Raises
    ------
    InputError
        Something else than a mesh, an unknown unit, or axes of the wrong shape.
    """
    if not isinstance(mesh, Mesh):
        known = [name for name in ("mesh", "to_mesh") if hasattr(mesh, name)]
        call = f".{known[0]}{'()' if callable(getattr(mesh, known[0])) else ''}" if known else ""
        hint = f": give its mesh, {call}" if known else ""
        raise InputError(f"a Mesh can be written, not a {type(mesh).__name__}{hint}")
    if units is not None and units not in FACTORS:
        raise InputError(f'unit "{units}" is unknown; one of {", ".join(FACTORS)}')
    lines = [] if units is None else [f"units: {units}"]
    if axes is not None:
        if np.shape(axes) != mesh.vertices.shape:
            raise InputError(f"axes have shape {np.shape(axes)}; expected {mesh.vertices.shape}")
        if not np.isfinite(axes).all() or not np.linalg.norm(axes, axis=1).all():
            raise InputError("an axis has length 0 or a coordinate that is not finite")
        digest = geometry_digest(mesh.vertices, mesh.corners, mesh.face_sizes)
        lines.append(f"{AXES_NOTE}; geometry {digest}")
    return lines


def geometry_digest(points: Floats, corners: Ints, sizes: Ints) -> str:
    """32 digits that change when a coordinate, a face or the order of either changes.

    Parameters
    ----------
    points : (V, 3) as the file has them, exactly
    corners : (C,) vertex ids from 0, face after face
    sizes : (F,) number of corners of each face
    """
    counted = hashlib.sha256()
    counted.update((np.asarray(points, dtype="<f8") + 0.0).tobytes())  # -0 is 0
    for ids in (corners, sizes):
        counted.update(np.asarray(ids, dtype="<i8").tobytes())
    return counted.hexdigest()[:32]


def stated_digest(comments: str) -> str | None:
    """The digest that comments state together with node axes, or None."""
    found = _STATED.search(comments)
    return found[1] if found else None
