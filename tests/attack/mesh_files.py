"""Mesh files of every kind, changed by their grammar or damaged: a sound mesh or a message.

    python tests/attack/mesh_files.py --count 500000

What is read is looked into as well: `validate`, and of some `inspect` and the design.
"""

from __future__ import annotations

import gzip
import json
import random
import struct
import sys
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

HERE = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(HERE), str(HERE / "tests" / "attack"), str(HERE / "tests" / "fabrication")]

import numpy as np  # noqa: E402
from damage import damaged  # noqa: E402
from mutations import changed_json, changed_text  # noqa: E402
from roofs import barrel  # noqa: E402
from watch import Watch, run  # noqa: E402

from ddgfab.forms import generate  # noqa: E402
from ddgfab.io import write_mesh  # noqa: E402
from ddgfab.measures import inspect  # noqa: E402
from ddgfab.mesh import Mesh  # noqa: E402
from fabrication import design  # noqa: E402
from fabrication.meshes_in import read_mesh  # noqa: E402

SUFFIXES = (".obj", ".off", ".ply", ".stl", ".json")
INSPECTED, DESIGNED = 16, 160
"""One in so many seeds is inspected, or becomes a design, where its mesh is read."""


def _hexagons() -> Mesh:
    """Three hexagons about a vertex."""
    points = [(0.0, 0.0, 9.0)]
    points += [(np.cos(a), np.sin(a), 8.0) for a in np.pi * np.arange(6) / 3]
    points += [(2 * np.cos(a), 2 * np.sin(a), 5.0) for a in np.pi * np.arange(12) / 6]
    outer = [7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18]
    faces = [
        [0, 1 + 2 * k, 7 + 4 * k, *outer[4 * k + 1 : 4 * k + 4], 1 + (2 * k + 2) % 6]
        for k in range(3)
    ]
    return Mesh.build(np.array(points) * 700.0, faces)


