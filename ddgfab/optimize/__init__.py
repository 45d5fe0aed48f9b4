"""Optimization: an energy that keeps the design, equations of a goal, and the path between them."""

from __future__ import annotations

from ddgfab.measures import interior_angles
from ddgfab.optimize.change import Change
from ddgfab.optimize.diagonals import diagonal_net
from ddgfab.optimize.energy import Keep
from ddgfab.optimize.expectation import better_diagonals, expected
from ddgfab.optimize.families_goal import families
from ddgfab.optimize.families_result import FamiliesResult
from ddgfab.optimize.forecast import doubtful, forecast_text
from ddgfab.optimize.goal import Additions, NetGoal
from ddgfab.optimize.goals import Goal, optimize
from ddgfab.optimize.limits import Limits
from ddgfab.optimize.pane_groups import kept_groups
from ddgfab.optimize.path import Path, PathOptions, follow, settle
from ddgfab.optimize.problem import Layout, Problem, Term, mean_edge
from ddgfab.optimize.quality import Quality, folded_faces, roughness
from ddgfab.optimize.result import Forecast, OptimizeResult, Price, Step, Trial
from ddgfab.optimize.rim import Boundary
from ddgfab.optimize.torsion_goal import TorsionFreeResult

__all__ = [
    "Additions",
    "Boundary",
    "Change",
    "FamiliesResult",
    "Forecast",
    "Goal",
    "Keep",
    "Layout",
    "Limits",
    "NetGoal",
    "OptimizeResult",
    "Path",
    "PathOptions",
    "Price",
    "Problem",
    "Quality",
    "Step",
    "Term",
    "TorsionFreeResult",
    "Trial",
    "better_diagonals",
    "diagonal_net",
    "doubtful",
    "expected",
    "families",
    "folded_faces",
    "follow",
    "forecast_text",
    "interior_angles",
    "kept_groups",
    "mean_edge",
    "optimize",
    "roughness",
    "settle",
]
