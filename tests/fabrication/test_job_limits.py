"""Limits that the net decides stop the job before parts are made, and name what helps."""

from __future__ import annotations

import re
import shlex
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from roofs import barrel

from ddgfab.errors import InputError
from ddgfab.io import write_mesh
from ddgfab.mesh import Mesh
from ddgfab.surfaces.analytic import named_surface
from ddgfab.trace import trace
from fabrication.gridshell.design import Design, design
from fabrication.job.limits import LimitError, check_limits
from fabrication.job.run import make
from fabrication.linkage.kit import kit
from fabrication.specs import Check

PLAIN = {"formats": ["csv"]}


def bent(lift: float = 25.0) -> Mesh:
    """The barrel with one inner vertex lifted: the panes around it are not planar."""
    mesh = barrel()
    points = mesh.vertices.copy()
    inner = int(np.flatnonzero(~mesh.boundary_vertex)[0])
    points[inner] += lift * mesh.vertex_normals[inner]
    return mesh.with_vertices(points)


def stopped(made: Design) -> LimitError:
    with pytest.raises(LimitError) as caught:
        check_limits(made.product())
    assert str(caught.value).count("\n") <= 2
    return caught.value


def with_checks(made: Design, **values: tuple[float, float]) -> Design:
    """The first node with failing checks of these names: value and limit."""
    node, *others = made.gridshell.nodes
    checks = tuple(Check(name, False, *pair) for name, pair in values.items())
    grid = replace(made.gridshell, nodes=(replace(node, checks=checks), *others))
    return replace(made, gridshell=grid)


def test_a_design_within_its_limits_goes_on(small_design: Design) -> None:
    check_limits(small_design.product())


def test_nothing_is_made_beyond_a_limit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def spoil(*arguments: Any) -> None:
        raise AssertionError("a part was made")

    monkeypatch.setattr("fabrication.job.steps.make_parts", spoil)
    with pytest.raises(LimitError, match=r"planarity: \d panels \(limit 0.2 %\), worst P-\d{4}"):
        make(design(bent(), output=PLAIN), tmp_path / "out")
    assert list(tmp_path.iterdir()) == []


def test_what_helps_is_by_the_fault(small_design: Design) -> None:
    """Faces alone: planar. Axes: torsion-free. That done, the limit that is kept, rounded up."""
    assert stopped(design(bent())).settings == (("optimize", "goal", "planar"),)
    leaning = with_checks(small_design, lean_deg=(42.34, 30.0))
    assert stopped(leaning).settings == (("optimize", "goal", "torsion-free"),)
    both = with_checks(design(bent()), torsion_deg=(3.0, 0.1))
    assert stopped(both).settings == (("optimize", "goal", "torsion-free"),)
    optimize = small_design.project.optimize.model_copy(update={"goal": "torsion-free"})
    project = small_design.project.model_copy(update={"optimize": optimize})
    again = with_checks(replace(small_design, project=project), lean_deg=(42.34, 30.0))
    assert stopped(again).settings == (("support", "lean_limit_deg", 42.4),)
    near = with_checks(small_design, least_angle_deg=(17.86, 25.0))
    assert stopped(near).settings == (("checks", "min_angle_deg", 17.8),)


def test_a_design_with_what_helps_goes_on() -> None:
    check_limits(design(bent(), optimize={"goal": "planar"}).product())
    limit = {"max_size_mm": [1200.0, 1000.0]}
    helps = stopped(design(barrel(), panel=limit)).settings
    assert helps == (("optimize", "goal", "planar"), ("optimize", "max_pane_mm", [1000.0, 1200.0]))
    optimize = {key: value for _, key, value in helps}
    divided = design(barrel(), panel=limit, optimize=optimize)
    assert len(divided.gridshell.panels) > len(design(barrel()).gridshell.panels)
    check_limits(divided.product())


