"""Rhino files (.3dm): their meshes; what else they hold is counted."""

from __future__ import annotations

import importlib.util
import io
import json
import subprocess
import sys
from pathlib import Path
from typing import Any, Final

import numpy as np

from ddgfab.errors import MeshError
from ddgfab.io.raw import RawMesh, binary_step, check_count

SECONDS: Final = 60.0
"""Reading a file may take so long."""

MEMORY_BYTES: Final = 2 * 1024**3
"""Reading a file may take so much memory."""

UNITS: Final = {
    "Millimeters": "mm",
    "Centimeters": "cm",
    "Meters": "m",
    "Inches": "in",
    "Feet": "ft",
}
"""Units of Rhino that `ddgfab.io.units` knows."""

PLURALS: Final = {
    "Brep": "NURBS surfaces or polysurfaces",
    "Surface": "NURBS surfaces or polysurfaces",
    "Extrusion": "extrusions",
    "SubD": "SubD objects",
    "Curve": "curves",
    "InstanceReference": "blocks",
    "Point": "points",
    "PointSet": "point clouds",
}
"""Kinds of objects that are passed over, as text."""

EXPORT: Final = (
    "make a mesh of it in Rhino (Mesh, ToNURBS > QuadRemesh, or Explode for blocks) and save again"
    "; a net on NURBS surfaces: ddgfab trace"
)


def parse_rhino(data: bytes, file: str) -> RawMesh:
    """The meshes of a Rhino file as one, in the unit that the file states.

    The library that reads the format runs in a process of its own, with limits on time and
    memory: a damaged file can end that process, not this one.

    Raises
    ------
    MeshError
        The library is missing, the file is not a Rhino file or damaged, or it holds no mesh (and
        what it holds instead).

    Source: openNURBS, `ON_Mesh` and `ON_3dmSettings`, read by rhino3dm.
    """
    require_reader(file)
    found = in_child(data, file, __name__)
    about: dict[str, Any] = json.loads(str(found["about"]))
    counts: dict[str, int] = about["skipped"]
    skipped = ", ".join(f"{count} {what}" for what, count in counts.items())
    points, faces = found["points"], found["faces"]
    if not len(faces):
        raise MeshError(
            f"holds no mesh ({skipped or 'nothing'}): {EXPORT}",
            file=file,
        )
    check_count(len(points), "vertices", file)
    check_count(len(faces), "faces", file)
    unit, notes = UNITS.get(about["unit"]), []
    if about["meshes"] > 1:
        notes.append(f"the file holds {about['meshes']} meshes: they are read as one")
    if skipped:
        notes.append(f"ignored {skipped}: a face of them counts only as a mesh")
    if unit is None:
        notes.append(f"its unit ({about['unit']}) is none of {', '.join(UNITS.values())}: state it")
    # Rhino stores a triangle as a quad whose last corner comes twice.
    triangle = faces[:, 2] == faces[:, 3]
    keep = np.ones(faces.shape, dtype=bool)
    keep[triangle, 3] = False
    code = "<f8" if about["double"] else "<f4"
    return RawMesh(
        file,
        points,
        faces[keep].astype(np.int64),
        np.where(triangle, 3, 4).astype(np.int64),
        None,
        None,
        notes,
        binary_step(points, code),
        unit,
    )


def require_reader(file: str) -> None:
    """Raise where the library that reads Rhino files is missing.

    Raises
    ------
    MeshError
        Names what to install.
    """
    if importlib.util.find_spec("rhino3dm") is None:
        raise MeshError(
            "Rhino files need rhino3dm, which is not installed: pip install 'ddgfab[3dm]'\n"
            "or export the mesh from Rhino as OBJ",
            file=file,
        )


def in_child(data: bytes, file: str, module: str) -> dict[str, Any]:
    """The arrays that `main` of a module writes, run by itself.

    Raises
    ------
    MeshError
        It takes too long, or ends with an error.
    """
    root = str(Path(__file__).resolve().parents[2])
    code = f"import sys; sys.path.insert(0, {root!r}); from {module} import main; main()"
    try:
        done = subprocess.run(
            [sys.executable, "-c", code], input=data, capture_output=True, timeout=SECONDS
        )
    except subprocess.TimeoutExpired:
        raise MeshError(f"takes more than {SECONDS:g} s to read: damaged?", file=file) from None
    if done.returncode == _NO_FILE:
        raise MeshError("is not a Rhino file that can be read: damaged?", file=file)
    if done.returncode != 0:
        raise MeshError(
            "is damaged, or needs too much memory: the library that reads Rhino files ended "
            f"(code {done.returncode}); export the mesh as OBJ",
            file=file,
        )
    with np.load(io.BytesIO(done.stdout), allow_pickle=False) as table:
        return {name: table[name] for name in table.files}


_NO_FILE: Final = 7


def main() -> None:
    """Read a Rhino file from standard input, and write its meshes as arrays to standard output."""
    limit_memory()
    model = model_of(sys.stdin.buffer.read())
    points: list[Any] = [np.empty((0, 3))]
    faces: list[Any] = [np.empty((0, 4), dtype=np.int64)]
    skipped: dict[str, int] = {}
    count, double = 0, True
    for item in model.Objects:
        shape = item.Geometry
        kind = shape.ObjectType.name
        if item.Attributes.IsInstanceDefinitionObject:
            continue  # the blocks that place it count
        if kind != "Mesh":
            what = PLURALS.get(kind, f"objects of kind {kind}")
            skipped[what] = skipped.get(what, 0) + 1
            continue
        own = np.array([(p.X, p.Y, p.Z) for p in _vertices(shape)], dtype=np.float64)
        corners = np.array(
            [shape.Faces[i] for i in range(shape.Faces.Count)], dtype=np.int64
        ).reshape(-1, 4)
        faces.append(corners + sum(map(len, points)))
        points.append(own.reshape(-1, 3))
        double = double and bool((own != own.astype(np.float32)).any())
        count += 1
    about = {
        "unit": model.Settings.ModelUnitSystem.name,
        "meshes": count,
        "skipped": skipped,
        "double": double and count > 0,
    }
    out = io.BytesIO()
    np.savez(
        out,
        points=np.concatenate(points),
        faces=np.concatenate(faces),
        about=np.array(json.dumps(about)),
    )
    sys.stdout.buffer.write(out.getvalue())


def model_of(data: bytes) -> Any:
    """The model of a Rhino file; this process ends where it is none."""
    import rhino3dm

    read: Any = rhino3dm.File3dm.FromByteArray  # its stubs are not those of the library
    model = read(data)
    if model is None:
        raise SystemExit(_NO_FILE)
    return model


def _vertices(mesh: Any) -> list[Any]:
    return [mesh.Vertices.Point3dAt(i) for i in range(len(mesh.Vertices))]


def limit_memory() -> None:
    """Limit this process's memory, where the system can."""
    try:
        import resource
    except ImportError:
        return
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY_BYTES, MEMORY_BYTES))
