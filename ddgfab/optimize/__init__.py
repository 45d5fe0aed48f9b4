"""Optimisation: terms on the vertices of a mesh, solved together, and recipes made of them."""

from __future__ import annotations

from ddgfab.optimize.problem import Layout, Problem, Term, mean_edge
from ddgfab.optimize.solve import Solution, SolveOptions, Step, solve

__all__ = [
    "Layout",
    "Problem",
    "Solution",
    "SolveOptions",
    "Step",
    "Term",
    "mean_edge",
    "solve",
]
