"""Sparse symmetric systems that are factored once and solved for several right sides."""

from __future__ import annotations

from typing import Any

from scipy.sparse import csc_array
from scipy.sparse.linalg import SuperLU, splu

from ddgfab.arguments import checked


@checked
def factored(matrix: Any) -> SuperLU:
    """Factors of a positive definite or quasi-definite sparse matrix; `solve` uses them.

    Such matrices need no pivoting, so that the ordering that keeps the factors sparse is kept
    (minimum degree on A + A^T; Li 2005, An overview of SuperLU). Systems that may be
    indefinite (Newton steps of `curvature.area_newton` and `support.nearest_axes`) are solved with
    pivots there; large ones of the path solver have orderings of their own, see
    `ddgfab.optimize.linear`.

    Raises
    ------
    RuntimeError
        The matrix is exactly singular.
    """
    return splu(
        csc_array(matrix),
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )
