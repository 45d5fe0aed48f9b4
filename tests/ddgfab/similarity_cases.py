"""Similarities of space, under which every transform and measure has to do what it should."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from ddgfab.mesh import Floats, Mesh

EPS = float(np.finfo(np.float64).eps)


@dataclass(frozen=True, eq=False)
class Similarity:
    """x -> scale turn x + shift; turn is orthogonal, a reflection has determinant -1."""

    name: str
    scale: float
    turn: Floats
    shift: Floats

    def __call__(self, points: Floats) -> Floats:
        return self.vectors(points, 1) + self.shift

    def vectors(self, values: Floats, power: int = 1) -> Floats:
        """Turned, and multiplied by a power of the scale."""
        return np.asarray(values @ self.turn.T * self.scale**power)

    @property
    def mirrors(self) -> bool:
        return float(np.linalg.det(self.turn)) < 0

    def mesh(self, mesh: Mesh) -> Mesh:
        """The image of a mesh; a reflection turns its faces round, so that outside stays so."""
        faces = [face[::-1] if self.mirrors else face for face in mesh.faces]
        return Mesh.build(self(mesh.vertices), faces)

    @property
    def rounding(self) -> float:
        """Relative error of coordinates of size 1 after the map: far from the origin, and turned
        by a matrix that is orthogonal to rounding only."""
        return EPS * (1.0 + float(np.linalg.norm(self.shift)) / self.scale)


TURN = Rotation.from_rotvec([0.3, -0.8, 0.5]).as_matrix()
NOWHERE = np.zeros(3)
SIMILARITIES = [
    *(
        Similarity(f"scale {s:g}", s, np.eye(3), NOWHERE)
        for s in (1e-6, 1e-3, 0.7, 304.8, 1e6, 1e9)
    ),
    Similarity("motion", 1.0, TURN, np.array([3.0, -2.0, 7.0])),
    Similarity(
        "eighth of a turn", 1.0, Rotation.from_rotvec([0, 0, np.pi / 4]).as_matrix(), NOWHERE
    ),
    Similarity("reflection", 1.0, np.diag([1.0, 1.0, -1.0]), NOWHERE),
    Similarity(
        "mirror and turn", 2.0, TURN @ np.diag([-1.0, 1.0, 1.0]), np.array([-5.0, 1.0, 4.0])
    ),
    Similarity("far", 1.0, np.eye(3), np.array([4e5, 5.4e6, 120.0])),
    Similarity("far and small", 1e-3, TURN, np.array([4e2, 5.4e3, 120.0])),
]
"""By name; "far" are coordinates of a national grid in metres."""
