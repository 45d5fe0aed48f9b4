"""How reading and `inspect` grow with the size of a mesh file, for files of many kinds.

python benchmarks/inputs.py [--faces 4000 16000] [--only hub]

Prints processor seconds for each size and the exponent between the two: 1 is linear.
"""

from __future__ import annotations

import argparse
import json
import math
import resource
import time
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from ddgfab.errors import DdgError
from ddgfab.io import read_mesh
from ddgfab.measures import inspect


def obj(points: np.ndarray, faces: list[list[int]], key: str = "f") -> str:
    rows = ["v {:.6f} {:.6f} {:.6f}".format(*p) for p in points.tolist()]
    rows += [f"{key} " + " ".join(str(i + 1) for i in face) for face in faces]
    return "\n".join([*rows, ""])


def sheet(count: int) -> tuple[np.ndarray, list[list[int]]]:
    """A wavy square of about so many quads."""
    n = max(2, round(math.sqrt(count)))
    u, v = np.meshgrid(np.arange(n + 1.0), np.arange(n + 1.0), indexing="ij")
    points = 1000 * np.stack([u, v, np.sin(0.2 * u) + np.cos(0.3 * v)], axis=-1).reshape(-1, 3)
    at = np.arange((n + 1) ** 2).reshape(n + 1, n + 1)
    corners = [at[:-1, :-1], at[1:, :-1], at[1:, 1:], at[:-1, 1:]]
    return points, np.stack(corners, axis=-1).reshape(-1, 4).tolist()


def ring(count: int, radius: float = 1e6) -> np.ndarray:
    turn = 2 * np.pi * np.arange(count) / count
    return np.stack([radius * np.cos(turn), radius * np.sin(turn), 1e4 * np.sin(3 * turn)], axis=1)


def quads(count: int) -> str:
    return obj(*sheet(count))


