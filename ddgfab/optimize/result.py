"""What an optimization did to a mesh: before and after, what it cost, on the way too."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Final, Self, TypeAlias

import numpy as np

from ddgfab.measures import Report, inspect
from ddgfab.mesh import Floats, Ints, Mesh
from ddgfab.optimize.change import Change

WORST: Final = 5
"""How many of the worst elements a report names."""


@dataclass(frozen=True)
class Step:
    """One step of a solver, a line of its history."""

    objective: float
    violation: float
    """Greatest residual of an equation after the step."""
    longest: float
    """Greatest movement, of a vertex or of an element of another block of unknowns."""
    length: float
    """Part of the proposed step that was taken."""


Progress: TypeAlias = Callable[[int, Step], None]
"""Called with the number of each step and what it did."""


@dataclass(frozen=True)
class Price:
    """What one degree of flatness costs: a point of the path to the goal.

    Attributes
    ----------
    percent : violation of the goal [%]; for planarity the distance of the diagonals over their mean
    distance_mean, distance_max : of the vertices from the surface, in the unit of the mesh
    movement_mean, movement_max : of the vertices
    """

    percent: float
    distance_mean: float
    distance_max: float
    movement_mean: float
    movement_max: float


@dataclass(frozen=True)
class Forecast:
    """What planar faces will cost, from one linear solve at the input. An estimate, not a bound.

    Attributes
    ----------
    unit : mean edge
    distance_mean : expected mean distance from the surface, in the unit of the mesh; true within a
        factor of two on the meshes it was measured on, above 0.075 mean edges with creases or
        flattened parts
    movement_mean : expected mean movement, overestimated up to 2.5 times
    stretch : greatest change of an edge over its length, overestimated where vertices slide far
    """

    unit: float
    distance_mean: float
    movement_mean: float
    stretch: float


@dataclass(frozen=True)
class Repetition:
    """How alike pieces are: before, in a result without the wish, in that with it.

    Attributes
    ----------
    of : "edge" or "panel"
    kinds : number of lengths or shapes that were wished for
    spread, most : how far lengths are from those of their kind [mean edges]: root mean square, most
    """

    of: str
    kinds: int
    spread: tuple[float, ...]
    most: tuple[float, ...]


@dataclass(frozen=True)
class WishPrice:
    """What a result without the wishes is like, and what came of them.

    Attributes
    ----------
    met_without : whether the goal is met within the limits without the wishes
    distance_mean, distance_max : from the surface without them, both ways, in the unit of the mesh
    """

    met_without: bool
    distance_mean: float
    distance_max: float
    repetitions: tuple[Repetition, ...]


@dataclass(frozen=True, eq=False)
class Trial:
    """One of the limits that a goal tries in turn, and what came of it.

    Attributes
    ----------
    limit : for people
    met : whether the goal was met within the limits
    distance_mean, distance_max : from the surface, both ways, in the unit of the mesh
    own : measures of this goal alone, as `OptimizeResult.own`
    """

    limit: str
    met: bool
    distance_mean: float
    distance_max: float
    own: dict[str, Any]


@dataclass(frozen=True, eq=False, repr=False)
class OptimizeResult:
    """A mesh before and after an optimization.

    Attributes
    ----------
    goal : its name
    status : "converged", or "missed": such a result comes only with an `OptimizeError`
    history : (stage, step) in order
    residual : greatest residual of the goal's equations (parts of diagonals, angles in rad)
    remarks : what else the reader should know, one line each
    surface : what distances are measured from; None: the original
    prices : what less flat results would cost, from coarse to fine
    forecast : what was expected before solving, or None
    advice : options to try next where the goal was missed, as (name, value)
    pane : lengths of the largest pane that was asked for; `original` is divided for it
    tried : what came of each limit that was tried, if there was more than one
    parts : (E,) into how many parts the edges of the mesh that was given were divided; None: not
    wishes : what came of equal edges or panels, and what they cost; None: nothing was wished for
    """

    goal: str
    mesh: Mesh
    original: Mesh
    status: str
    history: tuple[tuple[str, Step], ...]
    residual: float
    remarks: tuple[str, ...] = ()
    surface: Mesh | None = None
    prices: tuple[Price, ...] = ()
    forecast: Forecast | None = None
    advice: tuple[tuple[str, object], ...] = ()
    pane: tuple[float, float] | None = None
    tried: tuple[Trial, ...] = ()
    parts: Ints | None = None
    wishes: WishPrice | None = None

    def __repr__(self) -> str:
        return (
            f"OptimizeResult({self.goal}: {self.status}, moved {self.movement_max:.4g} at most, "
            f"residual {self.residual:.2g})"
        )

    def revised(self, **fields: Any) -> Self:
        """The result with other fields than meshes; measures that are known stay so."""
        made = replace(self, **fields)
        measures = ("before", "after", "change", "movement")
        made.__dict__.update({k: v for k, v in self.__dict__.items() if k in measures})
        return made

    @cached_property
    def before(self) -> Report:
        """Measures of the mesh before."""
        return inspect(self.original)

    @cached_property
    def after(self) -> Report:
        """Measures of the mesh after."""
        return inspect(self.mesh)

    @cached_property
    def change(self) -> Change:
        """What the optimization did to the design."""
        reference = self.original if self.surface is None else self.surface
        return Change(self.original, self.mesh, reference)

    @cached_property
    def movement(self) -> Floats:
        """(V,) how far each vertex moved, in the unit of the mesh."""
        moved: Floats = np.linalg.norm(self.mesh.vertices - self.original.vertices, axis=1)
        return moved

    @property
    def movement_max(self) -> float:
        """Greatest movement of a vertex."""
        return float(self.movement.max())

    @property
    def movement_mean(self) -> float:
        """Mean movement of the vertices that faces use."""
        return float(self.movement[self.original.valences > 0].mean())

    def own(self) -> dict[str, Any]:
        """Measures that only this goal has, ready for JSON."""
        return {}

    def own_lines(self) -> list[str]:
        """The same for people."""
        return []
