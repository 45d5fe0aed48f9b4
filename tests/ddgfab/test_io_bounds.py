"""Reading takes time and memory in proportion to the file, or the file is refused."""

from __future__ import annotations

import gzip
import os
import socket
import tracemalloc
from pathlib import Path

import numpy as np
import pytest

from ddgfab.errors import MeshError
from ddgfab.io import compas, raw, read_mesh
from ddgfab.io.near import near_pairs
from ddgfab.measures import inspect
from ddgfab.measures.faces import planarity_percent
from ddgfab.mesh import Mesh

TRIANGLE = "v 0 0 0\nv 1000 0 0\nv 0 1000 0\nf 1 2 3\n"


def peak_mb(path: Path) -> float:
    """Greatest memory that reading a file takes [MB], also where it is refused."""
    tracemalloc.start()
    try:
        read_mesh(path)
    except MeshError:
        pass
    finally:
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
    return peak / 1e6


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="needs named pipes")
def test_only_regular_files_are_read_and_nothing_is_waited_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    os.mkfifo(tmp_path / "pipe.obj")
    with pytest.raises(MeshError, match="this is a named pipe; a mesh file is needed"):
        read_mesh(tmp_path / "pipe.obj")
    with socket.socket(socket.AF_UNIX) as own:
        monkeypatch.chdir(tmp_path)  # names of sockets are short
        own.bind("s.obj")
        with pytest.raises(MeshError, match=r"cannot be read|this is a socket"):
            read_mesh("s.obj")
    for target, reason in [
        ("/dev/zero", "this is a device"),
        ("/dev/tty", "this is a device|cannot be read"),
        ("/proc/self/maps", "is not a file on a disk"),
        ("/proc", "this is a folder"),
    ]:
        if Path(target).exists():
            link = tmp_path / f"{target.replace('/', '_')}.obj"
            link.symlink_to(target)
            with pytest.raises(MeshError, match=reason):
                read_mesh(link)
    (tmp_path / "loop.obj").symlink_to(tmp_path / "loop.obj")
    with pytest.raises(MeshError, match="cannot be read"):
        read_mesh(tmp_path / "loop.obj")


@pytest.mark.parametrize("name", ["a\0b.obj", "a\udcff\udc00.obj", "x" * 5000 + ".obj"])
def test_names_that_no_system_takes(name: str) -> None:
    with pytest.raises(MeshError, match=r"cannot be read|no such file") as caught:
        read_mesh(name)
    str(caught.value).encode()  # fit for a terminal


def test_blank_lines_comments_and_unknown_lines_take_no_memory(tmp_path: Path) -> None:
    path = tmp_path / "a.obj"
    for filling in ("\n" * 500_000, "# x\n" * 30_000, " \t\n" * 200_000):
        path.write_text(TRIANGLE + filling)
        size = path.stat().st_size / 1e6
        assert peak_mb(path) < 5 * size + 1
    path.write_text(TRIANGLE + "".join(f"key{i} 1\n" for i in range(5_000)))
    read = read_mesh(path)
    assert len(read.notes) == 21
    assert read.notes[-1].startswith("ignored 4980 lines of other kinds (first in line 25)")


@pytest.mark.parametrize("kind", ["obj", "off", "ply"])
def test_memory_of_text_meshes_is_small(kind: str, tmp_path: Path) -> None:
    """Every vertex and face takes a few hundred bytes, whatever the format."""
    m = 50
    points = [f"{i} {j} {i * j % 7}" for i in range(m + 1) for j in range(m + 1)]
    corner = [i * (m + 1) + j for i in range(m) for j in range(m)]
    faces = [[a, a + m + 1, a + m + 2, a + 1] for a in corner]
    head = {"obj": "", "off": f"OFF\n{len(points)} {len(faces)} 0\n", "ply": (
        f"ply\nformat ascii 1.0\nelement vertex {len(points)}\nproperty float x\n"
        f"property float y\nproperty float z\nelement face {len(faces)}\n"
        "property list uchar int vertex_indices\nend_header\n")}[kind]  # fmt: skip
    if kind == "obj":
        rows = ["v " + p for p in points] + ["f " + " ".join(str(i + 1) for i in f) for f in faces]
    else:
        rows = points + ["4 " + " ".join(map(str, f)) for f in faces]
    path = tmp_path / f"a.{kind}"
    path.write_text(head + "\n".join(rows) + "\n")
    assert peak_mb(path) < 1200 * (len(points) + len(faces)) / 1e6


