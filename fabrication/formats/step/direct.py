"""STEP files as text: straight from exact boundaries, without CAD kernel, some 0.15 ms a part.

Parts without an exact boundary stand beside the others, with OCCT's text of their geometry.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import lru_cache
from typing import Final

import numpy as np

from ddgfab.errors import DdgError, KernelError
from fabrication.formats.base import REJECTED_KIND, Header, Material
from fabrication.formats.step.attributes import IDS, MARK, Attribute, attribute_text
from fabrication.formats.step.entities import (
    COMMON,
    COMMON_CONTEXT,
    DEFINED,
    DEFINITION,
    DENSITY_UNIT,
    FILE_CONTEXT,
    FIRST_FREE,
    INSTANCE,
    MATERIAL,
    ORIGIN,
    PRODUCT,
    REPRESENTED,
    SCHEMAS,
    SHELL,
    SOLID,
)
from fabrication.formats.step.geometry import LOCAL, BoundaryShell
from fabrication.formats.step.kernel import KernelShell
from fabrication.formats.step.records import Schema, StepProduct, product_name, time_stamp
from fabrication.formats.step.text import (
    STYLE_IDS,
    header_list,
    header_text,
    quoted,
    real,
    style,
)
from fabrication.specs import Kind, Placement
from fabrication.version import originating_system

_LEAST_WIDTH: Final = 3
"""Least digits of local ids."""

_LIST_PER_LINE: Final = 12
"""References on a line of a long list."""


def part_bytes(
    product: StepProduct, file_name: str, *, header: Header | None = None, schema: Schema = "AP214"
) -> bytes:
    """One part number as a STEP file.

    Raises
    ------
    KernelError
        The product has no geometry, or OCCT refused its solid.
    DegenerateError
        Its boundary has an edge without length, or a number that is not finite.
    """
    return _Text([product]).file(header or Header(), file_name, schema)


def assembly_bytes(
    products: Sequence[StepProduct],
    instances: Iterable[tuple[str, str, Placement]],
    *,
    name: str,
    file_name: str,
    rejected: Collection[str] = (),
    header: Header | None = None,
    schema: Schema = "AP214",
) -> bytes:
    """The whole as a STEP file of true instances: one shape a part number, many placements.

    The instances hang in one sub-assembly a kind (Beams, Nodes, Panels), in the order in which the
    products name them, under the root `name`.

    Parameters
    ----------
    instances : (part number, piece mark, (4, 4) placement [mm]) of every piece
    rejected : marks of pieces that stand in the group Rejected, on the layer REJECTED; a part
        number that has others too is in the file twice

    Raises
    ------
    KernelError
        An instance of an unknown part number, a product without geometry, or OCCT refused.
    DegenerateError
        A boundary has an edge without length, or a number that is not finite.
    """
    instances = list(instances)
    good = {number for number, mark, _ in instances if mark not in rejected}
    bad = {number for number, mark, _ in instances if mark in rejected}
    products = [
        *(p for p in products if p.number in good or p.number not in bad),
        *(replace(p, kind=REJECTED_KIND) for p in products if p.number in bad),
    ]
    text = _Text(products)
    kinds = list(dict.fromkeys(product.kind for product in products))
    root = text.unit(name)
    groups = {kind: text.unit(kind.title) for kind in kinds}
    for kind, group in groups.items():
        root.add(kind.title, group.definition, group.representation, np.eye(4))
    targets = {
        (product.number, product.kind == REJECTED_KIND): (
            groups[product.kind],
            *text.references[index],
        )
        for index, product in enumerate(products)
    }
    for number, mark, placement in instances:
        target = targets.get((number, mark in rejected))
        if target is None:
            raise KernelError(f"piece {mark} is an instance of {number}, which has no solid")
        unit, definition, representation = target
        unit.add(mark, definition, representation, placement)
    for unit in (root, *groups.values()):
        unit.close()
    return text.file(header or Header(), file_name, schema)


class _Text:
    """The data section of a file: what is shared, the products, and then what else is added.

    Ids: what is shared counts from 1; the local ids of product k follow the digits of k + some.
    """

    def __init__(self, products: Sequence[StepProduct]) -> None:
        self._parts: list[bytes] = []
        self.occurrences = 0
        self._following = FIRST_FREE
        materials = self._materials(products)
        styles = self._styles(products)
        shells = [_shell_of(product) for product in products]
        most = SHELL + max((shell.ids for shell in shells), default=0)
        width = max(_LEAST_WIDTH, len(str(most - 1)))
        first = 1 + self._following // 10**width
        self.references: list[tuple[str, str]] = []  # definition, representation
        solids: dict[Kind, list[str]] = {}
        for index, (product, shell) in enumerate(zip(products, shells, strict=True)):
            prefix = f"#{first + index}"
            self.write(
                _product(
                    product,
                    shell,
                    prefix,
                    width,
                    styles[product.kind],
                )
            )
            local = [f"{prefix}{i:0{width}d}" for i in (DEFINED, REPRESENTED, SOLID)]
            self.references.append((local[0], local[1]))
            solids.setdefault(product.kind, []).append(local[2])
        self._following = (first + len(products)) * 10**width
        for index, product in enumerate(products):
            for attribute in product.attributes:
                self.attribute(self.references[index][0], attribute)
            # After the attributes: OCCT takes every representation of a product for its material,
            # so that a mass or a length would be its density. The last one stays.
            if product.material is not None:
                text = _numbered(MATERIAL, width).replace(LOCAL, f"#{first + index}")
                self.write(text % materials[product.material])
        for kind, members in solids.items():
            self.write(
                f"#{self.take(1)}=PRESENTATION_LAYER_ASSIGNMENT("
                f"{quoted(kind.layer)},'visible',({_listed(members)}));\n"
            )

    def take(self, count: int) -> int:
        """The first of some new ids."""
        self._following += count
        return self._following - count

    def write(self, entities: str) -> None:
        """Some more entities."""
        self._parts.append(entities.encode("ascii"))

    def attribute(self, of: str, attribute: Attribute) -> None:
        """An attribute of a product definition, or of an instance."""
        self.write(attribute_text(self.take(IDS), of, attribute))

    def unit(self, name: str) -> _Unit:
        """A new assembly."""
        return _Unit(self, name)

    def file(self, header: Header, file_name: str, schema: Schema) -> bytes:
        """The whole file."""
        identity, application, protocol, year = SCHEMAS[schema]
        system = header_text(originating_system())
        start = (
            "ISO-10303-21;\nHEADER;\n"
            f"FILE_DESCRIPTION({header_list(header.description or file_name)},'2;1');\n"
            f"FILE_NAME({header_text(file_name)},{header_text(time_stamp())},"
            f"{header_list(header.author)},{header_list(header.organization)},"
            f"{system},{system},'Unknown');\n"
            f"FILE_SCHEMA(('{identity}'));\nENDSEC;\nDATA;\n"
        )
        common = COMMON % (protocol, year, application) + COMMON_CONTEXT
        whole = [(start + common).encode("ascii"), *self._parts, b"ENDSEC;\nEND-ISO-10303-21;\n"]
        return b"".join(whole)

    def _materials(self, products: Sequence[StepProduct]) -> dict[Material, tuple[str, str]]:
        """Ids of the representations of each material's name and density, by material."""
        found: dict[Material, tuple[str, str]] = {}
        for product in products:
            material = product.material
            if material is None or material in found:
                continue
            i = self.take(4)
            # Grams per cubic centimetre, as OCCT and its readers have it.
            density = f"POSITIVE_RATIO_MEASURE({real(material.density / 1000.0)})"
            self.write(
                f"#{i}=REPRESENTATION('material name',(#{i + 1}),{FILE_CONTEXT});\n"
                f"#{i + 1}=DESCRIPTIVE_REPRESENTATION_ITEM({quoted(material.name)},'');\n"
                f"#{i + 2}=REPRESENTATION('density',(#{i + 3}),{FILE_CONTEXT});\n"
                f"#{i + 3}=MEASURE_REPRESENTATION_ITEM('density',{density},{DENSITY_UNIT});\n"
            )
            found[material] = (f"#{i}", f"#{i + 2}")
        return found

    def _styles(self, products: Sequence[StepProduct]) -> dict[Kind, str]:
        """Ids of the presentation styles, by kind."""
        found: dict[Kind, str] = {}
        for kind in dict.fromkeys(product.kind for product in products):
            first = self.take(STYLE_IDS)
            self.write("\n".join(style(first, kind.color)) + "\n")
            found[kind] = f"#{first}"
        return found


