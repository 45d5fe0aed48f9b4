"""Base plates and anchors at the supports: plates level on the ground, posts upright on them.

A post stands below the middle of its node's bottom. As seen along the node axis its end stays
within the cuts of the beams, so that it meets none that is not steeper than upright.
Sizes are in `feet`. The usual depth of anchors is a rule of our own: only their assessment (ETA)
can state what the concrete needs.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

import numpy as np

from ddgfab.errors import DetailError
from ddgfab.mesh import Floats, Ints, Mesh
from fabrication.gridshell.detailing.connections.base import Mounted
from fabrication.gridshell.detailing.feet import SLACK, STEP, Foot, foot_of, highest_top
from fabrication.gridshell.detailing.frames import NAMED, Arms, EdgeFrames, node_mark
from fabrication.gridshell.detailing.joining import Fitted, Place
from fabrication.gridshell.detailing.sections import Sections
from fabrication.gridshell.ground_settings import GroundSettings
from fabrication.gridshell.pieces import Anchor, Base
from fabrication.gridshell.project import Project
from fabrication.parts.base import BASE, BaseShape
from fabrication.parts.fastener import nut, stud, washer
from fabrication.specs import Check
from fabrication.standards.fasteners import stud_length

STEEPEST: Final = 75.0
"""A node axis that leans more from the vertical [deg] has no post below it."""

LEVEL: Final = 0.01
"""How far plates may be from level [deg] and from the ground [mm]."""

USUAL_DEPTH: Final = 10.0
"""Depth of anchors in the ground, in diameters."""

MARK: Final = "A"
"""Begins the marks of anchors: A-0000."""

ALIGNED: Final = 0.1
"""A mean direction of arms shorter than this says nothing of where inwards is."""


def grounded(
    mesh: Mesh,
    axes: Floats,
    frames: EdgeFrames,
    arms: Arms,
    sections: Sections,
    places: Sequence[Place],
    fitted: Fitted,
    supports: Ints,
    project: Project,
) -> tuple[tuple[Base, ...], tuple[Anchor, ...]]:
    """A base plate for every support, and its anchors; none where [ground] wants none.

    Parameters
    ----------
    axes : (V, 3) unit node axes
    arms : of all nodes
    supports : vertices that stand on the ground

    Raises
    ------
    DetailError
        An axis that leans too far, a post that the node does not take, ground that is too high:
        names node, value, limit and what helps.
    """
    settings = project.ground
    if settings.kind == "none" or not len(supports):
        return (), ()
    _check_lean(axes, supports)
    feet: dict[int, Foot] = {}
    for place in places:
        nodes = np.unique(place.joints.arms.node)
        own = nodes[np.isin(nodes, supports)]
        if len(own):
            foot = foot_of(place, axes, fitted, own, project)
            feet |= dict.fromkeys(own.tolist(), foot)
    tops = {
        v: highest_top(v, feet[v], axes, frames, arms, sections, fitted, project)
        for v in supports.tolist()
    }
    grounds = _grounds(mesh, supports, feet, tops, settings)
    bases: list[Base] = []
    anchors: list[Anchor] = []
    for v in supports.tolist():
        base = _base(v, feet[v], grounds[v], mesh, axes, frames, arms, fitted, project)
        bases.append(base)
        anchors += _anchors(base, feet[v], len(anchors), settings)
    return tuple(bases), tuple(anchors)


def _check_lean(axes: Floats, supports: Ints) -> None:
    lean = np.degrees(np.arccos(np.clip(axes[supports, 2], -1.0, 1.0)))
    bad = np.flatnonzero(lean > STEEPEST)
    if len(bad):
        bad = bad[np.argsort(-lean[bad], kind="stable")]
        named = ", ".join(
            f"{node_mark(supports[k])} ({lean[k]:.1f} deg)" for k in bad[:NAMED].tolist()
        )
        more = f" and {len(bad) - NAMED} more" if len(bad) > NAMED else ""
        raise DetailError(
            f"the axes of supports lean from the vertical by more than {STEEPEST:g} deg, the limit "
            f"of posts below them: {named}{more}\nleave these nodes out of [ground] where, or take "
            '[ground] kind = "none"'
        )


def _grounds(
    mesh: Mesh,
    supports: Ints,
    feet: dict[int, Foot],
    tops: dict[int, float],
    settings: GroundSettings,
) -> dict[int, float]:
    """Height [mm] of the underside of each plate, by vertex."""
    height = mesh.vertices[:, 2].tolist()
    highest = {v: height[v] + tops[v] - feet[v].thickness for v in supports.tolist()}
    if settings.level_mm == "auto":
        drop = max(height[v] - highest[v] for v in highest)
        drop = STEP * math.ceil((drop - SLACK) / STEP)
        return {v: height[v] - drop for v in highest}
    level = settings.level_mm
    bad = sorted((v for v in highest if level > highest[v] + SLACK), key=lambda v: highest[v])
    if bad:
        named = ", ".join(f"{node_mark(v)} ({highest[v]:.1f} mm)" for v in bad[:NAMED])
        more = f" and {len(bad) - NAMED} more" if len(bad) > NAMED else ""
        raise DetailError(
            f"[ground] level_mm = {level:g} is too high for the base plates of {named}{more}, "
            "whose posts and beams need the ground there or lower\ntake [ground] level_mm = "
            f'{math.floor(highest[bad[0]]):g} or "auto"'
        )
    return dict.fromkeys(highest, level)


def _base(
    v: int,
    foot: Foot,
    ground: float,
    mesh: Mesh,
    axes: Floats,
    frames: EdgeFrames,
    arms: Arms,
    fitted: Fitted,
    project: Project,
) -> Base:
    """A plate on the ground below the middle of a node's bottom.

    The post ends as far from the node as beams do: `clearance_mm`, square to the axis.
    """
    axis, vertex = axes[v], mesh.vertices[v]
    bottom = vertex + fitted.bottoms[v] * axis
    gap = project.beam.clearance_mm / float(axis[2])
    length = float(bottom[2] - ground - foot.thickness) - gap
    own = np.arange(arms.start[v], arms.start[v + 1])
    inwards = (frames.x[arms.edge[own]] * (1 - 2 * arms.end[own])[:, None])[:, :2].sum(axis=0)
    if np.hypot(*inwards) < ALIGNED:
        inwards = -axis[:2] if np.hypot(*axis[:2]) > SLACK else np.array([1.0, 0.0])
    x = np.array([*(inwards / np.hypot(*inwards)), 0.0])
    y = np.array([-x[1], x[0], 0.0])
    placement = np.eye(4)
    placement[:3, 0], placement[:3, 1] = x, y
    placement[:3, 3] = bottom[0], bottom[1], ground + foot.thickness
    placement.setflags(write=False)
    lean = math.atan2(math.hypot(axis[0], axis[1]), axis[2])
    azimuth = math.atan2(float(axis @ y), float(axis @ x)) if lean > SLACK else 0.0
    shape = BaseShape(
        foot.width, foot.thickness, foot.spread, foot.size.hole, foot.radius, length, lean, azimuth
    )
    off_level = math.degrees(math.acos(min(1.0, float(placement[2, 2]))))
    away = abs(float(placement[2, 3]) - foot.thickness - ground)
    return Base(
        BASE.mark_of(v),
        node_mark(v),
        v,
        ground,
        shape,
        placement,
        checks=(
            Check("ground_deg", off_level <= LEVEL, off_level, LEVEL),
            Check("ground_mm", away <= LEVEL, away, LEVEL),
            Check("anchor_edge_mm", shape.edge >= foot.size.edge, shape.edge, foot.size.edge),
            Check("anchor_post_mm", shape.from_post >= foot.off, shape.from_post, foot.off),
        ),
    )


def _anchors(base: Base, foot: Foot, first: int, settings: GroundSettings) -> list[Anchor]:
    """The anchors of a plate: a threaded rod in the ground, washer and nut on the plate."""
    size, thick = foot.size, foot.thickness
    depth = settings.embedment_mm
    if depth == "auto":
        depth = USUAL_DEPTH * size.diameter
    least = depth + thick + foot.above
    length = stud_length(least) or STEP * math.ceil(least / STEP)
    mounted = (
        Mounted(stud(size, length), thick + foot.above - length, 1),
        Mounted(washer(size), thick, 1),
        Mounted(nut(size), thick + size.washer[2], 1),
    )
    place = base.placement
    return [
        Anchor(
            f"{MARK}-{first + k:04d}",
            base.mark,
            base.node,
            place[:3, :3] @ np.array([x, y, -thick]) + place[:3, 3],
            np.array([0.0, 0.0, 1.0]),
            mounted,
            base.shape.diameter,
            thick,
            length - thick - foot.above,
        )
        for k, (x, y) in enumerate(base.shape.places)
    ]
