"""What report.html says of a kit: how it moves, and which part goes on when and which way."""

from __future__ import annotations

import numpy as np

from fabrication.formats.html.page import Motion, Step, Subject
from fabrication.linkage.facing import Facing, facings
from fabrication.linkage.kit import Kit
from fabrication.linkage.links import Linkage
from fabrication.linkage.moving import MovingScene
from fabrication.linkage.schedules import hinge_order, marks_of, number_of
from fabrication.parts.link import LINK
from fabrication.parts.pin import PIN


def subject_of(kit: Kit, scene: MovingScene) -> Subject:
    """The kit as its page shows it; the scene gives meshes, colors and poses."""
    numbers = [group.number for group in scene.groups]
    return Subject(
        title=kit.name,
        lead=f"{kit.summary()}. {moves(kit)}",
        facts=kit.motion_facts(),
        notes=kit.notes,
        marks_of=lambda row: marks_of(dict(row)),
        steps=lambda _: steps_of(kit.linkage),
        motion=Motion(
            {piece.mark: scene.motions[:, n] for n, piece in enumerate(scene.pieces)},
            scene.driver,
            scene.values_deg,
            scene.design,
            scene.touches,
        ),
        meshes=dict(zip(numbers, scene.bodies, strict=True)),
        labelled=(LINK.role, PIN.role),
    )


def moves(kit: Kit) -> str:
    """How far the linkage moves, as a sentence."""
    low, high = np.degrees([kit.motion.low, kit.motion.high])
    if not high > low:
        return "It does not move: its parts touch in the design pose."
    return f"It moves freely through {high - low:.0f} degrees, from {low:.0f} to {high:.0f}."


def steps_of(linkage: Linkage) -> list[Step]:
    """A step a part, pin by pin, each from its head upwards, as in the schedule "assembly"."""
    numbers, facing = number_of(linkage), facings(linkage)
    labelled = {link.mark for link in linkage.links if link.shape.label is not None}
    pins = {pin.hinge: pin.mark for pin in linkage.pins}
    steps = []
    for hinge in hinge_order(linkage.mechanism):
        pin = pins[hinge]
        for item in linkage.stacks[hinge]:
            name = f"{item.kind.role} {item.mark} ({numbers[item.mark]})"
            if item.kind == PIN:
                text = f"take {name}"
            elif item.kind == LINK:
                way = _way(facing[item.mark], hinge, pins, item.mark in labelled)
                text = f"{name} onto {pin}: {way}"
            else:
                text = f"{name} onto {pin}"
            steps.append(Step(text, (item.mark,), f"pin {pin}"))
    return steps


def _way(facing: Facing, hinge: int, pins: dict[int, str], labelled: bool) -> str:
    """Which side of a link is up, and which of its ends goes on the pin of a hinge."""
    side = "up" if facing.up else "down"
    if not labelled:
        towards = pins[facing.towards]
        return f"it has no label; the side for one is {side}, its reading direction to {towards}"
    if facing.towards == hinge:
        return f"label {side}, this end is the one that the label reads towards"
    return f"label {side}, the label reads away from this pin, towards {pins[facing.towards]}"
