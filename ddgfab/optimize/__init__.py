"""Optimisation: terms on the vertices of a mesh, solved together, and recipes made of them."""

from __future__ import annotations

from ddgfab.measures import interior_angles
from ddgfab.optimize.families import FamiliesResult, families
from ddgfab.optimize.goals import Goal, optimize
from ddgfab.optimize.problem import Layout, Problem, Term, mean_edge
from ddgfab.optimize.quality import Quality, folded_faces, roughness
from ddgfab.optimize.recipes import Boundary, circularize, conicalize, planarize
from ddgfab.optimize.result import OptimizeResult
from ddgfab.optimize.solve import Solution, SolveOptions, Step, polish, solve
from ddgfab.optimize.torsion_free import TorsionFreeResult, torsion_free
from ddgfab.optimize.trials import RecipeOptions

__all__ = [
    "Boundary",
    "FamiliesResult",
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
    "TorsionFreeResult",
    "circularize",
    "conicalize",
    "families",
    "folded_faces",
    "interior_angles",
    "mean_edge",
    "optimize",
    "planarize",
    "polish",
    "roughness",
    "solve",
    "torsion_free",
]
