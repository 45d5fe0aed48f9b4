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
from scipy.spatial.transform import Rotation

from fabrication.formats.glb import Movement, glb_bytes
from fabrication.formats.glb.movement import quaternions
from fabrication.formats.glb.normals import shaded
from fabrication.parts.panel import PanelShape
from fabrication.parts.pin import PinShape
from fabrication.solids import mesh_of
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
        indices = document["accessors"][primitive["indices"]]
        offset = document["bufferViews"][2]["byteOffset"] + indices["byteOffset"]
        corners = np.frombuffer(binary, "<u4", indices["count"], offset).reshape(-1, 3)
        # y up: (x, y, z) [mm] is (x, z, -y) [m]; every triangle where it was
        wanted = ours[meshes[number].triangles][..., [0, 2, 1]] * [1, 1, -1] / 1000
        np.testing.assert_allclose(placed[corners], wanted, atol=1e-6)
        role = {"B": "beam", "N": "node", "P": "panel"}[number[0]]
        assert node["extras"] == {"mark": mark, "number": number, "role": role, "status": "ok"}


def test_normals_are_flat_on_blocks_and_radial_on_cylinders() -> None:
    (box,) = shaded([block(3.0, 4.0, 5.0)])
    assert len(box.points) == 24  # three a corner
    assert set(map(tuple, np.abs(box.normals).tolist())) == set(map(tuple, np.eye(3).tolist()))
    assert np.einsum("ni,ni->n", box.normals, box.points - (1.5, 2.0, 2.5)).min() > 0.0
    tube = mesh_of(PinShape(4.0, 20.0), 0.02)
    first, second = shaded([tube, block(1.0, 1.0, 1.0)])
    np.testing.assert_allclose(np.linalg.norm(first.normals, axis=1), 1.0, atol=1e-12)
    side = np.abs(first.normals[:, 2]) < 0.5
    radial = first.points[side, :2] / np.linalg.norm(first.points[side, :2], axis=1)[:, None]
    assert np.abs(first.normals[side, :2] - radial).max() < 0.1  # half a chord's turn
    assert np.abs(np.abs(first.normals[~side, 2]) - 1.0).max() < 1e-12
    # Alone and together they are the same; triangles stay in place.
    (alone,) = shaded([block(1.0, 1.0, 1.0)])
    np.testing.assert_array_equal(second.normals, alone.normals)
    np.testing.assert_array_equal(first.points[first.triangles], tube.vertices[tube.triangles])
    assert shaded([]) == []


def test_quaternions_turn_as_their_matrices_do() -> None:
    turns = Rotation.random(500, random_state=7).as_matrix()
    halves = Rotation.from_rotvec(np.pi * np.vstack([np.eye(3), [[0.6, 0.8, 0.0]]]))
    turns = np.concatenate([turns, halves.as_matrix(), np.eye(3)[None]])
    back = Rotation.from_quat(quaternions(turns)).as_matrix()
    np.testing.assert_allclose(back, turns, atol=1e-14)


def moving() -> bytes:
    """The example; a beam turns about z through more than a whole turn."""
    poses = np.tile(np.eye(4), (9, 1, 1))
    angles = np.linspace(0.0, 7.0, 9)
    poses[:, 0, 0] = poses[:, 1, 1] = np.cos(angles)
    poses[:, 1, 0], poses[:, 0, 1] = np.sin(angles), -np.sin(angles)
    poses[:, 0, 3] = 1000.0 * angles
    return glb_bytes(*example(), {"B-0001"}, movement=Movement("turn", {"B-0000": poses}))


def test_what_moves_goes_there_and_back_without_jumps() -> None:
    document, binary = parse(moving())
    (animation,) = document["animations"]
    views, accessors = document["bufferViews"], document["accessors"]

    def values(number: int) -> np.ndarray:
        accessor = accessors[number]
        start = views[accessor["bufferView"]]["byteOffset"] + accessor["byteOffset"]
        width = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}[accessor["type"]]
        found = np.frombuffer(binary, "<f4", width * accessor["count"], start)
        return found.reshape(-1, width).astype(float)

    assert {channel["target"]["node"] for channel in animation["channels"]} == {
        k for k, node in enumerate(document["nodes"]) if node["name"] == "B-0000"
    }
    shift, turn = (values(sampler["output"]) for sampler in animation["samplers"])
    times = values(animation["samplers"][0]["input"])
    assert len(times) == len(shift) == len(turn) == 17
    assert (np.diff(times[:, 0]) > 0.0).all()
    np.testing.assert_allclose(shift, shift[::-1])
    np.testing.assert_allclose(shift[:9, 0], np.linspace(0.0, 7.0, 9), rtol=1e-6)
    assert (np.einsum("ti,ti->t", turn[1:], turn[:-1]) > 0.0).all()
    angle = 2.0 * np.unwrap(np.arctan2(turn[:9, 1], turn[:9, 3]))  # about y, which is up
    np.testing.assert_allclose(angle, np.linspace(0.0, 7.0, 9), atol=1e-5)


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
    path.write_bytes(moving())
    program = (
        f"require({VALIDATOR!r}).validateBytes(new Uint8Array(require('fs').readFileSync("
        f"{str(path)!r}))).then(r => console.log(JSON.stringify(r.issues)))"
    )
    done = subprocess.run(["node", "-e", program], capture_output=True, text=True, check=True)
    issues = json.loads(done.stdout)
    assert (issues["numErrors"], issues["numWarnings"]) == (0, 0), issues["messages"]
