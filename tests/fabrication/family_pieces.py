"""Single panels, beams and nodes for the tests of families."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from ddgfab.mesh import Floats
from fabrication.gridshell.pieces import Beam, Node, Panel
from fabrication.parts.beam import BeamShape, EndCut
from fabrication.parts.node import NodeShape, Seat
from fabrication.parts.panel import PanelShape
from fabrication.specs import Family
from fabrication.standards import profile


def motion(seed: int) -> Floats:
    rng = np.random.default_rng(seed)
    m = np.eye(4)
    m[:3, :3] = Rotation.random(random_state=rng).as_matrix()
    m[:3, 3] = rng.uniform(-5000, 5000, 3)
    return m


def panel(face: int, inner: Floats, outer: Floats | None = None, thickness: float = 10.0) -> Panel:
    shape = PanelShape(thickness, inner, inner if outer is None else outer)
    return Panel(f"P-{face:04d}", face, 0.0, 0.0, "flat", (), shape, motion(face))


def beam(edge: int, start: EndCut, end: EndCut, section: str = "FL 60x8") -> Beam:
    shape = BeamShape(profile(section), start, end)
    mark = f"B-{edge:04d}"
    return Beam(mark, edge, (0, 1), ("", ""), (None, None), 1.0, 0.0, shape, motion(edge))


def node(vertex: int, azimuths: list[float], z0: float = -60.0, radius: float = 20.0) -> Node:
    seats = tuple(Seat(a, 19.0, 8.0) for a in azimuths)
    shape = NodeShape(radius, 0.0, z0, z0 + 65, seats)
    m = motion(vertex)
    return Node(f"N-{vertex:04d}", vertex, m[:3, 3], m[:3, 2], 0.0, (), shape, m)


def marks(found: tuple[Family, ...]) -> list[list[str]]:
    return [[i.mark for i in f.instances] for f in found]
