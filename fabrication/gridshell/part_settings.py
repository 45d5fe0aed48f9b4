"""What parts are, as the project says: the sections [beam], [node], [connection] and [panel].

A key's unit is in its name: _mm millimetres, _deg degrees, _percent percent.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Final, Literal

from pydantic import Field, field_validator, model_validator

from ddgfab.errors import ProjectError, clipped
from fabrication.gridshell.detailing.connections import registry as connections
from fabrication.gridshell.detailing.nodes import registry as nodes
from fabrication.gridshell.kind_settings import KindSection, Registry
from fabrication.gridshell.where import Edges, Rule
from fabrication.project.sections import Finite, NotNegative, Positive, Section
from fabrication.specs import Profile
from fabrication.standards import density, polygon, profile, stock_size
from fabrication.standards.fasteners import BoltClass, BoltSize
from fabrication.standards.glass import build_up

EdgeWork = Literal["cut", "arrissed", "ground", "smooth ground", "polished"]

AGREE: Final = 1e-6
"""How far, of its value, a thickness or density may be from that of the build-up."""


def _section(value: str | list[list[float | int]]) -> Profile:
    return profile(value) if isinstance(value, str) else polygon(value)


class _WithProfile(Section):
    """A section with a profile."""

    profile: str | list[list[float | int]]

    @field_validator("profile")
    @classmethod
    def _exists(cls, value: str | list[list[float | int]]) -> str | list[list[float | int]]:
        _section(value)
        return value

    def section(self) -> Profile:
        """The cross-section itself."""
        return _section(self.profile)


class BeamRule(_WithProfile, Rule):
    """[[beam]] with `where`: beams of one place.

    Attributes
    ----------
    where : "boundary", "supports" (beams that end at those of [ground]), "group:NAME" (a group of
        the mesh file), or edge numbers as in beams.csv
    profile : as in [beam]
    """

    where: Edges


class BeamSettings(_WithProfile):
    """[beam].

    Attributes
    ----------
    profile : designation ("FL 60x8", "RHS 120x60x5", "SHS 60x4", "T 60x60x7": depth x width
        [x thickness]) or corners [[y, z], ...] in mm, y across, z up
    eccentricity_mm : the profile's datum (top center) above the mesh edge, in the plane pi(e)
    end : "flat" (a plane parallel to the node axis) or "cope" (the node's cylinder)
    clearance_mm : between the cut and the node; 0.5 leaves room for paint and length tolerance
    min_length_mm : least length between the cuts
    grade : for the order: steel grade and what is done to the surface, "S355J2, galvanized"
    tolerances : for the order; empty: ISO 2768-1 m, and lengths that the clearances leave room for
    rules : profiles of beams of one place; in a file [[beam]] tables, the first without `where`
    density : kg/m3; default steel, EN 1991-1-1
    material : what the bars are of, as files name it
    """

    profile: str | list[list[float | int]] = "FL 60x8"
    eccentricity_mm: Finite = 0.0
    end: Literal["flat", "cope"] = "flat"
    clearance_mm: NotNegative = 0.5
    min_length_mm: Positive = 100.0
    grade: str = ""
    tolerances: str = ""
    material: str = "Steel"
    rules: tuple[BeamRule, ...] = Field(default=(), strict=False)
    density: Positive = density("steel")


class NodeSettings(KindSection):
    """[node].

    Attributes
    ----------
    kind : one of the registry of nodes: "cylinder" (solid), "tube", "star" (plates in the
        planes of the beams, for bolted tongues) or "plates" (two discs on a core, for slots)
    diameter_mm : "auto" = the least of the series that fits the whole project, or a number
    series_mm : diameters to choose from; empty: round bars EN 10060, or tubes EN 10210-2
    min_diameter_mm : "auto" takes no less: room for weld or bolt, and for the mark
    wall_mm : of a tube
    arm_clearance_mm : land left between neighbouring arms (seats) at the cylinder
    margin_mm, top_margin_mm : how far a node reaches below and above its arms' end faces
    height_step_mm : top and bottom are rounded outwards to multiples of it
    grade, tolerances : for the order, as of beams
    rules : nodes of one place; in a file [[node]] tables, the first without `where`
    density : kg/m3; default steel, EN 1991-1-1
    """

    registry: ClassVar[Registry] = nodes
    whole: ClassVar[frozenset[str]] = frozenset({"grade", "tolerances", "density"})

    kind: str = "cylinder"
    diameter_mm: Literal["auto"] | Positive = "auto"
    series_mm: tuple[Positive, ...] = Field(default=(), strict=False)
    min_diameter_mm: NotNegative = 40.0
    wall_mm: Positive = 8.0
    arm_clearance_mm: NotNegative = 1.0
    margin_mm: NotNegative = 5.0
    top_margin_mm: NotNegative = 0.5
    height_step_mm: Positive = 1.0
    grade: str = ""
    tolerances: str = ""
    density: Positive = density("steel")


class ConnectionSettings(KindSection):
    """[connection]: how beams are joined to nodes.

    Attributes
    ----------
    kind : "welded" (the end on the seat, no holes), "stud" (a thread in the node, a plate or
        solid end of the beam on the same axis, an opening to tighten it), "end_plate" (a plate
        across the end of the beam, bolts on either side of the bar), "slotted" (the discs of [node]
        kind = "plates" in slots across timber bars) or "bolted_tongue" (the
        plates of [node] kind = "star", or plates welded to a "cylinder" or "tube", in slots of
        flat bars, two bolts in double shear)
    weld_mm : throat thickness of the fillet weld, 3 or more (EN 1993-1-8, 4.5.2): of beams to
        nodes, of plates to hollow sections, of discs to the cores of nodes
    bolt : size of studs and bolts
    bolt_class : their property class (ISO 898-1, ISO 3506-1); nuts and washers go with it
    grade : for the order: coating of the fasteners, tightening
    ends : of beams with tongues: "slotted" (a slot in a flat bar), or "doubled" (two straps on
        the sides of a thin one)
    bolts : of an end plate: 2, or more in rows of 2
    fastener : "stud" (DIN 976-1, with a nut) or "bolt" (ISO 4017) through the plate
    plate_mm : thickness of the plate, of a solid end, or of a tongue; "auto": the
        first thickness kept in stock, from the bolt's diameter, with which a bolt fits
    thread_mm : complete thread in the node; "auto": 1.5 bolt diameters where there is room, at
        least 1; through the wall of a tube
    fasteners : whether studs, bolts, nuts and washers are parts, with files, in the assembly
    rules : nodes of one place; in a file [[connection]] tables, the first without `where`
    """

    registry: ClassVar[Registry] = connections
    whole: ClassVar[frozenset[str]] = frozenset({"bolt_class", "grade", "fasteners"})

    kind: str = "welded"
    weld_mm: Annotated[float, Field(ge=3.0, le=50.0)] = 4.0
    bolt: BoltSize = "M12"
    bolt_class: BoltClass = "8.8"
    grade: str = ""
    ends: Literal["slotted", "doubled"] = "slotted"
    bolts: Literal[2, 4, 6, 8] = 2
    fastener: Literal["stud", "bolt"] = "stud"
    plate_mm: Literal["auto"] | Positive = "auto"
    thread_mm: Literal["auto"] | Positive = "auto"
    fasteners: bool = False


class JointSettings(Section):
    """[joint]: profiles along the joints between panes, for the order; empty: not stated.

    Attributes
    ----------
    gasket : inside, under the panes, "EPDM 60 Shore, 30 x 8"
    clamp : that holds the panes, "pressure plate 50 mm, screws at 250 mm"
    cap : outside, over the joint
    """

    gasket: str = ""
    clamp: str = ""
    cap: str = ""


class PanelSettings(Section):
    """[panel].

    Attributes
    ----------
    kind : "glass" or "none" (beams and nodes only)
    build_up : of the pane from the outside inwards, such as "8/16Ar/6.6.2": plies in mm, dots in
        laminates (two 6 mm plies with 2 films of PVB), cavities with Air, Ar or Kr; it sets
        thickness_mm and density. Empty: one pane of thickness_mm
    grade : for the order: heat treatment, coatings, standards, "toughened, low-e on face 2"
    tolerances : for the order; empty: the product standard of the build-up
    thickness_mm : of the pane; default 12, e.g. two 6 mm plies
    gap_mm : joint between neighbouring panes, half on each side of pi(e)
    gap_at : the level where a square-sided pane keeps the gap: "tightest" (nowhere less),
        "inner" or "outer" surface; mitred panes keep it everywhere
    offset_mm : inner surface above the mesh face; "auto": the least multiple of 5 mm that clears
        all beams and nodes by 3 mm, at most 60
    edge : "square" to the pane, or "mitred" (parallel to pi(e))
    edge_work, edge_work_boundary : of sides with a neighbour, and of those at the boundary, which
        are seen: "cut", "arrissed", "ground", "smooth ground" or "polished" (EN 12150-1), codes C,
        A, G, S and P in the schedule
    step_mm : how far the inner panes of a build-up stand back at sides on the boundary; for the
        order, the solids are made without steps
    corner_radius_mm : 0 leaves the corners sharp
    max_size_mm : smaller and larger side of the least rectangle; default jumbo stock, EN 572-2
    density : kg/m3; default glass, EN 572-1
    """

    kind: Literal["glass", "none"] = "glass"
    build_up: str = ""
    grade: str = ""
    tolerances: str = ""
    thickness_mm: Positive = 12.0
    gap_mm: NotNegative = 12.0
    gap_at: Literal["tightest", "inner", "outer"] = "tightest"
    offset_mm: Literal["auto"] | Finite = "auto"
    edge: Literal["square", "mitred"] = "square"
    edge_work: EdgeWork = "arrissed"
    edge_work_boundary: EdgeWork = "polished"
    step_mm: NotNegative = 0.0
    corner_radius_mm: NotNegative = 0.0
    max_size_mm: tuple[Positive, Positive] = Field(default=stock_size(), strict=False)
    density: Positive = density("glass")

    @model_validator(mode="before")
    @classmethod
    def _of_build_up(cls, values: Any) -> Any:
        """Thickness and density of the build-up; given ones must agree with it."""
        text = values.get("build_up") if isinstance(values, Mapping) else None
        if not isinstance(text, str) or not text:
            return values
        try:
            made = build_up(text)
        except ProjectError as error:
            raise ValueError(str(error)) from None
        for key, own in (("thickness_mm", made.thickness), ("density", made.density)):
            given = values.get(key, own)
            if not isinstance(given, int | float) or abs(given - own) > AGREE * own:
                raise ValueError(
                    f'{key} = {clipped(given)} is not that of build_up = "{text}", {own:.6g}: '
                    "leave one of the two out"
                )
        return {**values, "thickness_mm": made.thickness, "density": made.density}

    @model_validator(mode="after")
    def _steps(self) -> PanelSettings:
        if self.step_mm > 0 and self.panes < 2:
            raise ValueError(
                f"step_mm = {self.step_mm:g} needs a build_up of two panes or more, such as "
                '"8/16Ar/6.6"'
            )
        return self

    @property
    def panes(self) -> int:
        """How many panes lie one above the other, with cavities between."""
        return len(build_up(self.build_up).panes) if self.build_up else 1
