"""How each link goes on its pins: which side is up and which end where, seen from its label."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fabrication.linkage.links import Linkage
from fabrication.parts.link import LINK
from fabrication.parts.link.frame import bar_sides, eyes_of


@dataclass(frozen=True)
class Facing:
    """A link as it is put on its pins.

    up : whether the labelled side faces along the axes of its hinges, where stacks are counted to
    towards : the hinge at the end to which the label reads; letters that stand one below the other
        have their upper end there
    """

    up: bool
    towards: int


def facings(linkage: Linkage) -> dict[str, Facing]:
    """How the links go on their pins, by mark.

    One part number may serve bars that are turned over or end for end against each other: the parts
    are equal, and are distinguished by the side on which their label lies. For links without a
    label the side and end that would bear it are given.
    """
    mechanism = linkage.mechanism
    pose = mechanism.pose(mechanism.design)
    links = {link.mark: link for link in linkage.links}
    found = {}
    for family in linkage.families:
        if family.kind != LINK:
            continue
        shape = links[family.instances[0].mark].shape
        normal = np.array(bar_sides(shape, eyes_of(shape))[0].up)
        for instance in family.instances:
            hinges = list(links[instance.mark].hinges)
            turn, at = instance.placement[:3, :3], instance.placement[:3, 3]
            up = float(turn @ normal @ pose.axes[hinges].sum(axis=0)) > 0.0
            end = at + shape.length * turn[:, 0]
            away = np.linalg.norm(pose.points[hinges] - end, axis=1)
            found[instance.mark] = Facing(up, hinges[int(away.argmin())])
    return found
