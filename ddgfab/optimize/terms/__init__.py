"""Terms: what a mesh should be, each as residuals with a sparse Jacobian and a weight."""

from __future__ import annotations

from ddgfab.optimize.terms.base import LinearTerm, LocalTerm, VectorTerm, widened
from ddgfab.optimize.terms.planarity import Planarity, planarity_terms
from ddgfab.optimize.terms.shape import closeness, fairness, laplacian_fairness, strain

__all__ = [
    "LinearTerm",
    "LocalTerm",
    "Planarity",
    "VectorTerm",
    "closeness",
    "fairness",
    "laplacian_fairness",
    "planarity_terms",
    "strain",
    "widened",
]
