"""Triangle meshes that are not quads cut in two: what is advised can be built."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import Delaunay

from ddgfab.mesh import Mesh
from fabrication.gridshell.axes import AxesError
from fabrication.gridshell.design import Design, design
from fabrication.gridshell.room import CHORD_MM, gaps_kept
from fabrication.job.limits import LimitError, check_limits
from fabrication.solids import mesh_of


def triangles(height: float, wave: float) -> Mesh:
    """Irregular triangles of side 1500 in plan, under a dome and a wave."""
    rng = np.random.default_rng(2)
    side, rows = 1500.0, range(-2, 3)
    plan = np.array([(side * (i + 0.5 * (j % 2)), side * j * 0.866) for j in rows for i in rows])
    plan = plan + 0.08 * side * rng.uniform(-1, 1, plan.shape)
    faces = Delaunay(plan).simplices
    x, y = plan[faces][..., 0], plan[faces][..., 1]
    area = (x[:, 1] - x[:, 0]) * (y[:, 2] - y[:, 0]) - (x[:, 2] - x[:, 0]) * (y[:, 1] - y[:, 0])
    faces = np.where(area[:, None] > 0, faces, faces[:, ::-1])[np.abs(area) > 0.5 * side**2]
    z = height * (1 - (plan**2).sum(axis=1) / (4 * side) ** 2)
    z = z + wave * np.sin(plan[:, 0] / side) * np.cos(plan[:, 1] / side)
    used = np.unique(faces)
    return Mesh.build(np.column_stack([plan, z])[used], np.searchsorted(used, faces).tolist())


def clashes(made: Design) -> int:
    meshes = {family.number: mesh_of(family.shape, CHORD_MM) for family in made.families}
    checks = gaps_kept(made, list(made.families), meshes)
    return sum(not check.passed for own in checks.values() for check in own)


def advised(error: AxesError | LimitError) -> dict[str, dict[str, object]]:
    sections: dict[str, dict[str, object]] = {}
    for section, key, value in error.settings:
        sections.setdefault(section, {})[key] = value
    return sections


def test_a_dome_is_told_to_take_a_center() -> None:
    mesh = triangles(1200.0, 0.0)
    with pytest.raises(AxesError, match=r"Prop\. 5\.2") as caught:
        design(mesh)
    assert caught.value.settings == (("support", "kind", "central"),)
    made = design(mesh, support={"kind": "central"})
    check_limits(made.product())
    assert clashes(made) == 0


def test_normals_are_allowed_with_room_for_the_panes() -> None:
    mesh = triangles(600.0, 900.0)
    with pytest.raises(AxesError, match="whose beams twist") as no_axes:
        design(mesh)
    assert no_axes.value.settings == (("support", "kind", "normals"),)
    twisted = design(mesh, support={"kind": "normals"})
    with pytest.raises(LimitError) as caught:
        check_limits(twisted.product())
    sections = advised(caught.value)
    assert set(sections) == {"checks", "panel"}
    # The torsion alone, as it was advised before, is not enough.
    assert clashes(design(mesh, support={"kind": "normals"}, checks=sections["checks"])) > 0
    made = design(mesh, support={"kind": "normals"}, **sections)
    check_limits(made.product())
    assert clashes(made) == 0


def test_where_nothing_helps_that_is_said() -> None:
    with pytest.raises(LimitError, match="the net itself has to change") as caught:
        check_limits(design(triangles(0.0, 1700.0), support={"kind": "normals"}).product())
    assert caught.value.settings == ()
