"""IFC files read back: entities by number, and the elements with what they are and where."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np

from ddgfab.errors import InputError, clipped
from ddgfab.io.regular import read_regular
from ddgfab.mesh import Floats
from ddgfab.tolerances import COORDINATE_LIMIT
from fabrication.specs import Placement

LIMIT_BYTES: Final = 512 * 1024 * 1024
"""Larger files are refused."""

_ENTITY: Final = re.compile(r"(#\d+)\s*=\s*([A-Z0-9_]+)\s*\((.*)\)\s*$", re.DOTALL)
_STRING: Final = re.compile(r"'(?:[^']|'')*'")
_REFERENCE: Final = re.compile(r"#\d+")
_SCHEMA: Final = re.compile(r"FILE_SCHEMA\s*\(\s*\(\s*'([^']*)'", re.IGNORECASE)
_LIST: Final = re.compile(r"\(([^()]*)\)")
DEEPEST: Final = 64
"""Placements within placements beyond this are taken for a circle."""


@dataclass(frozen=True)
class Element:
    """An element: its global id, class, name, tag and placement [units of the file]."""

    guid: str
    ifc: str
    name: str
    tag: str
    placement: Placement


class Model:
    """The entities of an IFC file."""

    def __init__(self, path: Path) -> None:
        data = read_regular(path, LIMIT_BYTES, InputError, what="an IFC file", advice="split it")
        text = data.decode("ascii", "replace")
        self._file = str(path)
        schema = _SCHEMA.search(text)
        if not text.startswith("ISO-10303-21;") or schema is None:
            raise self._error("no IFC file: it does not begin as ISO 10303-21 asks")
        self.schema = schema[1].upper()
        if not self.schema.startswith("IFC"):
            raise self._error(f"its schema is {clipped(self.schema)}, which is not one of IFC")
        if "END-ISO-10303-21;" not in text[-200:]:
            raise self._error("truncated: its last line is missing")
        self.entities: dict[str, tuple[str, str]] = {}
        for statement in _statements(text):
            found = _ENTITY.match(statement)
            if found:
                self.entities[found[1]] = (found[2].upper(), found[3])
        self._placements: dict[str, Placement] = {}

    def _error(self, text: str) -> InputError:
        return InputError(text, file=self._file)

    def dangling(self) -> list[str]:
        """References, "#12", that belong to no entity."""
        known = self.entities.keys()
        used = {
            reference
            for _, arguments in self.entities.values()
            for reference in _REFERENCE.findall(_STRING.sub("''", arguments))
        }
        return sorted(used - known)

    def elements(self) -> Iterator[Element]:
        """All that has a class of `CLASSES`."""
        for entity, text in self.entities.values():
            if entity in CLASSES:
                values = arguments(text)
                if len(values) < 8:
                    raise self._error(
                        f"an {entity} with {len(values)} attributes; needs 8 and more"
                    )
                placement = self._placement(values[5], 0)
                yield Element(
                    _text(values[0]), CLASSES[entity], _text(values[2]), _text(values[7]), placement
                )

    def _placement(self, reference: str, depth: int) -> Placement:
        """(4, 4) of an IfcLocalPlacement, from its own axes to those of the project."""
        if reference == "$":
            return np.eye(4)
        if reference not in self._placements:
            if depth > DEEPEST:
                raise self._error(f"placement {clipped(reference)} stands within itself")
            above, axes = self._arguments(reference, "IFCLOCALPLACEMENT", 2)
            found = self._placement(above, depth + 1) @ self._axes(axes)
            self._placements[reference] = found
        return self._placements[reference]

    def _axes(self, reference: str) -> Placement:
        location, z, x = self._arguments(reference, "IFCAXIS2PLACEMENT3D", 3)
        frame = np.eye(4)
        frame[:3, 3] = self._numbers(location, "IFCCARTESIANPOINT")
        up = self._unit(np.array([0.0, 0, 1] if z == "$" else self._numbers(z, "IFCDIRECTION")), z)
        ahead = np.array([1.0, 0, 0] if x == "$" else self._numbers(x, "IFCDIRECTION"))
        ahead = self._unit(ahead - (ahead @ up) * up, x)
        frame[:3, 0], frame[:3, 1], frame[:3, 2] = ahead, np.cross(up, ahead), up
        return frame

    def _unit(self, way: Floats, reference: str) -> Floats:
        length = float(np.linalg.norm(way))
        if not 0.0 < length < math.inf:
            raise self._error(f"direction {clipped(reference)} has no length, or is along z")
        return way / length

    def _numbers(self, reference: str, entity: str) -> list[float]:
        (text,) = self._arguments(reference, entity, 1)
        try:
            values = [float(value) for value in text.strip("()").split(",")]
        except ValueError:
            values = []
        if len(values) != 3 or not (np.abs(values) <= COORDINATE_LIMIT).all():
            limit = f"three finite numbers, at most {COORDINATE_LIMIT:g}"
            raise self._error(f"{entity} {reference} needs {limit}")
        return values

    def _arguments(self, reference: str, entity: str, count: int) -> list[str]:
        known, text = self.entities.get(reference, ("", ""))
        values = arguments(text)
        if known != entity or len(values) != count:
            raise self._error(f"{clipped(reference)} must be an {entity} with {count} attributes")
        return values


CLASSES: Final = {
    name.upper(): name
    for name in ("IfcMember", "IfcPlate", "IfcDiscreteAccessory", "IfcMechanicalFastener")
}
"""Classes of the elements that are read, by the names they have in files."""


def arguments(text: str) -> list[str]:
    """The arguments of an entity, split at the commas that stand in no string and no list."""
    out, depth, start, quoted = [], 0, 0, False
    for i, letter in enumerate(text):
        if letter == "'":
            quoted = not quoted
        elif quoted:
            continue
        elif letter == "(":
            depth += 1
        elif letter == ")":
            depth -= 1
        elif letter == "," and depth == 0:
            out.append(text[start:i].strip())
            start = i + 1
    return [*out, text[start:].strip()]


def _statements(text: str) -> Iterator[str]:
    """What stands between semicolons that are in no string."""
    pending = ""
    for part in text.split(";"):
        pending += part
        if pending.count("'") % 2 == 0:
            yield pending.strip()
            pending = ""
        else:
            pending += ";"


def _text(value: str) -> str:
    return value[1:-1].replace("''", "'") if value.startswith("'") else ""
