"""In which order a structure goes up: rings of nodes from its supports, with what they carry."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from fabrication.formats.base import Row, Whole
from fabrication.formats.sheets.parts import is_drawn

LOWEST = 1.0
"""Nodes that are higher than the lowest one by less [mm] are as low."""


@dataclass(frozen=True)
class Ring:
    """What goes up together.

    counts : pieces by group
    mass : of all of them [kg]
    heaviest : mark and mass [kg] of the heaviest piece
    """

    number: int
    marks: tuple[str, ...]
    counts: Mapping[str, int]
    mass: float
    heaviest: tuple[str, float]


def rings_of(whole: Whole) -> list[Ring]:
    """Rings in order; none where the schedules do not say which nodes a beam joins."""
    tables = whole.tables or {}
    beams, nodes, panels = (tables.get(name, ()) for name in ("beams", "nodes", "panels"))
    if not beams or not nodes or "node_start" not in beams[0]:
        return []
    depth = _depths(beams, nodes, _grounded(tables))
    of_beam = {row["mark"]: max(depth[row["node_start"]], depth[row["node_end"]]) for row in beams}
    ring = {**depth, **of_beam}
    for row in panels:
        own = [row[name] for name in row if name.startswith("beam_") and row[name] in of_beam]
        if own:
            ring[row["mark"]] = max(of_beam[mark] for mark in own)
    for row in tables.get("bases", ()):
        ring[row["mark"]] = 0
    return _gathered(whole, ring)


def _grounded(tables: Mapping[str, Iterable[Row]]) -> set[str]:
    """Nodes that stand on a base plate."""
    return {row["node"] for row in tables.get("bases", ()) if row.get("node")}


def _depths(beams: Iterable[Row], nodes: Iterable[Row], grounded: set[str]) -> dict[str, int]:
    """How many beams every node is from where the structure stands."""
    joined: defaultdict[str, list[str]] = defaultdict(list)
    border: set[str] = set()
    for row in beams:
        one, two = row["node_start"], row["node_end"]
        joined[one].append(two)
        joined[two].append(one)
        if row.get("panel_left") is None or row.get("panel_right") is None:
            border |= {one, two}
    height = {row["mark"]: float(row.get("z_mm") or 0.0) for row in nodes}
    depth: dict[str, int] = {}
    left = sorted(height)
    while left:  # parts that are not joined begin at their own lowest nodes
        low = min(height[mark] for mark in left) + LOWEST
        start = [m for m in left if m in grounded] or [m for m in left if m in border]
        start = start or [m for m in left if height[m] <= low]
        for mark in start:
            depth[mark] = 0
        front = start
        while front:
            following = []
            for mark in front:
                for other in joined[mark]:
                    if other not in depth:
                        depth[other] = depth[mark] + 1
                        following.append(other)
            front = following
        left = [mark for mark in left if mark not in depth]
    return depth


def _gathered(whole: Whole, ring: Mapping[str, int]) -> list[Ring]:
    marks: defaultdict[int, list[str]] = defaultdict(list)
    counts: defaultdict[int, defaultdict[str, int]] = defaultdict(lambda: defaultdict(int))
    masses: defaultdict[int, list[tuple[float, str]]] = defaultdict(list)
    for family in whole.families:
        if not is_drawn(family) or family.number not in whole.parts:
            continue
        mass = whole.parts[family.number].mass
        for instance in family.instances:
            number = ring.get(instance.mark)
            if number is None or instance.mark in whole.failed:
                continue
            marks[number].append(instance.mark)
            counts[number][family.kind.title] += 1
            masses[number].append((mass, instance.mark))
    found = []
    for number in sorted(marks):
        mass, mark = max(masses[number], key=lambda pair: (pair[0], pair[1]))
        total = sum(mass for mass, _ in masses[number])
        found.append(
            Ring(number, tuple(sorted(marks[number])), dict(counts[number]), total, (mark, mass))
        )
    return found
