"""Monge surfaces, their normals, inversions and the canopy: exact invariants."""

from __future__ import annotations

import numpy as np
import pytest

from ddgfab.errors import DegenerateError, InputError, MeshError
from ddgfab.forms import canopy, monge, profile_polyline
from ddgfab.grid import grid_mesh
from ddgfab.measures import dihedral_angles, planarity, torsion
from ddgfab.mesh import Floats, unit
from ddgfab.nets import circularity, vertex_normals
from ddgfab.transforms import invert, invert_normals


def helix_net() -> Floats:
    """A wavy profile along a helix: nothing symmetric, nothing planar."""
    way = np.linspace(0.0, 1.5, 13)
    tangents = np.stack([np.cos(way), np.sin(way), 0.4 + 0 * way], axis=1)
    profile = profile_polyline(np.linspace(0.9, -0.7, 8), np.linspace(0.2, 0.4, 7))
    return monge(profile, tangents, np.linspace(0.9, 1.1, 12), (0.0, 0.0, 1.0)) * 1000.0


def ellipsoid_grid() -> Floats:
    """A net that is not circular: parallels of latitude on an ellipsoid with three axes."""
    u, v = np.meshgrid(np.linspace(0.2, 1.2, 6), np.linspace(0.4, 1.3, 5), indexing="ij")
    return np.stack([3 * np.cos(u) * np.sin(v), 2 * np.sin(u) * np.sin(v), np.cos(v)], axis=-1)


def test_monge_quads_are_isosceles_trapezoids() -> None:
    x = helix_net()
    across = x[:, 1:] - x[:, :-1]
    along = x[1:] - x[:-1]
    lengths = np.linalg.norm(across, axis=-1)
    assert np.ptp(lengths, axis=0).max() < 1e-9  # the profile keeps its size
    turned = np.linalg.norm(np.cross(unit(along[:, 1:]), unit(along[:, :-1])), axis=-1)
    assert turned.max() < 1e-12  # edges of one step are parallel


def test_circularity_sees_a_net_that_is_not_circular() -> None:
    assert circularity(helix_net()).max() < 1e-12
    assert circularity(ellipsoid_grid()).max() > 1e-3


def test_profile_planes_hold_torsion_free_axes() -> None:
    """Any axes in the profile's plane, carried along by the reflections, are torsion-free."""
    x = helix_net()
    ways = unit(x[1:, 0] - x[:-1, 0])
    rng = np.random.default_rng(3)
    plane = x[0, 1:3] - x[0, 0]
    axes = np.empty_like(x)
    axes[0] = rng.normal(size=(x.shape[1], 2)) @ plane
    for k, way in enumerate(ways):
        axes[k + 1] = axes[k] - 2 * np.outer(axes[k] @ way, way)
    assert np.degrees(torsion(grid_mesh(x), axes.reshape(-1, 3)).max()) < 1e-9


def test_reflected_normals_close_give_parallel_nets_and_have_no_torsion() -> None:
    x = helix_net()
    for first in ((0.1, 0.2, 1.0), (1.0, -0.3, 0.2)):
        n = vertex_normals(x, first)
        # Other order of the directions: path independence.
        other = vertex_normals(x.transpose(1, 0, 2), first).transpose(1, 0, 2)
        assert np.abs(n - other).max() < 1e-13
        shifted = x + 70.0 * n
        for axis in (0, 1):
            e, f = np.diff(x, axis=axis), np.diff(shifted, axis=axis)
            assert np.abs(np.cross(unit(e), unit(f))).max() < 1e-12
        assert circularity(shifted).max() < 1e-12
        assert np.degrees(torsion(grid_mesh(x), n.reshape(-1, 3)).max()) < 1e-9


def test_reflected_normals_do_not_close_on_other_nets() -> None:
    x = ellipsoid_grid()
    n = vertex_normals(x, (0.3, 0.2, 1.0))
    other = vertex_normals(x.transpose(1, 0, 2), (0.3, 0.2, 1.0)).transpose(1, 0, 2)
    assert np.abs(n - other).max() > 1e-4


def test_inversion_is_an_involution_and_keeps_circular_nets_with_their_normals() -> None:
    x, center = helix_net(), np.array([-9000.0, 400.0, 300.0])
    y = invert(x, center, 8000.0)
    assert np.abs(invert(y, center, 8000.0) - x).max() < 1e-8
    assert circularity(y).max() < 1e-12
    n = vertex_normals(x, (0.1, 0.2, 1.0))
    m = invert_normals(x, n, center)
    assert np.abs(m - vertex_normals(y, m[0, 0])).max() < 1e-11
    # Derivative by differences: a point moved along its normal moves along the image normal.
    step = 1e-3
    moved = (invert(x + step * n, center, 8000.0) - y) / step
    assert np.abs(unit(moved) - m).max() < 1e-6