def test_panes_that_cannot_be_divided_name_the_limit_they_keep() -> None:
    optimize = {"goal": "planar", "max_pane_mm": [3000.0, 3000.0]}  # divided already
    small = design(barrel(), panel={"max_size_mm": [1000.0, 1200.0]}, optimize=optimize)
    ((section, key, value),) = stopped(small).settings
    assert (section, key) == ("panel", "max_size_mm")
    check_limits(design(barrel(), panel={"max_size_mm": list(map(float, value))}).product())
    wide, long = value
    for less in ([wide - 10.0, float(long)], [float(wide), long - 10.0]):
        stopped(design(barrel(), panel={"max_size_mm": less}))  # no smaller one would do


def test_nets_on_surfaces_are_traced_more_closely() -> None:
    net = {"kind": "surface", "surface": "torus-piece", "spacing_mm": 2500.0}
    limit = {"max_size_mm": [2400.0, 2400.0]}
    found = design(None, net={**net, "spacing_across_mm": 2400.0}, panel=limit)
    helps = stopped(found).settings
    assert [key for _, key, _ in helps] == ["spacing_mm", "spacing_across_mm"]
    closer = {key: value for _, key, value in helps}
    check_limits(design(None, net={**net, **closer}, panel=limit).product())


def test_axes_of_polygons_are_made_upright() -> None:
    """Cells at the rim of a traced net have three to six corners."""
    wide = named_surface("dome", {"radius_x_mm": 16e3, "radius_y_mm": 12e3})
    panel = {"max_size_mm": [9e3, 9e3]}
    found = design(trace(wide, 3000.0).mesh, panel=panel, optimize={"goal": "planar"})
    assert len(set(found.mesh.face_sizes.tolist())) > 1
    helps = stopped(with_checks(found, lean_deg=(42.34, 30.0))).settings
    assert helps == (("optimize", "goal", "torsion-free"),)


def test_a_mesh_in_another_unit_is_told_by_its_panes() -> None:
    large = design(barrel().scaled(0.5), project={"units": "m"})
    assert stopped(large).settings == (("project", "units", "mm"),)
    large = design(barrel().scaled(500.0))
    assert stopped(large).settings == (("project", "scale", 0.001),)


@pytest.mark.parametrize(
    ("scale", "units", "advice"),
    [(1.0, "m", 'units = "mm"'), (1000.0, "mm", "scale = 0.001"), (0.001, "mm", 'units = "m"')],
)
def test_edges_of_no_gridshell_are_refused_with_the_unit(
    scale: float, units: str, advice: str
) -> None:
    with pytest.raises(InputError, match=re.escape(advice)):
        design(barrel().scaled(scale), project={"units": units})


def test_kits_stop_too(tmp_path: Path) -> None:
    product = kit("bennett").product()
    first, *others = product.pieces
    thin = replace(first, checks=(Check("wall_mm", False, 0.8, 1.2),))
    product.pieces = (thin, *others)
    with pytest.raises(LimitError, match=r"wall: 1 link \(limit 1.2 mm\), worst L-0000 0.8 mm"):
        make(product, tmp_path / "kit")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
def test_the_commands_that_are_named_work(tmp_path: Path) -> None:
    """Exit code 2 and nothing written; the next command ends with 0, the one beside it with 1."""
    mesh = tmp_path / "bent roof.obj"
    write_mesh(mesh, bent())
    folder = tmp_path / "job"
    given = ["make", str(mesh), "-o", str(folder), "--formats", "csv", "--verify", "none"]

    def run(words: list[str]) -> subprocess.CompletedProcess[str]:
        command = [sys.executable, "-m", "fabrication", *words]
        return subprocess.run(command, capture_output=True, text=True, timeout=120)

    first = run(given)
    assert first.returncode == 2, first.stderr
    assert not folder.exists()
    error = first.stderr[first.stderr.index("error: ") :].splitlines()
    assert len(error) == 3
    assert error[0].startswith("error: planarity: 4 panels (limit 0.2 %), worst P-")
    commands = [shlex.split(line[line.index("ddgfab ") :])[1:] for line in error[1:]]
    assert commands[0] == [*given, "--set", "optimize.goal=planar"]
    assert commands[1] == [*given, "--anyway"]
    assert run(commands[0]).returncode == 0
    second = run(commands[1])
    assert second.returncode == 1
    assert "note: 4 parts are rejected (P-" in second.stdout
    assert "FAILED planarity: 4 panels" in second.stderr