def triangles(count: int) -> str:
    points, faces = sheet(count // 2)
    return obj(points, [t for a, b, c, d in faces for t in ([a, b, c], [a, c, d])])


def soup(count: int) -> str:
    """Every face has vertices of its own: they are welded."""
    points, faces = sheet(count)
    return obj(points[np.array(faces).ravel()], np.arange(4 * len(faces)).reshape(-1, 4).tolist())


def islands(count: int) -> str:
    """As many components as faces."""
    points, faces = sheet(count)
    shrunk = points[np.array(faces)] + 0.2 * np.array([[1, 1, 0], [-1, 1, 0], [-1, -1, 0],
                                                       [1, -1, 0]]) * 1000  # fmt: skip
    return obj(shrunk.reshape(-1, 3), np.arange(4 * len(faces)).reshape(-1, 4).tolist())


def polygon(count: int) -> str:
    """One face of so many corners."""
    return obj(ring(count), [list(range(count))])


def long_strips(count: int) -> str:
    """A few faces of very many corners, one beside the other."""
    n = count // 8
    t = np.linspace(0, 1e6, n)
    points = np.concatenate([np.stack([t, np.full(n, 1e4 * k), 0 * t], 1) for k in range(9)])
    faces = [[*range(k * n, k * n + n), *range((k + 2) * n - 1, (k + 1) * n - 1, -1)]
             for k in range(8)]  # fmt: skip
    return obj(points, faces)


def hub(count: int) -> str:
    """All triangles about one vertex."""
    points = np.concatenate([ring(count), [[0, 0, 5e5]]])
    return obj(points, [[count, k, (k + 1) % count] for k in range(count)])


def lines(count: int) -> str:
    points, faces = sheet(count // 2)
    edges = {tuple(sorted(e)) for f in faces for e in zip(f, f[1:] + f[:1], strict=True)}
    return obj(points, [list(edge) for edge in sorted(edges)], "l")


def line_path(count: int) -> str:
    """One open polyline in space: nothing but free ends."""
    points = np.random.default_rng(0).uniform(0, 1e5, (count + 1, 3))
    return obj(points, [[k, k + 1] for k in range(count)], "l")


def spokes(count: int) -> str:
    """Lines from one point, and a rim."""
    half = count // 2
    points = np.concatenate([ring(half), [[0, 0, 0]]])
    edges = [[k, half] for k in range(half)] + [[k, (k + 1) % half] for k in range(half)]
    return obj(points, edges, "l")


def crossing_lines(count: int) -> str:
    """Closed, and every line crosses many others."""
    points = np.random.default_rng(0).uniform(0, 1e5, (count, 3))
    return obj(points, [[k, (k + 1) % count] for k in range(count)], "l")


def doubled(count: int) -> str:
    """Every face comes twice."""
    points, faces = sheet(count // 2)
    return obj(points, [*faces, *faces])


def turned(count: int) -> str:
    """Every other face runs the wrong way."""
    points, faces = sheet(count)
    return obj(points, [face[::-1] if k % 2 else face for k, face in enumerate(faces)])


def heaps(count: int) -> str:
    """All vertices at a few places."""
    points = np.repeat(np.array([[0, 0, 0], [1e3, 0, 0], [0, 1e3, 0]]), count, axis=0)
    return obj(points, [[k, count + k, 2 * count + k] for k in range(count)])


def bow_ties(count: int) -> str:
    """Faces that meet in single vertices only."""
    points, faces = sheet(2 * count)
    n = round(math.sqrt(2 * count))
    return obj(points, [f for k, f in enumerate(faces) if (k // n + k % n) % 2 == 0])


def t_junctions(count: int) -> str:
    """Rows of two faces against one."""
    n = count // 3
    x = 1000.0 * np.arange(2 * n + 1)
    rows = [np.stack([x, 0 * x + 1000 * k, 0 * x], 1) for k in range(3)]
    w = 2 * n + 1
    faces = [[2 * k, 2 * k + 2, w + 2 * k + 2, w + 2 * k] for k in range(n)]
    faces += [[w + k, w + k + 1, 2 * w + k + 1, 2 * w + k] for k in range(2 * n)]
    return obj(np.concatenate(rows), faces)


def compas(count: int) -> str:
    points, faces = sheet(count)
    return json.dumps({"vertices": points.tolist(), "faces": faces})


def off(count: int) -> str:
    points, faces = sheet(count)
    rows = [f"OFF\n{len(points)} {len(faces)} 0"]
    rows += ["{:.6f} {:.6f} {:.6f}".format(*p) for p in points.tolist()]
    return "\n".join([*rows, *(f"{len(f)} {' '.join(map(str, f))}" for f in faces), ""])


def ply(count: int) -> str:
    points, faces = sheet(count)
    head = f"ply\nformat ascii 1.0\nelement vertex {len(points)}\nproperty float x\n"
    head += f"property float y\nproperty float z\nelement face {len(faces)}\n"
    head += "property list uchar int vertex_indices\nend_header"
    rows = ["{:.6f} {:.6f} {:.6f}".format(*p) for p in points.tolist()]
    return "\n".join([head, *rows, *(f"{len(f)} {' '.join(map(str, f))}" for f in faces), ""])


def stl(count: int) -> str:
    points, faces = sheet(count // 2)
    rows = ["solid a"]
    for triangle in (t for a, b, c, d in faces for t in ((a, b, c), (a, c, d))):
        rows += ["facet normal 0 0 0", "outer loop"]
        rows += ["vertex {:.6f} {:.6f} {:.6f}".format(*points[i]) for i in triangle]
        rows += ["endloop", "endfacet"]
    return "\n".join([*rows, "endsolid a", ""])


def empty_lines(count: int) -> str:
    return quads(16) + "\n" * (200 * count)


def comments(count: int) -> str:
    return "".join(f"# units: m {k}\n" for k in range(10 * count)) + quads(16)


KINDS: dict[str, tuple[str, Callable[[int], str]]] = {
    function.__name__: (suffix, function)
    for suffix, functions in {
        ".obj": (
            *(quads, triangles, soup, islands, polygon, long_strips, hub, lines, line_path),
            *(spokes, crossing_lines, doubled, turned, heaps, bow_ties, t_junctions),
            *(empty_lines, comments),
        ),
        ".off": (off,),
        ".ply": (ply,),
        ".stl": (stl,),
        ".json": (compas,),
    }.items()
    for function in functions
}


def seconds(path: Path, text: str) -> tuple[float, float, str]:
    """Of reading, and of inspecting; and what came out."""
    path.write_text(text)
    begin = time.process_time()
    try:
        mesh = read_mesh(path).mesh
    except DdgError as error:
        return time.process_time() - begin, 0.0, str(error).split(": ", 1)[1][:60]
    read = time.process_time()
    inspect(mesh)
    return read - begin, time.process_time() - read, f"{mesh.n_faces} faces"


def main() -> None:
    """Print a row for each kind of file."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--faces", type=int, nargs=2, default=[4000, 16000])
    parser.add_argument("--only", nargs="*", choices=sorted(KINDS))
    given = parser.parse_args()
    few, many = given.faces
    with TemporaryDirectory() as folder:
        inspect(read_mesh(_warm(Path(folder))).mesh)
        for name in given.only or KINDS:
            suffix, function = KINDS[name]
            path = Path(folder, f"a{suffix}")
            small = seconds(path, function(few))
            large = seconds(path, function(many))
            growth = [
                f"{math.log(b / a) / math.log(many / few):4.1f}" if min(a, b) > 0.02 else "   -"
                for a, b in zip(small[:2], large[:2], strict=True)
            ]
            print(
                f"{name:15} read {small[0]:6.2f} {large[0]:6.2f} s ^{growth[0]}   inspect "
                f"{small[1]:6.2f} {large[1]:6.2f} s ^{growth[1]}   {large[2]}",
                flush=True,
            )
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(f"peak of memory {peak:.0f} MB")


def _warm(folder: Path) -> Path:
    path = folder / "warm.obj"
    path.write_text(quads(9))
    return path


if __name__ == "__main__":
    main()