def test_canopy_is_what_the_example_promises() -> None:
    mesh = canopy()
    net = mesh.vertices.reshape(29, 12, 3)
    assert mesh.n_faces == 308
    assert circularity(net).max() < 1e-12
    assert planarity(mesh).max() < 1e-9
    angles = np.degrees(mesh.corner_angles)
    assert angles.min() > 50
    assert angles.max() < 130
    assert np.degrees(np.abs(dihedral_angles(mesh)).max()) < 15
    assert mesh.edge_lengths.min() > 900
    assert mesh.edge_lengths.max() < 2200
    assert 1400 < np.median(mesh.edge_lengths) < 1600
    assert mesh.face_normals[:, 2].min() > 0  # upright everywhere
    assert mesh.vertices[:, 2].min() == 0.0
    # It flares: the last arch is wider than the first, by about the factor asked for.
    spans = np.linalg.norm(net[:, -1] - net[:, 0], axis=1)
    assert max(spans[0], spans[-1]) / min(spans[0], spans[-1]) == pytest.approx(1.6, rel=0.1)


@pytest.mark.parametrize("flare", [0.7, 1.0, 2.0])
def test_canopy_stays_exact_for_other_parameters(flare: float) -> None:
    mesh = canopy(9, 5, 1000.0, bend_deg=5, rise_deg=0, flare=flare)
    assert circularity(mesh.vertices.reshape(10, 6, 3)).max() < 1e-12
    assert mesh.face_normals[:, 2].min() > 0
    middle = np.diff(mesh.vertices.reshape(10, 6, 3)[4:6, 2:4], axis=0)
    assert np.linalg.norm(middle, axis=-1).mean() == pytest.approx(1000, rel=0.15)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"panels_along": 0}, "panels_along = 0 .* 1 to 1000"),
        ({"panel_mm": -1.0}, "panel_mm = -1 .* 0.001 or more"),
        ({"turn": 1.5}, "turn = 1.5 .* 0.01 to 0.99"),
        ({"flare": 0.0}, "flare = 0 .* 0.1 to 10"),
        ({"bend_deg": 80.0}, "bend_deg = 80 .* -59 to 59"),
    ],
)
def test_canopy_refuses(arguments: dict[str, float], message: str) -> None:
    with pytest.raises(InputError, match=message):
        canopy(**arguments)  # type: ignore[arg-type]


def test_degenerate_input_is_refused_by_place() -> None:
    with pytest.raises(DegenerateError, match="step 1 turns back"):
        monge([[0, 0], [1, 0]], [[1, 0, 0], [1, 0, 0], [-1, 0, 0]], [1, 1], (0, 0, 1))
    with pytest.raises(DegenerateError, match="upward direction"):
        monge([[0, 0], [1, 0]], [[1, 0, 0], [1, 0, 0]], [1], (1, 0, 0))
    with pytest.raises(DegenerateError, match=r"point \(1,\)"):
        invert([[1.0, 0, 0], [5.0, 0, 0]], [5.0, 0, 0], 1.0)
    with pytest.raises(DegenerateError, match=r"quad \(0, 0\)"):
        circularity([[[0, 0, 0], [0, 1, 0]], [[0, 2, 0], [0, 3, 0]]])
    with pytest.raises(MeshError, match="shape"):
        grid_mesh(np.zeros((3, 3)))
    with pytest.raises(MeshError, match="3 needed"):
        grid_mesh(np.zeros((2, 4, 3)), closed=(True, False))


def test_grid_mesh_numbers_and_closes() -> None:
    u, v = np.meshgrid(np.arange(5) * 2 * np.pi / 5, np.arange(4) * 2 * np.pi / 4, indexing="ij")
    ring = np.stack([(2 + np.cos(v)) * np.cos(u), (2 + np.cos(v)) * np.sin(u), np.sin(v)], axis=-1)
    assert grid_mesh(ring).faces[0].tolist() == [0, 4, 5, 1]
    torus = grid_mesh(ring, closed=(True, True))
    assert (torus.n_vertices, torus.n_edges, torus.n_faces) == (20, 40, 20)
    assert len(grid_mesh(ring, closed=(True, False)).boundary_loops) == 2
