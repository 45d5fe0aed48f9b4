"""Fasteners in tapped holes of nodes: how deep, how long, which of the series; all in mm."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Literal, TypeAlias

import numpy as np

from ddgfab.errors import DetailError
from fabrication.gridshell.detailing.connections.base import Drilling, Mounted, usual_plates
from fabrication.gridshell.detailing.frames import beam_mark, node_mark
from fabrication.parts.beam.slot import bar_sides
from fabrication.parts.fastener import bolt, nut, stud, washer
from fabrication.standards import plates
from fabrication.standards.fasteners import Fastener, bolt_length, fastener, stud_length

if TYPE_CHECKING:
    from fabrication.gridshell.detailing.nodes.base import Joints, NodeSize
    from fabrication.gridshell.project import Project

FastenerChoice: TypeAlias = Literal["stud", "bolt"]

DEPTH_STEP: Final = 0.5
"""Depths of holes [mm] are multiples of this."""

THROUGH: Final = 10.0
"""How far [mm] a bolt may stand out of the wall of a tube, in its bore."""

FLAT_STEP: Final = 5.0
"""Flat bars that messages name are multiples of this [mm]."""

SLACK: Final = 1e-9
"""A bolt [mm] may be longer by this: rounding of sums."""


@dataclass(frozen=True)
class Threaded:
    """Fasteners through a plate into a tapped hole.

    depth : of the hole; None: through the wall
    thread : complete thread in the node
    grip : from the seat to the head or nut
    mounted : the fasteners, from the seat outwards
    length : of the fastener, a bolt's with its head
    plate : thickness of the plate
    """

    depth: float | None
    thread: float
    grip: float
    mounted: tuple[Mounted, ...]
    length: float
    plate: float


def least_flat(depth: float, width: float) -> str:
    """The flat bar that is just large enough, in steps of 5 mm."""
    deep, wide = (FLAT_STEP * math.ceil(size / FLAT_STEP) for size in (depth, width))
    return f"FL {deep:g}x{wide:g}"


def tapped(project: Project) -> tuple[Fastener, FastenerChoice, tuple[float, ...], float | None]:
    """Size, stud or bolt, plates [mm] to choose from, and the thread [mm] asked for, or None."""
    settings, size = project.connection, fastener(project.connection.bolt)
    plates = usual_plates(size) if settings.plate_mm == "auto" else (settings.plate_mm,)
    thread = None if settings.thread_mm == "auto" else settings.thread_mm
    return size, settings.fastener, plates, thread


def drilling(size: Fastener, thread: float | None, across: float = 0.0) -> Drilling:
    """Tapped holes, a run-out deeper than their thread; thread: what the project asks for."""
    usual = size.usual_thread if thread is None else thread
    least = size.least_thread if thread is None else thread
    runout = size.runout
    return Drilling(size.size, size.drill, least + runout, usual + runout, least, across)


def threaded(
    joints: Joints,
    node: NodeSize,
    size: Fastener,
    holes: Drilling,
    gap: float,
    choice: Sequence[float],
    kind: FastenerChoice,
) -> Threaded:
    """The fasteners of all arms, as the shallowest hole allows, with the first plate that fits.

    Parameters
    ----------
    gap : from the seat to the plate
    choice : thicknesses of the plate

    Raises
    ------
    DetailError
        Too little room for the thread, or no length of the series; names node and beam.
    """
    room, through = node.hole_room(joints, holes)
    depth: float | None = None
    if through:
        thread = float(room.min())
    else:
        depth = min(holes.usual, DEPTH_STEP * math.floor(float(room.min()) / DEPTH_STEP))
        depth = max(depth, holes.least)
        thread = depth - size.runout
    for plate in choice:
        grip = gap + plate + size.washer[2]
        length, _ = _length(size, kind, grip, thread, holes, through)
        if length is None:
            continue
        under = gap + plate
        if kind == "bolt":
            screw = (Mounted(washer(size), under, 1), Mounted(bolt(size, length), grip, -1))
            return Threaded(depth, thread, grip, screw, length + size.head, plate)
        rod = Mounted(stud(size, length), -thread, 1)
        on_rod = (rod, Mounted(washer(size), under, 1), Mounted(nut(size), grip, 1))
        return Threaded(depth, thread, grip, on_rod, length, plate)
    plate = choice[0]
    grip = gap + plate + size.washer[2]
    _, (least, most) = _length(size, kind, grip, thread, holes, through)
    others = [
        t
        for t in sorted(plates(), key=lambda t: abs(t - plate))
        if t >= 0.5 * size.diameter
        and _length(size, kind, grip + t - plate, thread, holes, through)[0] is not None
    ]
    advice = f"another [connection] plate_mm, which is {plate:g}"
    if others:
        advice = f"[connection] plate_mm = {others[0]:g} instead of {plate:g}"
    elif kind == "bolt":
        advice = '[connection] fastener = "stud", which is cut to any thickness of the plate'
    raise _no_length(joints, size, kind, least, most, advice)


def _length(
    size: Fastener, kind: str, grip: float, thread: float, holes: Drilling, through: bool
) -> tuple[float | None, tuple[float, float]]:
    """Length of the series for a grip, or None; and between which lengths it is looked for."""
    if kind == "bolt":
        most = thread + (THROUGH if through else 0.0)  # into the bore a bolt may reach farther
        bounds = (grip + holes.thread, grip + most)
        return bolt_length(size, "full", bounds[0] - SLACK, bounds[1] + SLACK), bounds
    needed = thread + grip + size.nut + size.pitch
    return stud_length(needed), (needed, math.inf)


def _no_length(
    joints: Joints,
    size: Fastener,
    kind: str,
    least: float,
    most: float,
    advice: str,
) -> DetailError:
    arms = joints.arms
    upto = f" to {most:.1f}" if math.isfinite(most) else " or more"
    return DetailError(
        f"node {node_mark(arms.node[0])}, beam {beam_mark(arms.edge[0])} (and all others): a "
        f"{kind} {size.size} of {least:.1f}{upto} mm is needed, and the series "
        f"has none\ntake {advice}"
    )


def check_flat(joints: Joints) -> None:
    """Raise `DetailError` where the profile is not a flat bar, as slots and straps need it."""
    try:
        bar_sides(joints.profile)
    except DetailError as error:
        arms = joints.arms
        raise DetailError(
            f"node {node_mark(arms.node[0])}, beam {beam_mark(arms.edge[0])} (and all others): "
            f'{error}\ntake such a bar, or [connection] kind = "end_plate" with round nodes'
        ) from None


def check_square(joints: Joints, kind: str, what: str) -> None:
    """Raise `DetailError` where ends are coped, or torsion makes compound cuts."""
    if joints.project.beam.end != "flat":
        raise DetailError(
            f'[connection] kind = "{kind}" needs flat ends, not [beam] end = "cope": the plate at '
            'the end of a beam lies flat on its seat\ntake [beam] end = "flat"'
        )
    skew = np.where(joints.own, np.abs(joints.frames.skew), 0.0).max(axis=1)
    if skew.any():
        worst = int(skew.argmax())
        raise DetailError(
            f"beam {beam_mark(worst)} has a compound cut, skew by "
            f"{np.degrees(np.arctan(skew[worst])):.2f} deg, as torsion leaves it: {what} needs "
            '0\ntake [connection] kind = "welded", or a net without torsion ([optimize] '
            'goal = "torsion-free")'
        )
