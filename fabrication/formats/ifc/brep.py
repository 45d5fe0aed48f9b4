"""Exact boundaries as IfcAdvancedBrep.

IFC has the entities of STEP for planes, cylinders, lines, circles and ellipses, without underscores
in their names and without the label that each begins with: the text is that of STEP, renamed.
"""

from __future__ import annotations

import re
from functools import lru_cache
from typing import Final

from fabrication.boundary import Boundary
from fabrication.formats.ifc.lines import Lines
from fabrication.formats.step.geometry import count_ids, filled, shell

_ENTITY: Final = re.compile(r"=([A-Z0-9_]+)\('',")


def advanced_brep(lines: Lines, boundary: Boundary) -> str:
    """The reference of the solid.

    Raises
    ------
    DegenerateError
        As `fabrication.formats.step.geometry.shell`.
    """
    prefix, width = lines.block(count_ids(boundary))
    template, numbers = shell(boundary, 0, width)
    lines.raw(filled(_renamed(template.text), numbers, prefix))
    return lines.add(f"IFCADVANCEDBREP({prefix}{0:0{width}d})")


@lru_cache(maxsize=256)
def _renamed(text: str) -> str:
    """Entities of STEP as those of IFC."""
    return _ENTITY.sub(lambda found: f"=IFC{found[1].replace('_', '')}(", text)
