"""The project of a gridshell as typed records; every key has a unit, a default and a meaning.

A key's unit is in its name: _mm millimetres, _deg degrees, _percent percent.
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, ClassVar, Final, Literal

from pydantic import Field, model_validator

from fabrication.gridshell.compas import Compas
from fabrication.gridshell.ground_settings import GroundSettings
from fabrication.gridshell.net_settings import (
    GeneralSettings,
    NetSettings,
    OptimizeSettings,
    SupportSettings,
)
from fabrication.gridshell.part_settings import (
    BeamSettings,
    ConnectionSettings,
    JointSettings,
    NodeSettings,
    PanelSettings,
)
from fabrication.job.sources import Sources
from fabrication.project.sections import (
    Degrees,
    NotNegative,
    OutputSettings,
    Positive,
    Section,
    Verify,
)
from fabrication.project.shop import GlassStockSettings, RateSettings

EXAMPLE: Final = Path(__file__).parent / "builtin" / "canopy.toml"
"""The built-in example."""


class CheckSettings(Section):
    """[checks]: limits; a part beyond one is made and listed, and the exit code is 1.

    Attributes
    ----------
    flat_percent : planarity (distance of the diagonals over their mean length) of a flat pane
    bend_percent : planarity of a candidate for cold bending; beyond it the pane is rejected
    accept : the worst class that passes: "flat" (the panes are made flat) or "cold-bend"
    planarity_mm : greatest distance of a corner from the pane's plane, whatever the class
    min_angle_deg : azimuth difference of neighbouring arms
    torsion_deg : of an edge; default 0.1, the limit for optimized structures
    family_tolerance_mm : parts whose corners agree within it share a part number
    plausibility : what becomes of quantities that are far from what is built: "warn", "fail" or
        "ignore"
    verify : which files are read back: one for every part number, one in ten, or none
    """

    flat_percent: NotNegative = 0.2
    bend_percent: NotNegative = 1.0
    accept: Literal["flat", "cold-bend"] = "flat"
    planarity_mm: Positive | None = None
    min_angle_deg: Annotated[float, Field(ge=0, le=120)] = 25.0
    torsion_deg: Degrees = 0.1
    family_tolerance_mm: NotNegative = 0.1
    plausibility: Literal["warn", "fail", "ignore"] = "warn"
    verify: Verify = "all"

    @model_validator(mode="after")
    def _ordered(self) -> CheckSettings:
        if self.bend_percent < self.flat_percent:
            raise ValueError("bend_percent must not be less than flat_percent")
        return self


class GridshellOutput(OutputSettings):
    """[output] of gridshells."""

    own_formats: ClassVar[tuple[str, ...]] = (Compas.name,)


class Project(Section):
    """A whole project, validated. `file` is where it came from, None when made in Python."""

    project: GeneralSettings = GeneralSettings()
    net: NetSettings
    optimize: OptimizeSettings = OptimizeSettings()
    support: SupportSettings = SupportSettings()
    beam: BeamSettings = BeamSettings()
    node: NodeSettings = NodeSettings()
    connection: ConnectionSettings = ConnectionSettings()
    ground: GroundSettings = GroundSettings()
    panel: PanelSettings = PanelSettings()
    joint: JointSettings = JointSettings()
    stock: GlassStockSettings = GlassStockSettings()
    rates: RateSettings = RateSettings()
    checks: CheckSettings = CheckSettings()
    output: GridshellOutput = Field(default_factory=GridshellOutput)
    file: Path | None = Field(default=None, exclude=True)

    @property
    def name(self) -> str:
        """The project's name, or the stem of its file or mesh."""
        source = self.file or self.net.file
        return self.project.name or (source.stem if source else self.net.kind)

    @property
    def mesh_path(self) -> Path | None:
        """The mesh file, found from the project file's folder; None for a generated net."""
        if self.net.file is None or self.file is None:
            return self.net.file
        return self.file.parent / self.net.file

    @property
    def sources(self) -> Sources:
        """The files that it is made from; none of the built-in example."""
        return Sources() if self.file == EXAMPLE else Sources(self.file, self.mesh_path)

    @property
    def settings(self) -> dict[str, Any]:
        """Every section as plain values, for the manifest; without `jobs`."""
        return self.model_dump(mode="json", exclude={"output": {"jobs"}})

    def __repr__(self) -> str:
        source = self.net.file if self.net.file else self.net.kind
        panels = "no panels" if self.panel.kind == "none" else f"panels {self.panel.thickness_mm:g}"
        return f"Project({self.name}: {source}, {self.beam.section().name}, {panels})"

    __str__ = __repr__
