"""Limits beyond which a result is no longer the design, and what is said when they are exceeded."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from ddgfab.errors import InputError
from ddgfab.mesh import Floats, Ints
from ddgfab.optimize.change import Change

_NAMED: Final = 5
"""How many of the worst elements a message names."""


@dataclass(frozen=True)
class Limits:
    """What a result may cost; more misses the goal.

    Attributes
    ----------
    distance_mean, distance_max : between result and surface, in mean edges, of both directions
    movement : of a vertex, in the unit of the mesh; None: no limit
    reflex_quads : how many quads may get a reflex corner
    """

    distance_mean: float = 0.25
    distance_max: float = 1.0
    movement: float | None = None
    reflex_quads: int = 0

    def __post_init__(self) -> None:
        for name in ("distance_mean", "distance_max"):
            if not getattr(self, name) > 0:
                raise InputError(f"limit {name} = {getattr(self, name):g}: must be positive")
        if self.movement is not None and not self.movement > 0:
            raise InputError(f"max_movement = {self.movement:g}: must be positive")

    def exceeded(self, change: Change) -> tuple[str, ...]:
        """One sentence for each limit that a result exceeds."""
        out = []
        edge = change.edge
        for name, value, limit in (
            ("mean", change.distance_mean, self.distance_mean),
            ("greatest", change.distance_max, self.distance_max),
        ):
            if value > limit * edge:
                out.append(
                    f"{name} distance from the surface {value:.4g} ({value / edge:.2f} mean edges, "
                    f"limit {limit:g}), farthest vertices {named(change.from_surface)}"
                )
        if self.movement is not None and change.movement.max() > self.movement:
            out.append(
                f"vertices move by up to {change.movement.max():.4g} (limit {self.movement:.4g}), "
                f"most at vertices {named(change.movement)}"
            )
        if len(change.reflex_quads) > self.reflex_quads:
            out.append(
                f"{len(change.reflex_quads)} quads have a reflex corner that had none: faces "
                f"{ids(change.reflex_quads)}"
            )
        if len(change.folded):
            out.append(f"{len(change.folded)} faces fold or collapse: {ids(change.folded)}")
        return tuple(out)


def named(values: Floats) -> str:
    """The ids of the greatest values, with the values."""
    order = np.argsort(-values, kind="stable")[:_NAMED].tolist()
    return ", ".join(f"{v} ({values[v]:.3g})" for v in order)


def ids(elements: Ints) -> str:
    """The first ids, and that there are more."""
    text = ", ".join(map(str, elements[:_NAMED].tolist()))
    return text + (", ..." if len(elements) > _NAMED else "")
