"""Planes that keep parts apart: every face of a part is one, and a few of them nearly suffice."""

from __future__ import annotations

import manifold3d
import numpy as np
import pytest

from fabrication.checks.nearness import CANDIDATES, Supports, _directions, _separations
from fabrication.specs import TriangleMesh


def mesh_of(body: manifold3d.Manifold) -> TriangleMesh:
    mesh = body.to_mesh64()
    return TriangleMesh(
        np.array(mesh.vert_properties)[:, :3].copy(), np.array(mesh.tri_verts).astype(np.int64)
    )


def random_motions(rng: np.random.Generator, count: int, size: float) -> np.ndarray:
    motions = np.tile(np.eye(4), (count, 1, 1))
    for motion in motions:
        turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        motion[:3, :3] = turn * np.linalg.det(turn)
        motion[:3, 3] = rng.uniform(-size, size, 3)
    return motions


@pytest.mark.parametrize("sides", [3, 4, 7, 24])
def test_every_face_of_a_prism_gives_one_direction(sides: int) -> None:
    prism = manifold3d.Manifold.cylinder(20.0, 5.0, 5.0, sides)
    (motion,) = random_motions(np.random.default_rng(sides), 1, 50.0)
    found = _directions(mesh_of(prism.transform(motion[:3])))
    assert len(found) == sides + 2
    assert np.linalg.norm(found, axis=1) == pytest.approx(np.ones(sides + 2))
    along = found @ motion[:3, 2]
    assert sorted(np.round(along, 9).tolist()) == pytest.approx([-1.0, *[0.0] * sides, 1.0])


def test_a_few_planes_nearly_always_tell_what_all_planes_tell() -> None:
    """They are those that face the middle of the other part, wherever the two are placed."""
    meshes = [
        mesh_of(manifold3d.Manifold.cylinder(h, r, r, 12)) for h, r in ((0.4, 0.1), (0.2, 0.3))
    ]
    supports = Supports.build(meshes)
    rng = np.random.default_rng(3)
    motions = random_motions(rng, 60, 1.5)
    owner = rng.integers(0, 2, 60)
    pairs = np.argwhere(np.triu(np.ones((60, 60), dtype=bool), 1))
    every = _separations(supports, owner, motions, pairs, supports.normals.shape[1])
    some = _separations(supports, owner, motions, pairs, CANDIDATES)
    assert (some <= every).all()
    apart = every > 0
    assert 0.7 < apart.mean() < 1.0
    assert (some[apart] > 0).mean() > 0.98
    assert np.median(some[apart] / every[apart]) > 0.999
