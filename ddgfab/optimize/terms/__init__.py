"""Terms: what a mesh should be, each as residuals with a sparse Jacobian and a weight."""

from __future__ import annotations

from ddgfab.optimize.terms.angles import AngleSums, circularity_terms, conicality_terms
from ddgfab.optimize.terms.base import LinearTerm, LocalTerm, VectorTerm, widened
from ddgfab.optimize.terms.cones import Cones, cone_terms
from ddgfab.optimize.terms.edges import (
    Lengths,
    SideDifferences,
    edge_lengths,
    opposite_sides,
    panel_size,
)
from ddgfab.optimize.terms.nets import (
    CornerLimits,
    Crossings,
    StarVolumes,
    corner_angle_limits,
    orthogonality,
    plane_stars,
)
from ddgfab.optimize.terms.places import (
    OnCurve,
    OnSurface,
    boundary_glide,
    on_curve,
    on_surface,
)
from ddgfab.optimize.terms.planarity import Planarity, planarity_terms
from ddgfab.optimize.terms.shape import closeness, fairness, laplacian_fairness, strain

__all__ = [
    "AngleSums",
    "Cones",
    "CornerLimits",
    "Crossings",
    "Lengths",
    "LinearTerm",
    "LocalTerm",
    "OnCurve",
    "OnSurface",
    "Planarity",
    "SideDifferences",
    "StarVolumes",
    "VectorTerm",
    "boundary_glide",
    "circularity_terms",
    "closeness",
    "cone_terms",
    "conicality_terms",
    "corner_angle_limits",
    "edge_lengths",
    "fairness",
    "laplacian_fairness",
    "on_curve",
    "on_surface",
    "opposite_sides",
    "orthogonality",
    "panel_size",
    "planarity_terms",
    "plane_stars",
    "strain",
    "widened",
]
