"""What a format is, and what it is given: a part number as made, and the whole structure."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Final, Literal, TypeAlias

import numpy as np

from ddgfab.errors import InputError
from fabrication.boundary import Boundary
from fabrication.formats.tables import Legend
from fabrication.solids import Realised, boundary_of, solid_of
from fabrication.specs import (
    Check,
    Color,
    Family,
    FromStock,
    Kind,
    Mate,
    Placement,
    Properties,
    Shape,
    TriangleMesh,
)

if TYPE_CHECKING:
    from fabrication.formats.report import FileReport

Row: TypeAlias = Mapping[str, Any]
ByDefault: TypeAlias = Literal["always", "printed", "never"]
Standing: TypeAlias = tuple[str, str, Placement]
"""Part number, piece mark, (4, 4) placement [mm]."""

FAILED: Final = "failed"
"""Name of the look of pieces that failed a check."""

FAILED_COLOR: Final[Color] = (0.85, 0.10, 0.10)
"""Their color."""

REJECTED_KIND: Final = Kind("rejected", "", "", "Rejected", FAILED_COLOR)
"""Group, layer and color of such pieces in CAD files, whatever kind they are of."""

KG_PER_MM3: Final = 1e-9
"""Times a density [kg/m3]."""


@dataclass(frozen=True)
class Header:
    """Who made a file, and what of; empty fields are written as they are."""

    author: str = ""
    organization: str = ""
    description: str = ""


@dataclass(frozen=True)
class Title:
    """The title block of what people print: plain text on one line each, of any length.

    Attributes
    ----------
    title : of the project
    number, revision : the project's number, and which version of it this is
    date : YYYY-MM-DD, or empty where none is known
    author, client : who made it, and whom for
    """

    title: str = ""
    number: str = ""
    revision: str = ""
    date: str = ""
    author: str = ""
    client: str = ""


@dataclass(frozen=True)
class Provenance:
    """What files state of their origin.

    Attributes
    ----------
    project : name
    header : of files that have one
    options : [output.options]: by format, by name of an option
    title : the title block
    conventions : how signs, sides and counts in the schedules go, a sentence each
    origin : where the origin of all coordinates is in those of the input [mm]
    """

    project: str
    header: Header
    options: Mapping[str, Mapping[str, str]] = field(default_factory=dict)
    title: Title = Title()
    conventions: tuple[str, ...] = ()
    origin: tuple[float, float, float] = (0.0, 0.0, 0.0)

    @property
    def remarks(self) -> tuple[str, ...]:
        """Where the origin of coordinates is, unless it is that of the input."""
        if not any(self.origin):
            return ()
        at = ", ".join(f"{value:.12g}" for value in self.origin)
        return (f"The origin of all coordinates is at ({at}) mm of the input.",)


@dataclass(frozen=True)
class Material:
    """A material. Parts of other tolerances are of the same material.

    Attributes
    ----------
    name : as the parts list has it, with grade and treatment
    density : [kg/m3]
    tolerance : what parts of it have
    category : what it is without grade and treatment
    """

    name: str
    density: float
    tolerance: str = field(default="", compare=False)
    category: str = ""


@dataclass(frozen=True, eq=False)
class Part:
    """A part number as made: its family, properties, mesh in its own frame [mm], and material."""

    family: Family
    properties: Properties
    mesh: TriangleMesh
    material: Material

    @classmethod
    def of(cls, family: Family, made: Realised, material: Material) -> Part:
        """A part whose boundary, and solid where there is one, are known already."""
        part = cls(family, made.properties, made.mesh, material)
        part.__dict__["boundary"] = made.boundary
        if made.solid is not None:
            part.__dict__["solid"] = made.solid
        return part

    @property
    def number(self) -> str:
        """The part number."""
        return self.family.number

    @property
    def kind(self) -> Kind:
        """Its kind."""
        return self.family.kind

    @property
    def shape(self) -> Shape:
        """Its shape."""
        return self.family.shape

    @property
    def mass(self) -> float:
        """Mass [kg] of one piece."""
        return self.properties.volume * self.material.density * KG_PER_MM3

    @property
    def length(self) -> float:
        """Length [mm]: of what is sawn from a bar that of the bar, without what is welded to it.

        Of others over all, along the longest axis of their own frame.
        """
        if isinstance(self.shape, FromStock):
            return self.shape.stock()[1]
        return float(np.ptp(self.mesh.vertices, axis=0).max())

    @cached_property
    def boundary(self) -> Boundary | None:
        """Exact boundary; None where the shape has none."""
        return boundary_of(self.shape)

    @cached_property
    def solid(self) -> Any:
        """Solid of the CAD kernel, made when first asked for."""
        return solid_of(self.shape)

    def release(self) -> None:
        """Let the solid go where the boundary makes it again; it takes much memory."""
        if self.boundary is not None:
            self.__dict__.pop("solid", None)

    def __getstate__(self) -> dict[str, Any]:
        """Between processes without boundary and solid, which are made again where needed."""
        return {field.name: getattr(self, field.name) for field in fields(self)}


@dataclass(frozen=True, eq=False)
class Whole:
    """A structure as made.

    Attributes
    ----------
    parts : by part number
    families : part numbers with the pieces that are put together, placed
    shown : the same as models and pictures show them
    colors : by part number, where pages and pictures show another one than that of the kind
    failed : marks of pieces that failed a check or a limit
    tables : schedules by name, as rows
    legends : what they and their columns mean, by name
    plates : for each print plate, what stands where on it
    problems : what failed, a line each; empty but for formats that are reports
    checks : by mark, as `problems`
    mates : holes that must have one axis
    """

    about: Provenance
    parts: Mapping[str, Part]
    families: Sequence[Family]
    shown: Sequence[Family]
    failed: frozenset[str] = frozenset()
    tables: Mapping[str, Sequence[Row]] | None = None
    legends: Mapping[str, Legend] = field(default_factory=dict)
    plates: Sequence[Sequence[Standing]] = ()
    problems: tuple[str, ...] = ()
    checks: Mapping[str, Sequence[Check]] = field(default_factory=dict)
    mates: Sequence[Mate] = ()
    colors: Mapping[str, Color] = field(default_factory=dict)

    def standing(self) -> Iterator[Standing]:
        """All pieces that are put together."""
        for family in self.families:
            for instance in family.instances:
                yield family.number, instance.mark, instance.placement

    def passed(self) -> Iterator[Standing]:
        """The same without those that failed."""
        return (piece for piece in self.standing() if piece[1] not in self.failed)


@dataclass(frozen=True, eq=False)
class Contents:
    """What a structure has, before it is made.

    Attributes
    ----------
    about : project and options
    families : all part numbers
    tables : names of the schedules
    plates : number of print plates
    """

    about: Provenance
    families: Sequence[Family]
    tables: Sequence[str]
    plates: int


class Format:
    """A file format. One that writes parts has a file a part number in parts/NAME/.

    What a format does not write or check stays as it is here: nothing.

    Attributes
    ----------
    name : in [output] formats, and of the folder of the parts
    suffixes : of its files, the first one when they are written
    parts : whether it has a file a part number
    report : whether its whole names what failed: written last, by the process of the job itself
    by_default : which projects that name no formats are written in it: all, those of printed
        products, or none
    needs, needs_to_check : modules, and the packages that pip installs for them
    libraries : distributions whose versions belong into the manifest
    options : what [output.options] may set of it: the values of each option, the default first
    """

    name: ClassVar[str]
    suffixes: ClassVar[tuple[str, ...]]
    parts: ClassVar[bool] = False
    report: ClassVar[bool] = False
    by_default: ClassVar[ByDefault] = "never"
    needs: ClassVar[Mapping[str, str]] = {}
    needs_to_check: ClassVar[Mapping[str, str]] = {}
    libraries: ClassVar[tuple[str, ...]] = ()
    options: ClassVar[Mapping[str, tuple[str, ...]]] = {}

    def option(self, about: Provenance, name: str) -> str:
        """The value of an option: that of the project, or the default."""
        return about.options.get(self.name, {}).get(name, self.options[name][0])

    def takes(self, family: Family) -> bool:
        """Whether there is a file of this part number in the format."""
        return True

    def write_part(self, path: Path, part: Part, about: Provenance) -> None:
        """Write the file of one part number."""

    def check_part(self, path: Path, part: Part) -> list[Check]:
        """Read the file of one part number back and compare it with the part."""
        return []

    def whole_files(self, contents: Contents) -> list[str]:
        """Paths below the output folder of the files that `write_whole` writes."""
        return []

    def write_whole(self, folder: Path, whole: Whole) -> list[str]:
        """Write the files of the whole below the output folder, or replace them.

        Returns what could not be written though it is not a fault of the structure.
        """
        return []

    def check_whole(self, folder: Path, whole: Whole) -> list[Check]:
        """Read the files of the whole back and compare them."""
        return []

    def inspect(self, path: Path) -> FileReport:
        """What is in any file of this format.

        Raises
        ------
        InputError
            Missing, of another format, truncated or broken; or the format has nothing to inspect.
        """
        raise InputError(f"files of format {self.name} cannot be inspected", file=str(path))

    @classmethod
    def writes_whole(cls) -> bool:
        """Whether there are files of the whole in this format."""
        return cls.write_whole is not Format.write_whole

    @classmethod
    def inspects(cls) -> bool:
        """Whether `ddgfab check` can look into files of this format."""
        return cls.inspect is not Format.inspect
