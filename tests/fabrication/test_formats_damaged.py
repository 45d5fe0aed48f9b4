"""Damaged files of ours: `check` ends with a message, reading back with a failed check."""

from __future__ import annotations

import io
import json
import os
import struct
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ddgfab.errors import InputError
from fabrication.formats.base import Header, Provenance, Whole
from fabrication.formats.csv import FORMAT as CSV
from fabrication.formats.glb.read import read_glb
from fabrication.formats.report import inspect_file
from fabrication.formats.threemf.write import Body3MF, Item3MF, threemf_bytes
from fabrication.formats.xlsx import FORMAT as XLSX
from fabrication.specs import TriangleMesh

CORNERS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype="<f4")
ORDER = np.array([0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3], dtype="<u2")


def document() -> dict[str, Any]:
    """A glTF of one tetrahedron that two nodes show."""
    return {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0, 1]}],
        "nodes": [{"mesh": 0, "name": "a"}, {"mesh": 0, "translation": [2.0, 0.0, 0.0]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5123, "count": 12, "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteLength": 48},
            {"buffer": 0, "byteOffset": 48, "byteLength": 24},
        ],
        "buffers": [{"byteLength": 72}],
    }


def glb(content: Any) -> bytes:
    text = json.dumps(content).encode()
    text += b" " * (-len(text) % 4)
    body = CORNERS.tobytes() + ORDER.tobytes()
    parts = struct.pack("<II", len(text), 0x4E4F534A) + text
    parts += struct.pack("<II", len(body), 0x004E4942) + body
    return struct.pack("<4sII", b"glTF", 2, 12 + len(parts)) + parts


def test_the_sound_one_is_read(tmp_path: Path) -> None:
    (tmp_path / "a.glb").write_bytes(glb(document()))
    assert len(read_glb(tmp_path / "a.glb").pieces) == 2
    assert inspect_file(tmp_path / "a.glb").passed


@pytest.mark.parametrize(
    ("path", "value"),
    [
        ((), []),
        (("scenes",), 5),
        (("scene",), -1),
        (("scene",), "0"),
        (("scenes", 0, "nodes"), 0.5),
        (("nodes",), {"0": {}}),
        (("nodes", 0), 7),
        (("nodes", 0, "mesh"), -1),
        (("nodes", 0, "mesh"), None),
        (("nodes", 0, "children"), [0]),
        (("nodes", 0, "children"), [1]),
        (("nodes", 1, "translation"), [1e300, 0, 0]),
        (("nodes", 1, "translation"), [{}, 0, 0]),
        (("nodes", 1, "matrix"), [0.0] * 15),
        (("meshes", 0, "primitives"), []),
        (("meshes", 0, "primitives", 0, "indices"), -1),
        (("meshes", 0, "primitives", 0, "indices"), 0),
        (("accessors", 1, "count"), 10**9),
        (("accessors", 1, "count"), -3),
        (("accessors", 1, "count"), 2.5),
        (("accessors", 0, "componentType"), []),
        (("bufferViews", 1, "byteOffset"), -8),
        (("bufferViews", 1, "byteOffset"), "48"),
        (("bufferViews", 1, "byteStride"), 0),
        (("buffers",), None),
    ],
)
def test_a_glb_of_wrong_values_is_refused(
    path: tuple[str | int, ...], value: Any, tmp_path: Path
) -> None:
    content: Any = document()
    if path:
        holder = content
        for key in path[:-1]:
            holder = holder[key]
        holder[path[-1]] = value
    else:
        content = value
    (tmp_path / "a.glb").write_bytes(glb(content))
    with pytest.raises(InputError, match="not a readable GLB"):
        inspect_file(tmp_path / "a.glb")


