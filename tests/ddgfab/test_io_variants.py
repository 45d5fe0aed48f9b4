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

from ddgfab.errors import MeshError
from ddgfab.grid import grid_mesh
from ddgfab.io import (
    STATED,
    ReadResult,
    likely_setting,
    read_mesh,
    to_millimetres,
    unlikely_size,
    write_mesh,
)
from ddgfab.mesh import Floats, Mesh

GRID = (4, 3)


def roof() -> Mesh:
    x, y = np.meshgrid(np.arange(5.0), np.arange(4.0), indexing="ij")
    moves = np.random.default_rng(2).uniform(-0.03, 0.03, (20, 3))  # so that all digits are used
    height = 0.3 - 0.05 * ((x - 2.1) ** 2 + (y - 1.3) ** 2)
    mesh = grid_mesh(np.stack([1.37 * x, 1.51 * y, height], axis=-1))
    return mesh.with_vertices(mesh.vertices + moves)


def obj(points: Floats, faces: list[list[int]], form: str = "{:.17g}") -> str:
    rows = ["v " + " ".join(form.format(c) for c in p) for p in points.tolist()]
    return "\n".join([*rows, *("f " + " ".join(str(i + 1) for i in f) for f in faces)]) + "\n"


def lists(mesh: Mesh) -> list[list[int]]:
    return [face.tolist() for face in mesh.faces]


def read(path: Path, content: str | bytes, **ways: object) -> ReadResult:
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return read_mesh(path, **ways)  # type: ignore[arg-type]


def is_roof(found: Mesh, scale: float = 1.0, digits: float = 1e-9) -> bool:
    """The same quads at the same places, in any order."""
    mesh = roof()
    if (found.n_vertices, found.n_edges) != (mesh.n_vertices, mesh.n_edges):
        return False
    if set(found.face_sizes.tolist()) != {4}:
        return False
    gaps = np.linalg.norm(found.vertices[:, None] / scale - mesh.vertices[None], axis=2)
    name = gaps.argmin(axis=1)
    same = {frozenset(name[f].tolist()) for f in found.faces}
    return bool(gaps.min(axis=1).max() < digits) and same == {frozenset(f) for f in lists(mesh)}


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


def compas(version: int, mesh: Mesh, first: int) -> dict[str, object]:
    points = {str(first + i): dict(zip("xyz", p, strict=True)) for i, p in
              enumerate(mesh.vertices.tolist())}  # fmt: skip
    faces = {str(7 * i): [first + v for v in f] for i, f in enumerate(lists(mesh))}
    if version == 1:
        value = {
            "vertex": points,
            "face": faces,
            "dva": {"x": 0.0},
            "edgedata": {},
            "max_vertex": 99,
        }
        return {"dtype": "compas.datastructures/Mesh", "value": value, "guid": "1"}
    data = {"vertex": points, "face": {k: [str(v) for v in f] for k, f in faces.items()},
            "default_vertex_attributes": {"x": 0.0, "z": 0.0}, "facedata": {}}  # fmt: skip
    return {"dtype": "compas.datastructures/Mesh", "data": data, "name": "Mesh"}


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


@pytest.mark.parametrize("up", ["x", "y", "-z", "-y", "-x"])
@pytest.mark.parametrize("far", [False, True])
def test_on_its_side(up: str, far: bool, tmp_path: Path) -> None:
    """Turned files are told with the key that turns them, near and far from the origin."""
    mesh = roof()
    axis = np.zeros(3)
    axis["xyz".index(up[-1])] = -1.0 if up[0] == "-" else 1.0
    other = np.roll(axis, 1)
    points = mesh.vertices @ np.stack([other, np.cross(axis, other), axis])
    points += np.array([3e5, -2e5, 4e5]) * far
    path = tmp_path / "a.obj"
    notes = read(path, obj(points, lists(mesh))).notes
    assert any("look down" in note if up == "-z" else f"--up {up}" in note for note in notes)
    turned = read_mesh(path, up=up)
    assert not any("look down" in note or "upright" in note for note in turned.notes)
    assert np.allclose(np.ptp(turned.mesh.vertices[:, 2]), np.ptp(mesh.vertices[:, 2]), atol=1e-9)