def meshes() -> dict[str, Mesh]:
    """Small meshes: open, closed, of quads, triangles and hexagons."""
    corners = np.array([(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]) * 1200.0
    cube = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    vault = barrel(2, 2)
    halves = [t for a, b, c, d in vault.faces for t in ([a, b, c], [a, c, d])]
    return {
        "vault": vault,
        "cube": Mesh.build(corners, cube),
        "triangles": Mesh.build(vault.vertices, halves),
        "hexagons": _hexagons(),
        "canopy": generate("canopy", {"panels_along": 2, "panels_across": 2}, Path()),
    }


@cache
def sound_files() -> tuple[tuple[str, bytes], ...]:
    """(suffix, content) of files in all the ways in which programs write them."""
    found: list[tuple[str, bytes]] = []
    with TemporaryDirectory() as folder:
        for name, mesh in meshes().items():
            axes = np.tile([0.0, 0.0, 1.0], (mesh.n_vertices, 1))
            for suffix in (".obj", ".off", ".ply"):
                for units, given in ((None, None), ("mm", axes)):
                    path = Path(folder, name + suffix)
                    write_mesh(path, mesh, units=units, axes=given)
                    found.append((suffix, path.read_bytes()))
            found += [(suffix, data) for suffix, data in others(mesh)]
    return tuple(found)


def others(mesh: Mesh) -> list[tuple[str, bytes]]:
    """The same mesh as other programs write it."""
    points, faces = mesh.vertices.tolist(), [list(map(int, face)) for face in mesh.faces]
    rows = [f"v {x:.4f} {y:.4f} {z:.4f}" for x, y, z in points]
    obj = "\n".join(
        ["mtllib a.mtl", "o roof", *rows, "vn 0 0 1", "vt 0 0", "g one", "usemtl glass", "s off"]
        + ["f " + " ".join(f"{i + 1}/1/1" for i in face) for face in faces]
    )
    back = "\n".join(
        [*rows, *("f " + " ".join(f"{i - len(points)}" for i in face) for face in faces), ""]
    )
    edges = sorted(
        {(min(a, b), max(a, b)) for f in faces for a, b in zip(f, f[1:] + f[:1], strict=True)}
    )
    wires = "\n".join([*rows, *(f"l {a + 1} {b + 1}" for a, b in edges), ""])
    color = "\n".join(
        [f"COFF\n# units: m\n{len(points)} {len(faces)} 0"]
        + [f"{x / 1000:.6f} {y / 1000:.6f} {z / 1000:.6f} 255 0 0 1" for x, y, z in points]
        + [f"{len(f)}  {' '.join(map(str, f))} 0.1 0.2 0.3" for f in faces]
    )
    files = [(".obj", obj), (".obj", back), (".obj", wires), (".off", color)]
    head = (
        "ply\nformat {} 1.0\ncomment by others\nelement vertex {}\nproperty double x\n"
        "property double y\nproperty double z\nproperty uchar red\nelement face {}\n"
        "property uchar flag\nproperty list uchar int vertex_indices\nelement edge 1\n"
        "property int a\nend_header\n"
    )
    text = head.format("ascii", len(points), len(faces))
    text += "".join(f"{x:.5f} {y:.5f} {z:.5f} 9\n" for x, y, z in points)
    text += "".join(f"1 {len(f)} {' '.join(map(str, f))}\n" for f in faces) + "3\n"
    files.append((".ply", text))
    stl = ["solid roof"]
    triangles = [(f[0], f[k], f[k + 1]) for f in faces for k in range(1, len(f) - 1)]
    for triangle in triangles:
        stl += ["facet normal 0 0 0", "outer loop"]
        stl += ["vertex {:.5e} {:.5e} {:.5e}".format(*points[i]) for i in triangle]
        stl += ["endloop", "endfacet"]
    files.append((".stl", "\n".join([*stl, "endsolid roof", ""])))
    record = {
        "vertex": {str(i): dict(zip("xyz", p, strict=True)) for i, p in enumerate(points)},
        "face": {str(i): f for i, f in enumerate(faces)},
        "default_vertex_attributes": {"x": 0.0, "y": 0.0, "z": 0.0},
    }
    compas = {"dtype": "compas.datastructures/Mesh", "data": record}
    files.append((".json", json.dumps(compas)))
    files.append((".json", json.dumps({"vertices": points, "faces": faces})))
    found = [(suffix, text.encode()) for suffix, text in files]
    for order, sign in (("little", "<"), ("big", ">")):
        body = head.format(f"binary_{order}_endian", len(points), len(faces)).encode()
        body += b"".join(struct.pack(f"{sign}dddB", *p, 9) for p in points)
        body += b"".join(struct.pack(f"{sign}BB{len(f)}i", 1, len(f), *f) for f in faces)
        found.append((".ply", body + struct.pack(f"{sign}i", 3)))
    packed = b"".join(
        struct.pack("<12fH", 0, 0, 0, *points[a], *points[b], *points[c], 0)
        for a, b, c in triangles
    )
    found.append((".stl", b" " * 80 + struct.pack("<I", len(triangles)) + packed))
    return found


def changed(seed: int) -> tuple[str, bytes]:
    """A name and the content of a file that a seed changes."""
    rng = random.Random(seed)
    suffix, data = rng.choice(sound_files())
    text = b"\x00" not in data and not data.startswith(b"ply\nformat binary")
    kind = rng.random()
    if suffix == ".json" and kind < 0.7:
        data = changed_json(data.decode(), rng).encode()
    elif text and kind < 0.85:
        data = changed_text(data.decode(), rng).encode("utf-8", "surrogatepass")
    elif data.startswith(b"ply") and kind < 0.5:
        head, mark, body = data.partition(b"end_header\n")
        data = changed_text(head.decode("latin1"), rng).encode("latin1", "replace") + mark + body
    else:
        data = damaged(data, seed)
    name = f"a{suffix}"
    extra = rng.random()
    if extra < 0.02:
        name = f"a{rng.choice(SUFFIXES)}"
    elif extra < 0.06:
        data = gzip.compress(data, 1)
        if rng.random() < 0.5:
            data = damaged(data, seed)
    return name, data


def attack(watch: Watch, seed: int, folder: Path) -> None:
    """One file: read it, and look into what came out."""
    rng = random.Random(seed * 7 + 1)
    name, data = changed(seed)
    path = folder / name
    path.write_bytes(data)
    ways = {
        "quads": rng.random() < 0.2,
        "units": rng.choice((None, None, "stated", "m")),
        "merge": rng.choice((None, None, None, 0.0, 1.0, 500.0)),
    }

    def read() -> Mesh:
        mesh = read_mesh(path, **ways).mesh
        mesh.validate()
        assert np.isfinite(mesh.vertices).all(), "coordinates are not finite"
        return mesh

    mesh = watch.call(seed, read)
    if mesh is None:
        return
    if seed % INSPECTED == 0:
        watch.call(f"{seed} (inspect)", lambda: inspect(mesh).to_dict())
    if seed % DESIGNED == 0:
        watch.call(f"{seed} (design)", lambda: design(mesh).schedules)


if __name__ == "__main__":
    with TemporaryDirectory(dir="/dev/shm" if Path("/dev/shm").is_dir() else None) as place:
        sys.exit(run(attack, __doc__, 500_000, Path(place)))
