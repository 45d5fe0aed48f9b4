"""Several patches, drawn curves, and how certain lines are."""

from __future__ import annotations

import numpy as np
import pytest
from surface_cases import graph

from ddgfab.errors import DegenerateError, InputError
from ddgfab.surfaces.nearest import nearest_points
from ddgfab.surfaces.principal import principal
from ddgfab.surfaces.sampled import interpolated
from ddgfab.trace import trace
from ddgfab.trace.certainty import check_rest, turn_by_cell, turn_by_error
from ddgfab.trace.drawn import followed, laid_curves
from ddgfab.trace.field import plane_sections
from ddgfab.trace.patches import Patches, trace_patches
from ddgfab.trace.samples import Samples


def roof(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    return np.stack([x, y, 3 - 0.02 * x**2 - 0.04 * y**2 + 0.3 * np.sin(x / 3)], axis=-1)


@pytest.fixture(scope="module")
def halves() -> Patches:
    """The same roof as two patches, the second one seen from below (u and v exchanged)."""
    west = interpolated(roof, (-8, 0, -6, 6), (40, 40), name="west")
    east = interpolated(lambda u, v: roof(v, u), (-6, 6, 0, 7), (40, 40), name="east")
    return trace_patches([west, east], 1.8)


def test_lines_go_on_across_a_border(halves: Patches) -> None:
    mesh = halves.mesh
    assert int(mesh.components.max()) == 0
    assert len(mesh.boundary_loops) == 1
    (border,) = halves.joined.borders
    on_border = np.abs(mesh.vertices[:, 0]) < 1e-6
    assert border[2] >= 7
    assert border[4] < 1e-6  # lines of the second patch end where those of the first do
    inside = on_border & ~mesh.boundary_vertex
    assert inside.sum() == border[2] + border[3] - 2  # both ends of the border are on the rim
    assert (mesh.valences[inside] == 4).sum() >= border[2] - 3
    assert (halves.tag[inside] == 0).all()
    assert set(np.flatnonzero(halves.tag == 2)) >= {
        int(np.linalg.norm(mesh.vertices[:, :2] - p, axis=1).argmin())
        for p in ((-8, -6), (-8, 6), (7, -6), (7, 6))
    }
    assert "nodes together" in halves.joints[0]


def test_reference_of_patches_is_the_roof(halves: Patches) -> None:
    assert int(halves.reference.components.max()) == 1
    x, y, z = halves.reference.vertices.T
    assert np.abs(z - roof(x, y)[:, 2]).max() < 1e-3


def test_one_patch_is_what_trace_makes_and_far_ones_stay_apart() -> None:
    one = graph(lambda x, y: 0.2 * x**2 - 0.3 * y**2)
    both = trace_patches([one], 0.4)
    np.testing.assert_array_equal(both.mesh.vertices, trace(one, 0.4).mesh.vertices)
    assert both.joints == ()
    apart = trace_patches([one, one.moved([5.0, 0, 0])], 0.5)
    assert int(apart.mesh.components.max()) == 1
    assert sum("no border" in joint for joint in apart.joints) == 2
    with pytest.raises(InputError, match="no surface"):
        trace_patches([], 1.0)


def test_drawn_sections_are_those_of_planes() -> None:
    """Curves y = const in plan: the field between them is that of the planes' sections."""
    surface = graph(lambda x, y: 0.25 * x**2 + 0.15 * y**2 + 0.05 * x * y)
    x = np.linspace(-2, 2, 30)
    curves = [np.stack([x, 0 * x + y, 0 * x + 7], axis=1) for y in (-0.7, 0.0, 0.7)]
    laid = laid_curves(surface, curves)
    assert nearest_points(surface, laid[1]).distance.max() < 1e-12
    assert np.abs(laid[1][:, 1]).max() < 1e-9
    assert np.ptp(laid[1][:, 0]) > 1.9  # cut at the rim
    jets = surface.jets(np.random.default_rng(3).uniform(-0.9, 0.9, (50, 2)))
    field = followed(surface, laid)
    one, two = field(jets), plane_sections([0.0, 1.0, 0.0])(jets)
    turn = np.abs(one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0])
    assert (turn / np.linalg.norm(two, axis=1)).max() < 0.02
    net = trace(surface, 0.4, drawn=curves)
    for curve in laid[:1]:  # each drawn curve is a line of the net
        far = [np.linalg.norm(net.mesh.vertices - p, axis=1).min() for p in curve]
        assert np.percentile(far, 50) < 0.2
    drawn_row = np.abs(net.mesh.vertices[:, 1] + 0.7) < 0.01
    assert drawn_row.sum() >= 4
    assert net.quality.planarity_percent[0] < 0.2


def test_drawn_refusals() -> None:
    surface = graph(lambda x, y: 0.25 * x**2 + 0.15 * y**2)
    with pytest.raises(InputError, match="outside of its rim"):
        laid_curves(surface, [[[3, 0, 0], [4, 0, 0]]])
    with pytest.raises(InputError, match=r"curve 0 of 1 lies .* off the surface"):
        laid_curves(surface, [[[0, 0, 0], [0.2, 0.1, 0.9]]])
    with pytest.raises(InputError, match="no length"):
        laid_curves(surface, [[[0, 0, 0], [0, 0, 0]]])
    with pytest.raises(InputError, match="along and drawn both"):
        trace(surface, 0.3, along=[0, 1, 0], drawn=[[[0, 0, 0], [1, 0, 0]]])


def test_certainty_is_45_deg_at_umbilics_and_small_on_saddles() -> None:
    monkey = graph(lambda x, y: 0.3 * (x**3 - 3 * x * y**2))
    at = principal(monkey.jets(np.array([[1e-9, 0.0], [0.8, 0.3]])))
    assert (at.anisotropy > 0.99).all()  # which says nothing here
    turn = np.degrees(turn_by_error(at, 0.2))
    assert turn[0] == pytest.approx(45, abs=0.1)
    assert turn[1] < 1
    # half the error, double the difference of the curvatures: the closed form
    half = np.hypot(*at.deviator[1])
    assert np.tan(2 * np.radians(turn[1])) == pytest.approx(4e-3 / 0.2 / half)


def test_restless_directions_are_refused_not_many_umbilics() -> None:
    rough = graph(lambda x, y: 0.1 * x**2 + 2e-3 * np.sin(40 * x) * np.sin(37 * y))
    samples = Samples.of(rough)
    with pytest.raises(DegenerateError, match=r"turn by more than 45 deg .* noise, or waves"):
        check_rest(samples, 0.3)
    check_rest(samples, 1e-3)  # cells much smaller than the waves
    calm = Samples.of(graph(lambda x, y: 0.1 * x**2))
    assert turn_by_cell(calm, 0.3).max() < 0.07  # bending along the circle only