class _Unit:
    """An assembly to which instances are added: a product without a shape of its own."""

    def __init__(self, text: _Text, name: str) -> None:
        self._text = text
        first = text.take(8)
        ids = [f"#{first + i}" for i in range(8)]
        self.definition, self.representation, self._context = (
            ids[DEFINED],
            ids[REPRESENTED],
            ids[7],
        )
        text.write(DEFINITION.format(*ids) % (quoted(name), quoted(name)))
        self._placements: list[str] = [ORIGIN]

    def add(self, name: str, definition: str, representation: str, placement: Placement) -> None:
        """One instance, named."""
        text = self._text
        text.occurrences += 1
        i = text.take(9)
        (xx, _, zx, px), (xy, _, zy, py), (xz, _, zz, pz) = np.asarray(placement)[:3].tolist()
        text.write(
            INSTANCE
            % (
                *(i, i + 1, i + 3),
                *(i + 1, representation, self.representation, i + 2),
                *(i + 2, i + 5),
                *(i + 3, i + 4),
                *(i + 4, text.occurrences, quoted(name), self.definition, definition),
                *(i + 5, i + 6, i + 7, i + 8),
                *(i + 6, px, py, pz),
                *(i + 7, zx, zy, zz),
                *(i + 8, xx, xy, xz),
            )
        )
        text.attribute(f"#{i + 4}", (MARK, name, "text"))
        self._placements.append(f"#{i + 5}")

    def close(self) -> None:
        """Write the representation that holds the placements."""
        self._text.write(
            f"{self.representation}=SHAPE_REPRESENTATION('',({_listed(self._placements)}),"
            f"{self._context});\n"
        )


