"""The project of a linkage as typed records; every key has a unit, a default and a meaning.

A key's unit is in its name: _mm millimetres, _deg degrees.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, ClassVar, Final

from pydantic import Field, ValidationError, field_validator

from ddgfab.linkages import Mechanism
from ddgfab.suggest import nearest
from fabrication.formats.registry import defaults
from fabrication.job.sources import Sources
from fabrication.linkage.animation import Gif
from fabrication.linkage.kinds import BennettLinkage, CrabLinkage, CubeLinkage, KNetLinkage
from fabrication.linkage.plates import BED_MM, GAP_MM, MARGIN_MM, Bed
from fabrication.linkage.settings import LabelStyle, LinkageSettings, PinKind, settings_for
from fabrication.project.load import explain, sections_in, unknown
from fabrication.project.read import Changes, Origin, read_changed
from fabrication.project.sections import (
    NotNegative,
    OutputSettings,
    Positive,
    Section,
    TitleSettings,
    Verify,
)
from fabrication.project.shop import RateSettings, StockSettings
from fabrication.project.toml import toml_text
from fabrication.standards.printers import printer, printer_keys


class NameSettings(TitleSettings):
    """[project]: the name, and the title block.

    Attributes
    ----------
    name : of the output folder; empty: the file's stem, or the kind of linkage
    """


class PrinterSettings(Section):
    """[printer].

    Attributes
    ----------
    preset : "fdm-0.4", "fdm-0.25", "sla", "sls": clearances and limits; see standards/printers.toml
    bed_mm : width and depth of the bed that the print plates are laid out on
    margin_mm : land that stays free along the bed's edge, for brim and skirt
    gap_mm : between parts on a plate
    """

    preset: str = "fdm-0.4"
    bed_mm: tuple[Positive, Positive] = Field(default=BED_MM, strict=False)
    margin_mm: NotNegative = MARGIN_MM
    gap_mm: NotNegative = GAP_MM

    @classmethod
    def choices(cls) -> Mapping[str, Sequence[str]]:
        """The presets."""
        return {"preset": printer_keys()}

    @field_validator("preset")
    @classmethod
    def _known(cls, value: str) -> str:
        printer(value)
        return value

    def bed(self) -> Bed:
        """The bed itself."""
        return Bed(*self.bed_mm, margin=self.margin_mm, gap=self.gap_mm)


class PartsSettings(Section):
    """[parts]: what differs from the printer's defaults.

    Attributes
    ----------
    pin : "metal" (rods with printed caps) or "printed" (with a head and a cap)
    pin_diameter_mm, clearance_mm : of the pins; between pin and bore, a side
    axial_gap_mm, press_mm : between neighbours on a pin; between pin and cap, a side
    eye_diameter_mm, eye_height_mm : of the eyes
    bar_width_mm, bar_height_mm, bevel_mm : of the bars' section
    cap_diameter_mm, cap_grip_mm, cap_floor_mm, head_height_mm : of caps and heads
    label, label_depth_mm : "engraved", "embossed" or "none"
    coupon : whether the kit holds a clearance coupon
    max_levels : most levels along a hinge
    """

    pin: PinKind = "metal"
    pin_diameter_mm: Positive | None = None
    clearance_mm: Positive | None = None
    axial_gap_mm: Positive | None = None
    press_mm: NotNegative | None = None
    eye_diameter_mm: Positive | None = None
    eye_height_mm: Positive | None = None
    bar_width_mm: Positive | None = None
    bar_height_mm: Positive | None = None
    bevel_mm: NotNegative | None = None
    cap_diameter_mm: Positive | None = None
    cap_grip_mm: Positive | None = None
    cap_floor_mm: Positive | None = None
    head_height_mm: Positive | None = None
    label: LabelStyle = "engraved"
    label_depth_mm: Positive | None = None
    coupon: bool = True
    max_levels: Annotated[int, Field(ge=1, le=12)] = 6

    def given(self) -> dict[str, Any]:
        """What is given, by the names of `settings_for`."""
        values = self.model_dump(exclude_none=True)
        return {name.removesuffix("_mm"): value for name, value in values.items()}


class RodSettings(StockSettings):
    """[stock]: the rods that metal pins are cut from, for the cut list."""

    kerf_mm: NotNegative = 1.0
    trim_mm: NotNegative = 2.0


class MotionSettings(Section):
    """[motion].

    Attributes
    ----------
    maximize_range : try what widens the free range: levels further apart, slimmer bars
    poses : of the report and the animation, through the free range
    """

    maximize_range: bool = False
    poses: Annotated[int, Field(ge=2, le=400)] = 61


class CheckSettings(Section):
    """[checks].

    Attributes
    ----------
    verify : which files are read back: "all", "sample" (one in ten) or "none"
    """

    verify: Verify = "all"


class KitOutput(OutputSettings):
    """[output]: the files. Kits have few part numbers, so that one process is soonest."""

    own_formats: ClassVar[tuple[str, ...]] = (Gif.name,)

    formats: Annotated[tuple[str, ...], Field(strict=False)] = Field(
        default_factory=lambda: (*defaults(printed=True), Gif.name)
    )
    jobs: Annotated[int, Field(ge=0, le=256)] = 1


class KitProject(Section):
    """A whole project, validated. `file` is where it came from, None when made in Python."""

    project: NameSettings = NameSettings()
    linkage: BennettLinkage | CubeLinkage | KNetLinkage | CrabLinkage
    printer: PrinterSettings = PrinterSettings()
    parts: PartsSettings = PartsSettings()
    motion: MotionSettings = MotionSettings()
    stock: RodSettings = RodSettings()
    rates: RateSettings = RateSettings()
    checks: CheckSettings = CheckSettings()
    output: KitOutput = Field(default_factory=KitOutput)
    file: Path | None = Field(default=None, exclude=True)

    @property
    def name(self) -> str:
        """The project's name, or the stem of its file, or its kind."""
        return self.project.name or (self.file.stem if self.file else self.linkage.kind)

    @property
    def source(self) -> Path | None:
        """The mesh of a K-net, or the project file; None when made in Python."""
        mesh = self.linkage.file if isinstance(self.linkage, KNetLinkage) else None
        if mesh is None or self.file is None:
            return mesh or self.file
        return self.file.parent / mesh

    @property
    def sources(self) -> Sources:
        """The files that it is made from."""
        return Sources(self.file, None if self.source == self.file else self.source)

    @property
    def settings(self) -> dict[str, Any]:
        """Every section as plain values, for the manifest; without `jobs`."""
        return self.model_dump(mode="json", exclude={"output": {"jobs"}})

    def part_settings(self) -> LinkageSettings:
        """The numbers of the parts; raises `InputError` where they contradict each other."""
        return settings_for(self.printer.preset, **self.parts.given())

    def mechanism(self) -> Mechanism:
        """The mechanism of [linkage]; files are looked for beside the project's."""
        return self.linkage.mechanism(None if self.file is None else self.file.parent)


