"""Volume that placed bodies share: against manifold3d on all pairs, in files of every format."""

from __future__ import annotations

import itertools
import json
import struct
import time
from pathlib import Path

import manifold3d
import numpy as np
import pytest
from gridshell_kinds import KINDS

from fabrication.checks.overlaps import ClosedMesh, overlaps
from fabrication.formats.glb import write_glb
from fabrication.formats.report import inspect_file
from fabrication.formats.threemf import Body3MF, Item3MF, write_threemf
from fabrication.parts.panel import PanelShape
from fabrication.specs import Family, Instance, TriangleMesh


def mesh_of(body: manifold3d.Manifold) -> TriangleMesh:
    mesh = body.to_mesh64()
    return TriangleMesh(
        np.array(mesh.vert_properties)[:, :3].copy(), np.array(mesh.tri_verts).astype(np.int64)
    )


BOX = mesh_of(manifold3d.Manifold.cube((10.0, 10.0, 10.0)))
BODIES = [
    manifold3d.Manifold.cube((30.0, 4.0, 3.0), True),
    manifold3d.Manifold.cylinder(12, 5, 5, 20, True),
    manifold3d.Manifold.cube((20.0, 20.0, 3.0)) - manifold3d.Manifold.cube((14.0, 14.0, 9.0)),
]


def at(*shift: float) -> np.ndarray:
    motion = np.eye(4)
    motion[:3, 3] = shift
    return motion


def random_motion(rng: np.random.Generator, size: float) -> np.ndarray:
    q, r = np.linalg.qr(rng.normal(size=(3, 3)))
    q *= np.sign(np.diag(r))
    q[:, 0] *= np.sign(np.linalg.det(q))
    motion = np.eye(4)
    motion[:3, :3], motion[:3, 3] = q, rng.uniform(0, size, 3)
    return motion


@pytest.mark.parametrize("seed", range(4))
def test_random_structures_give_the_pairs_that_manifold3d_gives(seed: int) -> None:
    rng = np.random.default_rng(seed)
    owner = np.repeat(np.arange(3), 15)
    motions = np.array([random_motion(rng, 90) for _ in owner])
    # One is scaled and one is mirrored, as 3MF and GLB may have them.
    motions[3, :3, :3] *= 1.5
    motions[20, :3, :3] = motions[20, :3, :3] @ np.diag([1, 1, -1])
    bodies = [ClosedMesh(mesh_of(body), body.volume()) for body in BODIES]
    found = {o.pair: o.volume for o in overlaps(bodies, owner, motions, np.zeros(3))}
    placed = [BODIES[k].transform(m[:3]) for k, m in zip(owner, motions, strict=True)]
    expected = {}
    for (i, a), (j, b) in itertools.combinations(enumerate(placed), 2):
        volume = (a ^ b).volume()
        if volume > 1e-9:
            expected[i, j] = volume
    assert len(expected) > 5
    assert found.keys() == expected.keys()
    assert [found[p] for p in expected] == pytest.approx(list(expected.values()), rel=1e-6)


def test_what_touches_shares_nothing_and_the_least_overlap_is_found() -> None:
    box = [ClosedMesh(BOX, 1000.0)]
    turn = random_motion(np.random.default_rng(1), 5000)

    def found(gap: float) -> int:
        motions = np.array([turn, turn @ at(10 + gap, 3, 3)])
        return len(overlaps(box, np.zeros(2, dtype=int), motions, np.zeros(1)))

    assert [found(gap) for gap in (0.0, 1e-3, -1e-5, -1e-2)] == [0, 0, 1, 1]


def test_the_tolerances_of_both_bodies_add_up() -> None:
    boxes = [ClosedMesh(BOX, 1000.0), ClosedMesh(BOX, 1000.0)]
    tolerances = np.array([0.02, 0.03])

    def found(depth: float) -> list[float]:
        motions = np.array([np.eye(4), at(10 - depth, 3, 3)])
        return [o.depth for o in overlaps(boxes, np.arange(2), motions, tolerances)]

    assert found(0.049) == []
    assert found(0.051) == pytest.approx([0.051], rel=0.05)


def test_hundreds_of_placed_solids_take_little_time() -> None:
    body = [ClosedMesh(BOX, 1000.0)]
    motions = np.array([at(10.0 * i, 10.0 * j, 0) for i in range(20) for j in range(30)])
    owner = np.zeros(len(motions), dtype=int)
    overlaps(body, owner[:2], motions[:2], np.zeros(1))
    begin = time.process_time()
    assert overlaps(body, owner, motions, np.zeros(1)) == []
    assert time.process_time() - begin < 3.0  # 0.3 s on the machine it was written on


def test_a_glb_is_sound_only_if_its_placed_parts_are(tmp_path: Path) -> None:
    shape = PanelShape(1.0, np.zeros((4, 2)), np.zeros((4, 2)))  # never looked at

    def report(x: float) -> object:
        pieces = (Instance("P-0000", np.eye(4)), Instance("P-0001", at(x, 5, 5)))
        family = Family("PP-001", KINDS["panel"], shape, pieces, 0.0)
        write_glb(tmp_path / "a.glb", [family], {"PP-001": BOX})
        return inspect_file(tmp_path / "a.glb").problems

    assert report(10) == ()
    (text,) = report(5)  # type: ignore[misc]
    assert text.startswith("P-0000 and P-0001 overlap: they share 125 mm3")


