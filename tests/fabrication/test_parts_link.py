"""Links: where eyes, bores and bar are, what does not fit, which turns carry a link to another."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from parts_table import LINKS, link

from ddgfab.errors import DetailError
from fabrication.checks.mesh import check_mesh, to_manifold
from fabrication.linkage.bodies import link_body
from fabrication.parts.link import LinkShape
from fabrication.parts.link.frame import bar_corners, bar_radius, label_room
from fabrication.solids import boundary_of, mesh_of, properties_of, second_volume_of, volume_of
from fabrication.solids.integrals import properties
from fabrication.solids.tessellation import tessellate
from fabrication.solids.text import GLYPHS, Label, text_dots, text_outlines, text_size


def axis_of(shape: LinkShape, end: int) -> tuple[np.ndarray, np.ndarray]:
    """Foot point and direction of a hinge axis, from the definition of the frame."""
    if end == 0:
        return np.zeros(3), np.array([0.0, 0.0, 1.0])
    t = shape.twist
    return np.array([shape.length, 0.0, 0.0]), np.array([0.0, -math.sin(t), math.cos(t)])


@pytest.mark.parametrize("name", LINKS)
def test_bores_and_eyes_lie_on_the_hinge_axes(name: str) -> None:
    shape = LINKS[name][0]
    boundary = boundary_of(shape)
    assert boundary is not None
    for end, at in enumerate((shape.start, shape.end)):
        foot, axis = axis_of(shape, end)
        away = boundary.face_origin - foot
        off = np.linalg.norm(np.cross(away, axis), axis=1)
        here = (
            boundary.face_cylinder
            & (off < 1e-9)
            & (np.linalg.norm(np.cross(boundary.face_axis, axis), axis=1) < 1e-12)
        )
        # Two halves of the bore, turned inwards, and two of the eye, outwards.
        assert sorted(boundary.face_radius[here] * boundary.face_sign[here]) == pytest.approx(
            [-shape.bores[end] / 2] * 2 + [shape.eye_diameter / 2] * 2
        )
        # The end faces are perpendicular to the axis, half the eye's height from its middle.
        flat = ~boundary.face_cylinder & (np.abs(boundary.face_axis @ axis) > 1 - 1e-12)
        heights = (boundary.face_origin[flat] - foot) @ axis
        for height in (at - shape.eye_height / 2, at + shape.eye_height / 2):
            assert np.abs(heights - height).min() < 1e-9


@pytest.mark.parametrize("degrees", [0, 1e-9, 1e-7, 1e-5, 0.01, 12.5, 45, 60, 89.999, 90, 120, 179])
@pytest.mark.parametrize("levels", [(0.0, 0.0), (3.2, 3.2), (-3.2, 3.2), (1.0, -5.4)])
@pytest.mark.parametrize("hand", [1.0, -1.0])
def test_every_twist_gives_a_solid(
    degrees: float, levels: tuple[float, float], hand: float
) -> None:
    shape = link(hand * degrees, *levels)
    boundary = boundary_of(shape)
    assert boundary is not None
    boundary.validate()
    exact = properties_of(shape)
    assert second_volume_of(shape) == pytest.approx(exact.volume, rel=1e-11)
    checks = check_mesh(mesh_of(shape), volume=exact.volume, area=exact.area, chord=0.05, genus=2)
    assert all(check.passed for check in checks), checks


@pytest.mark.parametrize("seed", range(4))
def test_whatever_is_accepted_is_a_solid_with_its_label(seed: int) -> None:
    """Random links, most of them refused: bars near the edges of eyes, labels between them."""
    random = np.random.default_rng(seed)
    made = 0
    for _ in range(12):
        width, height = random.uniform(1.5, 8.0, 2)
        eye = random.uniform(6.0, 20.0)
        shape = LinkShape(
            random.uniform(eye, 60.0),
            random.uniform(-math.pi, math.pi) * random.choice([1.0, 1e-3]),
            *random.normal(0.0, 3.0, 2),
            eye,
            random.uniform(height, 3 * height),
            (2.0, 3.0),
            width,
            height,
            random.choice([0.0, 0.2, 0.29]) * min(width, height),
        )
        for depth in (0.5, -0.5):
            try:
                room = label_room(shape, max(0.0, -depth))
                unit = min(room[0] / 7, room[1] / 5)
                boundary = boundary_of(replace(shape, label=Label("L9", unit, depth)))
            except DetailError:
                continue
            made += 1
            assert boundary is not None
            boundary.validate()
            exact = properties(boundary)
            again = second_volume_of(replace(shape, label=Label("L9", unit, depth)))
            assert again == pytest.approx(exact.volume, rel=1e-9)
            checks = check_mesh(
                tessellate(boundary), volume=exact.volume, area=exact.area, chord=0.05, genus=2
            )
            assert all(check.passed for check in checks), (shape, checks)
    assert made > 3


def test_volume_by_manifold_boolean() -> None:
    """Eyes, bores and bar as bodies of manifold3d, joined and cut by it."""
    import manifold3d

    shape = LINKS["slanted"][0]
    total = manifold3d.Manifold()
    bores = manifold3d.Manifold()
    for end, at in enumerate((shape.start, shape.end)):
        foot, axis = axis_of(shape, end)
        turn = math.degrees(math.atan2(-axis[1], axis[2]))
        for radius, height in ((shape.eye_diameter / 2, shape.eye_height), (1.7, 20.0)):
            body = manifold3d.Manifold.cylinder(height, radius, radius, 720, True)
            body = body.rotate((turn, 0, 0)).translate(tuple(foot + at * axis))
            if height == 20.0:
                bores += body
            else:
                total += body
    # The bar's edges, drawn on into the eyes.
    start, finish = np.split(bar_corners(shape), 2)
    into = 2.0 * (finish - start) / np.linalg.norm(finish - start, axis=1)[:, None]
    total += manifold3d.Manifold.hull_points(np.vstack([start - into, finish + into]))
    # The polygon of 720 sides lacks 1.3e-5 of the circle's area.
    assert (total - bores).volume() == pytest.approx(volume_of(shape), rel=1e-4)


def test_mirrored_links_have_mirrored_bounds() -> None:
    for shape in (link(40.0, -3.2, 1.0), link(70.0, 3.2, 3.2)):
        other = replace(shape, twist=-shape.twist)
        assert volume_of(other) == pytest.approx(volume_of(shape), rel=1e-12)
        here, there = (boundary_of(s).points for s in (shape, other))  # type: ignore[union-attr]
        assert np.ptp(there, axis=0) == pytest.approx(np.ptp(here, axis=0), abs=1e-9)


@pytest.mark.parametrize("name", [name for name in LINKS if "bossed" not in name])
def test_bar_lies_in_its_capsule_and_in_the_hull_of_its_corners(name: str) -> None:
    shape = LINKS[name][0]
    corners = bar_corners(shape)
    half = len(corners) // 2
    start, end = corners[:half].mean(axis=0), corners[half:].mean(axis=0)
    boundary = boundary_of(shape)
    assert boundary is not None
    mesh = mesh_of(shape)
    corner = mesh.vertices[mesh.triangles]
    vertices = np.concatenate(
        [corner.mean(axis=1), 0.5 * (corner + np.roll(corner, 1, axis=1)).reshape(-1, 3)]
    )
    outside = np.ones(len(vertices), dtype=bool)
    for at in range(2):
        foot, axis = axis_of(shape, at)
        away = vertices - foot
        radial = np.linalg.norm(away - np.outer(away @ axis, axis), axis=1)
        outside &= radial > shape.eye_diameter / 2 + 1e-6
    along = (end - start) / np.linalg.norm(end - start)
    away = vertices[outside] - start
    reach = np.linalg.norm(away - np.outer(away @ along, along), axis=1)
    assert outside.sum() > 20
    assert reach.max() <= bar_radius(shape) + 0.1
    # Whatever is outside the eyes is in the hull: the body for collisions holds the solid.
    import manifold3d

    hull = manifold3d.Manifold.hull_points(corners)
    grown = manifold3d.Manifold.hull_points(np.vstack([corners, vertices[outside]]))
    assert grown.volume() <= hull.volume() * (1 + 1e-9)


@pytest.mark.parametrize("name", ["bennett b", "slanted", "embossed", "embossed stacked"])
def test_body_for_collisions_holds_the_solid(name: str) -> None:
    shape = LINKS[name][0]
    body = link_body("L-0000", 0, (0, 1), shape)
    import manifold3d

    cover = manifold3d.Manifold()
    for piece in body.pieces:
        points = piece.points
        if piece.disc:
            side = np.cross(piece.axis, [1.0, 0.0, 0.0])
            side = side / np.linalg.norm(side)
            angles = np.linspace(0, 2 * np.pi, 720, endpoint=False)
            ring = np.outer(np.cos(angles), side)
            ring += np.outer(np.sin(angles), np.cross(piece.axis, side))
            radius = piece.disc / math.cos(math.pi / 720) + 1e-9  # around the circle
            points = (points[:, None] + radius * ring).reshape(-1, 3)
        cover += manifold3d.Manifold.hull_points(points)
    left = to_manifold(mesh_of(shape)) - cover
    assert left.volume() < 1e-6 * volume_of(shape)


@pytest.mark.parametrize(
    ("shape", "words"),
    [
        (link(40.0, length=10.5), ["10.5 mm apart", "10 mm", "11 mm"]),
        (link(40.0, length=0.0), ["0 mm apart"]),
        (link(40.0, bore=10.0), ["bore of 10 mm", "eye of 10 mm"]),
        (link(40.0, bar_width=9.8), ["9.8 mm wide", "9.65926 mm"]),
        (link(40.0, bar_height=6.5), ["start eye", "limit 2.99 mm"]),
        (link(40.0, -3.2, 9.6, length=30.0), ["eye", "limit 2.99 mm", "levels"]),
        (link(40.0, bevel=2.6), ["bevels of 2.6 mm"]),
        (link(40.0, eye_height=-1.0), ["eyes -1 mm"]),
        (link(40.0, label=Label("L1", 0.9, 0.6)), ["4.5 mm wide", "2.6 mm"]),
        (link(40.0, length=17.0, label=Label("L1234", 0.5, 0.6)), ["long"]),
        (link(40.0, label=Label("L1", 0.5, 5.0)), ["5 mm deep"]),
        (link(40.0, label=Label("L\u00e4", 0.5, 0.5)), ['no letter "\u00e4"', "0123456789"]),
    ],
)
def test_what_does_not_fit_is_said(shape: LinkShape, words: list[str]) -> None:
    with pytest.raises(DetailError) as error:
        boundary_of(shape)
    assert all(word in str(error.value) for word in words), error.value
    assert len(str(error.value).splitlines()) <= 3


# --- text ----------------------------------------------------------------------------------------
@pytest.mark.parametrize("letter", [letter for letter in GLYPHS if letter != " "])
def test_letters_are_solids_of_their_dots(letter: str) -> None:
    rows = GLYPHS[letter].split()
    assert len(rows) == 5
    assert len({len(row) for row in rows}) == 1
    for above, below in pairwise(rows):
        for k in range(len(above) - 1):
            square = above[k : k + 2] + below[k : k + 2]
            assert square not in ("1001", "0110"), "two dots touch at a corner only"
    (outline,) = text_outlines(letter)  # one body: a letter that falls apart has two

    def area(ring: tuple[tuple[int, int], ...]) -> float:
        x, y = np.array(ring, dtype=float).T
        return 0.5 * float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))

    assert area(outline.outer) > 0
    assert all(area(island) < 0 for island in outline.islands)
    total = area(outline.outer) + sum(area(island) for island in outline.islands)
    assert total == text_dots(letter) == sum(row.count("1") for row in rows)


def test_letters_differ() -> None:
    assert len(set(GLYPHS.values())) == len(GLYPHS)


@pytest.mark.parametrize("stacked", [False, True])
def test_text_fills_its_size(stacked: bool) -> None:
    text = "L1068.4-2"
    points = np.array([p for o in text_outlines(text, stacked) for p in o.outer])
    width, height = text_size(text, stacked=stacked)
    assert points.min() >= 0
    assert (points.max(axis=0) == (width, height)).all()


@pytest.mark.parametrize("depth", [0.6, -0.5])
@pytest.mark.parametrize("stacked", [False, True])
def test_a_label_takes_or_adds_its_dots(depth: float, stacked: bool) -> None:
    bare = link(40.0, 3.2, 3.2)
    label = Label("L86", 0.5, depth, stacked)
    # L 7 + 8 13 + 6 12 dots of a quarter of a square millimetre.
    assert text_dots("L86") == 7 + 13 + 12
    expected = volume_of(bare) - 32 * 0.25 * depth
    assert volume_of(replace(bare, label=label)) == pytest.approx(expected, rel=1e-12)
