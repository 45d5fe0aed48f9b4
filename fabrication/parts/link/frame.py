"""The numbers of a link made geometry: its eyes, the bar's frame and section, where they meet."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from ddgfab.errors import DetailError
from ddgfab.mesh import Floats
from fabrication.boundary import Vec
from fabrication.solids.builder import add, cross, dot, normalized, scale
from fabrication.solids.text import Label, label_size

if TYPE_CHECKING:
    from fabrication.parts.link.shape import LinkShape

LABEL_MARGIN: Final = 0.2
"""Least distance [mm] of a label from the border of its face."""

ACROSS: Final = 16
"""Steps across the bar in which it is measured how far the eyes reach into its upper side."""

PARALLEL: Final = 1e-12
"""A side whose normal leans against an eye's axis by less is parallel and meets it in lines."""

SLANTED: Final = 2e-3
"""A side that leans by less [rad] and is not parallel meets an eye in an ellipse many metres long,
whose coordinates leave no digits: the bar is turned a little."""

NUDGE: Final = 4e-3
"""By how much [rad] a bar is turned about itself to avoid such sides: 0.01 mm at its corners."""


@dataclass(frozen=True)
class Eye:
    """An eye: middle, unit axis, unit direction towards the bar, radius, half its height."""

    middle: Vec
    axis: Vec
    outward: Vec
    radius: float
    half: float
    name: str

    @property
    def exit(self) -> Vec:
        """Where the bar's middle line leaves the round surface."""
        return add(self.middle, self.outward, self.radius)


@dataclass(frozen=True)
class BarFrame:
    """Where the bar leaves the first eye, and unit vectors along it, across it and up."""

    origin: Vec
    along: Vec
    across: Vec
    up: Vec


def eyes_of(shape: LinkShape) -> tuple[Eye, Eye]:
    """The two eyes of a link in its frame."""
    axes: tuple[Vec, Vec] = (
        (0.0, 0.0, 1.0),
        (0.0, -math.sin(shape.twist), math.cos(shape.twist)),
    )
    middles = scale(axes[0], shape.start), add((shape.length, 0.0, 0.0), axes[1], shape.end)
    eyes = []
    for k, name in enumerate(("start", "end")):
        towards = add(middles[1 - k], middles[k], -1.0)
        level = add(towards, axes[k], -dot(towards, axes[k]))
        radius, half = shape.eye_diameter / 2.0, shape.eye_height / 2.0
        eyes.append(Eye(middles[k], axes[k], normalized(level), radius, half, name))
    return eyes[0], eyes[1]


def bar_frame(shape: LinkShape, eyes: tuple[Eye, Eye], roll: float = 0.0) -> BarFrame:
    """Frame of the bar; its height stands along the mean of the axes, turned by `roll`."""
    origin = eyes[0].exit
    along = normalized(add(eyes[1].exit, origin, -1.0))
    mean: Vec = (0.0, -math.sin(shape.twist / 2.0), math.cos(shape.twist / 2.0))
    up = normalized(add(mean, along, -dot(mean, along)))
    across = cross(up, along)
    c, s = math.cos(roll), math.sin(roll)
    return BarFrame(origin, along, add(scale(across, c), up, s), add(scale(up, c), across, -s))


def section_of(shape: LinkShape) -> list[tuple[float, float]]:
    """Corners (across, up) [mm] of the bar's section, counterclockwise."""
    w, h, b = shape.bar_width / 2.0, shape.bar_height / 2.0, shape.bevel
    if b == 0.0:
        return [(-w, -h), (w, -h), (w, h), (-w, h)]
    return [
        (-w + b, -h), (w - b, -h), (w, -h + b), (w, h - b),
        (w - b, h), (-w + b, h), (-w, h - b), (-w, -h + b),
    ]  # fmt: skip


def section_top(shape: LinkShape) -> int:
    """The corner at which the upper side of the section begins."""
    return 2 if shape.bevel == 0.0 else 4


def bar_radius(shape: LinkShape) -> float:
    """Radius [mm] of the cylinder about the bar's middle line that holds bar and label."""
    raised = 0.0 if shape.label is None else max(0.0, -shape.label.depth)
    half = shape.bar_width / 2.0 - shape.bevel
    corners = [math.hypot(across, up) for across, up in section_of(shape)]
    return max(*corners, math.hypot(half, shape.bar_height / 2.0 + raised))


def bar_sides(shape: LinkShape, eyes: tuple[Eye, Eye]) -> tuple[BarFrame, list[Vec]]:
    """The bar's frame and the outward normals of its sides.

    None of them is almost parallel to the axis of an eye.
    """
    corners = section_of(shape)
    for step in range(2 * len(corners) + 1):
        frame = bar_frame(shape, eyes, NUDGE * step)
        normals = []
        for (y0, z0), (y1, z1) in zip(corners, corners[1:] + corners[:1], strict=True):
            size = math.hypot(y1 - y0, z1 - z0)
            normals.append(add(scale(frame.across, (z1 - z0) / size), frame.up, -(y1 - y0) / size))
        leans = [abs(dot(normal, eye.axis)) for normal in normals for eye in eyes]
        if not any(PARALLEL < lean < SLANTED for lean in leans):
            break
    return frame, normals


