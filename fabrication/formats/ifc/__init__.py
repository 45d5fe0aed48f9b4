"""IFC: model.ifc for planners, an assembly of elements with marks, part numbers and quantities."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np

from ddgfab.errors import InputError, clipped
from fabrication.formats.base import Contents, Format, Whole
from fabrication.formats.ifc.model import model_bytes
from fabrication.formats.ifc.read import Element, Model
from fabrication.formats.report import FileReport
from fabrication.formats.step.text import encoded
from fabrication.specs import Check

MODEL: Final = "model.ifc"
"""Name of the file of the whole."""

PLACED: Final = 1e-6
"""How far [mm] an element may stand from where its piece does, at 1 m from the origin."""


@dataclass(frozen=True)
class IfcReport(FileReport):
    """What is in an IFC file: how many elements of each class."""

    elements: tuple[tuple[str, int], ...] = ()


class Ifc(Format):
    """IFC4: the whole, with a type for each part number."""

    name = "ifc"
    suffixes = (".ifc",)

    def whole_files(self, contents: Contents) -> list[str]:
        """model.ifc."""
        return [MODEL]

    def write_whole(self, folder: Path, whole: Whole) -> list[str]:
        """model.ifc; see `model_bytes`."""
        (folder / MODEL).write_bytes(model_bytes(whole, MODEL))
        return []

    def check_whole(self, folder: Path, whole: Whole) -> list[Check]:
        """Read back: every piece once, of its class and part number, where it was placed."""
        try:
            model = Model(folder / MODEL)
            found = {element.name: element for element in model.elements()}
            count = sum(1 for _ in model.elements())
        except InputError as error:
            return [Check("ifc readable", False, str(error))]
        wanted = list(whole.standing())
        wrong, away, limit = 0, 0.0, PLACED
        for number, mark, placement in wanted:
            element = found.get(encoded(mark))
            ifc = whole.parts[number].kind.ifc
            if element is None or (element.ifc, element.tag) != (ifc, encoded(number)):
                wrong += 1
                continue
            away = max(away, float(np.abs(element.placement - placement).max()))
            limit = max(limit, PLACED * float(np.abs(placement[:3, 3]).max()) / 1000.0)
        dangling = len(model.dangling())
        return [
            Check("ifc readable", True),
            Check("ifc references", dangling == 0, float(dangling), 0.0),
            Check("ifc pieces", count == len(wanted), float(count), float(len(wanted))),
            Check("ifc numbers", wrong == 0, float(wrong), 0.0),
            Check("ifc positions_mm", away <= limit, away, limit),
        ]

    def inspect(self, path: Path) -> IfcReport:
        """Its elements, their ids and names, and references that lead nowhere."""
        model = Model(path)
        elements = list(model.elements())
        by_class = Counter(element.ifc for element in elements)
        contents = ", ".join(f"{count} {name}" for name, count in sorted(by_class.items()))
        return IfcReport(
            str(path),
            model.schema,
            contents or "no elements",
            tuple(_problems(model, elements)),
            elements=tuple(sorted(by_class.items())),
        )


def _problems(model: Model, elements: Sequence[Element]) -> list[str]:
    """What is wrong with a file, for people."""
    problems = []
    dangling = model.dangling()
    if dangling:
        problems.append(f"{clipped(dangling[0])} is referred to, but not in the file")
    for what in ("guid", "name"):
        values = Counter(getattr(element, what) for element in elements)
        for value, count in values.items():
            if count > 1 and value:
                problems.append(f"{what} {clipped(value)} belongs to {count} elements")
                break
    return problems


FORMAT: Final = Ifc()
