"""GLB: parsed again by hand, bounds compared with the placed parts, Khronos' validator."""

from __future__ import annotations

import json
import os
import shutil
import struct
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from gridshell_kinds import KINDS

from fabrication.formats.glb import glb_bytes, write_glb
from fabrication.parts.panel import PanelShape
from fabrication.specs import Family, Instance, TriangleMesh

VALIDATOR = os.environ.get("GLTF_VALIDATOR", "")  # .../node_modules/gltf-validator


def block(x: float, y: float, z: float) -> TriangleMesh:
    corners = np.array([[i, j, k] for i in (0, x) for j in (0, y) for k in (0, z)], dtype=float)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return TriangleMesh(
        corners, np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])
    )


def example() -> tuple[list[Family], dict[str, TriangleMesh]]:
    turn = np.eye(4)
    turn[:3, :3] = [[0, -1, 0], [1, 0, 0], [0, 0, 1]]  # x to y, about z
    turn[:3, 3] = 1000, 2000, 3000
    meshes = {
        "BP-001": block(1000, 60, 8),
        "NP-001": block(80, 80, 100),
        "PP-001": block(900, 900, 16),
    }
    # The writer looks at meshes, never at shapes: one shape serves all.
    shape = PanelShape(1.0, np.zeros((4, 2)), np.zeros((4, 2)))
    places = {
        "BP-001": ("beam", (Instance("B-0000", np.eye(4)), Instance("B-0001", turn))),
        "NP-001": ("node", (Instance("N-0000", np.eye(4)),)),
        "PP-001": ("panel", (Instance("P-0000", turn),)),
    }
    families = [
        Family(number, KINDS[role], shape, instances, 0.0)
        for number, (role, instances) in places.items()
    ]
    return families, meshes


def parse(data: bytes) -> tuple[dict[str, Any], bytes]:
    magic, version, total = struct.unpack_from("<4sII", data)
    assert (magic, version, total) == (b"glTF", 2, len(data))
    size, kind = struct.unpack_from("<I4s", data, 12)
    assert kind == b"JSON"
    binary, kind = struct.unpack_from("<I4s", data, 20 + size)
    assert kind == b"BIN\0"
    assert binary == len(data) - 28 - size
    return json.loads(data[20 : 20 + size]), data[28 + size :]


def test_each_instance_is_a_named_node_where_its_part_belongs() -> None:
    families, meshes = example()
    document, binary = parse(glb_bytes(families, meshes, name="Roof"))
    nodes = {node["name"]: node for node in document["nodes"]}
    assert [mesh["name"] for mesh in document["meshes"]] == list(meshes)
    reached = list(document["scenes"][0]["nodes"])
    for i in reached:
        reached += document["nodes"][i].get("children", [])
    assert sorted(reached) == list(range(len(document["nodes"])))
    for number, mark, placement in (
        (f.number, i.mark, i.placement) for f in families for i in f.instances
    ):
        node = nodes[mark]
        primitive = document["meshes"][node["mesh"]]["primitives"][0]
        accessor = document["accessors"][primitive["attributes"]["POSITION"]]
        start = accessor["byteOffset"]
        points = np.frombuffer(binary, "<f4", 3 * accessor["count"], start).reshape(-1, 3)
        np.testing.assert_array_equal(points.min(axis=0), accessor["min"])
        matrix = np.array(node["matrix"]).reshape(4, 4).T
        placed = points @ matrix[:3, :3].T + matrix[:3, 3]
        ours = meshes[number].vertices @ placement[:3, :3].T + placement[:3, 3]
        # y up: (x, y, z) [mm] is (x, z, -y) [m]
        np.testing.assert_allclose(placed, ours[:, [0, 2, 1]] * [1, 1, -1] / 1000, atol=1e-6)
        indices = document["accessors"][primitive["indices"]]
        offset = document["bufferViews"][1]["byteOffset"] + indices["byteOffset"]
        corners = np.frombuffer(binary, "<u4", indices["count"], offset).reshape(-1, 3)
        np.testing.assert_array_equal(corners, meshes[number].triangles)


def test_panels_are_glass_and_the_rest_is_not() -> None:
    document, _ = parse(glb_bytes(*example()))
    materials = {material["name"]: material for material in document["materials"]}
    assert materials["panel"]["alphaMode"] == "BLEND"
    assert materials["panel"]["doubleSided"]
    assert "alphaMode" not in materials["beam"]
    assert glb_bytes(*example()) == glb_bytes(*example())


def test_failed_pieces_are_red_and_their_sisters_are_not() -> None:
    document, _ = parse(glb_bytes(*example(), {"B-0001"}))
    nodes = {node["name"]: node for node in document["nodes"]}

    def material(mark: str) -> str:
        primitive = document["meshes"][nodes[mark]["mesh"]]["primitives"][0]
        return str(document["materials"][primitive["material"]]["name"])

    assert [material(mark) for mark in ("B-0000", "B-0001", "P-0000")] == [
        "beam",
        "failed",
        "panel",
    ]


def test_khronos_validator_finds_no_fault(tmp_path: Path) -> None:
    if shutil.which("node") is None or not VALIDATOR:
        pytest.skip("node or the npm package gltf-validator (GLTF_VALIDATOR) is not installed")
    path = tmp_path / "model.glb"
    write_glb(path, *example(), {"B-0001"})
    program = (
        f"require({VALIDATOR!r}).validateBytes(new Uint8Array(require('fs').readFileSync("
        f"{str(path)!r}))).then(r => console.log(JSON.stringify(r.issues)))"
    )
    done = subprocess.run(["node", "-e", program], capture_output=True, text=True, check=True)
    issues = json.loads(done.stdout)
    assert (issues["numErrors"], issues["numWarnings"]) == (0, 0), issues["messages"]
