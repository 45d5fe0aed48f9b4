"""A mesh with fewer families of congruent pieces, and how many there were."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ddgfab.mesh import Ints
from ddgfab.optimize.repetition import Piece
from ddgfab.optimize.result import OptimizeResult


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class FamiliesResult(OptimizeResult):
    """A mesh with fewer families.

    Attributes
    ----------
    of : "panel" or "edge"
    tolerance : what counts as equal, in the unit of the mesh
    labels_before, labels : (n,) family of each piece: the number of its first member
    """

    of: Piece
    tolerance: float
    labels_before: Ints
    labels: Ints

    @property
    def families_before(self) -> int:
        """Number of families of the input."""
        return len(np.unique(self.labels_before))

    @property
    def families(self) -> int:
        """Number of families of the result."""
        return len(np.unique(self.labels))

    def own(self) -> dict[str, Any]:
        """Numbers of families."""
        return {
            "families_of": self.of,
            "families_before": self.families_before,
            "families_after": self.families,
            "fit_tolerance": float(self.tolerance),
        }

    def own_lines(self) -> list[str]:
        """The same for people."""
        return [
            f"families of {self.of}s within {self.tolerance:.3g}: {self.families_before} "
            f"before, {self.families} after"
        ]
