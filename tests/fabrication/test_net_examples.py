"""The example projects of generated nets: their offsets, exact through the main job's own axes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from ddgfab.mesh import Floats
from ddgfab.offsets import classify_offset, face_offset, vertex_offset
from fabrication import design
from fabrication.gridshell.design import Design

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
DISTANCE = 300.0


def roof(name: str) -> Design:
    return design(EXAMPLES / name)


def test_circular_vault_has_a_vertex_offset() -> None:
    plan = roof("circular_vault.toml")
    mesh, axes = plan.support.mesh, plan.support.axes
    assert plan.support.kind == "normal"
    report = classify_offset(mesh, mesh.vertices + DISTANCE * axes)
    assert report.constant == ("vertex",)
    assert report.is_parallel
    assert report.spread["vertex"] < 1e-9
    assert (
        np.abs(vertex_offset(mesh, DISTANCE).vertices - mesh.vertices - DISTANCE * axes).max()
        < 1e-9
    )


def test_conical_roof_has_a_face_offset() -> None:
    plan = roof("conical_roof.toml")
    mesh, axes = plan.support.mesh, plan.support.axes
    assert plan.support.kind == "axis"
    # Node axes make one angle with all faces at a node, so they carry the offset of faces.
    height = np.einsum("cx,cx->c", axes[mesh.corners], mesh.face_normals[mesh.corner_face])
    least, most = np.full(mesh.n_vertices, 2.0), np.zeros(mesh.n_vertices)
    np.minimum.at(least, mesh.corners, height)
    np.maximum.at(most, mesh.corners, height)
    assert (most - least).max() < 1e-11
    moved = mesh.vertices + DISTANCE * axes / most[:, None]
    report = classify_offset(mesh, moved)
    assert report.constant == ("face",)
    assert report.is_parallel
    assert report.spread["face"] < 1e-9
    assert np.abs(face_offset(mesh, DISTANCE).vertices - moved).max() < 1e-8


def test_hippo_house_has_a_parallel_translation_net() -> None:
    """Every parallel net of a translation net is one: its distances split into f_i + g_j."""
    plan = roof("hippo_house.toml")
    mesh, axes = plan.support.mesh, plan.support.axes
    assert plan.support.kind == "offset"
    # Lengths of the axes by walking along edges: (l_j a_j - l_i a_i) is parallel to each edge.
    shift = (_lengths(mesh.edges, mesh.edge_vectors, axes)[:, None] * axes).reshape(16, 8, 3)
    report = classify_offset(mesh, mesh.vertices + DISTANCE * shift.reshape(-1, 3))
    assert report.parallel < 1e-9
    split = shift - shift[:1] - shift[:, :1] + shift[0, 0]
    assert np.abs(split).max() < 1e-9
    lengths = mesh.edge_lengths
    assert np.ptp(lengths) < 1e-9


def _lengths(edges: np.ndarray, vectors: Floats, axes: Floats) -> Floats:
    length = np.zeros(len(axes))
    length[0] = 1.0
    todo = edges.tolist()
    while todo:
        rest = []
        for k, (i, j) in enumerate(edges.tolist()):
            if (length[i] > 0) == (length[j] > 0):
                continue
            known, new = (i, j) if length[i] > 0 else (j, i)
            a, b = np.cross(axes[known], vectors[k]), np.cross(axes[new], vectors[k])
            length[new] = length[known] * (a @ b) / (b @ b)
            rest.append(k)
        todo = rest
    return length


@pytest.mark.parametrize("name", ["circular_vault", "conical_roof", "hippo_house"])
def test_the_examples_are_of_a_size_that_is_quick(name: str) -> None:
    assert 60 <= roof(f"{name}.toml").support.mesh.n_faces <= 120
