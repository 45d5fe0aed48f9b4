"""Damaged Rhino files (.3dm): a sound mesh, curves of a surface, or a message.

    python tests/attack/rhino_files.py --count 1000

Each file is read by a process of its own, as the program does it.
"""

from __future__ import annotations

import sys
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

HERE = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(HERE), str(HERE / "tests" / "attack"), str(HERE / "tests" / "fabrication")]

import numpy as np  # noqa: E402
from damage import damaged  # noqa: E402
from roofs import barrel  # noqa: E402
from watch import Watch, run  # noqa: E402

from ddgfab.mesh import Mesh  # noqa: E402
from fabrication.meshes_in import read_mesh  # noqa: E402


@cache
def sound_file() -> bytes:
    """A mesh of four quads and a triangle, a curve and a sphere."""
    import rhino3dm

    model, mesh = rhino3dm.File3dm(), rhino3dm.Mesh()
    model.Settings.ModelUnitSystem = rhino3dm.UnitSystem.Millimeters
    roof = barrel(2, 2)
    for point in roof.vertices.tolist():
        mesh.Vertices.Add(*point)
    for face in roof.faces:
        mesh.Faces.AddFace(*map(int, face))
    for corner in ((9e3, 0.0, 0.0), (1e4, 0.0, 0.0), (9e3, 1e3, 0.0)):
        mesh.Vertices.Add(*corner)
    mesh.Faces.AddFace(*range(len(roof.vertices), len(roof.vertices) + 3))
    model.Objects.AddMesh(mesh)
    model.Objects.AddLine(rhino3dm.Point3d(0, 0, 0), rhino3dm.Point3d(1, 0, 0))
    model.Objects.AddSphere(rhino3dm.Sphere(rhino3dm.Point3d(0, 0, 0), 5.0))
    with TemporaryDirectory() as folder:
        path = Path(folder, "a.3dm")
        model.Write(str(path), 7)
        return path.read_bytes()


def attack(watch: Watch, seed: int, folder: Path) -> None:
    """One file; every fourth one is damaged in its last third, where the table of ends stands."""
    data = sound_file()
    keep = 0 if seed % 4 else 2 * len(data) // 3
    path = folder / "a.3dm"
    path.write_bytes(data[:keep] + damaged(data[keep:], seed))

    def read() -> Mesh:
        mesh = read_mesh(path).mesh
        mesh.validate()
        assert np.isfinite(mesh.vertices).all(), "coordinates are not finite"
        return mesh

    watch.call(seed, read)


if __name__ == "__main__":
    with TemporaryDirectory() as place:
        sys.exit(run(attack, __doc__, 1000, Path(place)))
