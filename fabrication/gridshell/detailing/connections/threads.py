"""Fasteners in tapped holes of nodes: how deep, how long, which of the series; all in mm."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Literal, TypeAlias

import numpy as np

from ddgfab.errors import DetailError
from fabrication.gridshell.detailing.connections.base import Drilling, Mounted, usual_plate
from fabrication.gridshell.detailing.frames import beam_mark, node_mark
from fabrication.parts.fastener import bolt, nut, stud, washer
from fabrication.standards.fasteners import Fastener, bolt_length, fastener, stud_length

if TYPE_CHECKING:
    from fabrication.gridshell.detailing.nodes.base import Joints, NodeSize
    from fabrication.gridshell.project import Project

FastenerChoice: TypeAlias = Literal["stud", "bolt"]

DEPTH_STEP: Final = 0.5
"""Depths of holes [mm] are multiples of this."""

THROUGH: Final = 10.0
"""How far [mm] a bolt may stand out of the wall of a tube, in its bore."""

PLATES: Final = 60
"""Within so many steps the nearest thickness of a plate is looked for that a bolt fits."""

PLATE_STEP: Final = 0.1
"""Step [mm] of that search."""

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
    """

    depth: float | None
    thread: float
    grip: float
    mounted: tuple[Mounted, ...]
    length: float


def tapped(project: Project) -> tuple[Fastener, FastenerChoice, float, float | None]:
    """Size, stud or bolt, plate [mm], and the thread [mm] that a project asks for, or None."""
    settings, size = project.connection, fastener(project.connection.bolt)
    plate = usual_plate(size) if settings.plate_mm == "auto" else settings.plate_mm
    thread = None if settings.thread_mm == "auto" else settings.thread_mm
    return size, settings.fastener, plate, thread


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
    under: float,
    plate: float,
    kind: FastenerChoice,
) -> Threaded:
    """The fasteners of all arms, as the shallowest hole allows.

    Parameters
    ----------
    under : from the seat to the washer
    plate : what the project can change of it, for the message

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
    grip = under + size.washer[2]
    if kind == "bolt":
        most = thread + (THROUGH if through else 0.0)  # into the bore a bolt may reach farther
        length = bolt_length(size, "full", grip + holes.thread - SLACK, grip + most + SLACK)
        if length is None:
            advice = _nearest_plate(size, plate, grip + holes.thread, grip + most)
            raise _no_length(joints, size, kind, plate, grip + holes.thread, grip + most, advice)
        mounted = (Mounted(washer(size), under, 1), Mounted(bolt(size, length), grip, -1))
        return Threaded(depth, thread, grip, mounted, length + size.head)
    needed = thread + grip + size.nut + size.pitch
    length = stud_length(needed)
    if length is None:
        raise _no_length(joints, size, kind, plate, needed, math.inf, "")
    rod = Mounted(stud(size, length), -thread, 1)
    mounted_stud = (rod, Mounted(washer(size), under, 1), Mounted(nut(size), grip, 1))
    return Threaded(depth, thread, grip, mounted_stud, length)


def _nearest_plate(size: Fastener, plate: float, least: float, most: float) -> str:
    """The nearest thickness with which a bolt of the series fits, in steps; or an empty text."""
    steps = sorted(range(-PLATES, PLATES + 1), key=abs)
    for step in (PLATE_STEP * k for k in steps):
        fits = bolt_length(size, "full", least + step - SLACK, most + step + SLACK)
        if fits and plate + step >= 0.5 * size.diameter:
            return f"{plate + step:g} instead of {plate:g}"
    return ""


def _no_length(
    joints: Joints,
    size: Fastener,
    kind: str,
    plate: float,
    least: float,
    most: float,
    advice: str,
) -> DetailError:
    arms = joints.arms
    upto = f" to {most:.1f}" if math.isfinite(most) else " or more"
    return DetailError(
        f"node {node_mark(arms.node[0])}, beam {beam_mark(arms.edge[0])} (and all others): a "
        f"{kind} {size.size} of {least:.1f}{upto} mm is needed, and the series "
        "has none\n"
        + (f"take [connection] plate_mm = {advice}" if advice else "")
        + f"take another [connection] plate_mm, which is {plate:g}" * (not advice)
    )


def check_square(joints: Joints, kind: str, what: str) -> None:
    """Raise `DetailError` where ends are coped, or torsion makes compound cuts."""
    if joints.project.beam.end != "flat":
        raise DetailError(
            f'[connection] kind = "{kind}" needs flat ends, not [beam] end = "cope": the plate at '
            "the end of a beam lies flat on its seat"
        )
    skew = np.abs(joints.frames.skew).max(axis=1)
    if skew.any():
        worst = int(skew.argmax())
        raise DetailError(
            f"beam {beam_mark(worst)} has a compound cut, skew by "
            f"{np.degrees(np.arctan(skew[worst])):.2f} deg, as torsion leaves it: {what} needs "
            '0\ntake [connection] kind = "welded", or a net without torsion ([optimize] '
            'goal = "torsion-free")'
        )
