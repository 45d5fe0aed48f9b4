"""Cell decompositions from OBJ files: faces as they stand, with the groups that mark them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ddgfab.errors import MeshError
from ddgfab.io.load import LIMIT_BYTES, load_bytes
from ddgfab.io.obj import parse_obj
from ddgfab.io.tokens import decode
from ddgfab.mesh import Ints, Mesh

_MARKS = ("g", "o", "usemtl")


@dataclass(frozen=True, eq=False)
class Cells:
    """Faces of a cell decomposition, and which of them each name marks.

    Attributes
    ----------
    mesh : faces in the file's order; vertices that no face uses are gone, nothing else is mended
    groups : ids of the faces under each name of a group (`g`), an object (`o`) or a material
        (`usemtl`)
    file : where it came from
    """

    mesh: Mesh
    groups: dict[str, Ints]
    file: str

    def group(self, name: str) -> Ints:
        """Ids of the faces under a name.

        Raises
        ------
        MeshError
            No such name; lists those there are.
        """
        if name not in self.groups:
            known = ", ".join(self.groups) or "none"
            raise MeshError(
                f'no faces are marked "{name}"; marked in the file: {known}\n'
                f'write "g {name}" before the faces of the piece, and "g rest" before the others',
                file=self.file,
            )
        return self.groups[name]


def read_cells(path: str | Path) -> Cells:
    """Faces of an OBJ file with the names of their groups, objects and materials.

    Unlike `read_mesh` it leaves vertices at one place apart: only who is whose neighbour counts.
    A name holds from its line to the next of its kind; a group line may carry several names.

    Raises
    ------
    MeshError
        A file that is not OBJ, or faces that do not form an oriented surface.
    """
    data = load_bytes(Path(path), LIMIT_BYTES)[0]
    raw = parse_obj(data, str(path))
    points, own = np.unique(raw.corners, return_inverse=True)
    try:
        mesh = Mesh.build(raw.points[points], np.split(own, np.cumsum(raw.sizes)[:-1]))
    except MeshError as error:
        raise MeshError(str(error), file=str(path)) from None
    marked: dict[str, list[int]] = {}
    now: dict[str, list[str]] = {}
    face = 0
    for line in decode(data, str(path)).replace("\\\n", " ").split("\n"):
        parts = line.partition("#")[0].split()
        if parts and parts[0] in _MARKS:
            now[parts[0]] = parts[1:]
        elif parts and parts[0] in ("f", "fo"):
            for name in {name for names in now.values() for name in names}:
                marked.setdefault(name, []).append(face)
            face += 1
    groups = {name: np.array(ids, dtype=np.int64) for name, ids in sorted(marked.items())}
    return Cells(mesh, groups, str(path))
