"""Hubs: round bars or tubes about the node axis with plates on them, one in the plane of each beam.

As a star, but the plates are welded to the round surface and end there.
"""

from __future__ import annotations

import math
from collections.abc import Hashable
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from ddgfab.errors import DetailError
from fabrication.boundary import Boundary
from fabrication.parts.node import NODE
from fabrication.parts.star import Section, StarShape, at, gaps, star_boundary
from fabrication.solids.plate import Blank
from fabrication.specs import Kind, Loop
from fabrication.variants import key_of

HUB: Final = Kind(
    role=NODE.role,
    mark=NODE.mark,
    prefix="HP",
    title=NODE.title,
    color=NODE.color,
    finish=NODE.finish,
    form=NODE.form,
)


@dataclass(frozen=True, eq=False)
class HubShape(StarShape):
    """Plates from a cylinder or tube outwards, all as high as it is [mm].

    hub, bore : outside and inside RADIUS of the cylinder or tube; bore 0: solid
    weld : throat thickness of the fillet welds round the plates, which are not drawn
    """

    hub: float = 0.0
    bore: float = 0.0
    weld: float = 0.0

    def key(self) -> Hashable:
        """Sizes of plates, holes, mark and hub."""
        return (super().key(), *map(key_of, (self.hub, self.bore, self.weld)))

    def geometry(self) -> Boundary:
        """Exact boundary.

        Raises
        ------
        DetailError
            A hub that is not round, plates that meet before it, holes that leave them.
        """
        half = 0.5 * self.thickness
        if not (0.0 <= self.bore < self.hub < self.length and half < self.hub):
            raise DetailError(
                f"a hub of radius {self.hub:.6g} mm with a bore of radius {self.bore:.6g} mm and "
                f"plates {self.thickness:.6g} mm thick, {self.length:.6g} mm from the axis, is not "
                "a node"
            )
        narrow = min(gaps(self.azimuths))
        if narrow <= 2.0 * math.asin(half / self.hub):
            raise DetailError(
                f"plates at {math.degrees(narrow):.4g} deg meet outside the hub of radius "
                f"{self.hub:.6g} mm: widen it"
            )
        return star_boundary(self)

    def area(self) -> float:
        """Ring, and each plate beyond its circular segment [mm2]."""
        half = 0.5 * self.thickness
        root = math.sqrt(self.hub**2 - half**2)
        segment = self.hub**2 * math.asin(half / self.hub) - half * root
        plate = 2.0 * half * (self.length - root) - segment
        return math.pi * (self.hub**2 - self.bore**2) + len(self.azimuths) * plate

    def roots(self) -> list[float]:
        """All plates end at the hub."""
        return [self.hub] * len(self.azimuths)

    def section(self) -> Section:
        """The section across the axis: arcs of the hub between the plates."""
        half = 0.5 * self.thickness
        root, turn = math.sqrt(self.hub**2 - half**2), math.asin(half / self.hub)
        points: list[tuple[float, float]] = []
        bulges: list[float] = []
        right, left = [], []
        for azimuth, gap in zip(self.azimuths, gaps(self.azimuths), strict=True):
            right.append(len(points))
            left.append(len(points) + 2)
            points += [at(azimuth, far, -half) for far in (root, self.length)]
            points += [at(azimuth, self.length, half)]
            bulges += [0.0, 0.0, 0.0]
            free = gap - 2.0 * turn
            parts = math.ceil(free / math.pi)
            for k in range(parts):
                angle = azimuth + turn + free * k / parts
                points.append((self.hub * math.cos(angle), self.hub * math.sin(angle)))
                bulges.append(math.tan(free / parts / 4.0))
        outer = Loop(np.array(points), np.array(bulges))
        if not self.bore:
            return Section((outer,), right, left)
        ring = Loop(np.array([(self.bore, 0.0), (-self.bore, 0.0)]), np.array([-1.0, -1.0]))
        return Section((outer, ring), right, left)

    def circles(self) -> list[tuple[str, float, float]]:
        """Those of the hub and its bore."""
        opened = gaps(self.azimuths)
        widest = max(range(len(opened)), key=opened.__getitem__)
        middle = self.azimuths[widest] + 0.5 * opened[widest]
        found = [("hub_diameter_mm", self.hub, middle)]
        return [*found, ("hub_bore_mm", self.bore, middle + 0.3)] if self.bore else found

    def dimensions(self) -> dict[str, Any]:
        """Those of a star, and the hub's diameter."""
        return {
            **super().dimensions(),
            "hub_diameter_mm": 2.0 * self.hub,
            "plate_weld_mm": self.weld,
        }

    def described(self) -> str:
        """Bar and plates, for the parts list."""
        bar, length = self.stock()
        plate = f"{self.thickness:g} x {length:.1f} x {self.length - self.hub:.1f}"
        return f"{bar}, {length:.1f} long; {len(self.azimuths)} plates {plate}"

    def blanks(self) -> list[Blank]:
        """A plate for each arm, from the round surface outwards."""
        small, large = sorted((self.z1 - self.z0, self.length - self.hub))
        return [Blank("plate of a node", self.thickness, small, large)] * len(self.azimuths)

    def stock(self) -> tuple[str, float]:
        """Name of the bar that the hub is sawn from, and the length to saw [mm]."""
        name = f"round {2 * self.hub:g}"
        if self.bore:
            name = f"tube {2 * self.hub:g}x{self.hub - self.bore:g}"
        return name, self.z1 - self.z0
