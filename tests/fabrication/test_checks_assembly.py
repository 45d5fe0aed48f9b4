"""Clearances: compared with manifold3d on all pairs, and with hand-made cases."""

from __future__ import annotations

import itertools
import time

import manifold3d
import numpy as np
import pytest
from gridshell_kinds import KINDS

from ddgfab.errors import KernelError
from fabrication.checks.assembly import check_assembly, examine_assembly
from fabrication.checks.mesh import to_manifold
from fabrication.parts.panel import PanelShape
from fabrication.specs import Family, Instance, Role, TriangleMesh

SHAPE = PanelShape(1.0, np.zeros((4, 2)), np.zeros((4, 2)))  # never looked at: meshes are given


def mesh_of(body: manifold3d.Manifold) -> TriangleMesh:
    mesh = body.to_mesh64()
    return TriangleMesh(
        np.array(mesh.vert_properties)[:, :3].copy(), np.array(mesh.tri_verts).astype(np.int64)
    )


def box(x: float, y: float, z: float) -> TriangleMesh:
    return mesh_of(manifold3d.Manifold.cube((x, y, z), True))


def at(x: float, y: float, z: float) -> np.ndarray:
    placement = np.eye(4)
    placement[:3, 3] = x, y, z
    return placement


def family(number: str, role: Role, *instances: tuple[str, np.ndarray]) -> Family:
    return Family(number, KINDS[role], SHAPE, tuple(Instance(m, p) for m, p in instances), 0.0)


def faults(checks: dict[str, list]) -> dict[str, list[tuple[str, float]]]:
    bad = {
        mark: [(check.name, check.value) for check in list_ if not check.passed]
        for mark, list_ in checks.items()
    }
    return {mark: list_ for mark, list_ in bad.items() if list_}


def random_motion(rng: np.random.Generator, size: float) -> np.ndarray:
    q, r = np.linalg.qr(rng.normal(size=(3, 3)))
    q *= np.sign(np.diag(r))
    q[:, 0] *= np.sign(np.linalg.det(q))
    motion = np.eye(4)
    motion[:3, :3], motion[:3, 3] = q, rng.uniform(0, size, 3)
    return motion


@pytest.mark.parametrize("seed", range(3))
def test_random_bodies_give_the_clashes_that_all_pairs_give(seed: int) -> None:
    rng = np.random.default_rng(seed)
    bodies = {
        "BP-001": box(60, 10, 8),
        "NP-001": mesh_of(manifold3d.Manifold.cylinder(20, 10, 10, 24, True)),
        "PP-001": mesh_of(  # not convex: an L
            manifold3d.Manifold.cube((40, 40, 4)) - manifold3d.Manifold.cube((30, 30, 9))
        ),
    }
    roles: dict[str, Role] = {"BP-001": "beam", "NP-001": "node", "PP-001": "panel"}
    families = [
        family(
            number,
            roles[number],
            *((f"{number}/{i}", random_motion(rng, 200)) for i in range(25)),
        )
        for number in bodies
    ]
    clearances = {("node", "beam"): 3.0, ("panel", "panel"): 6.0, ("beam", "panel"): 1.0}
    report = examine_assembly(families, bodies, clearances, tolerance=0.0)  # type: ignore[arg-type]
    found = {frozenset(clash.marks): clash.gap for clash in report.clashes}

    placed = [
        (f.role, i.mark, to_manifold(bodies[f.number]).transform(i.placement[:3]))
        for f in families
        for i in f.instances
    ]
    expected = {}
    for (role, mark, body), (other_role, other, other_body) in itertools.combinations(placed, 2):
        limit = clearances.get((role, other_role), clearances.get((other_role, role), 0.0))
        gap = body.min_gap(other_body, 10.0)
        if gap < limit or (body ^ other_body).volume() > 0:
            expected[frozenset((mark, other))] = gap
    assert len(expected) > 10
    assert set(found) == set(expected)
    for pair, gap in expected.items():
        if gap > 0:
            assert found[pair] == pytest.approx(gap, abs=1e-9)
        else:
            assert found[pair] < 0
    assert report.measured < report.pairs


