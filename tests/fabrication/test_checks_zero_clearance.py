"""No overlap passes, whatever clearance is asked for: random structures, checked another way."""

from __future__ import annotations

import itertools
from typing import Any

import manifold3d
import numpy as np
import pytest
from gridshell_kinds import KINDS
from near_pairs import near_pairs

from ddgfab.mesh import Mesh
from fabrication import design
from fabrication.checks.assembly import check_assembly
from fabrication.checks.mesh import to_manifold
from fabrication.gridshell.room import CHORD_MM
from fabrication.parts.panel import PanelShape
from fabrication.solids import mesh_of
from fabrication.specs import Check, Family, Instance, TriangleMesh

SHAPE = PanelShape(1.0, np.zeros((4, 2)), np.zeros((4, 2)))  # never looked at: meshes are given


def plain(body: manifold3d.Manifold) -> TriangleMesh:
    mesh = body.to_mesh64()
    return TriangleMesh(
        np.array(mesh.vert_properties)[:, :3].copy(), np.array(mesh.tri_verts).astype(np.int64)
    )


def random_motion(rng: np.random.Generator) -> np.ndarray:
    q, r = np.linalg.qr(rng.normal(size=(3, 3)))
    q *= np.sign(np.diag(r))
    q[:, 0] *= np.sign(np.linalg.det(q))
    motion = np.eye(4)
    motion[:3, :3], motion[:3, 3] = q, rng.uniform(-2e4, 2e4, 3)
    return motion


def failing(checks: dict[str, list[Check]]) -> set[frozenset[str]]:
    return {
        frozenset((mark, str(check.other)))
        for mark, rows in checks.items()
        for check in rows
        if not check.passed
    }


@pytest.mark.parametrize("limit", [0.0, 0.05, 0.15])
def test_a_beam_in_a_round_node_is_found_however_little_it_goes_in(limit: float) -> None:
    """The end of a box stands square before a cylinder: the true gap is known without a mesh."""
    rng = np.random.default_rng(5)
    radius, box = 40.0, plain(manifold3d.Manifold.cube((100.0, 20.0, 30.0), True))

    def cylinder(chord: float) -> TriangleMesh:
        sides = int(np.ceil(np.pi / np.arccos(1 - chord / radius)))
        return plain(manifold3d.Manifold.cylinder(200, radius, radius, sides, True))

    cached: dict[float, TriangleMesh] = {}

    def finer(family: Family, chord: float) -> TriangleMesh:
        if family.number == "BP-001":
            return box
        return cached.setdefault(chord, cylinder(chord))

    meshes = {"BP-001": box, "NP-001": cylinder(CHORD_MM)}
    for _ in range(30):
        gap = float(rng.choice([-1, 1]) * 10 ** rng.uniform(-2.3, -0.9))
        turn = rng.uniform(0, 2 * np.pi)
        beam = np.eye(4)
        beam[:2, :2] = [[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]]
        beam[:3, 3] = (radius + gap + 50.0) * beam[:3, 0]
        beam[2, 3] = rng.uniform(-80, 80)
        world = random_motion(rng)
        families = [
            Family("NP-001", KINDS["node"], SHAPE, (Instance("N-0000", world),), 0.0),
            Family("BP-001", KINDS["beam"], SHAPE, (Instance("B-0000", world @ beam),), 0.0),
        ]
        limits = {("beam", "node"): limit}
        found = check_assembly(families, meshes, limits, tolerance=2 * CHORD_MM, finer=finer)
        if gap < 0:
            assert failing(found), gap
        elif gap > limit:
            assert not failing(found), gap


