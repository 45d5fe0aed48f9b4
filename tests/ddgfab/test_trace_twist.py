"""Normals turn about lines that are not principal by the integral of the geodesic torsion."""

from __future__ import annotations

import numpy as np
import pytest

from ddgfab.surfaces.analytic import named_surface
from ddgfab.surfaces.principal import lifted, principal
from ddgfab.surfaces.sampled import interpolated
from ddgfab.trace import PrincipalField, Tracer, trace
from ddgfab.trace.field import ConjugateField, turned
from ddgfab.trace.twist import edge_twist, geodesic_torsion, line_twist


def torus(u, v):
    far = 2 + np.cos(u)
    return np.stack([far * np.cos(v), far * np.sin(v), np.sin(u)], axis=-1)


def test_helix_on_a_cylinder_by_hand() -> None:
    """Torsion sin cos / R times the length: turn times rise over the length."""
    tube = interpolated(
        lambda u, v: np.stack([2 * np.cos(u), 2 * np.sin(u), v], axis=-1), (0, 1.5, 0, 2), (60, 20)
    )
    uv = np.array([[0.1, 0.2], [1.3, 1.7], [0.1, 1.7], [1.3, 0.2]])
    found = edge_twist(tube, uv, [[0, 1], [1, 0], [0, 2], [0, 3]])
    by_hand = 1.2 * 1.5 / np.hypot(2 * 1.2, 1.5)
    assert np.abs(found[:2]) == pytest.approx(by_hand, rel=1e-7)
    assert found[0] == pytest.approx(found[1], abs=1e-12)  # the sense of an edge does not matter
    assert found[2:] == pytest.approx(0, abs=1e-12)  # rulings and circles are principal


def test_torsion_is_that_of_the_angle_to_principal_directions() -> None:
    """The deviator itself is the second route; the sign is that of n' = -k_n t - t_g b."""
    surface = interpolated(torus, (0.2, 1.4, 0.0, 1.0), (60, 50))
    jets = surface.jets(np.array([[0.7, 0.4], [1.1, 0.8]]))
    found = principal(jets)
    for angle in (0.0, 0.3, np.pi / 4, 1.2):
        way = np.cos(angle) * found.first + np.sin(angle) * found.second
        size = 0.5 * (found.larger - found.smaller) * np.sin(2 * angle)
        assert np.abs(geodesic_torsion(jets, way)) == pytest.approx(np.abs(size), abs=1e-9)
        step = 1e-4
        uv = np.array([[0.7, 0.4], [1.1, 0.8]])
        ahead, back = (principal(surface.jets(uv + sign * step * way)).normal for sign in (1, -1))
        side = np.cross(found.normal, lifted(jets, way))
        slope = -np.einsum("nx,nx->n", (ahead - back) / (2 * step), side)
        assert geodesic_torsion(jets, way) == pytest.approx(slope, abs=1e-6)


def test_strips_are_developable_when_their_rulings_turn_by_the_twist() -> None:
    """a = cos f n + sin f b with f' = t_g: det(t, a, a') = 0; normals themselves: t_g."""
    surface = interpolated(torus, (0.2, 1.4, 0.0, 1.5), (80, 80))
    field = ConjugateField(surface, turned(np.radians(20)))
    (line,) = Tracer(field, 0, 0.01, 6.0, np.zeros((0, 3))).lines(np.array([[0.8, 0.7]]))
    jets = surface.jets(line.uv)
    normal = principal(jets).normal
    tangent = lifted(jets, field.directions(jets, 0))
    side = np.cross(normal, tangent)
    turn = line_twist(field, 0, line)
    middle = slice(3, -3)  # steps are even there

    def warp(rulings: np.ndarray) -> np.ndarray:
        slope = np.gradient(rulings, line.s, axis=0)
        return np.einsum("nx,nx->n", np.cross(tangent, rulings), slope)[middle]

    leaning = np.cos(turn)[:, None] * normal + np.sin(turn)[:, None] * side
    torsion = geodesic_torsion(jets, field.directions(jets, 0))[middle]
    assert np.abs(torsion).min() > 0.1
    assert np.abs(warp(normal)) == pytest.approx(np.abs(torsion), abs=1e-3)
    assert np.abs(warp(leaning)).max() < 1e-4


def test_principal_lines_have_none_and_reports_tell_that_of_others() -> None:
    surface = named_surface("saddle")
    field = PrincipalField(surface)
    straight = trace(surface, 2500.0)
    for family, lines in enumerate(straight.network.lines):
        assert max(np.abs(line_twist(field, family, line)).max() for line in lines) < 1e-9
    assert straight.quality.twist_deg is None
    skew = trace(surface, 2500.0, turn=np.radians(20))
    assert skew.quality.twist_deg is not None
    middle, greatest, whole = skew.quality.twist_deg
    edges = edge_twist(surface, skew.traced.uv, skew.mesh.edges[~skew.mesh.boundary_edge])
    assert np.degrees(np.abs(edges)).max() == pytest.approx(greatest)
    by_hand = np.degrees(2500 * 0.5 * (1 / 24e3 + 1 / 18e3) * np.sin(np.radians(40)))
    assert middle == pytest.approx(by_hand, rel=0.2)  # at the top of the saddle
    assert whole > 3 * middle
    assert any("ddgfab dilemma" in row for row in skew.quality.remarks())
