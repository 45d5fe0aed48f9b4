"""What a recipe did to a mesh: before and after, movement, history, remarks."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ddgfab.measures import Report, inspect
from ddgfab.mesh import Floats, Mesh
from ddgfab.optimize.solve import Step


@dataclass(frozen=True, eq=False, repr=False)
class OptimizeResult:
    """A mesh before and after an optimisation.

    Attributes
    ----------
    goal : name of the recipe
    status : "converged", or why not: such a result comes only with an `OptimizeError`
    history : (stage, step) in order; a stage is one stiffness, or the last digits
    residual : greatest residual of the hard terms (parts of diagonals, angles in rad)
    remarks : wishes that were not granted, one line each; empty when all were
    """

    goal: str
    mesh: Mesh
    original: Mesh
    status: str
    history: tuple[tuple[str, Step], ...]
    residual: float
    remarks: tuple[str, ...] = ()

    def __repr__(self) -> str:
        return (
            f"OptimizeResult({self.goal}: {self.status}, moved {self.movement_max:.4g} at most, "
            f"residual {self.residual:.2g})"
        )

    @cached_property
    def before(self) -> Report:
        """Measures of the mesh before."""
        return inspect(self.original)

    @cached_property
    def after(self) -> Report:
        """Measures of the mesh after."""
        return inspect(self.mesh)

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
