"""Recovering the data of K-nets from points and meshes, and refusing what is none."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from knet_cases import any_knet

from ddgfab.errors import DegenerateError, InputError
from ddgfab.grid import grid_mesh
from ddgfab.io import read_mesh
from ddgfab.mesh import Mesh
from ddgfab.nets import star_flatness
from ddgfab.nets.knet import crab_net, knet, knet_from_mesh, recover_knet


@pytest.mark.parametrize("cells", [(12, 9), (1, 1), (1, 5), (3, 4, 2), (2, 2, 2, 3)])
def test_data_of_exact_nets_come_back(cells: tuple[int, ...]) -> None:
    net = any_knet(*cells, r=2.5)
    found = recover_knet(net.points)
    assert found.defect < 1e-11
    assert found.distance < 1e-11
    assert not found.swapped
    assert found.data.r == pytest.approx(2.5, rel=1e-12)
    want = net.cauchy()
    for k in range(len(cells)):
        assert np.allclose(found.data.deltas[k], net.deltas[k], atol=1e-12)
        assert np.allclose(found.data.turns[k], want.turns[k], atol=1e-10)
    assert np.allclose(found.data.corner_angles, want.corner_angles, atol=1e-10)
    assert np.allclose(found.knet.normals, net.normals, atol=1e-10)
    assert max(found.knet.residuals().values()) < 1e-12


def test_folded_nets_and_large_angles_come_back() -> None:
    """Angles beyond pi / 2, turns that fold the net over: signs are found along edges."""
    rng = np.random.default_rng(2)
    deltas = [rng.uniform(0.8, 2.2, 6), rng.uniform(0.2, 0.9, 7)]
    net = knet(deltas, [rng.uniform(-2, 2, 5), rng.uniform(-2, 2, 6)], 0.4)
    found = recover_knet(net.points)
    assert found.distance < 1e-10
    assert np.allclose(np.sin(found.data.deltas[0]), np.sin(deltas[0]), atol=1e-11)
    assert np.allclose(np.abs(np.sum(found.knet.m * net.m, axis=-1)), 1, atol=1e-10)


def test_the_mirror_image_has_its_directions_exchanged() -> None:
    """A mirror changes the hand of all twists; direction 0 is the one with positive twist."""
    net = any_knet(5, 8)
    found = recover_knet(net.points * [1, 1, -1])
    assert found.swapped
    assert found.knet.shape == (9, 6)
    assert found.distance < 1e-12
    assert np.allclose(found.data.deltas[0], net.deltas[1])
    assert np.allclose(found.points, (net.points * [1, 1, -1]).transpose(1, 0, 2))


@pytest.mark.parametrize("scale", [1e-6, 1e6])
def test_scale_and_motion_do_not_matter(scale: float) -> None:
    net = any_knet(6, 5)
    turn = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    found = recover_knet(scale * (net.points @ turn + [3, -2, 1]))
    assert found.data.r == pytest.approx(scale, rel=1e-11)
    assert found.distance < 1e-11 * scale
    assert np.allclose(found.data.deltas[1], net.deltas[1])


def test_noise_is_the_defect() -> None:
    """Defect and distance grow in proportion to the noise, and the limit decides."""
    net = any_knet(8, 8)
    noise = np.random.default_rng(5).normal(size=net.points.shape)
    found = [recover_knet(net.points + s * noise, limit=1.0) for s in (1e-7, 1e-6, 1e-5)]
    for one, next_ in pairwise(found):
        assert next_.defect == pytest.approx(10 * one.defect, rel=0.05)
        assert 5 < next_.distance / one.distance < 20
    with pytest.raises(InputError, match="no K-net"):
        recover_knet(net.points + 1e-2 * noise)


def test_every_defect_by_itself() -> None:
    """An affine image keeps planar stars, but neither lengths nor scale; noise spoils all three."""
    net = any_knet(5, 6)
    stretched = recover_knet(net.points * [1.0, 1.0, 1.001], limit=1.0)
    assert stretched.defects["flatness"].max() < 1e-12
    assert 1e-5 < stretched.defects["length"].max() < 2e-3
    assert 1e-5 < stretched.defects["scale"].max() < 1e-2
    noise = np.random.default_rng(2).normal(size=net.points.shape)
    noisy = recover_knet(net.points + 1e-6 * noise, limit=1.0)
    assert noisy.defects["flatness"] == pytest.approx(star_flatness(noisy.points))
    assert noisy.defects["flatness"].max() > 1e-7
    x = noisy.points
    for k in (0, 1):  # by hand: the greatest of the edges at each vertex against their strip
        lengths = np.linalg.norm(np.diff(x, axis=k), axis=-1)
        off = np.moveaxis(np.abs(lengths / lengths.mean(axis=1 - k, keepdims=True) - 1), k, 0)
        for u, row in enumerate(off):
            for at in (u, u + 1):
                assert (np.moveaxis(noisy.defects["length"], k, 0)[at] >= row - 1e-15).all()
    assert 1e-7 < noisy.defects["length"].max() < 1e-4
    with pytest.raises(InputError, match=r"\(length\)|\(scale\)"):
        recover_knet(net.points * [1.0, 1.0, 1.1])


def test_knet_of_others(mesh_file: Callable[[str], Path]) -> None:
    """A K-net that others optimised: 20 x 20 equal cells, rebuilt from its axes alone."""
    mesh = read_mesh(mesh_file("knet1.obj")).mesh
    found = recover_knet(mesh)
    assert found.knet.shape == (21, 21)
    assert 1e-7 < found.defect < 5e-5
    size = float(np.ptp(mesh.vertices, axis=0).max())
    assert found.distance < 1e-7 * size
    assert max(found.knet.residuals().values()) < 1e-12
    # Edges of .9904 and r = 8.7503: delta = asin(.9904 / 8.7503) in both directions.
    assert found.data.r == pytest.approx(8.7503, abs=1e-4)
    edge = float(np.linalg.norm(mesh.edge_vectors, axis=1).mean())
    for delta in found.data.deltas:
        assert delta == pytest.approx(np.arcsin(edge / found.data.r), abs=1e-6)
    # The same whatever the numbering of the vertices; another corner may be the first.
    order = np.random.default_rng(0).permutation(len(mesh.vertices))
    back = np.argsort(order)
    again = recover_knet(Mesh.build(mesh.vertices[order], back[mesh.corners.reshape(-1, 4)]))
    assert again.distance < 1e-7 * size
    assert again.data.r == pytest.approx(found.data.r, rel=1e-9)
    # Both boundaries of the mirror image.
    assert recover_knet(Mesh.build(mesh.vertices * [-1, 1, 1], mesh.corners.reshape(-1, 4)))


@pytest.mark.parametrize("name", ["chebyshev_sphere.obj", "helical_minimal.obj"])
def test_meshes_that_are_no_k_nets_are_refused(name: str, mesh_file: Callable[[str], Path]) -> None:
    mesh = read_mesh(mesh_file(name)).mesh
    with pytest.raises(InputError, match="no K-net") as caught:
        recover_knet(mesh)
    text = str(caught.value)
    assert f"of {len(mesh.vertices)} vertices miss" in text
    worst = int(text.split("the worst are\n")[1].split(":")[0])
    assert 0 <= worst < len(mesh.vertices)


def test_the_moved_vertex_is_named() -> None:
    net = any_knet(6, 7)
    points = net.points.copy()
    points[3, 4] += 0.05 * net.normals[3, 4]
    with pytest.raises(InputError, match=r"worst are\n  .*\(3, 4\): \d\.\d+ \((flatness|scale)\)"):
        recover_knet(points)
    mesh = grid_mesh(points)
    vertex = int(np.argmin(np.abs(mesh.vertices - points[3, 4]).sum(axis=1)))
    with pytest.raises(InputError, match=rf"\b{vertex}: "):
        knet_from_mesh(mesh)


def test_other_bad_input() -> None:
    net = any_knet(3, 3)
    double = net.points.copy()
    double[1, 2] = double[1, 1]
    with pytest.raises(DegenerateError, match=r"direction 1 at vertex \(1, 1\): it has no length"):
        recover_knet(double)
    flat = np.stack(np.meshgrid(np.arange(4.0), np.arange(4.0), [0.0], indexing="ij"), -1)[:, :, 0]
    with pytest.raises(InputError, match="no K-net"):
        recover_knet(flat)
    with pytest.raises(InputError, match="two points or more"):
        recover_knet(net.points[:1])
    straight = np.zeros((3, 3, 3))
    straight[..., 0] = np.arange(3)[:, None] + 0.5 * np.arange(3)
    with pytest.raises(DegenerateError, match="all edges are parallel"):
        recover_knet(straight)


def test_patch_of_a_rotational_net_comes_back() -> None:
    net = crab_net(8, 0.35, 0.9, 9)
    found = recover_knet(net.patch((4, 4)).points)
    assert found.distance < 1e-12
    assert found.data.deltas[0] == pytest.approx(0.35, abs=1e-12)
