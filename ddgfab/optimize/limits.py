"""Limits beyond which a result is no longer the design, and the messages when they are exceeded."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from ddgfab.errors import InputError
from ddgfab.mesh import Floats, Ints, Mesh
from ddgfab.optimize.change import Change
from ddgfab.optimize.pane_size import FIT, misfit, pane_limit, pane_sizes

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
    rise : least part of its rise that a mesh keeps; it may not grow by more than the inverse
    zigzag : by how much more than before the bend at an edge may differ from the bends beside it
        [rad, root mean square]: more is a crumpled mesh
    stretch : part by which edges may become longer or shorter, but for one in twenty each way
    pane : lengths of the largest pane, in the unit of the mesh; None: no limit
    """

    distance_mean: float = 0.25
    distance_max: float = 1.0
    movement: float | None = None
    reflex_quads: int = 0
    rise: float = 0.8
    zigzag: float = math.radians(6.0)
    stretch: float = 0.6
    pane: tuple[float, float] | None = None

    @staticmethod
    def given(distance: tuple[float, float] | None, **others: Any) -> Limits:
        """Limits with the greatest distances, mean and greatest, where they are given."""
        if distance is None:
            return Limits(**others)
        return Limits(distance_mean=distance[0], distance_max=distance[1], **others)

    def __post_init__(self) -> None:
        for name in ("distance_mean", "distance_max", "zigzag", "stretch"):
            if not getattr(self, name) > 0:
                raise InputError(f"limit {name} = {getattr(self, name):g}: must be positive")
        if not 0 <= self.rise < 1:
            raise InputError(f"limit rise = {self.rise:g}: a part of the rise, 0 to 1")
        if self.pane is not None:
            pane_limit(self.pane)
        if self.movement is not None and not self.movement > 0:
            raise InputError(f"max_movement = {self.movement:g}: must be positive")

    def exceeded(self, change: Change) -> tuple[str, ...]:
        """One sentence for each limit that a result exceeds."""
        return tuple(text for _, text in self._found(change))

    def kinds(self, change: Change) -> frozenset[str]:
        """Which limits a result exceeds: "distance", "rise", "zigzag", "movement", ..."""
        return frozenset(kind for kind, _ in self._found(change))

    def _found(self, change: Change) -> list[tuple[str, str]]:
        out: list[tuple[str, str]] = []
        edge = change.edge
        for name, value, limit in (
            ("mean", change.distance_mean, self.distance_mean),
            ("greatest", change.distance_max, self.distance_max),
        ):
            if value > limit * edge:
                out.append(
                    (
                        "distance",
                        f"{name} distance from the surface {value:.4g} ({value / edge:.2f} mean "
                        f"edges, limit {limit:g}), farthest vertices {named(change.from_surface)}",
                    )
                )
        out += self._shape(change)
        out += self._edges(change)
        if self.pane is not None:
            out += self._panes(change.after, self.pane)
        if self.movement is not None and change.movement.max() > self.movement:
            out.append(
                (
                    "movement",
                    f"vertices move by up to {change.movement.max():.4g} (limit "
                    f"{self.movement:.4g}), most at vertices {named(change.movement)}",
                )
            )
        if len(change.reflex_quads) > self.reflex_quads:
            out.append(
                (
                    "reflex",
                    f"{len(change.reflex_quads)} quads have a reflex corner that had none: faces "
                    f"{ids(change.reflex_quads)}",
                )
            )
        if len(change.folded):
            out.append(
                ("folded", f"{len(change.folded)} faces fold or collapse: {ids(change.folded)}")
            )
        return out

    def _edges(self, change: Change) -> list[tuple[str, str]]:
        """Edges that became much longer or shorter: panes are no longer of the size they were."""
        low, _, high = change.edge_stretch
        if 1 - self.stretch <= low and high <= 1 + self.stretch:
            return []
        ratio = change.edge_ratios
        text = (
            f"edges are stretched: 5 of 100 to {low:.2f} of their length or less, 5 of 100 to "
            f"{high:.2f} or more (limits {max(1 - self.stretch, 0.0):.2g} and "
            f"{1 + self.stretch:.3g}), longest by edges {named(ratio)}"
        )
        return [("stretch", text)]

    def _panes(self, mesh: Mesh, limit: tuple[float, float]) -> list[tuple[str, str]]:
        over = misfit(mesh, limit)
        large = np.flatnonzero(over > 1 + FIT)
        if not len(large):
            return []
        worst = int(over.argmax())
        short, long = pane_sizes(mesh, limit)[worst]
        text = (
            f"{len(large)} faces are larger than a pane of {limit[0]:g} x {limit[1]:g}: "
            f"{ids(large)}; the largest, face {worst}, needs {short:.4g} x {long:.4g}"
        )
        return [("pane", text)]

    def _shape(self, change: Change) -> list[tuple[str, str]]:
        """What is wrong with the shape: rise lost or gained, crumpled."""
        out = []
        kept = change.rise_kept
        if kept is not None and not self.rise <= kept <= 1 / max(self.rise, 1e-3):
            word = "only " if kept < 1 else ""
            limit = self.rise if kept < 1 else 1 / self.rise
            out.append(
                (
                    "rise",
                    f"{word}{100 * kept:.0f} % of the rise is left (limit {100 * limit:.0f} %)",
                )
            )
        before, after = change.zigzag
        if after > before + self.zigzag:
            rough = np.degrees(change.zigzags[1] - change.zigzags[0])
            out.append(
                (
                    "zigzag",
                    f"the mesh is crumpled: bends at edges differ from those beside them by "
                    f"{np.degrees(after):.1f} deg (root mean square; before "
                    f"{np.degrees(before):.1f}, limit {np.degrees(self.zigzag):.2g} more), "
                    f"most at edges {named(rough)}",
                )
            )
        return out


def named(values: Floats) -> str:
    """The ids of the greatest values, with the values."""
    order = np.argsort(-values, kind="stable")[:_NAMED].tolist()
    return ", ".join(f"{v} ({values[v]:.3g})" for v in order)


def ids(elements: Ints) -> str:
    """The first ids, and that there are more."""
    text = ", ".join(map(str, elements[:_NAMED].tolist()))
    return text + (", ..." if len(elements) > _NAMED else "")
