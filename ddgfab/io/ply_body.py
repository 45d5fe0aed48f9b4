"""The body of a PLY file: elements of scalar and list properties, as text or binary."""

from __future__ import annotations

from array import array
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ddgfab.errors import MeshError
from ddgfab.io.raw import Digits, Rows, binary_step
from ddgfab.io.tokens import decode, integer, number, numbered
from ddgfab.mesh import Floats, Ints


@dataclass(frozen=True)
class Property:
    """A property: numpy type code of its values, and of its count where it is a list."""

    name: str
    code: str
    count: str | None


@dataclass(frozen=True)
class Element:
    """A kind of record and how many of them follow."""

    name: str
    count: int
    properties: list[Property]


class TextBody:
    """Elements a line each, as writers of text files do."""

    def __init__(self, data: bytes, file: str, header_lines: int) -> None:
        self._file = file
        self._rows = numbered(decode(data, file, header_lines))
        self._above = header_lines
        self._last: int | None = None
        self._step = self.lost = 0.0

    def _take(self, element: Element) -> Iterator[tuple[int, list[str]]]:
        for found in range(element.count):
            row = next(self._rows, None)
            if row is None:
                raise MeshError(
                    f"truncated: {element.count} of '{element.name}' are stated, {found} are there",
                    file=self._file,
                    line=self._last,
                )
            self._last = self._above + row[0]
            yield self._last, row[1].split()

    def _split(self, element: Element, line: int, parts: list[str]) -> dict[str, list[str]]:
        """Tokens of each property of one record."""
        values, at = {}, 0
        for item in element.properties:
            size = 1
            if item.count is not None:
                size = integer(parts[at], self._file, line, "count") if at < len(parts) else 1
                at += 1
            if size < 0 or at + size > len(parts):
                raise MeshError(
                    f"values of property '{item.name}' are missing", file=self._file, line=line
                )
            values[item.name] = parts[at : at + size]
            at += size
        return values

    def scalars(self, element: Element, names: tuple[str, ...]) -> tuple[list[Floats], Ints | None]:
        """Columns of scalar properties, and the line of each record."""
        table, lines, digits = array("d"), array("q"), Digits()
        for line, parts in self._take(element):
            values = self._split(element, line, parts)
            table.extend([number(values[name][0], self._file, line) for name in names])
            digits.look([values[name][0] for name in names[:3]])
            lines.append(line)
        self._step, self.lost = digits.step, digits.lost
        columns = np.array(table, dtype=np.float64).reshape(-1, len(names))
        return [columns[:, i] for i in range(len(names))], np.array(lines, dtype=np.int64)

    def step(self, code: str, points: Floats) -> float:
        """To what the coordinates are rounded: the last digit of the text."""
        return self._step

    def lists(self, element: Element, name: str) -> tuple[Ints, Ints, Ints | None]:
        """All values of a list property, the length of each list, the line of each record."""
        rows = Rows(self._file)
        for line, parts in self._take(element):
            tokens = self._split(element, line, parts)[name]
            rows.face([integer(token, self._file, line) for token in tokens], line)
        flat, sizes, lines = rows.corners, rows.sizes, rows.face_lines
        whole = np.int64
        return np.array(flat, whole), np.array(sizes, whole), np.array(lines, whole)

    def skip(self, element: Element) -> None:
        """Pass over an element."""
        for _ in self._take(element):
            pass

    def rest(self) -> bool:
        """Whether something follows."""
        return next(self._rows, None) is not None


class BinaryBody:
    """Elements packed without padding."""

    lost = 0.0  # no more than the step says

    def __init__(self, data: bytes, file: str, order: str) -> None:
        self._data = data
        self._file = file
        self._order = order
        self._at = 0

    def _table(self, element: Element) -> dict[str, NDArray[np.generic]] | None:
        """The element as columns when all its lists have the lengths of the first record.

        Then the records have one size, and numpy reads them at once; else None, nothing read.
        """
        if not element.count:
            return {item.name: np.empty((0, 0)) for item in element.properties}
        fields: list[tuple[str, str, tuple[int, ...]]] = []
        at = self._at
        for item in element.properties:
            if item.count is None:
                fields.append((item.name, self._order + item.code, ()))
            else:
                size = self._length(at, item, element)
                at += int(item.count[1])
                fields.append((f"count of {item.name}", self._order + item.count, ()))
                fields.append((item.name, self._order + item.code, (size,)))
                at += (size - 1) * int(item.code[1])
            at += int(item.code[1])
        record = np.dtype(fields)
        if self._at + record.itemsize * element.count > len(self._data):
            return None
        table = np.frombuffer(self._data, record, element.count, self._at)
        for item in element.properties:
            if item.count is not None and np.ptp(table[f"count of {item.name}"].astype(np.int64)):
                return None
        self._at += record.itemsize * element.count
        return {item.name: table[item.name] for item in element.properties}

    def _length(self, at: int, item: Property, element: Element) -> int:
        """Length of the list that begins at a byte; it must fit into what is left of the file."""
        code = item.count or "u1"
        start = at + int(code[1])
        if start > len(self._data):
            raise self._truncated(element)
        size = int(np.frombuffer(self._data, self._order + code, 1, at)[0])
        if size < 0:
            raise MeshError(f"a list of '{element.name}' has length {size}", file=self._file)
        if start + size * int(item.code[1]) > len(self._data):
            raise self._truncated(element)
        return size

    def _truncated(self, element: Element) -> MeshError:
        return MeshError(f"truncated: it ends within the element '{element.name}'", file=self._file)

    def _walk(self, element: Element, name: str | None) -> tuple[list[Ints], list[int]]:
        """Read record after record; keeps the lists of one property."""
        kept: list[Ints] = []
        at = self._at
        for _ in range(element.count):
            for item in element.properties:
                size = 1
                if item.count is not None:
                    size = self._length(at, item, element)
                    at += int(item.count[1])
                end = at + size * int(item.code[1])
                if end > len(self._data):
                    raise self._truncated(element)
                if item.name == name:
                    values = np.frombuffer(self._data, self._order + item.code, size, at)
                    kept.append(values.astype(np.int64))
                at = end
        self._at = at
        return kept, [len(values) for values in kept]

    def scalars(self, element: Element, names: tuple[str, ...]) -> tuple[list[Floats], Ints | None]:
        """Columns of scalar properties; binary files have no lines."""
        if any(item.count is not None for item in element.properties):
            raise MeshError(
                f"lists within '{element.name}' are not read; save it without", file=self._file
            )
        table = self._table(element)
        if table is None:
            raise self._truncated(element)
        return [table[name].astype(np.float64).reshape(-1) for name in names], None

    def step(self, code: str, points: Floats) -> float:
        """To what coordinates of a numpy type are rounded."""
        return binary_step(points, code)

    def lists(self, element: Element, name: str) -> tuple[Ints, Ints, Ints | None]:
        """All values of a list property, and the length of each list."""
        table = self._table(element)
        if table is not None:
            rows = table[name].astype(np.int64)
            return rows.ravel(), np.full(len(rows), rows.shape[1], dtype=np.int64), None
        kept, sizes = self._walk(element, name)
        return np.concatenate(kept), np.array(sizes, dtype=np.int64), None

    def skip(self, element: Element) -> None:
        """Pass over an element."""
        if self._table(element) is None:
            self._walk(element, None)

    def rest(self) -> bool:
        """Whether something follows."""
        return self._at < len(self._data)