def test_limits_are_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    limit = "the limit is 4"
    monkeypatch.setattr(raw, "LIMIT_ELEMENTS", 4)
    five = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n2 2 2\n"
    ply = (
        "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\n"
        "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
    )
    texts = {
        "v.obj": "".join(f"v {row}\n" for row in five.splitlines()) + "f 1 2 3\n",
        "f.obj": TRIANGLE + "f 1 2 3\n" * 4,
        "c.obj": TRIANGLE + "f" + " 1 2 3" * 6 + "\n",
        "l.obj": "v 0 0 0\nv 1 0 0\n" + "l 1 2\n" * 5,
        "v.off": f"OFF\n5 1 0\n{five}3 0 1 2\n",
        "f.off": "OFF\n3 5 0\n" + five,
        "v.ply": ply + five + "3 0 1 2\n",
        "t.stl": "solid\n" + "vertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n" * 5 + "endsolid\n",
        "v.json": '{"vertices": [[0,0,0],[1,0,0],[0,1,0],[1,1,0],[2,2,2]], "faces": [[0,1,2]]}',
    }
    for name, text in texts.items():
        (tmp_path / name).write_text(text)
        with pytest.raises(MeshError, match=limit if name != "c.obj" else "limit is 16"):
            read_mesh(tmp_path / name)


def test_packed_files_are_unpacked_up_to_the_limit(tmp_path: Path) -> None:
    path = tmp_path / "a.obj.gz"
    path.write_bytes(gzip.compress(TRIANGLE.encode() + b"\n" * 500_000))
    assert read_mesh(path).faces == 1
    with pytest.raises(MeshError, match="the unpacked bytes exceed the limit of 100000"):
        read_mesh(path, limit_bytes=100_000)


