"""Generators: exact nets from parameters, the registry, limits, and each net's own invariants."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from net_cases import concyclic_defect, planar_net, space_canal

from ddgfab.errors import DegenerateError, InputError
from ddgfab.forms import profile_polyline
from ddgfab.forms.canal import canal_circles, canal_net
from ddgfab.forms.moulding import moulding_net
from ddgfab.forms.placing import chord_arc
from ddgfab.forms.registry import ParameterError, find_generator, generate, kinds
from ddgfab.forms.rotational import rotational_net
from ddgfab.forms.translation import translation_net
from ddgfab.grid import grid_mesh
from ddgfab.measures import planarity
from ddgfab.mesh import Floats, Mesh, unit
from ddgfab.nets import circularity
from ddgfab.nets.conical import angle_balance, conical_residuals
from ddgfab.nets.conjugate import coefficients
from ddgfab.support import support_structure

KINDS = ("canal", "canopy", "circular", "conical", "monge", "moulding", "rotational", "translation")
CIRCULAR = ("canal", "canopy", "circular", "monge", "moulding", "rotational")
CONICAL = ("conical", "rotational")
OTHER = {
    "canal": {"climb_deg": 15.0, "turn_deg": -70.0, "end_radius_mm": 4000.0, "panels_across": 9},
    "canopy": {"flare": 0.7, "panels_along": 12},
    "circular": {"turn_deg": -40.0, "widening": 0.6, "arch_deg": 140.0},
    "conical": {"flare": 1.0, "bend_deg": -20.0, "arch_deg": 50.0},
    "monge": {"turn_deg": -60.0, "climb_deg": -20.0, "end_climb_deg": 10.0},
    "moulding": {"bends": 1.0, "swing_deg": -30.0, "wall_deg": 20.0},
    "rotational": {"sweep_deg": 200.0, "bulge": -0.15, "rings": 4},
    "translation": {"domes": 1, "panels_along": 6, "panel_along_mm": 1200.0},
}


def net_of(mesh: Mesh, entry: dict[str, float], kind: str) -> Floats:
    """The generated vertices as an array again; a closed one gets its first line at the end too."""
    known = {p.name: p.default for p in find_generator(kind).parameters} | entry
    across = known.get("panels_across", known.get("rings"))
    assert across is not None
    net = mesh.vertices.reshape(-1, int(across) + 1, 3)
    closed = kind == "rotational" and known["sweep_deg"] == 360.0
    return np.concatenate([net, net[:1]]) if closed else net


def test_every_kind_is_listed() -> None:
    assert set(KINDS) < set(kinds())  # koebe, minimal and K-nets have tests of their own
    assert list(kinds()) == sorted(kinds())
    for kind in kinds():
        entry = find_generator(kind)
        assert len(entry.summary) < 100
        assert all(p.text for p in entry.parameters)
        assert all(p.low <= p.default <= p.high for p in entry.parameters if p.type is not str)
        assert all(p.default in p.choices for p in entry.parameters if p.choices)
        assert kind in repr(entry)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("changed", [False, True])
def test_nets_are_exact_and_stand_upright(kind: str, changed: bool) -> None:
    """Relative to the size of the net: planar, circular, conical to 1e-12."""
    given = OTHER[kind] if changed else {}
    mesh = generate(kind, given)
    net = net_of(mesh, given, kind)
    assert planarity(mesh).max() < 1e-12 * mesh.diameter
    if kind in CIRCULAR:
        assert circularity(net).max() < 1e-12
        assert concyclic_defect(net) < 1e-11
    else:
        assert circularity(net).max() > 1e-5
    if kind in CONICAL:
        assert max(conical_residuals(net).values()) < 1e-11
        assert np.abs(angle_balance(net)).max() < 1e-9
    else:
        assert conical_residuals(net)["normals"] > 1e-5
    assert mesh.vertices[:, 2].min() == pytest.approx(0.0, abs=1e-9)
    assert mesh.face_normals[:, 2].min() > 0
    special = "offset" if kind == "translation" else "axis" if kind == "conical" else "normal"
    structure = support_structure(mesh, special)
    assert structure.torsion_deg_max < 1e-9
    assert structure.lean_deg_max < 30
    assert support_structure(mesh).lean_deg_mean <= structure.lean_deg_mean + 1e-6


# --- translation (8.1) -------------------------------------------------------------------------
def test_translation_nets_have_parallelograms_and_zero_coefficients() -> None:
    rng = np.random.default_rng(1)
    p, q = rng.normal(size=(6, 3)), rng.normal(size=(5, 3))
    x = translation_net(p, q)
    assert np.array_equal(x[:, 0], p)
    assert np.abs(x[1:, 1:] - x[1:, :-1] - x[:-1, 1:] + x[:-1, :-1]).max() < 1e-15
    for c in coefficients(x):
        assert np.abs(c).max() < 1e-13
    with pytest.raises(DegenerateError, match=r"quad \(1, 0\).*parallel"):
        translation_net([[0, 0, 0], [1, 0, 0], [1, 2, 0]], [[0, 0, 0], [0, 5, 0]])
    with pytest.raises(InputError, match="second curve"):
        translation_net(p, q[:1])


def test_hippo_house_has_equal_bars_and_two_domes() -> None:
    mesh = generate("translation", {"panel_across_mm": 1300.0})
    net = net_of(mesh, {}, "translation")
    assert np.abs(np.linalg.norm(np.diff(net, axis=0), axis=-1) - 1500).max() < 1e-9
    assert np.abs(np.linalg.norm(np.diff(net, axis=1), axis=-1) - 1300).max() < 1e-9
    ridge = net[:, 4, 2]
    tops = (ridge[1:-1] > ridge[:-2]) & (ridge[1:-1] >= ridge[2:])
    assert tops.sum() == 2


# --- rotational --------------------------------------------------------------------------------
def test_rotational_quads_are_isosceles_trapezoids_for_any_azimuths() -> None:
    rng = np.random.default_rng(2)
    meridian = np.stack([rng.uniform(1, 3, 5), np.cumsum(rng.uniform(0.5, 1, 5))], axis=1)
    x = rotational_net(meridian, np.cumsum(rng.uniform(0.1, 0.5, 7)))
    along = unit(np.diff(x, axis=0))
    assert np.linalg.norm(np.cross(along[:, 1:], along[:, :-1]), axis=-1).max() < 1e-14
    assert np.ptp(np.linalg.norm(np.diff(x, axis=1), axis=-1), axis=0).max() < 1e-14
    assert circularity(x).max() < 1e-13


def test_closed_dome() -> None:
    mesh = generate("rotational", {"panels_around": 20, "rings": 4})
    assert (mesh.n_vertices, mesh.n_faces, len(mesh.boundary_loops)) == (100, 80, 2)
    radius = np.linalg.norm(mesh.vertices[:, :2], axis=1).reshape(20, 5)
    assert np.ptp(radius, axis=0).max() < 1e-9
    assert radius[0, [0, -1]] == pytest.approx([7000, 1500])
    assert mesh.vertices[4, 2] == pytest.approx(4000)
    # Equal chords on a circle: the bulge is its height over the chord.
    arc = mesh.vertices.reshape(20, 5, 3)[0][:, [0, 2]]
    assert np.ptp(np.linalg.norm(np.diff(arc, axis=0), axis=1)) < 1e-9
    chord = arc[-1] - arc[0]
    out = (arc[2] - 0.5 * (arc[0] + arc[-1])) @ unit(np.array([chord[1], -chord[0]]))
    assert out / np.linalg.norm(chord) == pytest.approx(0.16)
    with pytest.raises(DegenerateError, match=r"meridian point \d"):
        generate("rotational", {"top_radius_mm": 10.0, "height_mm": 20000.0, "bulge": -0.5})
    with pytest.raises(DegenerateError, match="azimuth step 1"):
        rotational_net([[1, 0], [1, 1]], [0.0, 0.5, 0.5])
    with pytest.raises(InputError, match="azimuths"):
        rotational_net([[1, 0], [1, 1]], [0.0])


def test_chord_arc_of_half_a_circle() -> None:
    arc = chord_arc((1.0, 0.0), (-1.0, 0.0), 0.5, 6)
    assert np.abs(np.linalg.norm(arc, axis=1) - 1).max() < 1e-15
    assert arc[3] == pytest.approx([0.0, 1.0])
    with pytest.raises(DegenerateError, match="no length"):
        chord_arc((1.0, 0.0), (1.0, 0.0), 0.1, 3)


# --- moulding and canal ------------------------------------------------------------------------
def test_moulding_nets_have_horizontal_lines_and_vertical_congruent_ribs() -> None:
    profile = profile_polyline(np.linspace(0.9, -0.4, 7), np.linspace(1.0, 1.4, 6))
    x = moulding_net(profile, np.array([0.0, 0.2, 0.5, 0.4, 0.1]), np.array([1.0, 2.0, 1.5, 1.0]))
    assert np.ptp(x[..., 2], axis=0).max() < 1e-14
    ribs = x - x[:, :1]
    normal = unit(np.cross(ribs[:, 3], [0.0, 0.0, 1.0]))
    assert np.abs(np.einsum("ijk,ik->ij", ribs, normal)).max() < 1e-13
    assert np.ptp(np.linalg.norm(ribs, axis=-1), axis=0).max() < 1e-13
    assert circularity(x).max() < 1e-13
    mesh = generate("moulding")
    assert planarity(mesh).max() < 1e-9
    with pytest.raises(DegenerateError, match=r"panel \(\d+, \d+\) folds over"):
        generate("moulding", {"panels_along": 6, "bends": 9.0, "swing_deg": 80.0})


def test_canal_nets_lie_on_their_spheres_and_circles() -> None:
    way = np.linspace(0.0, 1.5, 10)
    centers = np.stack([np.cos(way), np.sin(way), 0.5 * way], axis=1) * 9000.0
    radii = 3000.0 + 500.0 * np.sin(2.0 * way)
    x = space_canal()
    middle, radius, normal = canal_circles(centers, radii)
    assert x.shape == (9, 6, 3)
    for k in range(9):
        assert np.abs(np.linalg.norm(x[k] - centers[k], axis=1) - radii[k]).max() < 1e-9
        assert np.abs(np.linalg.norm(x[k] - centers[k + 1], axis=1) - radii[k + 1]).max() < 1e-9
        assert np.abs(np.linalg.norm(x[k] - middle[k], axis=1) - radius[k]).max() < 1e-9
        assert np.abs((x[k] - middle[k]) @ normal[k]).max() < 1e-9
    assert circularity(x).max() < 1e-12
    assert concyclic_defect(x) < 1e-12


def test_a_canal_of_equal_spheres_on_a_line_is_a_cylinder() -> None:
    centers = np.stack([np.arange(5.0), np.zeros(5), np.zeros(5)], axis=1)
    x = canal_net(centers, np.full(5, 2.0), np.linspace(0.5, 2.0, 4))
    assert np.abs(x[..., 0] - (np.arange(4) + 0.5)[:, None]).max() < 1e-14
    assert np.ptp(x[..., 1:], axis=0).max() < 1e-14
    assert np.abs(np.linalg.norm(x[..., 1:], axis=-1) - np.sqrt(4 - 0.25)).max() < 1e-14


def test_canals_that_cannot_be_are_refused_by_sphere() -> None:
    line = np.stack([np.arange(4.0), np.zeros(4), np.zeros(4)], axis=1)
    with pytest.raises(DegenerateError, match=r"spheres 1 and 2.*1 apart, limits 1.5"):
        canal_net(line, [2.0, 2.0, 3.5, 3.5], [0.5, 1.0])
    with pytest.raises(DegenerateError, match=r"spheres 0 and 1.*0 to 0.8"):
        canal_net(line, np.full(4, 0.4), [0.5, 1.0])
    with pytest.raises(DegenerateError, match="along the spine"):
        canal_net(line, np.full(4, 2.0), [0.5, 1.0], up=(1.0, 0.0, 0.0))
    with pytest.raises(DegenerateError, match="turns back at sphere 1"):
        canal_net([[0, 0, 0], [1, 0, 0], [0, 0, 0]], [2.0, 2.0, 2.0], [0.5, 1.0])
    with pytest.raises(InputError, match="needed"):
        canal_circles(line, [1.0])
    with pytest.raises(DegenerateError, match="radius at sphere"):
        generate(
            "canal", {"middle_radius_mm": 100.0, "start_radius_mm": 9000.0, "end_radius_mm": 100.0}
        )
    with pytest.raises(DegenerateError, match="folds over"):
        generate("canal", {"turn_deg": 180.0, "length_mm": 15000.0, "arch_deg": 200.0})


# --- the registry ------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("kind", "values", "words"),
    [
        ("conicl", {}, 'kind "conicl" is unknown; did you mean conical'),
        ("xyz", {}, "known: .*canal, canopy"),
        ("canal", {"panels_alon": 3}, "panels_alon is unknown; did you mean panels_along"),
        ("canal", {"panels_along": 3.5}, "panels_along = 3.5 must be a whole number"),
        ("canal", {"panels_along": True}, "must be a whole number"),
        ("canal", {"turn_deg": "wide"}, "turn_deg = 'wide' must be a number"),
        ("canal", {"turn_deg": float("nan")}, "must be a number"),
        ("canal", {"panels_along": 0}, "panels_along = 0 is beyond its limits: 1 to 1000"),
        ("translation", {"panel_along_mm": 0}, "0.001 or more .length of every edge along"),
        ("circular", {"turn_deg": 0}, "turn_deg = 0 makes the torus a cylinder"),
        ("circular", {"turn_deg": 290}, "beyond the axis of the turn"),
    ],
)
def test_mistakes_name_parameter_value_and_limits(
    kind: str, values: dict[str, object], words: str
) -> None:
    with pytest.raises((ParameterError, DegenerateError), match=words):
        generate(kind, values)


def test_whole_numbers_pass_for_numbers_and_functions_check_themselves() -> None:
    from ddgfab.forms.translation import translation_roof

    assert translation_roof(3, 2, panel_along_mm=1000).n_faces == 6
    with pytest.raises(ParameterError) as caught:
        translation_roof(domes=0)
    assert caught.value.parameter == "domes"
    assert planarity(grid_mesh(planar_net())).max() < 1e-9


@pytest.mark.parametrize("kind", KINDS)
def test_any_parameters_give_an_exact_net_or_an_error(kind: str) -> None:
    """Never a warning, never a coordinate that is not finite, whatever is within the limits."""
    rng = np.random.default_rng(5)
    entry = find_generator(kind)
    made = 0
    for _ in range(40):
        values: dict[str, float] = {}
        for p in entry.parameters:
            low, high = max(p.low, -20000.0), min(p.high, 30000.0)
            if p.type is int:
                values[p.name] = int(rng.integers(p.low, min(high, 20) + 1))
            else:
                ends = [low, high, float(rng.uniform(low, high)), *([p.default] * 4)]
                values[p.name] = float(rng.choice(ends))
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            try:
                mesh = generate(kind, values)
            except DegenerateError:
                continue
        assert np.isfinite(mesh.vertices).all()
        assert planarity(mesh).max() < 1e-12 * mesh.diameter
        made += 1
    assert made > 3
