"""Many spellings of each kind of file: digits, scales, order, sides, places; one right answer."""

from __future__ import annotations

import gzip
import json
import struct
from collections.abc import Callable
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from variant_cases import GRID, compas, is_roof, lists, obj, read, roof

from ddgfab.errors import MeshError
from ddgfab.io import (
    read_mesh,
    write_mesh,
)
from ddgfab.mesh import Floats, Mesh


@pytest.mark.parametrize(("digits", "scale"), list(product([5, 6, 7, 9], [1e-3, 1.0, 37.0, 1e6])))
def test_soups(digits: int, scale: float, tmp_path: Path) -> None:
    """Every face has its own corners, moved by what the digits leave, each rounded by itself."""
    mesh = roof()
    rng = np.random.default_rng(digits)
    points = mesh.vertices[mesh.corners] * scale
    points += rng.uniform(-0.2, 0.2, points.shape) * 10.0 ** (1 - digits) * scale
    text = obj(points, np.arange(len(points)).reshape(-1, 4).tolist(), f"{{:.{digits}g}}")
    path = tmp_path / "a.obj"
    if digits > 5:
        assert is_roof(read(path, text).mesh, scale, 20 * 10.0**-digits)
        return
    # Five digits may leave more than what is joined unasked: on request.
    path.write_text(text)
    assert is_roof(read_mesh(path, merge=3e-4 * scale).mesh, scale, 1e-3)


@pytest.mark.parametrize("digits", [3, 4])
def test_what_few_digits_leave_apart_is_told(digits: int, tmp_path: Path) -> None:
    """Corners that differ in the last of few digits: what is told to weld helps."""
    mesh = roof()
    points = np.round(mesh.vertices[mesh.corners], digits - 1)
    points[::3, 0] += 10.0 ** (1 - digits)
    text = obj(points, np.arange(len(points)).reshape(-1, 4).tolist(), f"{{:.{digits - 1}f}}")
    try:
        said = " ".join(read(tmp_path / "a.obj", text).notes)
    except MeshError as error:
        said = str(error)
    assert "its numbers have few digits: vertices such as" in said
    assert "(--weld, [net] weld_mm)" in said
    asked = float(said.partition("what is nearer than ")[2].split()[0])
    assert is_roof(read_mesh(tmp_path / "a.obj", merge=asked).mesh, 1.0, 4 * 10.0 ** (1 - digits))


@pytest.mark.parametrize("seed", range(4))
def test_components_that_almost_meet_are_told(seed: int, tmp_path: Path) -> None:
    """Corners modelled up to a millimetre apart: what is told to weld gives one mesh."""
    mesh, noise = roof(), np.random.default_rng(seed)
    corners = mesh.vertices[mesh.corners]
    side = float(np.median(mesh.edge_lengths))
    faces = np.arange(len(corners)).reshape(-1, 4).tolist()
    points = corners + 2e-4 * side * noise.normal(size=corners.shape)
    found = read(tmp_path / "a.obj", obj(points, faces, "{:.9f}"))
    (said,) = (note for note in found.notes if "come near each other" in note)
    asked = float(said.partition("nearer than ")[2].split()[0])
    assert is_roof(read_mesh(tmp_path / "a.obj", merge=asked).mesh, 1.0, 2e-3 * side)
    # Faces that are apart by a joint as wide as a pane's are no such components.
    apart = corners + 0.02 * (mesh.vertices[mesh.corners] - np.repeat(
        mesh.face_centers, mesh.face_sizes, axis=0))  # fmt: skip
    found = read(tmp_path / "b.obj", obj(apart - 0.04 * corners, faces, "{:.9f}"))
    assert not any("come near" in note for note in found.notes)