def test_large_and_deep_json(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "a.json"
    path.write_text("[" * 100_000)
    with pytest.raises(MeshError, match="is not JSON that can be read"):
        read_mesh(path)
    path.write_text('{"vertices": [[' + "9" * 5000 + ', 0, 0]], "faces": [[0, 1, 2]]}')
    with pytest.raises(MeshError, match="is not JSON that can be read"):
        read_mesh(path)
    monkeypatch.setattr(compas, "LIMIT_JSON", 1000)
    path.write_text("[" + "0," * 1000 + "0]")
    with pytest.raises(MeshError, match="JSON is read up to 1000"):
        read_mesh(path)


def test_ply_elements_without_properties_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.ply"
    for kind in ("ascii", "binary_little_endian"):
        path.write_text(
            f"ply\nformat {kind} 1.0\nelement vertex 3\nelement user 400000\nend_header\n"
        )
        with pytest.raises(MeshError, match="element 'vertex' has no properties"):
            read_mesh(path)


def brute(points: np.ndarray, distance: float) -> list[int]:
    """For each point the lowest id that chains of near points lead to."""
    near = np.linalg.norm(points[:, None] - points[None], axis=2) <= distance
    label = list(range(len(points)))
    for _ in points:
        label = [min(label[j] for j in np.flatnonzero(row)) for row in near]
    return label


def labels(points: np.ndarray, distance: float) -> list[int]:
    label = list(range(len(points)))
    pairs = near_pairs(points, distance).tolist()
    for _ in points:
        for a, b in pairs:
            label[a] = label[b] = min(label[a], label[b])
    return label


@pytest.mark.parametrize("seed", range(6))
def test_near_pairs_agree_with_all_pairs(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    rng = np.random.default_rng(seed)
    middle = rng.uniform(-1, 1, (12, 3))
    points = middle[rng.integers(0, 12, 90)] + rng.normal(size=(90, 3)) * 0.03
    points[80:] = points[:10]
    for distance in (0.0, 0.01, 0.05, 0.2):
        swept = labels(points, distance)
        assert swept == brute(points, distance)
        monkeypatch.setattr("ddgfab.io.near.SWEPT", -1)  # by cubes, whatever the points
        assert labels(points, distance) == swept
        monkeypatch.undo()


def test_points_that_a_sweep_does_not_tell_apart(monkeypatch: pytest.MonkeyPatch) -> None:
    """Points in a plane across the sweep: as many comparisons as points, not their square."""
    rng = np.random.default_rng(1)
    way = np.array([0.5773, 0.2113, 0.7887])
    across = np.linalg.svd(way[None])[2][1:]
    points = rng.uniform(-1, 1, (5_000, 2)) @ across
    compared = []
    norm = np.linalg.norm
    monkeypatch.setattr(
        np.linalg, "norm", lambda x, *a, **k: (compared.append(len(x)), norm(x, *a, **k))[1]
    )
    near_pairs(points, 1e-4)
    assert sum(compared) < 5 * len(points)


def test_crowds_and_books_of_faces(tmp_path: Path) -> None:
    """Many vertices at three places; many faces at one edge: found at once, few are named."""
    rng = np.random.default_rng(0)
    base = np.array([[0, 0, 0], [1000, 0, 0], [0, 1000, 0]], dtype=float)
    points = np.tile(base, (1500, 1)) + rng.normal(size=(4500, 3)) * 1e-6
    rows = ["v {:.9f} {:.9f} {:.9f}".format(*p) for p in points.tolist()]
    rows += [f"f {3 * i + 1} {3 * i + 2} {3 * i + 3}" for i in range(1500)]
    path = tmp_path / "a.obj"
    path.write_text("\n".join(rows) + "\n")
    with pytest.raises(
        MeshError, match=r"faces 0, 1, 2, 3, 4, 5 and 1494 more meet there"
    ) as error:
        read_mesh(path)
    assert "lie on one another: remove one of them" in str(error.value)
    assert len(str(error.value)) < 500
    assert peak_mb(path) < 40


def test_polygon_of_very_many_corners(tmp_path: Path) -> None:
    turn = np.linspace(0, 2 * np.pi, 2001)[:-1]
    ring = np.stack([np.cos(turn), np.sin(turn), 0.01 * np.cos(2 * turn)], axis=1) * 5000
    mesh = Mesh.build(ring, [list(range(len(ring)))])
    tracemalloc.start()
    report = inspect(mesh)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 60e6
    # Mean of the chords of a circle: 4/pi times its radius; the corners spread 0.02 r.
    assert report.measures["planarity_percent"].greatest == pytest.approx(
        100 * 0.02 * np.pi / 4, rel=1e-2
    )


@pytest.mark.parametrize("size", [5, 6, 7, 30])
def test_mean_of_diagonals_is_that_of_all(size: int) -> None:
    rng = np.random.default_rng(size)
    turn = np.sort(rng.uniform(0, 2 * np.pi, size))
    points = np.stack([np.cos(turn), np.sin(turn), rng.normal(size=size) * 0.05], axis=1)
    mesh = Mesh.build(points, [list(range(size))])
    lengths = [
        np.linalg.norm(points[i] - points[j])
        for i in range(size)
        for j in range(i + 2, size)
        if (i, j) != (0, size - 1)
    ]
    centered = points - points.mean(axis=0)
    heights = centered @ np.linalg.svd(centered)[2][2]
    expected = 100 * np.ptp(heights) / np.mean(lengths)
    assert planarity_percent(mesh)[0] == pytest.approx(expected, rel=1e-12)
