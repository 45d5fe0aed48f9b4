"""Meshes of exact boundaries: manifold, outward, within the chord, of the right genus."""

from __future__ import annotations

import numpy as np
import pytest
from parts_table import CUT, EXACT

from fabrication.solids import (
    boundary_of,
    comparison_mesh,
    mesh_of,
    properties_of,
    second_volume_of,
)
from fabrication.specs import Properties, Shape, TriangleMesh

SLENDER = ["bar coped holes", "box coped holes", "tee coped", "rhs holes", "valence 5 holes",
           "reflex round", "cylinder"]  # fmt: skip


def mesh_properties(mesh: TriangleMesh) -> Properties:
    """Volume, area and centroid of a triangle mesh, by tetrahedra from a point of it."""
    corner = mesh.vertices[mesh.triangles] - mesh.vertices[0]
    normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    volumes = np.einsum("ti,ti->t", corner[:, 0], normal) / 6.0
    volume = float(volumes.sum())
    center = np.einsum("t,ti->i", volumes, corner.sum(axis=1) / 4.0) / volume + mesh.vertices[0]
    area = 0.5 * float(np.linalg.norm(normal, axis=1).sum())
    return Properties(volume, area, (float(center[0]), float(center[1]), float(center[2])))


def directed_edges(mesh: TriangleMesh) -> set[tuple[int, int]]:
    pairs = np.concatenate([mesh.triangles[:, [k, (k + 1) % 3]] for k in range(3)])
    return set(map(tuple, pairs.tolist()))


@pytest.mark.parametrize("name", EXACT)
def test_every_edge_has_two_triangles_that_run_opposite(name: str) -> None:
    mesh = mesh_of(EXACT[name][0])
    edges = directed_edges(mesh)
    assert len(edges) == 3 * len(mesh.triangles)
    assert edges == {(j, i) for i, j in edges}
    assert set(mesh.triangles.ravel().tolist()) == set(range(len(mesh.vertices)))
    corner = mesh.vertices[mesh.triangles]
    doubled = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    assert np.linalg.norm(doubled, axis=1).min() > 1e-6  # no triangle without area


@pytest.mark.parametrize("name", EXACT)
def test_is_a_solid_for_manifold3d(name: str) -> None:
    manifold3d = pytest.importorskip("manifold3d")
    shape, genus = EXACT[name]
    mesh = mesh_of(shape)
    solid = manifold3d.Manifold(manifold3d.Mesh64(mesh.vertices, mesh.triangles.astype(np.uint64)))
    assert solid.status() == manifold3d.Error.NoError
    assert solid.genus() == genus
    assert len(solid.decompose()) == 1
    exact = properties_of(shape)
    assert abs(solid.volume() - exact.volume) <= 0.05 * exact.area + 1e-9 * exact.volume


@pytest.mark.parametrize("name", EXACT)
def test_vertices_lie_on_the_surface_and_triangles_within_the_chord(name: str) -> None:
    shape = EXACT[name][0]
    boundary = boundary_of(shape)
    assert boundary is not None
    chord = 0.2
    mesh = mesh_of(shape, chord)

    def distance(points: np.ndarray) -> np.ndarray:
        """From the nearest of the faces' unbounded surfaces."""
        away = points[:, None] - boundary.face_origin
        along = np.einsum("nfi,fi->nf", away, boundary.face_axis)
        radial = np.linalg.norm(away - along[..., None] * boundary.face_axis, axis=-1)
        off = np.where(boundary.face_cylinder, radial - boundary.face_radius, along)
        return np.asarray(np.abs(off).min(axis=1))

    assert distance(mesh.vertices).max() < 1e-9
    assert distance(mesh.vertices[mesh.triangles].mean(axis=1)).max() <= chord
    halves = 0.5 * (mesh.vertices[mesh.triangles] + mesh.vertices[mesh.triangles[:, [1, 2, 0]]])
    assert distance(halves.reshape(-1, 3)).max() <= chord + 1e-9


@pytest.mark.parametrize("name", SLENDER)
def test_finer_chords_converge_to_the_exact_properties(name: str) -> None:
    exact = properties_of(EXACT[name][0])
    errors = []
    for chord in (0.4, 0.1, 0.025):
        found = mesh_properties(mesh_of(EXACT[name][0], chord))
        errors.append(
            (
                abs(found.volume / exact.volume - 1.0),
                abs(found.area / exact.area - 1.0),
                float(np.linalg.norm(np.subtract(found.centroid, exact.centroid))),
            )
        )
    # The error of inscribed facets is proportional to the chord; the steps round up, so a factor
    # of 16 in the chord is at least 5 in each error, down to a floor.
    for first, last in zip(errors[0], errors[-1], strict=True):
        assert last <= max(first / 5.0, 2e-6)


@pytest.mark.parametrize("name", ["bar mitred", "free flat", "touching seats", "quad mitred"])
def test_planes_alone_are_exact(name: str) -> None:
    boundary = boundary_of(EXACT[name][0])
    assert boundary is not None
    assert not boundary.face_cylinder.any()
    found = mesh_properties(mesh_of(EXACT[name][0]))
    assert found.volume == pytest.approx(properties_of(EXACT[name][0]).volume, rel=1e-12)


def test_is_the_same_every_time() -> None:
    shape: Shape = EXACT["valence 6 holes"][0]
    one, two = mesh_of(shape), mesh_of(shape)
    assert np.array_equal(one.vertices, two.vertices)
    assert np.array_equal(one.triangles, two.triangles)


@pytest.mark.parametrize("name", CUT)
def test_cut_parts_are_compared_without_the_kernel(name: str) -> None:
    """Against the volume by quadrature and the kernel's mesh, which share nothing with it."""
    manifold3d = pytest.importorskip("manifold3d")
    shape, genus = CUT[name]
    volume = second_volume_of(shape)
    fine = {}
    for chord in (0.05, 0.005):
        mesh = comparison_mesh(shape, chord)
        body = manifold3d.Manifold(manifold3d.Mesh64(mesh.vertices, mesh.triangles.astype("u8")))
        assert body.status() == manifold3d.Error.NoError
        assert body.genus() == genus
        assert len(body.decompose()) == 1
        assert abs(body.volume() - volume) <= chord * body.surface_area()
        fine[chord] = body
    assert abs(fine[0.005].volume() - volume) < 0.2 * abs(fine[0.05].volume() - volume)
    theirs = mesh_of(shape, 0.005)
    kernel = manifold3d.Manifold(manifold3d.Mesh64(theirs.vertices, theirs.triangles.astype("u8")))
    different = (fine[0.005] - kernel).volume() + (kernel - fine[0.005]).volume()
    assert different <= 0.01 * kernel.surface_area()
