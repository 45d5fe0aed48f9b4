"""Which profile each beam has: that of [beam], or of a rule for its place."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ddgfab.errors import DetailError
from ddgfab.mesh import Floats, Ints, Mesh
from fabrication.gridshell.detailing.frames import beam_mark
from fabrication.gridshell.part_settings import BeamRule
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


def beam_sections(mesh: Mesh, project: Project) -> Sections:
    """The profile of every beam.

    Raises
    ------
    DetailError
        A rule that selects no beam, or an edge that is not there; two rules that select the same
        beam; profiles of their own where beams are bolted.
    """
    rules = project.beam.rules
    profiles = (project.beam.section(), *(rule.section() for rule in rules))
    of_edge = np.zeros(mesh.n_edges, dtype=np.int64)
    for number, rule in enumerate(rules, 1):
        edges = _selected(mesh, rule, number)
        taken = edges[of_edge[edges] > 0]
        if len(taken):
            raise DetailError(
                f"[[beam]] rules {of_edge[taken[0]]} and {number} (where = {_shown(rule)}) both "
                f"select beam {beam_mark(taken[0])}"
                + (f" and {len(taken) - 1} more" if len(taken) > 1 else "")
                + ": let each beam have one"
            )
        of_edge[edges] = number
    if rules and project.connection.kind != "welded":
        raise DetailError(
            f"[[beam]] where = {_shown(rules[0])}: with [connection] kind = "
            f'"{project.connection.kind}" all beams have one profile; rules are for kind = "welded"'
        )
    heights = np.array([z_range(section) for section in profiles])
    widths = np.array([section.width for section in profiles])
    return Sections(profiles, of_edge, heights[of_edge, 0], heights[of_edge, 1], widths[of_edge])


def _selected(mesh: Mesh, rule: BeamRule, number: int) -> Ints:
    """Edges that a rule selects, each once."""
    if rule.where == "boundary":
        edges = np.flatnonzero((mesh.edge_faces < 0).any(axis=1))
    else:
        edges = np.unique(np.array(rule.where, dtype=np.int64))
        bad = edges[(edges < 0) | (edges >= mesh.n_edges)]
        if len(bad):
            raise DetailError(
                f"[[beam]] rule {number} selects edge {bad[0]}; there are edges 0 to "
                f"{mesh.n_edges - 1}"
            )
    if not len(edges):
        raise DetailError(f"[[beam]] rule {number} (where = {_shown(rule)}) selects no beam")
    return np.asarray(edges, dtype=np.int64)


def _shown(rule: BeamRule) -> str:
    """The place of a rule, as in the file."""
    return f'"{rule.where}"' if isinstance(rule.where, str) else str(list(rule.where))