class BennettKit(KitProject):
    """A project of kind "bennett"."""

    linkage: BennettLinkage = BennettLinkage()


class CubeKit(KitProject):
    """A project of kind "cube"."""

    linkage: CubeLinkage = CubeLinkage()


class KNetKit(KitProject):
    """A project of kind "knet"."""

    linkage: KNetLinkage = KNetLinkage()


class CrabKit(KitProject):
    """A project of kind "crab"."""

    linkage: CrabLinkage = CrabLinkage()


KITS: Final[dict[str, type[KitProject]]] = {
    "bennett": BennettKit,
    "cube": CubeKit,
    "knet": KNetKit,
    "crab": CrabKit,
}
"""Kinds of linkage."""


def kit_kinds() -> tuple[str, ...]:
    """Names of all kinds of linkage."""
    return tuple(KITS)


def load_kit_project(path: str | Path, changes: Changes | None = None) -> KitProject:
    """The project in a TOML file, validated; `changes` replaces single values, by section.

    Raises
    ------
    ProjectError
        A file that is missing, no TOML, or has an unknown key or a wrong value; names file, line,
        key, value, limit, and the nearest known key.
    """
    values, origin = read_changed(path, changes)
    if "linkage" not in values:
        if nearest("linkage", values):  # misspelt: the message of `sections_in` has its line
            sections_in(values, KitProject, origin)
        raise origin.error('a linkage needs [linkage] kind = "bennett", ...')
    return _kit_project(values, Path(path), origin)


def make_kit_project(sections: Mapping[str, Any]) -> KitProject:
    """Project from a dictionary of sections, as in a file; the kind defaults to "bennett".

    Raises
    ------
    ProjectError
        An unknown section or key, or a wrong value.
    """
    return _kit_project(sections, None, Origin())


def _kit_project(values: Mapping[str, Any], file: Path | None, origin: Origin) -> KitProject:
    sections = sections_in(values, KitProject, origin)
    kind = sections.get("linkage", {}).get("kind", "bennett")
    if not isinstance(kind, str) or kind not in KITS:
        shown = f"[linkage] kind = {toml_text(kind)}"
        raise origin.error(unknown(shown, str(kind), set(KITS)), "linkage", "kind")
    try:
        return KITS[kind].model_validate({**sections, "file": file}, strict=None)
    except ValidationError as error:
        raise explain(error, KITS[kind], origin) from None