def _shell_of(product: StepProduct) -> BoundaryShell | KernelShell:
    if product.boundary is not None:
        return BoundaryShell(product.boundary)
    if product.solid is None:
        raise KernelError(f"{product.number} has neither an exact boundary nor a solid to write")
    with _named(product):
        return KernelShell(product.solid)


@contextmanager
def _named(product: StepProduct) -> Iterator[None]:
    """Errors begin with the part number."""
    try:
        yield
    except DdgError as error:
        raise type(error)(f"{product.number}: {error}") from error


def _product(
    product: StepProduct,
    shell: BoundaryShell | KernelShell,
    prefix: str,
    width: int,
    style_id: str,
) -> str:
    """All entities of one product; its ids are the prefix and local ids of some width."""
    values = product.properties
    measures = (real(values.area), real(values.volume), *map(real, values.centroid))
    text = _numbered(PRODUCT, width).replace(LOCAL, prefix) % (
        quoted(product.number),
        quoted(product_name(product.number)),
        *measures,
        style_id,
    )
    with _named(product):
        return text + shell.text(prefix, SHELL, width)


@lru_cache(maxsize=16)
def _numbered(template: str, width: int) -> str:
    """A template with local ids in its braces."""
    return template.format(*(f"{LOCAL}{i:0{width}d}" for i in range(SHELL + 1)))


def _listed(references: Sequence[str]) -> str:
    """References separated by commas, in lines of readable length."""
    step = _LIST_PER_LINE
    rows = [",".join(references[i : i + step]) for i in range(0, len(references), step)]
    return ",\n".join(rows)
