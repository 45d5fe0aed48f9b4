"""Links: a straight bar between two round eyes on skew axes -> exact boundary.

The bar is a prism whose sides meet the eyes' round surfaces in arcs of ellipses (in lines where a
side is parallel to the eye's axis). The prism runs from surface to surface, so the eyes may stand
at any height on their axes and the bar only slants: nothing is left for booleans.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

from ddgfab.errors import DetailError
from fabrication.boundary import Boundary, Vec
from fabrication.parts.link.frame import (
    PARALLEL,
    BarFrame,
    Eye,
    bar_sides,
    corner_points,
    eye_angle,
    eyes_of,
    label_place,
    label_room,
    reading,
    section_top,
)
from fabrication.solids.builder import (
    BoundaryBuilder,
    Coedges,
    add,
    cross,
    dot,
    opposite,
    principal_axes,
    scale,
)
from fabrication.solids.drum import drum
from fabrication.solids.text import label_size, write_label

if TYPE_CHECKING:
    from fabrication.parts.link.shape import LinkShape

RIM: Final = 0.01
"""How far [mm] the bar must stay below the upper and lower edge of an eye's round surface."""

SPREAD: Final = math.radians(75.0)
"""Greatest angle between the middle of the bar and its corners on an eye's round surface."""

LEAST_BAR: Final = 1.0
"""Least length [mm] of the bar between the eyes."""

ROUNDING: Final = 1e-9
"""A label may be larger than its room by this [mm]."""


def check_link(shape: LinkShape) -> None:
    """Raise `DetailError` where the numbers of a link make no solid."""
    for bore in shape.bores:
        if not 0.0 < bore < shape.eye_diameter:
            raise DetailError(
                f"a bore of {bore:.6g} mm leaves no wall in an eye of {shape.eye_diameter:.6g} mm"
            )
    if shape.eye_height <= 0.0 or not 0.0 <= 2.0 * shape.bevel < min(
        shape.bar_width, shape.bar_height
    ):
        raise DetailError(
            f"a bar of {shape.bar_width:.6g} x {shape.bar_height:.6g} mm with bevels of "
            f"{shape.bevel:.6g} mm between eyes {shape.eye_height:.6g} mm high is not a solid"
        )
    least = shape.eye_diameter + LEAST_BAR
    if shape.length < least:
        raise DetailError(
            f"the hinges are {shape.length:.6g} mm apart, which leaves no bar between eyes of "
            f"{shape.eye_diameter:.6g} mm; make it {least:.6g} mm or more, or use smaller eyes"
        )
    if shape.bar_width >= shape.eye_diameter * math.sin(SPREAD):
        raise DetailError(
            f"a bar {shape.bar_width:.6g} mm wide is too wide for an eye of "
            f"{shape.eye_diameter:.6g} mm; limit {shape.eye_diameter * math.sin(SPREAD):.6g} mm"
        )


def _side_arc(
    builder: BoundaryBuilder, eye: Eye, ends: tuple[int, int], normal: Vec
) -> tuple[int, float]:
    """The edge between two points in which a side meets an eye, and its greatest height there."""
    p, q = builder.position(ends[0]), builder.position(ends[1])
    heights = [dot(add(point, eye.middle, -1.0), eye.axis) for point in (p, q)]
    slope = dot(eye.axis, normal)
    if abs(slope) <= PARALLEL:
        return builder.line(*ends), max(map(abs, heights))
    u, v = eye.outward, cross(eye.axis, eye.outward)
    # The plane's height over the circle is rise - (R / slope) (cos u.n + sin v.n).
    rise = dot(add(p, eye.middle, -1.0), normal) / slope
    a = scale(add(u, eye.axis, -dot(u, normal) / slope), eye.radius)
    b = scale(add(v, eye.axis, -dot(v, normal) / slope), eye.radius)
    a, b, shift = principal_axes(a, b)
    t0, t1 = eye_angle(eye, p), eye_angle(eye, q)
    turn = math.atan2(dot(v, normal), dot(u, normal))
    amplitude = eye.radius / slope * math.hypot(dot(u, normal), dot(v, normal))
    for angle, height in ((turn, rise - amplitude), (turn - math.pi, rise + amplitude)):
        inside = (angle - min(t0, t1)) % (2.0 * math.pi) < abs(t1 - t0)
        if inside:
            heights.append(height)
    center = add(eye.middle, eye.axis, rise)
    return builder.arc(ends, center, a, b, t0 - shift, t1 - shift), max(map(abs, heights))