@pytest.mark.parametrize("seed", range(6))
def test_random_boxes_that_nearly_touch(seed: int) -> None:
    """Boxes in a row, each turned and shifted a little: every common volume is a failure."""
    rng = np.random.default_rng(seed)
    sides = rng.uniform(20, 80, (12, 3))
    meshes = {f"BP-{i:03d}": plain(manifold3d.Manifold.cube(tuple(s), True)) for i, s in
              enumerate(sides)}  # fmt: skip
    world, x, families = random_motion(rng), 0.0, []
    for i, side in enumerate(sides):
        at = np.eye(4)
        angle = rng.choice([0.0, 1e-4, 1e-3]) * rng.normal()
        at[:2, :2] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
        x += side[0] / 2 + rng.choice([0.0, 1e-4, 1e-2, -1e-4, -1e-2]) * rng.uniform()
        at[:3, 3] = x, *rng.uniform(-5, 5, 2)
        x += side[0] / 2
        instance = Instance(f"B-{i:04d}", world @ at)
        families.append(Family(f"BP-{i:03d}", KINDS["beam"], SHAPE, (instance,), 0.0))
    found = failing(check_assembly(families, meshes, {}))
    placed = [
        (f.instances[0].mark, to_manifold(meshes[f.number]).transform(f.instances[0].placement[:3]))
        for f in families
    ]
    for (mark, a), (other, b) in itertools.combinations(placed, 2):
        common = a ^ b
        # The corners of the common body tell its thickness along the row, without its volume.
        deep = 0.0
        if common.volume() > 0:
            row = plain(common).vertices @ world[:3, 0]
            deep = float(np.ptp(row))
        if deep > 1e-4:
            assert frozenset((mark, other)) in found
        elif deep < 1e-7:
            assert frozenset((mark, other)) not in found


def roof(rng: np.random.Generator) -> Mesh:
    """A vault of 2 x 2 planar quads, of random size and curvature."""
    t = np.linspace(-1.0, 1.0, 3)
    x, y = rng.uniform(700, 1500, 2)
    u, v = np.meshgrid(t * x, t * y, indexing="ij")
    z = -(u**2) / rng.uniform(4e3, 2e4) - v**2 / rng.uniform(4e3, 2e4)
    points = np.stack([u, v, z], axis=-1).reshape(-1, 3)
    faces = [[0, 3, 4, 1], [1, 4, 5, 2], [3, 6, 7, 4], [4, 7, 8, 5]]
    return Mesh.build(points, faces)


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_random_gridshells_without_clearance(seed: int) -> None:
    """Settings that let parts come near each other: the job's check against all pairs."""
    rng = np.random.default_rng(seed)
    sections: dict[str, dict[str, Any]] = {
        "beam": {
            "profile": str(rng.choice(["FL 60x8", "RHS 60x40x3", "T 50x50x6"])),
            "clearance_mm": float(rng.choice([0.0, 0.02, 0.5])),
            "end": str(rng.choice(["flat", "cope"])),
            "eccentricity_mm": float(rng.uniform(-3, 3)),
        },
        "panel": {
            "offset_mm": float(rng.uniform(-4, 6)),
            "gap_mm": float(rng.choice([0.0, 0.1])),
            "edge": str(rng.choice(["square", "mitred"])),
        },
        "node": {"top_margin_mm": float(rng.uniform(0, 3))},
        "checks": {"family_tolerance_mm": 0.0},
    }
    plan = design(roof(rng), **sections)
    product = plan.product()
    meshes = {f.number: mesh_of(f.shape, CHORD_MM) for f in plan.families}
    found = failing(product.clearances(meshes))
    chord = 1e-3
    placed = [
        (i.mark, to_manifold(mesh_of(f.shape, chord)).transform(i.placement[:3]))
        for f in plan.families
        for i in f.instances
    ]
    overlapping = 0
    for one, two in near_pairs([body for _, body in placed]):
        (mark, a), (other, b) = placed[one], placed[two]
        common = a ^ b
        if common.volume() <= 0:
            continue
        depth = 2 * common.volume() / common.surface_area()
        if depth > 2 * chord:
            overlapping += 1
            assert frozenset((mark, other)) in found, (mark, other, depth)
    if sections["panel"]["offset_mm"] < -1.0:
        assert overlapping