BREAKS: dict[str, Callable[[str, list[str], list[str]], str]] = {
    "as written": lambda c, p, f: "OFF\n" + "\n".join([c, *p, *f]),
    "no word OFF": lambda c, p, f: "\n".join([c, *p, *f]),
    "no word OFF, one line": lambda c, p, f: " ".join([c, *p, *f]),
    "counts behind OFF": lambda c, p, f: f"OFF {c}\n" + "\n".join(p + f),
    "no space behind OFF": lambda c, p, f: f"OFF{c}\n" + "\n".join(p + f),
    "one line": lambda c, p, f: " ".join(["OFF", c, *p, *f]),
    "a number a line": lambda c, p, f: "\n".join(" ".join(["OFF", c, *p, *f]).split()),
    "blank lines": lambda c, p, f: "OFF\n\n" + "\n\n \n".join([c, *p, *f]),
    "comments": lambda c, p, f: "# a\nOFF # b\n" + " # c 1 2\n# d\n".join([c, *p, *f]),
    "two points a line": lambda c, p, f: f"OFF\n{c}\n" + "\n".join(
        " ".join(p[i : i + 2]) for i in range(0, len(p), 2)) + "\n" + "\n".join(f),
    "faces broken": lambda c, p, f: f"OFF\n{c}\n" + "\n".join(p) + "\n" + "\n".join(f).replace(
        " ", "\n"),
    "tabs": lambda c, p, f: "OFF\n" + "\n".join([c, *p, *f]).replace(" ", "\t  "),
    "old line ends": lambda c, p, f: "OFF\r" + "\r".join([c, *p, *f]),
    "no edges stated": lambda c, p, f: "OFF\n" + "\n".join([c.rsplit(" ", 1)[0], *p, *f]),
    "edges wrong": lambda c, p, f: "OFF\n" + "\n".join([c.rsplit(" ", 1)[0] + " 99", *p, *f]),
    "vertex colors": lambda c, p, f: "COFF\n" + "\n".join([c, *(q + " 9 8 7 255" for q in p), *f]),
    "face colors": lambda c, p, f: "OFF\n" + "\n".join([c, *p, *(g + " 0.1 0.2 0.3" for g in f)]),
    "whole colors": lambda c, p, f: "OFF\n" + "\n".join([c, *p, *(g + " 255 0 0" for g in f)]),
    "normals": lambda c, p, f: "NOFF\n" + "\n".join([c, *(q + " 0 0 1" for q in p), *f]),
    "something behind": lambda c, p, f: "OFF\n" + "\n".join([c, *p, *f, "4 0 1 2 3"]),
}  # fmt: skip


@pytest.mark.parametrize("name", BREAKS)
def test_off_files(name: str, tmp_path: Path) -> None:
    mesh = roof()
    points = ["{!r} {!r} {!r}".format(*p) for p in mesh.vertices.tolist()]
    faces = [f"{len(f)} " + " ".join(map(str, f)) for f in lists(mesh)]
    text = BREAKS[name](f"{len(points)} {len(faces)} 0", points, faces)
    assert is_roof(read(tmp_path / "a.off", text + "\n").mesh)


@pytest.mark.parametrize(("v", "f"), [(1, 0), (0, 1), (-1, 0), (3, 3), (0, 10**5), (10**5, 0)])
def test_off_counts_that_are_wrong_are_told(v: int, f: int, tmp_path: Path) -> None:
    mesh = roof()
    write_mesh(tmp_path / "a.off", mesh)
    text = (tmp_path / "a.off").read_text()
    head = f"{mesh.n_vertices} {mesh.n_faces} {mesh.n_edges}"
    assert head in text
    with pytest.raises(MeshError, match=r"a\.off:\d+: "):
        read(tmp_path / "a.off", text.replace(head, f"{mesh.n_vertices + v} {mesh.n_faces + f} 0"))