def test_a_glb_of_nodes_with_translation_rotation_and_scale_is_read(tmp_path: Path) -> None:
    shape = PanelShape(1.0, np.zeros((4, 2)), np.zeros((4, 2)))
    pieces = (Instance("P-0000", np.eye(4)), Instance("P-0001", at(20, 0, 0)))
    path = tmp_path / "a.glb"
    write_glb(path, [Family("PP-001", KINDS["panel"], shape, pieces, 0.0)], {"PP-001": BOX})
    data = path.read_bytes()
    size = struct.unpack_from("<I", data, 12)[0]
    document = json.loads(data[20 : 20 + size])
    node = next(n for n in document["nodes"] if n["name"] == "P-0001")
    del node["matrix"]
    half = float(np.sqrt(0.5))
    # A quarter turn about glTF's y, which is our z: x goes to y.
    node |= {"translation": [0.02, 0, 0], "rotation": [0, half, 0, half], "scale": [2, 1, 1]}
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    rest = data[20 + size :]
    head = struct.pack("<4sII", b"glTF", 2, 20 + len(text) + len(rest))
    path.write_bytes(head + struct.pack("<I4s", len(text), b"JSON") + text + rest)
    report = inspect_file(path)
    assert report.problems == ()  # turned: it reaches from 10 to 20 along x, from 0 to 20 along y
    assert report.volume_mm3 == pytest.approx(3000, rel=1e-6)


def test_a_3mf_is_sound_only_if_what_it_builds_is(tmp_path: Path) -> None:
    path = tmp_path / "a.3mf"
    turn = random_motion(np.random.default_rng(2), 50)
    for x, sound in ((10.0, True), (9.0, False)):
        items = [Item3MF(0, "L-1", turn), Item3MF(0, "L-2", turn @ at(x, 0, 0))]
        write_threemf(path, [Body3MF("LP-001", BOX)], items)
        report = inspect_file(path)
        assert report.passed == sound
    assert report.problems[0].startswith("L-1 and L-2 overlap: they share 100 mm3")


@pytest.mark.slow
def test_a_step_assembly_is_sound_only_if_its_placed_solids_are(tmp_path: Path) -> None:
    from OCP.BRep import BRep_Builder
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut
    from OCP.BRepPrimAPI import (
        BRepPrimAPI_MakeBox,
        BRepPrimAPI_MakeCylinder,
        BRepPrimAPI_MakeSphere,
    )
    from OCP.gp import gp_Pnt
    from OCP.STEPControl import STEPControl_StepModelType, STEPControl_Writer
    from OCP.TopoDS import TopoDS_Compound

    from fabrication.formats.step import StepProduct, write_assembly
    from fabrication.specs import Properties

    box = BRepPrimAPI_MakeBox(10, 10, 10).Solid()
    bored = BRepAlgoAPI_Cut(box, BRepPrimAPI_MakeCylinder(3, 40).Shape()).Shape()
    product = StepProduct("NP-001", KINDS["node"], box, Properties(1000.0, 600.0, (5, 5, 5)))
    path = tmp_path / "a.step"
    for x, sound in ((10.0, True), (5.0, False)):
        marks = [("NP-001", "N-0000", np.eye(4)), ("NP-001", "N-0001", at(x, 0, 0))]
        write_assembly(path, [product], marks, name="R")
        report = inspect_file(path)
        assert report.passed == sound
    assert report.problems == ("N-0000 and N-0001 overlap: they share 500 mm3, some 2.5 mm deep",)

    def written(*shapes: object) -> object:
        builder, whole = BRep_Builder(), TopoDS_Compound()
        builder.MakeCompound(whole)
        for shape in shapes:
            builder.Add(whole, shape)
        writer = STEPControl_Writer()
        writer.Transfer(whole, STEPControl_StepModelType.STEPControl_AsIs)
        writer.Write(str(path))
        return inspect_file(path)

    pin = BRepPrimAPI_MakeCylinder(3, 10).Solid()
    assert written(bored, pin).problems == ()  # it fills the bore: they touch
    thick = BRepPrimAPI_MakeCylinder(3.2, 10).Solid()
    assert "overlap" in written(bored, thick).problems[0]
    inner = BRepPrimAPI_MakeBox(gp_Pnt(2, 2, 2), 5, 5, 5).Solid()
    nested = written(box, inner)
    assert "they share 125 mm3" in nested.problems[0]
    hollow = BRepAlgoAPI_Cut(box, BRepPrimAPI_MakeSphere(gp_Pnt(5, 5, 5), 2).Shape()).Shape()
    report = written(hollow)
    assert report.passed
    assert sum(body.cavities for body in report.bodies) == 1
