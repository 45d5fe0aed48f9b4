"""Optimisation: terms on the vertices of a mesh, solved together, and recipes made of them."""

from __future__ import annotations

from ddgfab.optimize.goals import Goal, optimize
from ddgfab.optimize.problem import Layout, Problem, Term, mean_edge
from ddgfab.optimize.quality import Quality, folded_faces, interior_angles, roughness
from ddgfab.optimize.recipes import Boundary, RecipeOptions, circularize, conicalize, planarize
from ddgfab.optimize.result import OptimizeResult
from ddgfab.optimize.solve import Solution, SolveOptions, Step, polish, solve

__all__ = [
    "Boundary",
    "Goal",
    "Layout",
    "OptimizeResult",
    "Problem",
    "Quality",
    "RecipeOptions",
    "Solution",
    "SolveOptions",
    "Step",
    "Term",
    "circularize",
    "conicalize",
    "folded_faces",
    "interior_angles",
    "mean_edge",
    "optimize",
    "planarize",
    "polish",
    "roughness",
    "solve",
]