@pytest.mark.parametrize("seed", range(10))
def test_corners_that_come_twice(seed: int, tmp_path: Path) -> None:
    """Triangles stored as quads, any corner twice in a row, among faces that are right."""
    mesh = roof()
    rng = np.random.default_rng(seed)
    faces = lists(mesh)
    cut = int(rng.integers(len(faces)))
    a, b, c, d = faces[cut]
    twice = [[a, b, c], [a, c, d]]
    for face in twice:
        face.insert(int(rng.integers(3)) + 1, 0)
        at = face.index(0, 1) if face[0] == 0 else face.index(0)
        face[at] = face[at - 1]
    found = read(tmp_path / "a.obj", obj(mesh.vertices, [*faces[:cut], *twice, *faces[cut + 1 :]]))
    assert sorted(found.mesh.face_sizes.tolist()) == [3, 3] + [4] * (len(faces) - 1)
    assert any("2 faces repeated a corner" in note for note in found.notes)


def pairs(mesh: Mesh, way: str, rng: np.random.Generator) -> list[list[int]]:
    """Triangles of the quads, cut along one diagonal, in turn, or by chance; any first corner."""
    out = []
    for i, (a, b, c, d) in enumerate(lists(mesh)):
        other = {"same": 0, "turn": i % 2, "chess": (i + i // GRID[1]) % 2}.get(way)
        other = int(rng.integers(2)) if other is None else other
        for face in [[a, b, d], [b, c, d]] if other else [[a, b, c], [a, c, d]]:
            k = int(rng.integers(3))
            out.append(face[k:] + face[:k])
    return out


@pytest.mark.parametrize(
    ("way", "kind"), list(product(["same", "turn", "chess", "chance"], ["obj", "stl", "text stl"]))
)
def test_cut_quads(way: str, kind: str, tmp_path: Path) -> None:
    mesh = roof()
    triangles = pairs(mesh, way, np.random.default_rng(4))
    if kind == "obj":
        content: str | bytes = obj(mesh.vertices, triangles)
    elif kind == "stl":
        corners = mesh.vertices[np.array(triangles)].reshape(-1, 9).tolist()
        body = b"".join(struct.pack("<12fH", 0, 0, 0, *t, 0) for t in corners)
        content = b" " * 80 + struct.pack("<I", len(triangles)) + body
    else:
        rows = [
            "vertex {:.7e} {:.7e} {:.7e}".format(*mesh.vertices[i]) for t in triangles for i in t
        ]
        content = "solid a\n" + "\n".join(rows) + "\nendsolid a\n"
    path = tmp_path / f"a.{kind[-3:]}"
    found = read(path, content)
    assert set(found.mesh.face_sizes.tolist()) == {3}
    assert any("--quads" in note for note in found.notes)
    assert is_roof(read_mesh(path, quads=True).mesh, digits=1e-6)


WRAPS: dict[str, Callable[[object], object]] = {
    "alone": lambda m: m,
    "list": lambda m: [m],
    "dictionary": lambda m: {"mesh": m, "name": "roof"},
    "scene": lambda m: {"scene": {"children": [{"item": m, "settings": {}}]}},
    "session": lambda m: {"state": {"data": {"objects": {"a": {"value": 3}, "b": [m, 1]}}}},
}


@pytest.mark.parametrize(("version", "wrap", "first"), list(product([1, 2], WRAPS, [0, 5])))
def test_compas_files(version: int, wrap: str, first: int, tmp_path: Path) -> None:
    text = json.dumps(WRAPS[wrap](compas(version, roof(), first)))
    assert is_roof(read(tmp_path / "a.json", text).mesh)
    assert is_roof(read(tmp_path / "a.json.gz", gzip.compress(text.encode())).mesh)


@pytest.mark.parametrize("code", ["f4", "f8", "i4"])
@pytest.mark.parametrize("index", ["i1", "u1", "i2", "u2", "i4", "u4"])
def test_ply_files(code: str, index: str, tmp_path: Path) -> None:
    mesh = roof()
    scale = 1000.0 if code == "i4" else 1.0
    names = {"f4": "float", "f8": "double", "i4": "int", "i1": "char", "u1": "uint8", "i2": "short",
             "u2": "uint16", "u4": "uint"}  # fmt: skip
    for order, kind in (("<", "binary_little_endian"), (">", "binary_big_endian")):
        head = f"ply\nformat {kind} 1.0\nelement vertex {mesh.n_vertices}\nproperty uchar red\n"
        head += "".join(f"property {names[code]} {axis}\n" for axis in "zyx")
        head += f"element face {mesh.n_faces}\nproperty list uchar {names[index]} vertex_index\n"
        head += "property float quality\nend_header\n"
        points = np.round(mesh.vertices * scale, 0 if code == "i4" else 12)
        body = b"".join(b"\7" + p[::-1].astype(order + code).tobytes() for p in points)
        body += b"".join(
            b"\4" + f.astype(order + index).tobytes() + np.array(2, order + "f4").tobytes()
            for f in mesh.faces
        )
        found = read(tmp_path / "a.ply", head.encode() + body)
        assert is_roof(found.mesh, scale, 1e-3 if code == "i4" else 1e-6)


@pytest.mark.parametrize("seed", range(10))
def test_mixed_orientation(seed: int, tmp_path: Path) -> None:
    mesh = roof()
    rng = np.random.default_rng(seed)
    faces = [f[::-1] if rng.random() < 0.35 else f for f in lists(mesh)]
    turned = sum(f != g for f, g in zip(faces, lists(mesh), strict=True))
    found = read(tmp_path / "a.obj", obj(mesh.vertices, faces))
    assert is_roof(found.mesh)
    assert np.sign(found.mesh.vector_areas[:, 2]).tolist() == [
        1.0 if 2 * turned <= len(faces) else -1.0
    ] * len(faces)


def split_side(rim: bool) -> tuple[Floats, list[list[int]]]:
    """A square beside two smaller ones whose common corner lies on its side."""
    points = [
        [0, 0, 0],
        [2, 0, 0],
        [2, 2, 0],
        [0, 2, 0],
        [2, 1, 0],
        [3, 0, 0],
        [3, 1, 0],
        [3, 2, 0],
    ]
    faces = [[0, 1, 2, 3], [1, 5, 6, 4], [4, 6, 7, 2]]
    if not rim:  # closed all round, so that the corner is inside the piece
        points += [[-1, -1, 0], [4, -1, 0], [4, 3, 0], [-1, 3, 0]]
        faces += [[8, 9, 5, 1, 0], [9, 10, 7, 6, 5], [10, 11, 3, 2, 7], [11, 8, 0, 3]]
    return np.array(points, dtype=float), faces


@pytest.mark.parametrize("rim", [True, False])
@pytest.mark.parametrize("seed", range(6))
def test_corners_on_sides(rim: bool, seed: int, tmp_path: Path) -> None:
    """Turned, scaled and renumbered by chance; the vertex and the ends of the side are named."""
    points, faces = split_side(rim)
    rng = np.random.default_rng(seed)
    frame = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    new = rng.permutation(len(points))
    moved = np.empty_like(points)
    moved[new] = (points @ frame + rng.normal(size=3)) * 10.0 ** rng.integers(-2, 4)
    faces = [[int(new[i]) for i in face] for face in faces]
    ends = sorted([int(new[1]), int(new[2])])
    words = rf"vertex {new[4]} lies on edge {ends[0]}-{ends[1]} of face 0"
    with pytest.raises(MeshError, match=words):
        read(tmp_path / "a.obj", obj(moved, faces))


@pytest.mark.parametrize(("start", "reverse"), list(product(range(4), [False, True])))
@pytest.mark.parametrize("parts", ["quad", "triangles", "one triangle"])
def test_faces_twice(start: int, reverse: bool, parts: str, tmp_path: Path) -> None:
    mesh = roof()
    face = lists(mesh)[4]
    face = face[start:] + face[:start]
    a, b, c, d = face[::-1] if reverse else face
    more = {
        "quad": [[a, b, c, d]],
        "triangles": [[a, b, c], [a, c, d]],
        "one triangle": [[b, c, d]],
    }
    words = r"same vertices as face 4|lie on one another"
    with pytest.raises(MeshError, match=words) as caught:
        read(tmp_path / "a.obj", obj(mesh.vertices, lists(mesh) + more[parts]))
    assert caught.value.line is not None