def test_both_marks_the_gap_and_the_limit_are_named() -> None:
    families = [
        family("BP-001", "beam", ("B-0000", at(0, 0, 0))),
        family("NP-001", "node", ("N-0000", at(50.2, 0, 0)), ("N-0001", at(500, 0, 0))),
    ]
    meshes = {"BP-001": box(80, 10, 10), "NP-001": box(20, 20, 20)}
    checks = check_assembly(families, meshes, {("beam", "node"): 0.5})
    (check,) = checks["B-0000"]
    assert not check.passed
    assert (check.name, check.other) == ("clearance", "N-0000")
    assert check.value == pytest.approx(0.2, abs=1e-9)
    assert check.limit == 0.5
    assert checks["N-0000"][0].other == "B-0000"
    (alone,) = checks["N-0001"]
    assert alone.passed
    assert faults(check_assembly(families, meshes, {("node", "beam"): 0.2})) == {}


def test_faces_that_touch_pass_and_overlaps_are_measured_by_their_depth() -> None:
    meshes = {"BP-001": box(100, 10, 10), "NP-001": box(20, 20, 20)}

    def found(x: float) -> dict[str, list[tuple[str, float]]]:
        families = [
            family("BP-001", "beam", ("B-0000", at(0, 0, 0))),
            family("NP-001", "node", ("N-0000", at(x, 0, 0))),
        ]
        return faults(check_assembly(families, meshes, {}))

    assert found(60.0) == {}
    for overlap in (1e-4, 0.005, 0.1):
        ((_, depth),) = found(60.0 - overlap)["B-0000"]
        assert depth == pytest.approx(-overlap, rel=0.05)


def test_a_part_inside_another_is_found() -> None:
    families = [
        family("NP-001", "node", ("N-0000", at(0, 0, 0))),
        family("BP-001", "beam", ("B-0000", at(1, 2, 3))),
    ]
    meshes = {"NP-001": box(100, 100, 100), "BP-001": box(10, 10, 10)}
    assert set(faults(check_assembly(families, meshes, {}))) == {"N-0000", "B-0000"}


def test_a_coped_beam_may_embrace_its_node_though_their_hulls_overlap() -> None:
    cylinder = manifold3d.Manifold.cylinder(200, 50.5, 50.5, 64, True)
    coped = manifold3d.Manifold.cube((300, 60, 100), True) - cylinder.translate((150, 0, 0))
    meshes = {
        "BP-001": mesh_of(coped),
        "NP-001": mesh_of(manifold3d.Manifold.cylinder(150, 50, 50, 64, True)),
    }
    families = [
        family("BP-001", "beam", ("B-0000", at(0, 0, 0))),
        family("NP-001", "node", ("N-0000", at(150, 0, 0))),
    ]
    report = examine_assembly(families, meshes, {("beam", "node"): 0.4})
    assert (report.pairs, report.measured, report.clashes) == (1, 1, ())
    families[1] = family("NP-001", "node", ("N-0000", at(149, 0, 0)))
    assert len(examine_assembly(families, meshes, {("beam", "node"): 0.4}).clashes) == 1


def test_no_pieces_no_checks_and_open_meshes_are_refused() -> None:
    assert check_assembly([], {}, {}) == {}
    good = box(10, 10, 10)
    meshes = {"BP-001": good, "NP-001": TriangleMesh(good.vertices, good.triangles[1:])}
    families = [
        family("BP-001", "beam", ("B-0000", at(0, 0, 0))),
        family("NP-001", "node", ("N-0000", at(1, 0, 0))),
    ]
    with pytest.raises(KernelError, match="NP-001"):
        check_assembly(families, meshes, {})


def test_cost_grows_about_linearly() -> None:
    def seconds(n: int) -> float:
        rng = np.random.default_rng(0)
        cells = [(i, j) for i in range(n) for j in range(n)]
        families, meshes = [], {}
        for i, j in cells:
            number = f"PP-{i:03d}{j:03d}"
            meshes[number] = box(97 + rng.random(), 97 + rng.random(), 5)
            families.append(family(number, "panel", (number, at(100 * i, 100 * j, 0))))
        begin = time.process_time()
        report = examine_assembly(families, meshes, {("panel", "panel"): 1.5})
        assert report.clashes == ()
        assert report.measured == 0
        return time.process_time() - begin

    seconds(4)
    small, large = seconds(12), seconds(36)  # 9 times as many
    assert large < 9 * 4 * small
