"""Node axes from `optimize` to `make`, and what helps where a net has none that are upright."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from ddgfab.errors import DdgError, InputError, SupportError
from ddgfab.forms.registry import generate
from ddgfab.io import read_mesh, write_mesh
from ddgfab.measures import planarity_percent
from ddgfab.mesh import Mesh
from ddgfab.optimize import TorsionFreeResult, optimize
from ddgfab.support import SupportStructure, support_structure
from fabrication import design
from fabrication.cli import app
from fabrication.gridshell.axes import AxesError
from fabrication.job.limits import LimitError, check_limits


def translation(degrees: float, cells: int, radii: tuple[float, float], noise: float) -> Mesh:
    """A net of planar quads but for noise, its directions at an angle in plan: nearly conjugate
    directions far from principal ones, as on the hulls of hotels by the water."""
    t = np.linspace(-7e3, 7e3, cells + 1)
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    one = np.stack([t, 0 * t, -t * t / (2 * radii[0])], axis=1)
    two = np.stack([t * c, t * s, -t * t / (2 * radii[1])], axis=1)
    points = (one[:, None] + two[None]).reshape(-1, 3)
    points[:, 2] += noise * np.random.default_rng(0).normal(size=len(points))
    i = np.arange(cells)[:, None] * (cells + 1) + np.arange(cells)
    faces = np.stack([i, i + cells + 1, i + cells + 2, i + 1], axis=-1).reshape(-1, 4)
    return Mesh.build(points, faces.tolist())


def tilted(seed: int = 1) -> tuple[Mesh, SupportStructure]:
    """A net and torsion-free axes on it that no kind of the library would choose: all one way."""
    mesh = generate("conical", {})
    axes = np.tile([0.2, 0.1, 1.0], (mesh.n_vertices, 1))
    structure = SupportStructure.of(mesh, axes / np.linalg.norm(axes[0]), "given")
    return mesh, structure


def test_axes_of_the_file_are_those_of_the_design(tmp_path: Path) -> None:
    mesh, given = tilted()
    path = tmp_path / "a.obj"
    write_mesh(path, mesh, units="mm", axes=given.axes)
    found = design(path, support={"lean_limit_deg": 60.0}).support
    assert found.kind == "given"
    assert found.lean_deg_max == pytest.approx(given.lean_deg_max, abs=1e-9)
    assert np.abs(found.axes - given.axes).max() < 1e-14
    scaled = design(path, project={"median_edge_mm": 900.0}, support={"lean_limit_deg": 60.0})
    assert scaled.support.lean_deg_max == pytest.approx(given.lean_deg_max, abs=1e-9)
    # A kind that is asked for, a lean beyond its limit, torsion beyond its limit: said, not silent.
    other = design(path, support={"kind": "axis"})
    assert other.support.kind == "axis"
    assert any('kind = "axis" is taken instead' in note for note in other.source.notes)
    least = design(path, support={"lean_limit_deg": given.lean_deg_max - 0.1})
    assert least.support.kind != "given"
    assert any("node axes, which are not used" in note for note in least.source.notes)
    bent = given.axes.copy()
    bent[::7, 0] += 0.05
    write_mesh(path, mesh, units="mm", axes=bent)
    assert design(path, support={"lean_limit_deg": 60.0}).support.kind != "given"
    assert design(
        path, support={"lean_limit_deg": 60.0}, checks={"torsion_deg": 5.0}
    ).support.kind == "given"  # fmt: skip


def test_axes_of_a_script_are_those_of_the_design() -> None:
    mesh, given = tilted()
    wide = {"lean_limit_deg": 60.0}
    found = design(mesh, axes=3.0 * given.axes, support=wide)
    assert found.support.kind == "given"
    assert np.abs(found.support.axes - given.axes).max() < 1e-14
    assert np.abs(np.array([n.axis for n in found.gridshell.nodes]) - given.axes).max() < 1e-14
    faces = [face.tolist() for face in mesh.faces]
    metres = {"units": "m"}
    other = design((mesh.vertices / 1e3, faces), axes=given.axes, support=wide, project=metres)
    assert np.abs(other.support.axes - given.axes).max() < 1e-14
    # What carries its axes: a structure, the result of an optimization.
    offset = support_structure(mesh, "offset")
    assert np.abs(design(offset).support.axes - offset.axes).max() < 1e-15
    bent = optimize(translation(40, 4, (9e3, 12e3), 1.0), "torsion-free")
    assert isinstance(bent, TorsionFreeResult)
    same = design(bent, support=wide).support
    assert same.kind == "given"
    assert np.abs(same.axes - bent.axes).max() < 1e-14
    assert np.array_equal(design(optimize(mesh, "planar")).mesh.vertices, mesh.vertices)


@pytest.mark.parametrize(
    ("change", "sections", "words"),
    [
        (lambda a: a[:-1], {}, r"axes have shape \(\d+, 3\); expected"),
        (lambda a: a[:, :2], {}, r"axes have shape"),
        (lambda a: np.where(np.arange(len(a))[:, None] == 4, 0.0, a), {}, "axis of vertex 4 is"),
        (lambda a: np.where(np.arange(len(a))[:, None] == 4, np.nan, a), {}, "axis of vertex 4 is"),
        (lambda a: -a, {}, "give -axes"),
        (lambda a: a, {"support": {"lean_limit_deg": 12.0}}, r"\[support\] lean_limit_deg"),
        (lambda a: a + 0.1 * np.eye(3)[np.arange(len(a)) % 2], {}, r"\[checks\] torsion_deg"),
        (lambda a: a, {"support": {"kind": "offset"}}, 'kind = "offset" asks for others'),
        (lambda a: a, {"optimize": {"goal": "planar"}}, 'goal = "planar" asks for others'),
        (lambda a: "up", {}, "axes are of type str"),
    ],
)
def test_axes_of_a_script_that_cannot_be_used_are_refused(
    change: Any, sections: dict[str, Any], words: str
) -> None:
    mesh, given = tilted()
    with pytest.raises(InputError if "asks" in words or "str" in words else DdgError, match=words):
        design(mesh, axes=change(given.axes), **{"support": {"lean_limit_deg": 60.0}, **sections})


def test_axes_go_with_a_mesh_of_their_own() -> None:
    given = tilted()[1]
    for source in ("roof.obj", None, "conical"):
        with pytest.raises(InputError, match=r"design\(mesh, axes=axes\)"):
            design(source, axes=given.axes)
    with pytest.raises(InputError, match="given twice"):
        design(given, axes=given.axes)


def test_the_limits_of_a_flat_net_whose_axes_lean_name_the_goal_that_helps() -> None:
    mesh = translation(20, 8, (9e3, 9e3), 1.2)
    assert planarity_percent(mesh).max() < 0.2
    plan = design(mesh)
    assert plan.support.lean_deg_max > 45
    with pytest.raises(LimitError) as caught:
        check_limits(plan.product())
    assert ("optimize", "goal", "torsion-free") in caught.value.settings
    assert not any(value == "planar" for _, _, value in caught.value.settings)


def test_no_upright_axes_at_all_names_what_helps(tmp_path: Path) -> None:
    mesh = translation(7, 8, (9e3, -15e3), 0.6)
    with pytest.raises(SupportError) as caught:
        design(mesh)
    assert isinstance(caught.value, AxesError)
    path = tmp_path / "a.obj"
    write_mesh(path, mesh, units="mm")
    result = CliRunner().invoke(app, ["make", str(path), "-o", str(tmp_path / "out")])
    assert result.exit_code == 2
    (section, key, value), *_ = caught.value.settings
    assert f"--set {section}.{key}={value}" in result.output


@pytest.mark.slow
def test_optimize_then_make_has_the_axes_that_were_found(tmp_path: Path) -> None:
    write_mesh(tmp_path / "a.obj", translation(40, 4, (9e3, 12e3), 1.0), units="mm")
    run = CliRunner()
    to, out = tmp_path / "b.ply", tmp_path / "out"
    words = ["optimize", str(tmp_path / "a.obj"), "-o", str(to), "--goal", "torsion-free"]
    result = run.invoke(app, [*words, "--no-picture", "--json"])
    assert result.exit_code == 0, result.output
    record = json.loads(to.with_suffix(".json").read_text())
    read = read_mesh(to)
    assert read.axes is not None
    assert np.abs(read.axes - np.array(record["axes"])).max() < 1e-14
    lean = SupportStructure.of(read.mesh, read.axes, "given").lean_deg_max
    result = run.invoke(app, ["inspect", str(to), "--json"])
    assert json.loads(result.output)["axes"]["lean_deg_max"] == pytest.approx(lean, abs=1e-9)
    words = ["make", str(to), "-o", str(out), "--formats", "csv", "--jobs", "1"]
    wide = ["--set", "checks.min_angle_deg=1", "--set", "panel.max_size_mm=[3300,8000]"]
    result = run.invoke(app, [*words, *wide])
    assert result.exit_code == 0, result.output
    support = json.loads((out / "manifest.json").read_text())["support"]
    assert support["kind"] == "given"
    assert support["lean_deg_max"] == pytest.approx(lean, abs=1e-6)
