"""Schedules of a kit: bill of materials, links, hinges, and the order of assembly.

From the bill of materials alone (lengths, twists, adjacency) the linkage can be made again, which
the tests do. Lengths and twists are therefore written with all digits.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from typing import Any, Final, TypeAlias

import numpy as np

from ddgfab.linkages.mechanism import Mechanism
from ddgfab.mesh import Floats
from fabrication.linkage.facing import Facing, facings
from fabrication.linkage.legends import ASSEMBLY, BOM, HINGES, LINKS
from fabrication.linkage.links import Linkage
from fabrication.linkage.settings import LinkageSettings
from fabrication.parts.link import LINK
from fabrication.parts.pin import PIN
from fabrication.specs import Kind
from fabrication.table import Table

Row: TypeAlias = dict[str, Any]
Masses: TypeAlias = Mapping[str, float]

DIGITS: Final = 13
"""Significant digits of what the linkage is made again from."""

DIMENSIONS: Final = (
    "length_mm",
    "twist_deg",
    "hand",
    "diameter_mm",
    "bore_mm",
    "height_mm",
    "label",
)
"""Columns of the dimensions that kits usually have; others follow where a shape has them."""

FULL: Final = 1e-9
"""An angle this near [rad] below a full turn is 0."""


def kit_schedules(linkage: Linkage, masses: Masses) -> dict[str, Table]:
    """Tables "bom", "links", "hinges" and "assembly"; masses [kg] by part number."""
    return {
        "bom": Table(bom_rows(linkage, masses), "bom", BOM),
        "links": Table(link_rows(linkage), "links", LINKS),
        "hinges": Table(hinge_rows(linkage), "hinges", HINGES),
        "assembly": Table(assembly_rows(linkage), "assembly", ASSEMBLY),
    }


def marks_of(row: Row) -> list[str]:
    """The pieces that a row of a schedule is about: all of a part number, a link, part or pin."""
    if "marks" in row:
        return str(row["marks"]).split()
    return [str(row[key]) for key in ("mark", "part", "pin") if key in row][:1]


def bom_rows(linkage: Linkage, masses: Masses) -> list[Row]:
    """A row a part number: how many, its main dimensions, where it belongs.

    `between` lists, for every link of the number, from which hinge to which it goes: its start is
    the first, and the twist is counted about the direction from there.
    """
    links = {link.mark: link for link in linkage.links}
    places = {link.mark: f"{link.hinges[0]}>{link.hinges[1]}" for link in linkage.links}
    places |= {piece.mark: str(piece.hinge) for piece in linkage.on_pins}
    rows = []
    for family in linkage.families:
        marks = [instance.mark for instance in family.instances]
        link = links.get(marks[0])
        rows.append(
            {
                "number": family.number,
                "role": family.role,
                "count": len(marks),
                "material": material(linkage, family.kind),
                **dict.fromkeys(DIMENSIONS),
                **family.shape.dimensions(),
                "mass_g": 1000.0 * masses[family.number],
                "total_g": 1000.0 * masses[family.number] * len(marks),
                "between": " ".join(places[mark] for mark in marks if mark in places),
                "marks": " ".join(marks),
                "length_exact_mm": exact(link.shape.length) if link else None,
                "twist_exact_deg": exact(float(np.degrees(link.shape.twist))) if link else None,
            }
        )
    return rows


def material(linkage: Linkage, kind: Kind) -> str:
    """What parts of a kind are made of."""
    settings = linkage.settings
    return settings.printer.material if is_printed(kind, settings) else "steel rod"


def is_printed(kind: Kind, settings: LinkageSettings) -> bool:
    """Whether a printer makes parts of a kind; metal pins are lengths of rod."""
    return not (kind == PIN and settings.pin == "metal")


def exact(value: float) -> str:
    """A number with all the digits that count, as text: no table rounds it."""
    return f"{value:.{DIGITS}g}"


def link_rows(linkage: Linkage) -> list[Row]:
    """A row a link: its hinges, levels, and the angle at its start in the design pose.

    label_side and label_towards are how a link goes on its pins: the side with the label up along
    the axes or down, and the pin at the end to which the label reads.
    """
    mechanism, facing = linkage.mechanism, facings(linkage)
    numbers = number_of(linkage)
    azimuths = bar_azimuths(mechanism)
    rows = []
    for piece in linkage.links:
        bar = piece.bar
        rows.append(
            {
                "mark": piece.mark,
                "number": numbers[piece.mark],
                "bar": bar,
                "strip": piece.strip,
                "direction": piece.direction,
                "hinge_start": piece.hinges[0],
                "hinge_end": piece.hinges[1],
                "pin_start": piece.pins[0],
                "pin_end": piece.pins[1],
                "level_start": piece.levels[0],
                "level_end": piece.levels[1],
                "label_side": _side(facing[piece.mark]),
                "label_towards": PIN.mark_of(facing[piece.mark].towards),
                "length_mm": float(mechanism.lengths[bar]),
                "twist_deg": float(np.degrees(mechanism.twists[bar])),
                "hand": piece.shape.hand,
                "angle_start_deg": float(np.degrees(azimuths[bar, 0])),
                "angle_end_deg": float(np.degrees(azimuths[bar, 1])),
                "angle_start_exact_deg": exact(float(np.degrees(azimuths[bar, 0]))),
                "angle_end_exact_deg": exact(float(np.degrees(azimuths[bar, 1]))),
            }
        )
    return rows


def _side(facing: Facing) -> str:
    return "up" if facing.up else "down"


def bar_azimuths(mechanism: Mechanism) -> Floats:
    """(E, 2) direction of each bar about the axis at its two hinges in the design pose [rad].

    Counted about the axis from the hinge's bar of the lowest number, in [0, 2 pi).
    """
    pose = mechanism.pose(mechanism.design)
    azimuths = np.zeros((mechanism.n_bars, 2))
    reference: dict[int, Floats] = {}
    for bar, hinges in enumerate(mechanism.bars.tolist()):
        for end in (0, 1):
            hinge, other = hinges[end], hinges[1 - end]
            away = pose.points[other] - pose.points[hinge]
            axis = pose.axes[hinge]
            first = reference.setdefault(hinge, away)
            sine = axis @ np.cross(first, away)
            angle = float(np.arctan2(sine, first @ away)) % (2 * np.pi)
            azimuths[bar, end] = 0.0 if 2 * np.pi - angle < FULL else angle
    return azimuths


def hinge_rows(linkage: Linkage) -> list[Row]:
    """A row a hinge: its pin, where it is in the design pose, what is on it from the bottom up."""
    numbers = number_of(linkage)
    rows = []
    for piece in linkage.pins:
        stack = linkage.stacks[piece.hinge]
        x, axis = piece.position, piece.axis
        rows.append(
            {
                "hinge": piece.hinge,
                "pin": piece.mark,
                "number": numbers[piece.mark],
                "bars": sum(item.kind == LINK for item in stack),
                "stack": " ".join(item.mark for item in stack),
                "diameter_mm": piece.shape.diameter,
                "length_mm": piece.shape.length,
                **dict(zip(("x_mm", "y_mm", "z_mm"), x.tolist(), strict=True)),
                **dict(zip(("axis_x", "axis_y", "axis_z"), axis.tolist(), strict=True)),
            }
        )
    return rows


def assembly_rows(linkage: Linkage) -> list[Row]:
    """A row a part in the order in which it is put on: pin by pin, each from its head upwards.

    The pins come in an order in which every one but the first takes a link that is already there.
    """
    numbers, facing = number_of(linkage), facings(linkage)
    pins = {pin.hinge: pin.mark for pin in linkage.pins}
    levels = {
        (piece.mark, hinge): level
        for piece in linkage.links
        for hinge, level in zip(piece.hinges, piece.levels, strict=True)
    }
    rows: list[Row] = []
    for place, hinge in enumerate(hinge_order(linkage.mechanism), 1):
        for order, item in enumerate(linkage.stacks[hinge], 1):
            rows.append(
                {
                    "step": len(rows) + 1,
                    "pin_order": place,
                    "hinge": hinge,
                    "pin": pins[hinge],
                    "order": order,
                    "part": item.mark,
                    "number": numbers[item.mark],
                    "role": item.kind.role,
                    "level": levels.get((item.mark, hinge)),
                    "label_side": _side(facing[item.mark]) if item.mark in facing else None,
                    "from_mm": item.low,
                    "to_mm": item.high,
                }
            )
    return rows


def hinge_order(mechanism: Mechanism) -> list[int]:
    """Hinges breadth first along the bars from hinge 0; a second piece of a linkage follows."""
    near: list[list[int]] = [[] for _ in range(mechanism.n_hinges)]
    for i, j in mechanism.bars.tolist():
        near[i].append(j)
        near[j].append(i)
    order: list[int] = []
    seen = [False] * mechanism.n_hinges
    for start in range(mechanism.n_hinges):
        waiting = deque([start])
        while waiting:
            hinge = waiting.popleft()
            if not seen[hinge]:
                seen[hinge] = True
                order.append(hinge)
                waiting.extend(near[hinge])
    return order


def number_of(linkage: Linkage) -> dict[str, str]:
    """Part numbers by mark."""
    return {
        instance.mark: family.number for family in linkage.families for instance in family.instances
    }
