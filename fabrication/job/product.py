"""What a job needs to know of a product: a gridshell, a linkage, whatever comes next."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Protocol, runtime_checkable

from fabrication.formats.base import Format, Header, Material, Provenance, Standing, Title
from fabrication.formats.registry import find
from fabrication.job.problems import FailedCheck
from fabrication.job.sources import Sources
from fabrication.project.sections import OutputSettings, Verify
from fabrication.specs import Check, Color, Family, Mate, Piece, TriangleMesh
from fabrication.table import Table


class Product(ABC):
    """A structure as numbers, before solids and files.

    A product derives from this class and brings its names, pieces and schedules; what it does not
    bring stays as it is here.

    Attributes
    ----------
    name : of the project, and of the output folder by default
    pieces, families : every piece, and all part numbers with their instances
    chord : greatest distance [mm] of the meshes from the exact surfaces
    title : title block of what people print
    conventions : how signs, sides and counts in the schedules go, a sentence each
    output, verify : [output] of the project, and which files are read back
    seconds : what its design took, by step
    libraries : distributions that shape it, whose versions belong into the manifest
    sources : files that it is made from
    shown_first : files that a person opens first, where they are written
    nothing_helps : what to do where limits are not kept and no setting helps
    """

    name: str
    pieces: Sequence[Piece]
    families: Sequence[Family]
    chord: float
    output: OutputSettings
    verify: Verify
    seconds: Mapping[str, float]
    title: Title = Title()
    conventions: tuple[str, ...] = ()
    libraries: tuple[str, ...] = ()
    sources: Sources = Sources()
    shown_first: tuple[str, ...] = ("assembly.step", "preview.png")
    nothing_helps: str = ""

    @abstractmethod
    def material(self, family: Family) -> Material:
        """What parts of a number are made of, as schedules name it."""

    @abstractmethod
    def schedules(self, masses: Mapping[str, float]) -> Mapping[str, Table]:
        """Schedules by name, with the masses [kg] of the part numbers."""

    def marks_of(self, row: Mapping[str, Any]) -> Sequence[str]:
        """The pieces that a row of a schedule is about: its marks, or all of its part number."""
        if "marks" in row:
            return str(row["marks"]).split()
        if "mark" in row:
            return [row["mark"]]
        own = (f for f in self.families if f.number == row.get("number"))
        return [instance.mark for family in own for instance in family.instances]

    @abstractmethod
    def clearances(self, meshes: Mapping[str, TriangleMesh]) -> dict[str, list[Check]]:
        """Checks of the distances between pieces, by mark; `meshes` by part number."""

    @abstractmethod
    def facts(self) -> dict[str, Any]:
        """Entries of the manifest that are the product's own: input, settings, net, ..."""

    @property
    def placed(self) -> Sequence[Family]:
        """Part numbers with the pieces that are put together, where the assembly has them."""
        return self.families

    @property
    def shown(self) -> Sequence[Family]:
        """The same where models and pictures have them."""
        return self.placed

    @property
    def colors(self) -> Mapping[str, Color]:
        """By part number, where pages and pictures show another one than that of the kind."""
        return {}

    @property
    def plates(self) -> Sequence[Sequence[Standing]]:
        """For each print plate, what stands where on it."""
        return ()

    @property
    def mates(self) -> Sequence[Mate]:
        """Holes of the assembly that must have one axis."""
        return ()

    @property
    def notes(self) -> Sequence[str]:
        """Remarks for people."""
        return ()

    def about(self) -> Provenance:
        """What files state of their origin."""
        output = self.output
        author = output.author or self.title.author
        header = Header(author, output.organization, self.name)
        return Provenance(
            self.name, header, output.options, self.title, self.conventions, self.origin
        )

    @property
    def origin(self) -> tuple[float, float, float]:
        """Where the origin of all coordinates is in those of the input [mm]."""
        return (0.0, 0.0, 0.0)

    def format(self, name: str) -> Format:
        """A format of [output] formats: of the registry, or of the product's own."""
        return find(name)

    def checks(self) -> list[Check]:
        """Checks of the whole that need no files."""
        return []

    def remedies(self, problems: Sequence[FailedCheck]) -> Sequence[tuple[str, str, Any]]:
        """(section, key, value) of settings that help where pieces are beyond limits."""
        return ()

    def extra_files(self) -> list[str]:
        """Paths below the output folder of the files of the product's own."""
        return []

    def write_extra(self, folder: Path) -> list[str]:
        """Write files of the product's own; returns what could not be written."""
        return []


@runtime_checkable
class HasProduct(Protocol):
    """What `make` takes besides a product: numbers of a structure that can be made."""

    def product(self) -> Product:
        """The product that is made of it."""
