"""Which profile each beam has: that of [beam], or of a rule for its place."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ddgfab.mesh import Floats, Ints
from fabrication.gridshell.detailing.places import Net, rules_of_beams
from fabrication.gridshell.project import Project
from fabrication.specs import Profile
from fabrication.standards.profiles import z_range


@dataclass(frozen=True, eq=False)
class Sections:
    """Profiles of all beams.

    profiles : that of [beam] first, then those of the rules
    of_edge : (E,) which of them each beam has
    low, high, width : (E,) lowest and highest z [mm] from the datum, and width
    """

    profiles: tuple[Profile, ...]
    of_edge: Ints
    low: Floats
    high: Floats
    width: Floats


def beam_sections(net: Net, project: Project) -> Sections:
    """The profile of every beam.

    Raises
    ------
    DetailError
        A rule that selects no beam, or an edge or group that is not there; two rules that select
        the same beam.
    """
    rules = project.beam.rules
    profiles = (project.beam.section(), *(rule.section() for rule in rules))
    of_edge = rules_of_beams(net, rules)
    heights = np.array([z_range(section) for section in profiles])
    widths = np.array([section.width for section in profiles])
    return Sections(profiles, of_edge, heights[of_edge, 0], heights[of_edge, 1], widths[of_edge])
