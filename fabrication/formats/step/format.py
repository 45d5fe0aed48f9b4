"""STEP as a format: a file a part number, and assembly.step of all pieces."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Final, cast, get_args

from ddgfab.errors import InputError
from fabrication.checks.solid import check_solid
from fabrication.formats.base import Contents, Format, Header, Part, Provenance, Whole
from fabrication.formats.solids import SolidsReport
from fabrication.formats.step.apart import apart
from fabrication.formats.step.attributes import MARK, Attribute, marks_text
from fabrication.formats.step.compressed import SUFFIX, compressed, is_compressed, unpacked
from fabrication.formats.step.direct import assembly_bytes, part_bytes
from fabrication.formats.step.inspect import step_report
from fabrication.formats.step.read import check_step_part
from fabrication.formats.step.records import Schema, StepProduct
from fabrication.formats.step.whole import check_step_assembly
from fabrication.specs import Check

ASSEMBLY: Final = "assembly.step"
"""Name of the file of the whole."""

COMPRESSED: Final = f"assembly{SUFFIX}"
"""The same, compressed."""


class StepFormat(Format):
    """STEP: exact solids; written as text, read back by the CAD kernel."""

    name = "step"
    suffixes = (".step", ".stp", SUFFIX.lower())
    parts = True
    by_default = "always"
    needs_to_check = {"OCP": "cadquery-ocp"}  # noqa: RUF012
    libraries = ("cadquery-ocp", "build123d", "cadquery")
    options = {"schema": get_args(Schema), "assembly": ("step", "stpZ")}  # noqa: RUF012

    def write_part(self, path: Path, part: Part, about: Provenance) -> None:
        """One product; see `part_bytes`."""
        schema = self._schema(about)
        marks = marks_text([instance.mark for instance in part.family.instances])
        product = _product(part, (MARK, marks, "text"))
        data = part_bytes(product, path.name, header=about.header, schema=schema)
        path.write_bytes(data)

    def check_part(self, path: Path, part: Part) -> list[Check]:
        """The kernel's solid against the closed form, and the file read back."""
        try:
            return apart(_check_part, path, part, foreign=False)
        except InputError as error:
            return [Check("file readable", False, str(error))]

    def whole_files(self, contents: Contents) -> list[str]:
        """assembly.step, or assembly.stpZ."""
        return [self._assembly(contents.about)]

    def write_whole(self, folder: Path, whole: Whole) -> list[str]:
        """All pieces as instances; those that failed are a group and a layer of their own."""
        path, instances = folder / self._assembly(whole.about), list(whole.standing())
        used = {number for number, _, _ in instances}
        products = [_product(part) for number, part in whole.parts.items() if number in used]
        data = assembly_bytes(
            products,
            instances,
            rejected=whole.failed,
            name=whole.about.project,
            file_name=ASSEMBLY,
            header=_header(whole.about),
            schema=self._schema(whole.about),
        )
        path.write_bytes(compressed(data) if is_compressed(path) else data)
        return []

    def check_whole(self, folder: Path, whole: Whole) -> list[Check]:
        """Read back and compared piece by piece; see `check_step_assembly`."""
        expected = {
            mark: (number, whole.parts[number].properties.volume, at)
            for number, mark, at in whole.standing()
        }
        mates = tuple(whole.mates)
        try:
            with unpacked(folder / self._assembly(whole.about)) as path:
                return apart(
                    check_step_assembly, path, expected, whole.failed, mates, foreign=False
                )
        except InputError as error:
            return [Check("assembly readable", False, str(error))]

    def _assembly(self, about: Provenance) -> str:
        """Name of the file of all pieces."""
        return ASSEMBLY if self.option(about, "assembly") == "step" else COMPRESSED

    def _schema(self, about: Provenance) -> Schema:
        return cast(Schema, self.option(about, "schema"))

    def inspect(self, path: Path) -> SolidsReport:
        """Each product: solids, closed, valid, volume; and what solids share where they stand."""
        with unpacked(path) as file:
            return replace(apart(step_report, file), file=str(path))


def _header(about: Provenance) -> Header:
    """The header of the whole: it names the origin where that is not the input's."""
    text = " ".join([about.header.description, *about.remarks])
    return replace(about.header, description=text)


def _check_part(path: Path, part: Part) -> list[Check]:
    volume = part.properties.volume
    return [
        *check_solid(part.solid, volume),
        *check_step_part(path, number=part.number, volume=volume),
    ]


def _product(part: Part, *further: Attribute) -> StepProduct:
    solid = part.solid if part.boundary is None else None
    attributes: list[Attribute] = [
        ("part number", part.number, "text"),
        *further,
        ("mass", part.mass, "mass"),
        ("material", part.material.name, "text"),
    ]
    if part.kind.form == "bar":
        attributes.append(("length", part.length, "length"))
    return StepProduct(
        part.number,
        part.kind,
        solid,
        part.properties,
        part.material,
        part.boundary,
        tuple(attributes),
    )


FORMAT: Final = StepFormat()
