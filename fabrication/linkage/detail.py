"""Levels that keep all parts of a mechanism apart in its design pose, the best of them taken."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final

import numpy as np

from ddgfab.errors import DetailError
from ddgfab.linkages import Mechanism
from ddgfab.mesh import Ints
from fabrication.checks.assembly import Clash
from fabrication.linkage.bodies import bodies
from fabrication.linkage.choose import Prefer, check_links, rank_levels
from fabrication.linkage.levels import even_levels
from fabrication.linkage.links import Linkage, linkage_at
from fabrication.linkage.settings import LinkageSettings
from fabrication.linkage.shapes import heights_of, link_shapes
from fabrication.motion.convex import ConvexPieces
from fabrication.motion.free_range import JOINT_CLEARANCE
from fabrication.motion.pairs import Rules
from fabrication.motion.proof import Search

MOST_TRIED: Final = 12
"""How many choices of levels are tried until the parts keep apart."""


def detail_linkage(
    mechanism: Mechanism,
    settings: LinkageSettings,
    levels: Ints | Iterable[Ints] | None = None,
    prefer: Prefer = "parts",
) -> Linkage:
    """Parts of a mechanism, in its design pose, in which they do not touch.

    Parameters
    ----------
    levels : (E, 2) of the bars' ends, taken as they are; or choices of them, or by default all that
        `fabrication.linkage.levels.even_levels` gives, of which the best that fits is taken
    prefer : what the best one is: "parts" for few part numbers, "range" for a large free range

    Raises
    ------
    DetailError
        A link that cannot be made: it is named with its pins, the value, the limit and what helps;
        or parts that touch in the design pose whatever the levels: they are named with their pins.
    """
    if isinstance(levels, np.ndarray):
        shapes = link_shapes(mechanism, heights_of(levels, settings), settings)
        check_links(mechanism, shapes)
        return linkage_at(mechanism, settings, levels)
    choices = even_levels(mechanism, settings.max_levels) if levels is None else levels
    first: tuple[Linkage, Clash] | None = None
    for choice in rank_levels(mechanism, settings, choices, prefer)[:MOST_TRIED]:
        linkage = linkage_at(mechanism, settings, choice.levels)
        touching = touching_parts(linkage)
        if not touching:
            return linkage
        first = first or (linkage, touching[0])
    assert first is not None
    raise _no_levels(*first)


def touching_parts(linkage: Linkage) -> tuple[Clash, ...]:
    """Parts too near each other in the design pose, worst first.

    Parts on one pin whose distance never changes come last.
    """
    mechanism, solids = linkage.mechanism, bodies(linkage)
    pieces = ConvexPieces.build(mechanism, solids)
    rules = Rules.build(mechanism, solids, linkage.settings.axial_gap, JOINT_CLEARANCE)
    search = Search(mechanism, pieces, rules)
    return tuple(
        Clash((solids[pieces.body[k.a]].mark, solids[pieces.body[k.b]].mark), k.gap, k.limit)
        for k in search.too_near(mechanism.design) + search.standing()
    )


def _no_levels(linkage: Linkage, clash: Clash) -> DetailError:
    """The error where no levels help; names the parts that meet, and their pins."""
    pins = {link.mark: link.pins for link in linkage.links}
    first, second = (
        f"{mark} (on pins {', '.join(pins[mark])})" if mark in pins else mark
        for mark in clash.marks
    )
    return DetailError(
        f"no levels keep all parts apart in the design pose: {first} and {second} are "
        f"{clash.gap:.3g} mm apart; limit {clash.limit:g} mm.\n"
        "Take another design pose, longer or slimmer bars, smaller eyes, or smaller twists "
        "([linkage] deltas_deg of a K-net)"
    )
