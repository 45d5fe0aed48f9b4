"""The data section of an IFC file: entities get numbers, equal ones are written once."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from ddgfab.mesh import Floats
from fabrication.formats.step.text import real


class Lines:
    """Entities in the order in which they were added."""

    def __init__(self) -> None:
        self._lines: list[str] = []
        self._shared: dict[str, str] = {}
        self._last = 0

    def add(self, entity: str) -> str:
        """A new entity; returns its reference."""
        self._last += 1
        reference = f"#{self._last}"
        self._lines.append(f"{reference}={entity};\n")
        return reference

    def block(self, count: int) -> tuple[str, int]:
        """Reserve references; each is the prefix and a number of the width, counted from 0."""
        width = len(str(max(count - 1, 99)))
        first = self._last // 10**width + 1
        self._last = (first * 10**width) + count - 1
        return f"#{first}", width

    def raw(self, text: str) -> None:
        """Lines of entities whose references were reserved."""
        self._lines.append(text)

    def share(self, entity: str) -> str:
        """The reference of an entity without identity: a point, a direction, a value."""
        found = self._shared.get(entity)
        if found is None:
            found = self._shared[entity] = self.add(entity)
        return found

    def point(self, *at: float) -> str:
        """A point."""
        return self.share(f"IFCCARTESIANPOINT(({','.join(map(real, at))}))")

    def direction(self, *way: float) -> str:
        """A direction."""
        return self.share(f"IFCDIRECTION(({','.join(map(real, way))}))")

    def axes(self, frame: Floats) -> str:
        """The placement (4, 4) as IfcAxis2Placement3D."""
        (xx, _, zx, px), (xy, _, zy, py), (xz, _, zz, pz) = np.asarray(frame)[:3].tolist()
        if (zx, zy, zz) == (0.0, 0.0, 1.0) and (xx, xy, xz) == (1.0, 0.0, 0.0):
            return self.share(f"IFCAXIS2PLACEMENT3D({self.point(px, py, pz)},$,$)")
        z, x = self.direction(zx, zy, zz), self.direction(xx, xy, xz)
        return self.share(f"IFCAXIS2PLACEMENT3D({self.point(px, py, pz)},{z},{x})")

    def text(self) -> str:
        """All of it."""
        return "".join(self._lines)


def listed(references: Iterable[str]) -> str:
    """References as a list."""
    return f"({','.join(references)})"


def rows(values: Sequence[Sequence[float]]) -> str:
    """Rows of numbers as a list of lists."""
    return listed(f"({','.join(map(real, row))})" for row in values)
