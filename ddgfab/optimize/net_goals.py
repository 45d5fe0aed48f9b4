"""The goals that are equations of the vertices alone: planar, circular, conical faces."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np

from ddgfab.mesh import Ints, Mesh
from ddgfab.optimize.energy import FREE_CORNER, Weights
from ddgfab.optimize.goal import NetGoal
from ddgfab.optimize.quality import reflex_faces
from ddgfab.optimize.terms import (
    circularity_terms,
    cone_terms,
    conicality_terms,
    planarity_terms,
)

FLAT_PERCENT: Final = 0.2
"""How flat faces are made by default: what a pane of glass takes up."""

_QUAD: Final = 4


def _bent_quads(mesh: Mesh) -> Ints:
    """Quads with a reflex corner at an inner vertex."""
    bad = reflex_faces(mesh, np.flatnonzero(~mesh.boundary_vertex))
    found: Ints = bad[mesh.face_sizes[bad] == _QUAD]
    return found


def _free_corners(weights: Weights) -> Weights:
    """Corners of the boundary may move."""
    return replace(weights, corner=FREE_CORNER)


PLANAR: Final = NetGoal(
    "planar",
    lambda m, _: planarity_terms(m),
    FLAT_PERCENT,
    "Liu, Pottmann, Wallner, Yang, Wang 2006, section 3; mathematics.md 8.5",
)
CIRCULAR: Final = NetGoal(
    "circular",
    lambda m, _: (*planarity_terms(m), *circularity_terms(m)),
    0.0,
    "Bobenko, Suris, Discrete Differential Geometry, 3.1; mathematics.md 2",
    crooked=reflex_faces,
    weights=_free_corners,
)
CONICAL: Final = NetGoal(
    "conical",
    lambda m, _: (*planarity_terms(m), *conicality_terms(m), *cone_terms(m)),
    0.0,
    "Liu, Pottmann, Wallner, Yang, Wang 2006, section 4; mathematics.md 2.9",
    crooked=_bent_quads,
    weights=_free_corners,
)