def test_few_nodes_that_name_each_other_twice_do_not_multiply(tmp_path: Path) -> None:
    content = document()
    content["nodes"] = [{"children": [k + 1, k + 1]} for k in range(60)] + [{"mesh": 0}]
    content["scenes"][0]["nodes"] = [0]
    (tmp_path / "a.glb").write_bytes(glb(content))
    with pytest.raises(InputError, match="in two places"):
        inspect_file(tmp_path / "a.glb")


def test_a_long_chain_of_nodes_is_read(tmp_path: Path) -> None:
    content = document()
    content["nodes"] = [{"children": [k + 1]} for k in range(5000)] + [{"mesh": 0}]
    content["scenes"][0]["nodes"] = [0]
    (tmp_path / "a.glb").write_bytes(glb(content))
    assert inspect_file(tmp_path / "a.glb").passed


@pytest.mark.filterwarnings("error")
def test_nodes_that_are_flat_mirrored_or_scaled(tmp_path: Path) -> None:
    content = document()
    content["nodes"][0]["scale"] = [0.0, 0.0, 0.0]
    content["nodes"][1]["scale"] = [-1.0, 2.0, 3.0]
    (tmp_path / "a.glb").write_bytes(glb(content))
    report = inspect_file(tmp_path / "a.glb")
    assert report.passed
    assert report.volume_mm3 == pytest.approx(1e9)  # 6 x 1/6 m3


@pytest.mark.parametrize("suffix", ["glb", "stl", "3mf", "step"])
@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no pipes here")
def test_a_pipe_is_refused_and_not_waited_for(suffix: str, tmp_path: Path) -> None:
    os.mkfifo(tmp_path / f"a.{suffix}")
    with pytest.raises(InputError, match="pipe"):
        inspect_file(tmp_path / f"a.{suffix}")
    with pytest.raises(InputError, match="no such file"):
        inspect_file(tmp_path / f"none.{suffix}")


def test_a_3mf_that_unpacks_to_far_more_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    mesh = TriangleMesh(CORNERS.astype(np.float64), ORDER.reshape(-1, 3).astype(np.int64))
    data = threemf_bytes([Body3MF("a", mesh)], [Item3MF(0, "a", np.eye(4))])
    (tmp_path / "a.3mf").write_bytes(data)
    assert inspect_file(tmp_path / "a.3mf").passed
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        files = {name: archive.read(name) for name in archive.namelist()}
    with zipfile.ZipFile(tmp_path / "bomb.3mf", "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files.items():
            archive.writestr(name, content + b" " * 40_000_000)
    monkeypatch.setattr("fabrication.formats.threemf.read.LIMIT_BYTES", 100_000_000)
    with pytest.raises(InputError, match="when unpacked exceed the limit"):
        inspect_file(tmp_path / "bomb.3mf")
    (tmp_path / "no.3mf").write_bytes(b"PK\x03\x04" + b"x" * 90)
    with pytest.raises(InputError, match="no archive"):
        inspect_file(tmp_path / "no.3mf")


@pytest.mark.parametrize("damage", [lambda d: d[:-9], lambda d: b"\xff" + d[::-1], lambda d: b""])
@pytest.mark.parametrize("format", [CSV, XLSX], ids=["csv", "xlsx"])
def test_damaged_schedules_fail_their_check(format: Any, damage: Any, tmp_path: Path) -> None:
    rows = [{"mark": "B-0001", "length_mm": 5.0}, {"mark": "B-0002", "length_mm": 6.0}]
    whole = Whole(
        Provenance("roof", Header("", "", "roof"), {}), {}, (), (), tables={"beams": rows}
    )
    format.write_whole(tmp_path, whole)
    assert all(check.passed for check in format.check_whole(tmp_path, whole))
    for path in sorted((tmp_path / "schedules").iterdir()):
        content = path.read_bytes()
        for number, bad in enumerate((damage(content), None)):
            path.unlink() if bad is None else path.write_bytes(bad)
            checks = format.check_whole(tmp_path, whole)
            assert sum(not check.passed for check in checks) == 1, (path.name, number)
        path.write_bytes(content)
