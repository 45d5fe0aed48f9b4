"""What is unlikely of a design: quantities far from what is built, both ways, with sources."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from ddgfab.mesh import Mesh, extent
from fabrication.gridshell.detailing.gridshell import Gridshell
from fabrication.gridshell.pieces import Beam
from fabrication.gridshell.project import Project
from fabrication.specs import Profile
from fabrication.standards import stock_lengths
from fabrication.standards.data import table

INWARD = (
    "the faces of the closed net look inwards: glass would lie inside, under the beams; "
    "flip = true in [net] (--flip) turns them over"
)

SHOWN = 3
"""So many pieces are named of each quantity."""


def unlikely(project: Project, mesh: Mesh, gridshell: Gridshell) -> tuple[str, ...]:
    """What is unlikely, a sentence each, with the limit, its source and the pieces concerned.

    Parameters
    ----------
    mesh : the net [mm]
    """
    found = [
        text
        for quantity, values, marks in _quantities(project, mesh, gridshell)
        if (text := _judged(table("plausible")[quantity], values, marks))
    ]
    found += _beyond_stock(gridshell)
    if looks_inward(mesh):
        found.append(INWARD)
    if text := _wide_gap(project, gridshell):
        found.append(text)
    return tuple(found)


def looks_inward(mesh: Mesh) -> bool:
    """Whether a mesh is closed and its faces look inwards."""
    if len(mesh.boundary_loops):
        return False
    middle = mesh.vertices.mean(axis=0)
    return float(np.einsum("ij,ij->", mesh.face_centers - middle, mesh.vector_areas)) < 0


def _quantities(
    project: Project, mesh: Mesh, gridshell: Gridshell
) -> Iterator[tuple[str, list[float], list[str]]]:
    """Name of each quantity, its values, and the marks of their pieces (none for settings)."""
    beams = [beam.mark for beam in gridshell.beams]
    yield "span", [extent(mesh.vertices) / 2], []
    slender = [beam.length_axis / _section(beam).depth for beam in gridshell.beams]
    yield "slenderness", slender, beams
    yield "eccentricity", [project.beam.eccentricity_mm], []
    yield "bar_density", [project.beam.density, project.node.density], []
    if not gridshell.panels:
        return
    yield "glass_thickness", [project.panel.thickness_mm], []
    yield "gap", [project.panel.gap_mm], []
    if project.panel.offset_mm != "auto":
        yield "pane_offset", [project.panel.offset_mm], []
    yield "pane_density", [project.panel.density], []
    sides = [side for panel in gridshell.panels for side in _sides(panel.shape.outer)]
    yield "pane_side", sides, [panel.mark for panel in gridshell.panels for _ in range(2)]


def _beyond_stock(gridshell: Gridshell) -> Iterator[str]:
    """What is unlikely of the lengths of bars, for each profile: they come from its stock."""
    by_profile: dict[str, list[int]] = {}
    for place, beam in enumerate(gridshell.beams):
        by_profile.setdefault(_section(beam).name, []).append(place)
    for places in by_profile.values():
        beams = [gridshell.beams[place] for place in places]
        rule = _stock_rule(_section(beams[0]))
        if text := _judged(rule, [b.length_axis for b in beams], [b.mark for b in beams]):
            yield text


def _section(beam: Beam) -> Profile:
    """The profile of a beam, whatever its ends."""
    section: Profile = getattr(beam.shape, "profile")  # noqa: B009 - shapes of beams have one
    return section


def _stock_rule(section: Profile) -> Mapping[str, Any]:
    """Limits of the length of a bar and their source, for a profile."""
    rule: Mapping[str, Any] = table("plausible")["bar_length"]
    stock = stock_lengths(section)
    if stock is None or max(stock[0]) >= rule["high"]:
        return rule
    source = f"{section.name}: {stock[1]}; longer ones are spliced, or made to order"
    return {**rule, "high": max(stock[0]), "source": source}


def _judged(rule: Mapping[str, Any], values: list[float], marks: list[str]) -> str:
    """What is unlikely of a quantity, or an empty text."""
    numbers = np.array(values, dtype=np.float64)
    below, above = numbers < rule["low"], numbers > rule["high"]
    for out, order, word in ((above, -numbers, "high"), (below, numbers, "low")):
        if not out.any():
            continue
        worst = [int(k) for k in np.argsort(order, kind="stable") if out[k]]
        value = f"{numbers[worst[0]]:.4g} {rule['unit']}".strip()
        pieces = list(dict.fromkeys(marks[k] for k in worst)) if marks else []
        named = ", ".join(pieces[:SHOWN])
        more = f" and {len(pieces) - SHOWN} more" if len(pieces) > SHOWN else ""
        limit = f"{rule[word]:g} {rule['unit']}".strip()
        side = "over" if word == "high" else "under"
        return (
            f"unlikely: {rule['what'].format(value=value)}{f' ({named}{more})' if named else ''} "
            f"is {side} {limit}: {rule['source']}"
        )
    return ""


def _wide_gap(project: Project, gridshell: Gridshell) -> str:
    """A gap that takes more of a pane's place than a fifth."""
    gap = project.panel.gap_mm
    small = [(min(_sides(panel.shape.outer)), panel.mark) for panel in gridshell.panels]
    narrow = [(side, mark) for side, mark in small if gap > WIDE * (side + gap)]
    if not narrow:
        return ""
    side, mark = min(narrow)
    return (
        f"unlikely: the gap of {gap:g} mm is over a fifth of the place of {len(narrow)} panes, of "
        f"which {side:.0f} mm are left ({mark}): set [panel] gap_mm"
    )


WIDE = 0.2
"""Greatest part of a pane's place that a gap may take."""


def _sides(outline: np.ndarray) -> tuple[float, float]:
    """Shortest and longest side [mm] of a pane."""
    lengths = np.linalg.norm(np.roll(outline, -1, axis=0) - outline, axis=1)
    return float(lengths.min()), float(lengths.max())