PLACES = [
    (5e5, 0.0, 0.0),
    (0.0, 5.4e6, 0.0),
    (456_789.25, 5_412_345.75, 430.0),
    (-5e5, -2e6, 10.0),
    (691_234.567, 1_234_567.891, -12.3),
    (5e6, 5e6, 5e6),
]


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("kind", ["obj", "off", "ply", "json"])
def test_far_from_the_origin_with_enough_digits(
    place: tuple[float, float, float], kind: str, tmp_path: Path
) -> None:
    """All that is measured is as at the origin, to what four decimals leave."""
    mesh = roof()
    points = np.round(mesh.vertices + place, 4)
    path = tmp_path / f"a.{kind}"
    moved = mesh.with_vertices(points)
    if kind == "json":
        path.write_text(json.dumps(compas(2, moved, 0)))
    else:
        write_mesh(path, moved)
    found = read_mesh(path)
    assert np.abs(found.mesh.vertices).max() < 20
    assert np.allclose(found.in_place.vertices, points, atol=2e-9)
    assert np.allclose(found.mesh.vertices - found.mesh.vertices[0],
                       mesh.vertices - mesh.vertices[0], atol=2e-4)  # fmt: skip
    assert np.allclose(found.mesh.face_normals, mesh.face_normals, atol=2e-4)
    assert not any("rounded" in note for note in found.notes)


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("form", ["{:.6g}", "{:.7g}", "{:.8g}", "float"])
def test_far_from_the_origin_with_too_few_digits(
    place: tuple[float, float, float], form: str, tmp_path: Path
) -> None:
    """The loss is named, with its size, or the mesh is refused: it fell to pieces."""
    mesh = roof()
    points = mesh.vertices + place
    if form == "float":
        head = f"ply\nformat binary_little_endian 1.0\nelement vertex {mesh.n_vertices}\n"
        head += "".join(f"property float {axis}\n" for axis in "xyz")
        head += f"element face {mesh.n_faces}\nproperty list int int vertex_indices\nend_header\n"
        body = points.astype("<f4").tobytes()
        body += np.insert(mesh.corners, mesh.face_start[:-1], 4).astype("<i4").tobytes()
        path, content = tmp_path / "a.ply", head.encode() + body
    else:
        path, content = tmp_path / "a.obj", obj(points, lists(mesh), form).encode()
    try:
        notes = read(path, content).notes
    except MeshError:
        return
    assert any("so far from the origin its numbers are rounded to" in note for note in notes)


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


@pytest.mark.parametrize(
    ("median", "unlikely"),
    [
        *((m, True) for m in (1e-3, 1.5, 19.9, 20_100, 1.5e6)),
        *((m, False) for m in (20.1, 150, 1500, 6000, 19_900)),
    ],
)
def test_sizes_that_no_gridshell_has(median: float, unlikely: bool) -> None:
    assert bool(unlikely_size(median)) == unlikely


@pytest.mark.parametrize("edge", [1e-6, 1.5, 15.0, 900.0, 3e5, 1.5e9])
@pytest.mark.parametrize("unit", ["mm", "m", "ft"])
@pytest.mark.parametrize("scale", [1.0, 0.01])
@pytest.mark.parametrize("stated", [False, True])
def test_the_setting_that_is_advised_gives_a_likely_size(
    edge: float, unit: str, scale: float, stated: bool
) -> None:
    said = unit if stated else None
    factor = to_millimetres(unit, scale, said, None)
    if not unlikely_size(edge * factor):
        return
    key, value = likely_setting(edge * factor, factor, scale, said)
    changed = {"units": unit, "scale": scale, key: value}
    again = to_millimetres(str(changed["units"]), float(changed["scale"]), said, None)
    assert not unlikely_size(edge * again)
    assert key == "scale" or not stated


@pytest.mark.parametrize("unit", ["mm", "cm", "m", "in", "ft"])
@pytest.mark.parametrize("kind", ["obj", "off", "ply"])
def test_files_that_state_their_unit(unit: str, kind: str, tmp_path: Path) -> None:
    factor = {"mm": 1.0, "cm": 10.0, "m": 1000.0, "in": 25.4, "ft": 304.8}[unit]
    path = tmp_path / f"a.{kind}"
    write_mesh(path, roof().scaled(1000 / factor), units=unit)
    assert is_roof(read_mesh(path, units=STATED).mesh, 1000.0)
    packed = tmp_path / f"a.{kind}.gz"
    packed.write_bytes(gzip.compress(path.read_bytes()))
    assert is_roof(read_mesh(packed, units=STATED).mesh, 1000.0)
