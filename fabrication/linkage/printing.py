"""How the parts of a kit are printed: which, how they lie, and on which plates."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from ddgfab.mesh import Floats
from fabrication.linkage.plates import Bed, Plate, Printed, plates
from fabrication.linkage.schedules import is_printed
from fabrication.linkage.settings import LinkageSettings
from fabrication.parts.ring import CAP
from fabrication.specs import Family, TriangleMesh

PRINTED_CHORD_MM: Final = 0.01
"""Greatest distance [mm] of the meshes that are printed from the exact surfaces: a twentieth of the
clearance between pin and bore, so that round parts turn in round bores."""

UPSIDE_DOWN: Final[Floats] = np.diag([1.0, -1.0, -1.0, 1.0])
"""A half turn about x."""


def printed_parts(
    families: Sequence[Family], meshes: Mapping[str, TriangleMesh], settings: LinkageSettings
) -> list[Printed]:
    """What a printer makes, lying as it is printed.

    The axis of a hinge is vertical, caps lie on their floors, printed pins stand on their heads.
    """
    return [
        Printed(f.number, meshes[f.number], lying(f), tuple(i.mark for i in f.instances))
        for f in families
        if is_printed(f.kind, settings)
    ]


def lying(family: Family) -> Floats:
    """(4, 4) motion from the part's frame to the printer's, z up.

    A link's label looks up, and the axis at its start is vertical.
    """
    return UPSIDE_DOWN if family.kind == CAP else np.eye(4)


def laid_out(
    families: Sequence[Family],
    meshes: Mapping[str, TriangleMesh],
    settings: LinkageSettings,
    bed: Bed,
    apart: Collection[str] = (),
) -> tuple[list[Printed], tuple[Plate, ...]]:
    """What is printed, and on which plates; the links first.

    apart : marks of pieces that are printed before the others, on plates of their own that come
        last: the coupon, which tells the clearance that the printer needs, and its pin

    Raises
    ------
    InputError
        A part is larger than the bed; names it.
    """
    parts = printed_parts(families, meshes, settings)
    piles = [
        [
            replace(part, marks=tuple(m for m in part.marks if (m in apart) == tried))
            for part in parts
        ]
        for tried in (False, True)
    ]
    return parts, tuple(plate for pile in piles for plate in plates(pile, bed))
