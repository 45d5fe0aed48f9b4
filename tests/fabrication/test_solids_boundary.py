"""Exact boundaries: closed, oriented, on their surfaces, of the genus the shape has."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from parts_table import BEAMS, CROSSED, CUT, EXACT, NODES

from ddgfab.errors import DegenerateError
from fabrication.boundary import Boundary
from fabrication.parts.node import NodeShape, RadialHole, Seat
from fabrication.parts.node.drills import bore_splits
from fabrication.solids import boundary_of, genus_of
from fabrication.solids.builder import principal_axes
from fabrication.solids.integrals import properties


def exact(name: str) -> Boundary:
    boundary = boundary_of(EXACT[name][0])
    assert boundary is not None
    return boundary


@pytest.mark.parametrize("name", EXACT)
def test_is_the_boundary_of_one_solid(name: str) -> None:
    boundary = exact(name)
    boundary.validate()
    assert boundary.genus == EXACT[name][1] == genus_of(EXACT[name][0])
    # Every edge twice, in two different faces or as a seam-free pair, once each way.
    assert sorted(boundary.coedges.tolist()) == sorted(
        [*range(len(boundary.edges)), *(~e for e in range(len(boundary.edges)))]
    )
    assert boundary.surface_distance().max() < 1e-9


@pytest.mark.parametrize("name", EXACT)
def test_every_arc_has_one_cylinder_and_one_plane_or_two_cylinders(name: str) -> None:
    boundary = exact(name)
    kinds = np.zeros((len(boundary.edges), 2), dtype=int)
    np.add.at(
        kinds,
        (boundary.coedge_edge, boundary.face_cylinder[boundary.coedge_face].astype(int)),
        1,
    )
    crosses = np.append(boundary.arc_crosses, False)[boundary.edge_arc]
    assert (kinds[(boundary.edge_arc >= 0) & ~crosses] == 1).all()
    assert (kinds[crosses] == [0, 2]).all()
    assert crosses.any() == (name in CROSSED)


@pytest.mark.parametrize("name", EXACT)
def test_no_face_meets_the_seam_of_its_cylinder(name: str) -> None:
    boundary = exact(name)
    face = boundary.coedge_face
    points = boundary.edge_points(np.linspace(0, 1, 9))[boundary.coedge_edge]
    away = points - boundary.face_origin[face][:, None]
    x, axis = boundary.face_xdir[face], boundary.face_axis[face]
    u = np.arctan2(
        np.einsum("cgi,ci->cg", away, np.cross(axis, x)), np.einsum("cgi,ci->cg", away, x)
    )
    # Half a turn at most, centered opposite to the seam: the seam is a quarter turn away.
    assert np.abs(u[boundary.face_cylinder[face]]).min(initial=math.pi) > math.pi / 2 - 1e-9
    assert (boundary.arc_range[:, 1] > boundary.arc_range[:, 0]).all()
    assert np.diff(boundary.arc_range, axis=1).max(initial=0.0) <= math.pi + 1e-12


@pytest.mark.parametrize("name", EXACT)
def test_frames_are_orthonormal(name: str) -> None:
    boundary = exact(name)
    for rows in (boundary.face_axis, boundary.face_xdir):
        assert np.abs(np.linalg.norm(rows, axis=1) - 1.0).max() < 1e-14
    assert np.abs(np.sum(boundary.face_axis * boundary.face_xdir, axis=1)).max() < 1e-14
    length = np.linalg.norm(boundary.arc_a, axis=1) * np.linalg.norm(boundary.arc_b, axis=1)
    assert (np.abs(np.sum(boundary.arc_a * boundary.arc_b, axis=1)) <= 1e-12 * length).all()


@pytest.mark.parametrize("name", CUT)
def test_other_curves_have_no_exact_boundary(name: str) -> None:
    shape, genus = CUT[name]
    assert boundary_of(shape) is None
    assert genus_of(shape) == genus


def test_principal_axes_trace_the_same_ellipse() -> None:
    rng = np.random.default_rng(7)
    for _ in range(20):
        a, b = rng.normal(size=(2, 3))
        major, minor, phi = (np.array(x) for x in principal_axes(tuple(a), tuple(b)))
        assert abs(major @ minor) < 1e-12
        assert major @ major >= minor @ minor
        for t in rng.uniform(-3, 3, size=5):
            expected = math.cos(t) * a + math.sin(t) * b
            found = math.cos(t - phi) * major + math.sin(t - phi) * minor
            assert np.allclose(found, expected, atol=1e-12)


def test_faces_of_a_square_bar() -> None:
    # Six planes, twelve edges, eight corners at the ends of the bar.
    boundary = exact("bar square")
    assert (boundary.n_faces, len(boundary.edges), len(boundary.points)) == (6, 12, 8)
    assert boundary.points.min(axis=0).tolist() == [62.0, -4.0, -30.0]
    assert boundary.points.max(axis=0).tolist() == [1170.0, 4.0, 30.0]
    assert repr(boundary) == "Boundary(6 plane and 0 cylinder faces, 12 edges, genus 0)"


@pytest.mark.parametrize("name", ["bar coped", "box coped", "tee coped", "free coped"])
def test_coped_ends_stand_on_the_coping_cylinder(name: str) -> None:
    # From the words of EndCut: the axis runs along (slope, 0, 1), `radius` beyond x.
    shape = replace(BEAMS[name][0], holes=())
    boundary = boundary_of(shape)
    assert boundary is not None
    for cut, outward in ((shape.start, -1.0), (shape.end, 1.0)):
        assert cut.radius is not None
        axis = np.array([cut.slope, 0.0, 1.0]) / math.hypot(cut.slope, 1.0)
        across = np.array([1.0, 0.0, -cut.slope]) / math.hypot(cut.slope, 1.0)
        foot = np.array([cut.x, 0.0, 0.0]) + outward * cut.radius * across
        points = boundary.points[(boundary.points[:, 0] > 600.0) == (outward > 0)]
        away = np.linalg.norm(np.cross(points - foot, axis), axis=1)
        assert np.abs(away - cut.radius).max() < 1e-9
        assert ((points - foot) @ across * outward < 0).all()  # the near side


def test_seats_and_holes_stand_where_the_spec_says() -> None:
    shape = NODES["valence 5 holes"][0]
    boundary = exact("valence 5 holes")
    for seat, hole in zip(shape.seats, shape.holes, strict=True):
        direction = np.array([math.cos(seat.azimuth), math.sin(seat.azimuth), 0.0])
        planes = ~boundary.face_cylinder & (boundary.face_axis @ direction > 1 - 1e-12)
        levels = sorted((boundary.face_origin[planes] @ direction).tolist())
        # The bottom of the hole, hole.depth below the seat, and the seat itself.
        assert levels == pytest.approx([seat.distance - (hole.depth or 0.0), seat.distance])
        walls = boundary.face_cylinder & (np.abs(boundary.face_axis @ direction) > 1 - 1e-12)
        walls &= boundary.face_radius == hole.diameter / 2
        walls &= boundary.face_origin @ direction > 0
        assert walls.sum() == 2
        assert boundary.face_origin[walls][:, 2] == pytest.approx([hole.z, hole.z])


# --- what validate refuses -----------------------------------------------------------------------
def test_refuses_an_edge_used_twice_the_same_way() -> None:
    boundary = exact("bar mitred")
    coedges = boundary.coedges.copy()
    # The loop of a face turned over: it still closes, but its edges run wrong.
    part = slice(boundary.loop_start[2], boundary.loop_start[3])
    coedges[part] = ~coedges[part][::-1]
    with pytest.raises(DegenerateError, match="instead of once"):
        replace(boundary, coedges=coedges).validate()


def test_refuses_a_loop_that_does_not_close() -> None:
    boundary = exact("bar mitred")
    coedges = boundary.coedges.copy()
    coedges[[0, 1]] = coedges[[1, 0]]
    with pytest.raises(DegenerateError, match="does not close"):
        replace(boundary, coedges=coedges).validate()


def test_refuses_a_vertex_off_its_plane() -> None:
    boundary = exact("quad mitred")
    points = boundary.points.copy()
    points[0, 2] += 1e-6
    with pytest.raises(DegenerateError, match="off the surface of face"):
        replace(boundary, points=points).validate()


def test_refuses_an_arc_that_misses_its_vertices() -> None:
    boundary = exact("bar coped")
    t = boundary.arc_range.copy()
    t[0, 1] += 1e-6
    with pytest.raises(DegenerateError, match="misses its vertices"):
        replace(boundary, arc_range=t).validate()


def test_refuses_a_wrong_radius() -> None:
    boundary = exact("bar coped")
    with pytest.raises(DegenerateError, match="off the surface of face"):
        replace(boundary, face_radius=boundary.face_radius * 1.001).validate()


def test_refuses_two_solids() -> None:
    one = exact("bar square")
    both = Boundary(
        np.concatenate([one.points, one.points + 5000.0]),
        np.concatenate([one.edges, one.edges + 8]),
        np.concatenate([one.edge_arc, one.edge_arc]),
        one.arc_center,
        one.arc_a,
        one.arc_b,
        one.arc_range,
        one.arc_onto,
        np.concatenate([one.face_cylinder] * 2),
        np.concatenate([one.face_origin, one.face_origin + 5000.0]),
        np.concatenate([one.face_axis] * 2),
        np.concatenate([one.face_xdir] * 2),
        np.concatenate([one.face_radius] * 2),
        np.concatenate([one.face_sign] * 2),
        np.concatenate([one.loop_face, one.loop_face + 6]),
        np.concatenate([one.loop_start, one.loop_start[1:] + 24]),
        np.concatenate(
            [one.coedges, np.where(one.coedges < 0, one.coedges - 12, one.coedges + 12)]
        ),
    )
    with pytest.raises(DegenerateError, match="6 of 12 faces are connected"):
        both.validate()


@pytest.mark.parametrize("azimuths", [(0.3,), (0.0, 0.62), (0.0, 1.5, 3.1, 4.7)])
def test_faces_of_a_bore_end_beside_the_mouths_of_its_holes(azimuths: tuple[float, ...]) -> None:
    holes = tuple(
        RadialHole(a, z, 14.0, None, y)
        for a in azimuths
        for z in (-30.0, 30.0)
        for y in (-9.0, 9.0)
    )
    seats = tuple(Seat(a, 76.6, 46.0) for a in azimuths)
    shape = NodeShape(80.0, 60.0, -60.0, 60.0, seats, holes)
    splits = bore_splits(shape)
    assert max(np.diff([*splits, splits[0] + 2.0 * math.pi])) <= math.pi + 1e-12
    for hole in holes:
        for turn in (split - hole.azimuth for split in splits):
            beside = abs(60.0 * math.sin(turn) - hole.across) - 0.5 * hole.diameter
            assert beside > 0.0 or math.cos(turn) < 0.0
    boundary = shape.geometry()
    assert isinstance(boundary, Boundary)
    boundary.validate()
    assert properties(boundary).volume == pytest.approx(shape.second_volume(), rel=1e-12)
