"""Nets and meshes on which tests of invariance run, and the same with other names."""

from __future__ import annotations

from typing import Any

import numpy as np
from net_cases import catenoid_net, circular_net, planar_net, skew_net
from similarity_cases import SIMILARITIES, Similarity

from ddgfab import nets
from ddgfab.grid import grid_mesh
from ddgfab.mesh import Mesh
from ddgfab.nets import circular_to_conical
from ddgfab.nets.knet import dini

IDENTITY = Similarity("identity", 1.0, np.eye(3), np.zeros(3))
NEAR = [at for at in SIMILARITIES if at.name in ("scale 1e-06", "motion", "mirror and turn", "far")]


def mixed(seed: int = 2) -> Mesh:
    """A pentagon with quads and triangles round it, nothing symmetric."""
    rng = np.random.default_rng(seed)
    t = 2 * np.pi * np.arange(5) / 5
    rings = []
    for r, s in ((1.0, 0.0), (2.0, 0.2), (3.0, -0.4)):
        height = 0.2 * r * np.sin(2 * t) - 0.2 * r**2
        rings.append(np.stack([r * np.cos(t + s), r * np.sin(t + s), height], axis=1))
    faces = [[0, 1, 2, 3, 4]]
    for k in range(5):
        m = (k + 1) % 5
        faces += [[k, 5 + k, 5 + m, m], [5 + k, 10 + k, 10 + m], [5 + k, 10 + m, 5 + m]]
    points = np.concatenate(rings)
    return Mesh.build(points + 0.05 * rng.normal(size=points.shape), faces)


def relabelled(mesh: Mesh, seed: int = 0) -> tuple[Mesh, Any, Any]:
    """The mesh with vertices and faces in another order and faces from other corners."""
    rng = np.random.default_rng(seed)
    vertices, faces = rng.permutation(mesh.n_vertices), rng.permutation(mesh.n_faces)
    place = np.argsort(vertices)
    turned = [np.roll(place[mesh.faces[f]], int(rng.integers(4))) for f in faces]
    return Mesh.build(mesh.vertices[vertices], turned), vertices, faces


MESHES = {
    "skew": grid_mesh(skew_net() / 1000.0),
    "circular": grid_mesh(circular_net() / 1000.0),
    "conical": grid_mesh(circular_to_conical(circular_net() / 1000.0)),
    "mixed": mixed(),
    "K-net": grid_mesh(dini(np.full(4, 0.3), np.full(3, 0.25), 1.2).points),
    "translation": grid_mesh(
        np.array([[[u, v, 0.3 * u * u - 0.2 * v * v] for v in range(4)] for u in range(5)], float)
    ),
}


FIRST, SECOND = circular_net()[:, 0] / 1000.0, circular_net()[0] / 1000.0
CIRCULAR, PLANAR, CATENOID = circular_net() / 1000.0, planar_net() / 1000.0, catenoid_net()
KPOINTS = dini(np.full(4, 0.3), np.full(3, 0.25), 1.2).points
QUAD = CIRCULAR[0, 0], CIRCULAR[1, 0], CIRCULAR[0, 1]
THREE = [
    np.array([[0, 0, 0], [1, 0.1, 0.2], [2, 0, 0.1]], float),
    np.array([[0, 0, 0], [0.1, 1, -0.2], [0, 2.1, 0.1]], float),
    np.array([[0, 0, 0], [0.1, -0.2, 1], [0.3, 0.1, 2]], float),
]
PAIRS = ((0, 1), (0, 2), (1, 2))
CORNERS = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 0), (1, 0, 1), (0, 1, 1)]

SYSTEM = nets.evolve_circular_by_angles(THREE, dict.fromkeys(PAIRS, 1.4))
"""A circular net of three directions, so a conjugate one."""
PLANES = nets.coordinate_surfaces(SYSTEM)
