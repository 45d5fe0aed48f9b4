"""Which support structure is chosen: exact kinds, the least lean; refusals with the reason."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from net_cases import catenoid_net, circular_net, koebe_net
from support_cases import planar_net

from ddgfab.errors import SupportError
from ddgfab.forms import canopy
from ddgfab.grid import grid_mesh
from ddgfab.io import read_mesh
from ddgfab.measures import torsion
from ddgfab.mesh import Mesh
from ddgfab.nets import circular_to_conical, evolve_by_angles
from ddgfab.support import (
    cone_axes,
    edge_bend,
    support_structure,
)


def test_asymptotic_net_is_refused_with_the_reason(mesh_file: Callable[[str], Path]) -> None:
    mesh = read_mesh(mesh_file("knet1.obj")).mesh
    assert edge_bend(mesh) < 0.05
    with pytest.raises(SupportError, match="asymptotic lines") as caught:
        support_structure(mesh)
    assert f"{np.degrees(torsion(mesh, mesh.vertex_normals).max()):.2f} deg" in str(caught.value)


def test_net_without_upright_axes_is_refused(mesh_file: Callable[[str], Path]) -> None:
    mesh = read_mesh(mesh_file("helical_minimal.obj")).mesh
    with pytest.raises(SupportError, match="no upright torsion-free") as caught:
        support_structure(mesh)
    assert "8.3" in str(caught.value)


def test_edge_bend_is_one_along_principal_lines() -> None:
    assert edge_bend(canopy()) == pytest.approx(1, abs=0.1)


def test_published_meshes_by_default(mesh_file: Callable[[str], Path]) -> None:
    for name, limit in (("conical1.obj", 3.0), ("quad_dome.obj", 1.5), ("heart.obj", 66.0)):
        structure = support_structure(read_mesh(mesh_file(name)).mesh)
        assert structure.torsion_free
        assert structure.lean_deg_max < limit
        assert (structure.lean < np.pi / 2).all()  # on the side of the normals


def test_nearly_conical_net_is_moved_onto_torsion_zero(mesh_file: Callable[[str], Path]) -> None:
    mesh = read_mesh(mesh_file("conical1.obj")).mesh
    structure = support_structure(mesh, "axis")
    assert structure.torsion_deg_max < 1e-9
    assert structure.history_deg[0] > 1e-5  # what the cones alone left
    assert np.degrees(np.arccos(np.sum(structure.axes * cone_axes(mesh), axis=1)).max()) < 0.1


@pytest.mark.parametrize(
    ("kind", "message"),
    [
        ("offset", r"face \d+ is .* % from planar"),
        ("normal", r"face \d+ is .* % from planar"),
        ("axis", r"face \d+ is .* % from planar"),
        ("radial", "unknown support kind"),
    ],
)
def test_wrong_kind_says_by_how_much(kind: str, message: str) -> None:
    mesh = planar_net()
    bent = mesh.with_vertices(mesh.vertices + 20 * np.sin(mesh.vertices[:, ::-1] / 150))
    with pytest.raises(SupportError, match=message):
        support_structure(bent, kind)  # type: ignore[arg-type]


def test_planar_net_that_is_neither_circular_nor_conical() -> None:
    with pytest.raises(SupportError, match="deg from circular"):
        support_structure(planar_net(), "normal")
    with pytest.raises(SupportError, match="deg from conical"):
        support_structure(planar_net(), "axis")


def rough_circular_net(noise: float, seed: int) -> Mesh:
    """A circular net of random polylines and angles: its reflected normals zigzag."""
    rng = np.random.default_rng(seed)
    lines = []
    for count, way in ((9, [1.0, 0.1, 0.1]), (8, [-0.1, 1.0, 0.1])):
        steps = np.array(way) + noise * rng.normal(size=(count, 3))
        lines.append(np.concatenate([np.zeros((1, 3)), np.cumsum(steps, axis=0)]))
    angles = np.pi / 2 + 0.5 * noise * rng.normal(size=(9, 8))
    return grid_mesh(evolve_by_angles(*lines, angles))


def exact_leans(mesh: Mesh) -> dict[str, tuple[float, float]]:
    """Mean and greatest lean of the torsion-free structures of all exact kinds."""
    out = {}
    for kind in ("normal", "axis", "edge", "offset"):
        try:
            found = support_structure(mesh, kind)  # type: ignore[arg-type]
        except SupportError:
            continue
        if found.torsion_free:
            out[kind] = found.lean_deg_mean, found.lean_deg_max
    return out


@pytest.mark.parametrize(
    "mesh",
    [
        *(rough_circular_net(noise, seed) for noise, seed in ((0.1, 1), (0.12, 2), (0.05, 3))),
        canopy(12, 8),
        grid_mesh(circular_net()),
        grid_mesh(circular_to_conical(circular_net())),
        grid_mesh(koebe_net()),
        grid_mesh(catenoid_net()),
        planar_net(),
    ],
    ids=[
        "rough",
        "rougher",
        "uneven",
        "canopy",
        "circular",
        "conical",
        "koebe",
        "minimal",
        "planar",
    ],
)
def test_auto_takes_the_least_lean_of_all_that_are_exact(mesh: Mesh) -> None:
    leans = exact_leans(mesh)
    assert leans
    found = support_structure(mesh)
    assert found.torsion_free
    assert found.lean_deg_mean <= min(mean for mean, _ in leans.values()) + 1e-5
    assert found.kind == min(leans, key=lambda kind: leans[kind][0])


def test_the_lean_limit_decides_between_exact_kinds_and_optimised_axes() -> None:
    """A planar net whose only exact kind leans by 10.3 deg at most, 6.3 deg on average.

    Above the limit that kind is taken as it is; below it the optimised axes, if they lean less.
    """
    mesh = planar_net()
    (kind, (_, greatest)), *others = exact_leans(mesh).items()
    assert kind == "offset"
    assert not others
    optimised = support_structure(mesh, "optimize")
    assert support_structure(mesh, lean_limit_deg=greatest + 0.01).kind == "offset"
    below = support_structure(mesh, lean_limit_deg=greatest - 0.01)
    assert below.lean_deg_max == pytest.approx(min(greatest, optimised.lean_deg_max))
    assert optimised.lean_deg_max != pytest.approx(greatest)


def test_a_kind_beyond_the_lean_limit_is_passed_over() -> None:
    """Of two exact kinds the one that leans less on average may lean more somewhere."""
    mesh = grid_mesh(koebe_net())
    leans = exact_leans(mesh)
    order = sorted(leans.values(), key=lambda pair: pair[1])
    for least, more in pairwise(order):
        limit = 0.5 * (least[1] + more[1])
        found = support_structure(mesh, lean_limit_deg=limit)
        assert found.lean_deg_max <= limit
        allowed = [mean for mean, greatest in leans.values() if greatest <= limit]
        assert found.lean_deg_mean == pytest.approx(min(allowed), abs=1e-6)