def meet(eye: Eye, foot: Vec, along: Vec, sign: float) -> Vec:
    """Where a line leaves (sign 1) or enters (sign -1) the round surface of an eye."""
    away = add(foot, eye.middle, -1.0)
    p = add(away, eye.axis, -dot(away, eye.axis))
    q = add(along, eye.axis, -dot(along, eye.axis))
    a, b, c = dot(q, q), dot(p, q), dot(p, p) - eye.radius**2
    root = b * b - a * c
    if root <= 0.0:
        raise DetailError(f"the bar passes beside the {eye.name} eye; make it slimmer")
    return add(foot, along, (sign * math.sqrt(root) - b) / a)


def corner_points(shape: LinkShape, eyes: tuple[Eye, Eye], frame: BarFrame) -> list[list[Vec]]:
    """Where the edges of the bar meet the start's and the end's eye, in order of the section."""
    feet = [add(add(frame.origin, frame.across, y), frame.up, z) for y, z in section_of(shape)]
    return [
        [meet(eye, foot, frame.along, sign) for foot in feet]
        for eye, sign in zip(eyes, (1.0, -1.0), strict=True)
    ]


def bar_corners(shape: LinkShape) -> Floats:
    """(k, 3) points in which the edges of the bar meet the eyes: their hull holds the bar.

    Raises
    ------
    DetailError
        The bar does not meet its eyes.
    """
    eyes = eyes_of(shape)
    ends = corner_points(shape, eyes, bar_sides(shape, eyes)[0])
    return np.array(ends[0] + ends[1])


def eye_angle(eye: Eye, point: Vec) -> float:
    """Angle [rad] about an eye's axis, from the direction in which the bar leaves."""
    away = add(point, eye.middle, -1.0)
    return math.atan2(dot(away, cross(eye.axis, eye.outward)), dot(away, eye.outward))


def label_place(
    shape: LinkShape, eyes: tuple[Eye, Eye], frame: BarFrame, raised: float
) -> tuple[Vec, float]:
    """Middle of the upper side of the bar, and how much of its length [mm] the eyes leave free.

    The length is free up to `raised` [mm] above the bar.
    """
    half = shape.bar_width / 2.0 - shape.bevel
    low, high = -math.inf, math.inf
    for rise in (0.0, raised) if raised > 0.0 else (0.0,):
        for k in range(ACROSS + 1):
            foot = add(frame.origin, frame.up, shape.bar_height / 2.0 + rise)
            foot = add(foot, frame.across, half * (2.0 * k / ACROSS - 1.0))
            start, end = (
                dot(add(meet(eye, foot, frame.along, sign), frame.origin, -1.0), frame.along)
                for eye, sign in zip(eyes, (1.0, -1.0), strict=True)
            )
            low, high = max(low, start), min(high, end)
    middle = add(frame.origin, frame.along, 0.5 * (low + high))
    return add(middle, frame.up, shape.bar_height / 2.0), high - low


def label_room(shape: LinkShape, raised: float = 0.0) -> tuple[float, float]:
    """Length along the bar and width across it [mm] that a label may have.

    raised : how far [mm] it stands out

    Raises
    ------
    DetailError
        The bar does not meet its eyes.
    """
    eyes = eyes_of(shape)
    length = label_place(shape, eyes, bar_sides(shape, eyes)[0], raised)[1]
    margin = 2.0 * LABEL_MARGIN
    return length - margin, shape.bar_width - 2.0 * shape.bevel - margin


def reading(label: Label, frame: BarFrame) -> tuple[Vec, Vec]:
    """Directions of a label to the right and up."""
    if label.stacked:
        return scale(frame.across, -1.0), frame.along
    return frame.along, frame.across


def label_corners(shape: LinkShape) -> Floats:
    """(8, 3) corners of the block that holds the link's raised label."""
    label = shape.label
    assert label is not None
    eyes = eyes_of(shape)
    frame = bar_sides(shape, eyes)[0]
    middle, _ = label_place(shape, eyes, frame, max(0.0, -label.depth))
    right, up = (np.array(vec) for vec in reading(label, frame))
    width, height = label_size(label)
    foot = np.array(middle)
    return np.array(
        [
            foot + x * width / 2.0 * right + y * height / 2.0 * up + z * np.array(frame.up)
            for x in (-1.0, 1.0)
            for y in (-1.0, 1.0)
            for z in (0.0, -label.depth)
        ]
    )
