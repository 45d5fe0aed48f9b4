"""Checks of assembly.step: read back and compared piece by piece with what went in."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import Final

import numpy as np

from ddgfab.errors import InputError
from fabrication.formats.base import REJECTED_KIND
from fabrication.formats.step.coaxial import check_mates
from fabrication.formats.step.read import FILE_VOLUME_RELATIVE, STEP_UNIT, read_step
from fabrication.formats.step.records import product_name
from fabrication.specs import Check, Mate, Placement

PLACEMENT_MM: Final = 1e-6
"""How far [mm] the placement of an instance read back may be from the one written."""

PLACEMENT_ROTATION: Final = 1e-9
"""How far the entries of its rotation may be."""


def check_step_assembly(
    path: Path,
    expected: Mapping[str, tuple[str, float, Placement]],
    rejected: Collection[str] = (),
    mates: Sequence[Mate] = (),
) -> list[Check]:
    """The checks of the whole: names, counts, placements, and each product closed, of right volume.

    The products are those of the part files, which are validated one by one (BRepCheck).

    Parameters
    ----------
    expected : by piece mark: part number, volume [mm3], (4, 4) placement
    rejected : marks of the pieces that must be on the layer REJECTED, as no others are
    mates : holes that must have one axis; see `check_mates`
    """
    try:
        content = read_step(path, validate=False, holes=bool(mates))
    except InputError as error:
        return [Check("assembly readable", False, str(error))]
    found = {name: (product, placement) for product, name, placement in content.instances}
    marks = set(found) == set(expected) and len(content.instances) == len(expected)
    wrong = sorted(
        mark
        for mark in found.keys() & expected.keys()
        if found[mark][0] != product_name(expected[mark][0])
    )
    turn = shift = 0.0
    for mark in found.keys() & expected.keys():
        away = np.abs(found[mark][1] - expected[mark][2])
        turn, shift = max(turn, float(away[:3, :3].max())), max(shift, float(away[:3, 3].max()))
    sound = [p.report.closed and p.report.solids == 1 for p in content.products]
    volumes = {product.name: product.report.volume for product in content.products}
    deviation = max(
        (
            abs(volumes[found[mark][0]] - expected[mark][1]) / max(expected[mark][1], 1e-300)
            for mark in found.keys() & expected.keys()
        ),
        default=0.0,
    )
    apart = {mark for mark, names in content.layers.items() if REJECTED_KIND.layer in names}
    wanted = set(rejected) & expected.keys()
    return [
        Check("assembly rejected", apart == wanted, float(len(apart)), float(len(wanted))),
        Check("assembly marks", marks, float(len(content.instances)), float(len(expected))),
        Check("assembly part numbers", not wrong, ", ".join(wrong[:3]) or None),
        Check("assembly solids closed", all(sound), float(sum(sound)), float(len(volumes))),
        Check("assembly rotations", turn <= PLACEMENT_ROTATION, turn, PLACEMENT_ROTATION),
        Check("assembly positions_mm", shift <= PLACEMENT_MM, shift, PLACEMENT_MM),
        Check(
            "assembly volume", deviation <= FILE_VOLUME_RELATIVE, deviation, FILE_VOLUME_RELATIVE
        ),
        Check("assembly unit", content.unit == STEP_UNIT, content.unit, STEP_UNIT),
        *check_mates(content, mates),
    ]
