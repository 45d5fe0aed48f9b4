"""Sections of a gridshell's project about its net: size, source, optimisation, node axes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, Final, Literal, get_args

from pydantic import Field, field_validator, model_validator

from ddgfab.forms.registry import kinds
from ddgfab.io import Unit, Up, to_millimetres
from ddgfab.optimize import Boundary, Goal, Keep
from ddgfab.optimize.wishes import EQUAL_WEIGHT
from ddgfab.suggest import suggestion
from ddgfab.support import SupportKind
from ddgfab.surfaces.analytic import SURFACES
from ddgfab.tolerances import LEAN_LIMIT_DEG
from fabrication.project.sections import (
    Degrees,
    Finite,
    NotNegative,
    Positive,
    Section,
    TitleSettings,
)

VertexIds = Annotated[tuple[Annotated[int, Field(ge=0)], ...], Field(strict=False)]

FaceNumber = Annotated[int, Field(ge=0)]
FaceList = Annotated[tuple[FaceNumber | str, ...], Field(strict=False)]

MESH: Final = "mesh"
"""The kind of net that is read from a file."""

SURFACE: Final = "surface"
"""The kind of net that is traced on a surface; all others are generated."""


class GeneralSettings(TitleSettings):
    """[project]: the name, the title block, and the size of the input.

    Attributes
    ----------
    units : of the input's coordinates; none: what the file states in a comment, else millimetres
    scale : factor on the input's coordinates, before units
    median_edge_mm : instead of scale and units: the median edge becomes this long
    """

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
    face : "surface": which face of the file: its number from 0, its name, several of them as a
        list (one net a face, kept together along their borders), or "all"
    along : "surface": normal of planes; one family is the sections, the other conjugate to it
    turn_deg : "surface": angle of one family to the principal directions, the other is conjugate
    curves : "surface": DXF, OBJ or CSV file of curves [mm] that one family follows, the other is
        conjugate to them; relative to the project file
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
    face: FaceNumber | str | FaceList | None = None
    along: Annotated[tuple[Finite, Finite, Finite], Field(strict=False)] | None = None
    turn_deg: Finite | None = None
    curves: Path | None = Field(default=None, strict=False)
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
    "stretch_limit_percent": _SHAPES,
    "max_pane_mm": _SHAPES,
    "diagonals": _SHAPES,
    "equal_edges": _SHAPES,
    "equal_panels": _SHAPES,
    "equal_weight": _SHAPES,
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
    stretch_limit_percent : more than one edge in twenty that becomes longer, or shorter, by a
        greater part is an error
    diagonals : take the net of the diagonals of the faces, which may be planar near surfaces
        where the mesh cannot; edges become quads, edges of the boundary triangles
    equal_edges, equal_panels : number of lengths that edges, or of shapes that panels, are drawn
        to: a wish, whose price in distance the report names; 0: none
    equal_weight : of these wishes, against the distance from the surface, which has 1
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
    diagonals: bool = False
    equal_edges: Annotated[int, Field(ge=0)] = 0
    equal_panels: Annotated[int, Field(ge=0)] = 0
    equal_weight: Positive = EQUAL_WEIGHT
    zigzag_limit_deg: Annotated[float, Field(gt=0, le=180)] = 6.0
    stretch_limit_percent: Annotated[float, Field(gt=0, le=1000)] = 60.0
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
