"""The project of a gridshell as typed records; every key has a unit, a default and a meaning.

A key's unit is in its name: _mm millimetres, _deg degrees, _percent percent.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, Final, Literal, get_args

from pydantic import Field, field_validator, model_validator

from ddgfab.forms.registry import kinds
from ddgfab.io import Unit, Up, to_millimetres
from ddgfab.optimize import Boundary, Goal, Keep
from ddgfab.suggest import suggestion
from ddgfab.support import SupportKind
from ddgfab.surfaces.analytic import SURFACES
from ddgfab.tolerances import LEAN_LIMIT_DEG
from fabrication.gridshell.detailing.nodes import registry as nodes
from fabrication.project.sections import (
    Degrees,
    Finite,
    NotNegative,
    OutputSettings,
    Positive,
    Section,
    Verify,
)
from fabrication.specs import Profile
from fabrication.standards import bolt_hole, density, polygon, profile, stock_size

VertexIds = Annotated[tuple[Annotated[int, Field(ge=0)], ...], Field(strict=False)]
BoltSize = Literal["none", "M6", "M8", "M10", "M12", "M14", "M16", "M18", "M20", "M22", "M24"]

MESH: Final = "mesh"
"""The kind of net that is read from a file."""

SURFACE: Final = "surface"
"""The kind of net that is traced on a surface; all others are generated."""


class GeneralSettings(Section):
    """[project]: the name, and the size of the input.

    Attributes
    ----------
    name : of the output folder; empty: the file's stem
    units : of the input's coordinates; none: what the file states in a comment, else millimetres
    scale : factor on the input's coordinates, before units
    median_edge_mm : instead of scale and units: the median edge becomes this long
    """

    name: str = ""
    units: Unit | None = None
    scale: Positive = 1.0
    median_edge_mm: Positive | None = None

    @model_validator(mode="after")
    def _one_size(self) -> GeneralSettings:
        if self.median_edge_mm is not None and self.changed() & {"scale", "units"}:
            raise ValueError("median_edge_mm replaces scale and units: give one or the other")
        return self

    def factor(
        self, median_edge: float, stated: str | None = None, file: str | None = None
    ) -> float:
        """Millimetres for one unit of the input whose median edge length is given.

        Parameters
        ----------
        stated : unit that the file states
        file : for messages

        Raises
        ------
        InputError
            The settings and the file name different units.
        """
        if self.median_edge_mm is not None:
            return self.median_edge_mm / median_edge
        return to_millimetres(self.units, self.scale, stated, file)


class NetSettings(Section):
    """[net]: where the surface comes from.

    Attributes
    ----------
    kind : "mesh" (a file), or a kind that `ddgfab net --list` shows: "canopy" (the built-in
        example), "circular", "conical", "translation", ..., or "surface": a net is traced on one
    file : OBJ, OFF, PLY, STL or COMPAS JSON, for "surface" STEP or IGES; relative to the project
        file
    up : "mesh": axis of the file that becomes z: "z", "y", "x", "-z", "-y" or "-x"
    flip : "mesh": turn all faces over
    quads : "mesh": merge pairs of triangles into quads
    weld_mm : "mesh": vertices nearer than this are one; none: what the digits of the file leave
    parameters : of the generator, or of the surface; in the file they stand in [net] beside kind
    surface : "surface": its name, of those that `ddgfab trace --list` shows, instead of a file
    spacing_mm, spacing_across_mm : "surface": distance of neighboring lines, of the first family
        and of the second
    face : "surface": which face of the file, from 0
    along : "surface": normal of planes; one family is the sections, the other conjugate to it
    turn_deg : "surface": angle of one family to the principal directions, the other is conjugate
    through : "surface": points [mm] through which a line of each family runs: [[0, 0, 3000]]
    """

    kind: str = MESH
    file: Path | None = Field(default=None, strict=False)
    up: Up = "z"
    flip: bool = False
    quads: bool = False
    weld_mm: NotNegative | None = None
    parameters: dict[str, Any] = Field(default_factory=dict)
    surface: str = ""
    spacing_mm: Positive = 1500.0
    spacing_across_mm: Positive | None = None
    face: Annotated[int, Field(ge=0)] | None = None
    along: Annotated[tuple[Finite, Finite, Finite], Field(strict=False)] | None = None
    turn_deg: Finite | None = None
    through: (
        Annotated[
            tuple[Annotated[tuple[Finite, Finite, Finite], Field(strict=False)], ...],
            Field(strict=False),
        ]
        | None
    ) = None

    @classmethod
    def keys(cls) -> set[str]:
        """Of a mesh: without `parameters`, which no file may name, and keys of surfaces."""
        return {"kind", "file", *cls.mesh_keys()}

    @classmethod
    def mesh_keys(cls) -> tuple[str, ...]:
        """How a mesh file is read."""
        return ("up", "flip", "quads", "weld_mm")

    @classmethod
    def surface_keys(cls) -> set[str]:
        """Of kind = "surface", besides the parameters of the surface itself."""
        return set(cls.model_fields) - {"parameters", *cls.mesh_keys()}

    @classmethod
    def choices(cls) -> Mapping[str, Sequence[str]]:
        """The surfaces by name."""
        return {"surface": tuple(SURFACES)}

    @field_validator("kind")
    @classmethod
    def _known(cls, value: str) -> str:
        known = (MESH, SURFACE, *kinds())
        if value not in known:
            raise ValueError(f'"{value}" is unknown; {suggestion(value, known)}')
        return value

    @model_validator(mode="after")
    def _source(self) -> NetSettings:
        if self.kind == MESH and self.file is None:
            raise ValueError('kind = "mesh" needs file = "..."')
        if self.kind == SURFACE:
            if (self.file is None) == (not self.surface):
                raise ValueError('kind = "surface" needs file = "..." or surface = "dome"')
            return self
        if own := sorted(self.changed() & (self.surface_keys() - self.keys())):
            raise ValueError(f'{own[0]} is for kind = "surface", not for "{self.kind}"')
        if self.kind != MESH and self.file is not None:
            raise ValueError(f'file is for kind = "mesh", not for "{self.kind}"')
        return self


_SHAPES: Final = ("planar", "circular", "conical", "torsion-free")

OPTIMIZE_OPTIONS: Final[dict[str, tuple[str, ...]]] = {
    "flat_percent": _SHAPES,
    "keep": _SHAPES,
    "distance_limit_edges": _SHAPES,
    "rise_limit_percent": _SHAPES,
    "zigzag_limit_deg": _SHAPES,
    "max_pane_mm": _SHAPES,
    "axes_only": ("torsion-free",),
    "max_lean_deg": ("torsion-free",),
    "families_of": ("families",),
    "fit_tolerance_mm": ("families",),
}
"""Keys of [optimize] that only some goals have."""


class OptimizeSettings(Section):
    """[optimize]: how the mesh is changed before anything is built on it.

    Attributes
    ----------
    goal : "planar", "circular", "conical", "torsion-free" (planar faces and upright node axes),
        "families" (fewer congruent pieces); "none" leaves the mesh as it is
    flat_percent : how far faces may be from planar (distance of the diagonals over their mean);
        default 0.2 for "planar", 0 (exact) for the others
    keep : "close" to the surface, "balanced", "fair" (smooth faces), or a number between (0.2,
        0.33, 0.5)
    distance_limit_edges : greatest distance from the surface, mean and greatest, in mean edges;
        more is an error
    rise_limit_percent : a mesh that keeps less of its rise is an error
    zigzag_limit_deg : a mesh whose bends differ from edge to edge by so much more than before
        (root mean square) is crumpled, and an error
    max_pane_mm : lengths of the largest pane, [1500, 2500]: quads are divided until they fit
    fix : "none", "boundary", or ids of vertices that stay
    boundary : what boundary vertices may do: "free", "glide" along the boundary, "fixed"
    feature_angle_deg : edges sharper than this are features, which need not stay smooth
    max_movement_mm : a vertex that would move further is an error
    axes_only : "torsion-free": vertices stay, only node axes are found
    max_lean_deg : "torsion-free": greatest angle between node axis and surface normal
    families_of : "families": of panels, or of edges by their length
    fit_tolerance_mm : "families": pieces that agree within it are equal
    """

    goal: Literal["none"] | Goal = "none"
    flat_percent: Annotated[float, Field(ge=0, le=100)] | None = None
    keep: Keep | Positive = "balanced"
    distance_limit_edges: Annotated[tuple[Positive, Positive], Field(strict=False)] = (0.25, 1.0)
    rise_limit_percent: Annotated[float, Field(ge=0, lt=100)] = 80.0
    max_pane_mm: Annotated[tuple[Positive, Positive], Field(strict=False)] | None = None
    zigzag_limit_deg: Annotated[float, Field(gt=0, le=180)] = 8.0
    fix: Literal["none", "boundary"] | VertexIds = "none"
    boundary: Boundary = "free"
    feature_angle_deg: Degrees | None = None
    max_movement_mm: Positive | None = None
    axes_only: bool = False
    max_lean_deg: Annotated[float, Field(gt=0, le=90)] | None = None
    families_of: Literal["panel", "edge"] = "panel"
    fit_tolerance_mm: Positive | None = None

    @model_validator(mode="after")
    def _has_goal(self) -> OptimizeSettings:
        if self.changed() and "goal" not in self.model_fields_set:
            raise ValueError(f"goal is missing; one of {', '.join(get_args(Goal))}")
        for key, goals in OPTIMIZE_OPTIONS.items():
            if key in self.changed() and self.goal not in goals:
                names = " or ".join(f'"{goal}"' for goal in goals)
                raise ValueError(f'{key} is for goal = {names}, not for "{self.goal}"')
        return self


class SupportSettings(Section):
    """[support]: the construction of the node axes, and how far they may lean.

    Attributes
    ----------
    kind : of the torsion-free structure; "auto" takes what the kind of net is made for (Koebe
        and minimal nets: "edge", K-nets: "normals"), else what the net allows. "normals" (surface
        normals) leaves torsion in every beam, so it needs a [checks] torsion_deg to match
    lean_limit_deg : angle between node axis and surface normal
    """

    kind: SupportKind = "auto"
    lean_limit_deg: Degrees = LEAN_LIMIT_DEG


def _section(value: str | list[list[float | int]]) -> Profile:
    return profile(value) if isinstance(value, str) else polygon(value)


class BeamSettings(Section):
    """[beam].

    Attributes
    ----------
    profile : designation ("FL 60x8", "RHS 120x60x5", "SHS 60x4", "T 60x60x7": depth x width
        [x thickness]) or corners [[y, z], ...] in mm, y across, z up
    eccentricity_mm : the profile's datum (top center) above the mesh edge, in the plane pi(e)
    end : "flat" (a plane parallel to the node axis) or "cope" (the node's cylinder)
    clearance_mm : between the cut and the node; 0.5 leaves room for paint and length tolerance
    bolt : a cross hole near each end for this bolt, or "none"
    min_length_mm : least length between the cuts
    density : kg/m3; default steel, EN 1991-1-1
    """

    profile: str | list[list[float | int]] = "FL 60x8"
    eccentricity_mm: Finite = 0.0
    end: Literal["flat", "cope"] = "flat"
    clearance_mm: NotNegative = 0.5
    bolt: BoltSize = "none"
    min_length_mm: Positive = 100.0
    density: Positive = density("steel")

    @field_validator("profile")
    @classmethod
    def _exists(cls, value: str | list[list[float | int]]) -> str | list[list[float | int]]:
        _section(value)
        return value

    def section(self) -> Profile:
        """The cross-section itself."""
        return _section(self.profile)


class NodeSettings(Section):
    """[node].

    Attributes
    ----------
    kind : one of the registry of nodes, such as "cylinder" (solid) or "tube"
    diameter_mm : "auto" = the least of the series that fits the whole project, or a number
    series_mm : diameters to choose from; empty: round bars EN 10060, or tubes EN 10210-2
    min_diameter_mm : "auto" takes no less: room for weld or bolt, and for the mark
    wall_mm : of a tube
    arm_clearance_mm : land left between neighbouring arms (seats) at the cylinder
    margin_mm, top_margin_mm : how far a node reaches below and above its arms' end faces
    height_step_mm : top and bottom are rounded outwards to multiples of it
    bolt : a radial hole for each arm, or "none"
    density : kg/m3; default steel, EN 1991-1-1
    """

    kind: str = "cylinder"
    diameter_mm: Literal["auto"] | Positive = "auto"
    series_mm: tuple[Positive, ...] = Field(default=(), strict=False)
    min_diameter_mm: NotNegative = 40.0
    wall_mm: Positive = 8.0
    arm_clearance_mm: NotNegative = 1.0
    margin_mm: NotNegative = 5.0
    top_margin_mm: NotNegative = 0.5
    height_step_mm: Positive = 1.0
    bolt: BoltSize = "none"
    density: Positive = density("steel")

    @classmethod
    def choices(cls) -> Mapping[str, Sequence[str]]:
        """The kinds by name."""
        return {"kind": nodes.names()}

    @field_validator("kind")
    @classmethod
    def _known(cls, value: str) -> str:
        if value not in nodes.names():
            raise ValueError(f'"{value}" is unknown; {suggestion(value, nodes.names())}')
        return value

    @model_validator(mode="after")
    def _own_keys(self) -> NodeSettings:
        for key in sorted(self.changed() - {"kind"}):
            if (kinds := nodes.kinds_of(key)) and self.kind not in kinds:
                shown = " or ".join(f'"{kind}"' for kind in kinds)
                raise ValueError(f'{key} is for kind = {shown}, not for "{self.kind}"')
        return self


class PanelSettings(Section):
    """[panel].

    Attributes
    ----------
    kind : "glass" or "none" (beams and nodes only)
    thickness_mm : of the pane; default 12, e.g. two 6 mm plies
    gap_mm : joint between neighbouring panes, half on each side of pi(e)
    gap_at : the level where a square-sided pane keeps the gap: "tightest" (nowhere less),
        "inner" or "outer" surface; mitred panes keep it everywhere
    offset_mm : inner surface above the mesh face; "auto": the least multiple of 5 mm that clears
        all beams and nodes by 3 mm, at most 60
    edge : "square" to the pane, or "mitred" (parallel to pi(e))
    corner_radius_mm : 0 leaves the corners sharp
    max_size_mm : smaller and larger side of the least rectangle; default jumbo stock, EN 572-2
    density : kg/m3; default glass, EN 572-1
    """

    kind: Literal["glass", "none"] = "glass"
    thickness_mm: Positive = 12.0
    gap_mm: NotNegative = 12.0
    gap_at: Literal["tightest", "inner", "outer"] = "tightest"
    offset_mm: Literal["auto"] | Finite = "auto"
    edge: Literal["square", "mitred"] = "square"
    corner_radius_mm: NotNegative = 0.0
    max_size_mm: tuple[Positive, Positive] = Field(default=stock_size(), strict=False)
    density: Positive = density("glass")


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


class Project(Section):
    """A whole project, validated. `file` is where it came from, None when made in Python."""

    project: GeneralSettings = GeneralSettings()
    net: NetSettings
    optimize: OptimizeSettings = OptimizeSettings()
    support: SupportSettings = SupportSettings()
    beam: BeamSettings = BeamSettings()
    node: NodeSettings = NodeSettings()
    panel: PanelSettings = PanelSettings()
    checks: CheckSettings = CheckSettings()
    output: OutputSettings = OutputSettings()
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
    def settings(self) -> dict[str, Any]:
        """Every section as plain values, for the manifest; without `jobs`."""
        return self.model_dump(mode="json", exclude={"output": {"jobs"}})

    def __repr__(self) -> str:
        source = self.net.file if self.net.file else self.net.kind
        panels = "no panels" if self.panel.kind == "none" else f"panels {self.panel.thickness_mm:g}"
        return f"Project({self.name}: {source}, {self.beam.section().name}, {panels})"

    __str__ = __repr__


def bolt_diameters(size: BoltSize) -> tuple[float, float] | None:
    """Nominal diameter and clearance hole [mm], or None for "none"."""
    return None if size == "none" else bolt_hole(size)