def link_boundary(shape: LinkShape) -> Boundary:
    """Exact boundary of a link.

    Raises
    ------
    DetailError
        The eyes touch, the bar leaves an eye's round surface, a bore leaves no wall, or the label
        does not fit; the value, the limit and what helps are named.
    """
    check_link(shape)
    eyes = eyes_of(shape)
    frame, normals = bar_sides(shape, eyes)
    builder = BoundaryBuilder()
    corners = [[builder.point(p) for p in ends] for ends in corner_points(shape, eyes, frame)]
    n = len(normals)
    arcs: tuple[Coedges, Coedges] = ([], [])
    for k, eye in enumerate(eyes):
        high = 0.0
        for i in range(n):
            ends = corners[k][i], corners[k][(i + 1) % n]
            edge, height = _side_arc(builder, eye, ends, normals[i])
            arcs[k].append(edge)
            high = max(high, height)
        _check_eye(eye, [builder.position(p) for p in corners[k]], high)
    for i in range(n):
        j = (i + 1) % n
        here, there = (builder.line(corners[0][c], corners[1][c]) for c in (i, j))
        loops = [[arcs[0][i], there, ~arcs[1][i], ~here]]
        if i == section_top(shape):
            loops += _label(builder, shape, eyes, frame)
        builder.plane(normals[i], loops)
    for eye, loop, bore in zip(eyes, (opposite(arcs[0]), arcs[1]), shape.bores, strict=True):
        low, high_point = (add(eye.middle, eye.axis, sign * eye.half) for sign in (-1.0, 1.0))
        bottom, lid = drum(builder, low, high_point, eye.outward, eye.radius, [loop])
        near, far = builder.round_hole(low, high_point, eye.outward, bore / 2.0)
        builder.plane(scale(eye.axis, -1.0), [bottom, near])
        builder.plane(eye.axis, [lid, far])
    return builder.build()


def _check_eye(eye: Eye, corners: list[Vec], high: float) -> None:
    """Raise `DetailError` where the bar does not end on the round surface of an eye."""
    if high > eye.half - RIM:
        raise DetailError(
            f"the bar reaches {high:.6g} mm from the middle of the {eye.name} eye along its axis; "
            f"limit {eye.half - RIM:.6g} mm (half the eye's height).\n"
            f"Use a slimmer bar, a taller eye, or levels that differ less between its ends"
        )
    spread = max(abs(eye_angle(eye, corner)) for corner in corners)
    if spread > SPREAD:
        raise DetailError(
            f"the bar spreads {math.degrees(spread):.4g} deg to a side on the {eye.name} eye; "
            f"limit {math.degrees(SPREAD):.4g} deg: use a slimmer bar or a larger eye"
        )


def _label(
    builder: BoundaryBuilder, shape: LinkShape, eyes: tuple[Eye, Eye], frame: BarFrame
) -> list[Coedges]:
    """Write the label on the upper side of the bar; the loops that it gets as holes."""
    label = shape.label
    if label is None:
        return []
    size, raised = label_size(label), max(0.0, -label.depth)
    needed = size[::-1] if label.stacked else size
    for name, need, free in zip(("long", "wide"), needed, label_room(shape, raised), strict=True):
        if need > free + ROUNDING:
            raise DetailError(
                f'the label "{label.text}" is {need:.6g} mm {name}; the bar has {free:.6g} mm '
                f"for it: use a smaller label or none"
            )
    if not 0.0 < abs(label.depth) < shape.bar_height:
        raise DetailError(
            f'the label "{label.text}" is {label.depth:.6g} mm deep in a bar of '
            f"{shape.bar_height:.6g} mm"
        )
    middle, _ = label_place(shape, eyes, frame, raised)
    return write_label(builder, label, middle, *reading(label, frame))
