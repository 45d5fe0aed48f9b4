"""[net] kind = "surface": a net traced on a surface, made planar, detailed."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from ddgfab.errors import ProjectError
from ddgfab.measures import planarity_percent
from ddgfab.surfaces.analytic import named_surface
from fabrication.gridshell import traced
from fabrication.gridshell.design import design
from fabrication.gridshell.load import make_project, project_for_mesh
from fabrication.gridshell.traced import rim_distance, traced_net
from fabrication.progress import silent

NET = {"kind": "surface", "surface": "saddle", "spacing_mm": 2500, "width_mm": 12e3}


def test_design_on_a_named_surface_has_planar_panes_and_no_torsion() -> None:
    made = design(None, net=NET, panel={"kind": "glass"})
    assert planarity_percent(made.mesh).max() < 1e-8
    assert made.support.torsion_deg_max < 1e-8
    assert np.ptp(made.mesh.vertices[:, 0]) == pytest.approx(12e3, rel=0.02)
    assert made.optimized is not None
    assert made.optimized.movement_max < 100  # curvature lines are nearly there


def test_round_an_umbilic_axes_are_made_upright() -> None:
    """Planar faces of a monkey saddle leave axes that lean by 50 deg at its steep corners."""
    net = {"kind": "surface", "surface": "monkey-saddle", "spacing_mm": 3000}
    made = design(None, net=net, panel={"kind": "glass", "max_size_mm": [9e3, 9e3]})
    assert made.support.lean_deg_max < 30
    assert made.support.torsion_deg_max < 1e-8
    assert any("planar faces alone leave node axes that lean" in n for n in made.source.notes)
    assert any("because with the rim on them axes lean by" in n for n in made.source.notes)
    surface = named_surface("monkey-saddle")
    off = rim_distance([surface], made.mesh)
    (told,) = (n for n in made.source.notes if n.startswith("vertices lie"))
    assert f"those of the rim {off.mean():.3g} mm from its trimming curves" in told
    # second route: the sides of the square of parameters, as points of the surface itself
    (u0, u1), (v0, v1) = surface.domain[:2], surface.domain[2:]
    at = np.linspace(0, 1, 4001)
    sides = [(u0 + at * (u1 - u0), v + 0 * at) for v in (v0, v1)]
    sides += [(u + 0 * at, v0 + at * (v1 - v0)) for u in (u0, u1)]
    curve = np.concatenate([surface.points(np.stack(side, axis=1)) for side in sides])
    gap = made.mesh.vertices[made.mesh.boundary_vertex][:, None] - curve
    assert off == pytest.approx(np.linalg.norm(gap, axis=2).min(axis=1), abs=5.0)


@pytest.mark.slow
def test_rim_stays_on_the_trimming_curves_where_axes_can_be_upright(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """With a limit that planar faces miss and upright axes with a gliding rim keep."""
    net = make_project({"net": {"kind": "surface", "surface": "enneper", "spacing_mm": 2500}})
    found = traced_net(net)
    real = traced._lean_deg
    leans = iter([90.0])
    monkeypatch.setattr(traced, "_lean_deg", lambda *given: next(leans, None) or real(*given))
    result, notes = traced.traced_optimum(found.mesh, found.reference, net, silent)
    assert notes[0].endswith("with the rim on the trimming curves")
    assert rim_distance(found.surfaces, result.mesh).max() < 5.0


def test_settings_of_a_surface() -> None:
    project = make_project({"net": NET})
    assert project.net.parameters == {"width_mm": 12e3}
    assert project.optimize.goal == "planar"
    assert make_project({"net": NET, "optimize": {"goal": "none"}}).optimize.goal == "none"
    step = project_for_mesh("roof.step", {"net": {"spacing_mm": 900.0}})
    assert (step.net.kind, step.net.spacing_mm) == ("surface", 900.0)
    assert project_for_mesh("roof.obj").net.kind == "mesh"


@pytest.mark.parametrize(
    ("net", "message"),
    [
        ({"kind": "surface"}, "needs file"),
        ({"kind": "surface", "surface": "dome", "file": "a.step"}, "needs file"),
        ({"kind": "surface", "surface": "dome", "spacing_mm": -1}, "spacing_mm"),
        ({"kind": "mesh", "file": "a.obj", "spacing_mm": 900.0}, 'is for kind = "surface"'),
        ({"kind": "surfce"}, "did you mean surface"),
    ],
)
def test_wrong_settings_are_named(net: dict[str, object], message: str) -> None:
    with pytest.raises(ProjectError, match=message):
        make_project({"net": net})


@pytest.mark.slow
def test_step_file_is_found_beside_the_project(tmp_path: Path) -> None:
    import build123d

    x, y = np.meshgrid(np.linspace(-6e3, 6e3, 7), np.linspace(-4e3, 4e3, 6), indexing="ij")
    rows = np.stack([x, y, 1200 - x**2 / 3e4 - y**2 / 1.6e4], axis=-1).tolist()
    face = build123d.Face.make_surface_from_array_of_points(
        [[build123d.Vector(*point) for point in row] for row in rows]
    )
    build123d.export_step(face, str(tmp_path / "roof.step"))
    project = tmp_path / "roof.toml"
    project.write_text('[net]\nkind = "surface"\nfile = "roof.step"\nspacing_mm = 1500\n')
    made = design(project)
    assert made.support.torsion_deg_max < 1e-8
    assert made.source.file == str(tmp_path / "roof.step")
    assert made.source.sha256
