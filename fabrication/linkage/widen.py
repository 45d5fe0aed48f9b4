"""Variants that may widen the free range: other levels along the hinges, slimmer bars."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import chain
from typing import Final

import numpy as np

from ddgfab.errors import DetailError, InputError
from ddgfab.linkages import Mechanism
from ddgfab.mesh import Ints
from fabrication.linkage.bodies import bodies
from fabrication.linkage.detail import detail_linkage
from fabrication.linkage.levels import even_levels, slanted_levels
from fabrication.linkage.links import Linkage
from fabrication.linkage.settings import LinkageSettings, check_settings
from fabrication.motion.free_range import FreeMotion, free_motion, maximize_range

SLIM: Final = 0.8
"""Width and height of slimmer bars over those of the settings, where the printer's wall allows."""

ENOUGH: Final = 2.0 * np.pi
"""No range is larger than this [rad]: nothing more is tried then."""


@dataclass(frozen=True, eq=False)
class MovingLinkage:
    """A linkage with its free motion, and what was tried: a line each."""

    linkage: Linkage
    motion: FreeMotion
    tried: tuple[str, ...] = ()


def moved(mechanism: Mechanism, settings: LinkageSettings) -> MovingLinkage:
    """The linkage of the settings, and its free motion.

    Raises
    ------
    DetailError
        Parts that cannot be made or that touch in the design pose; names them.
    """
    linkage = detail_linkage(mechanism, settings)
    return MovingLinkage(linkage, motion_of(linkage))


def widened(mechanism: Mechanism, settings: LinkageSettings) -> MovingLinkage:
    """The linkage of the greatest free range among some.

    Tried are: the settings as they are; other levels along the hinges, also further apart and with
    bars that climb from one to another; slimmer bars; and both.

    Raises
    ------
    DetailError
        None of them can be made: the fault of the first.
    """
    options: list[tuple[str, Linkage]] = []
    fault: DetailError | None = None
    for name, own, wide in _options(settings):
        try:
            levels = _levels(mechanism, own) if wide else None
            options.append(
                (name, detail_linkage(mechanism, own, levels, "range" if wide else "parts"))
            )
        except DetailError as error:
            fault = fault or error
    if fault is not None and not options:
        raise fault
    found = maximize_range(options, lambda option: motion_of(option[1]), enough=ENOUGH)
    tried = tuple(
        f"{name}: free through {np.degrees(motion.range):.2f} deg"
        + (" (taken)" if name == found.best[0] else "")
        for (name, _), motion in found.tried
    )
    return MovingLinkage(found.best[1], found.motion, tried)


def motion_of(linkage: Linkage) -> FreeMotion:
    """The certified free motion of a linkage, with its axial gap as the clearance."""
    return free_motion(linkage.mechanism, bodies(linkage), linkage.settings.axial_gap)


def _options(settings: LinkageSettings) -> list[tuple[str, LinkageSettings, bool]]:
    """Name, settings, and whether levels are chosen for the range."""
    wall = settings.printer.wall
    width, height = (max(wall, SLIM * size) for size in (settings.bar_width, settings.bar_height))
    slim = replace(settings, bar_width=width, bar_height=height)
    bars = f"bars of {width:g} x {height:g} mm"
    asked = [
        ("settings as given", settings, False),
        ("levels chosen for the range", settings, True),
    ]
    try:
        check_settings(slim)
    except InputError:  # the printer makes none slimmer
        return asked
    return [*asked, (bars, slim, False), (f"{bars}, levels chosen for the range", slim, True)]


def _levels(mechanism: Mechanism, settings: LinkageSettings) -> Iterator[Ints]:
    """All levels that may be had: even ones, slanted ones, and even ones twice as far apart."""
    return chain(
        even_levels(mechanism, settings.max_levels),
        slanted_levels(mechanism),
        (2 * levels for levels in even_levels(mechanism, settings.max_levels)),
    )
