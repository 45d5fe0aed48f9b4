"""Where the path of a large mesh begins: at the end of that of a coarser one."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Final

import numpy as np

from ddgfab.mesh import Floats, Ints, Mesh
from ddgfab.optimize.coarse import coarsened
from ddgfab.optimize.frame import Frame
from ddgfab.optimize.goal import violation
from ddgfab.optimize.merit import Merit
from ddgfab.optimize.path import PathOptions, follow
from ddgfab.optimize.problem import Problem
from ddgfab.optimize.result import Progress

LEAST_FACES: Final = 4000
"""From this number of faces on a path begins at the end of that of a coarser mesh."""
_COARSEST: Final = 1600
"""Meshes of fewer faces are not made coarser."""
_TOLERANCE: Final = 2e-3
"""Violation that is enough for coarse meshes, times their mean edge in those of the mesh: the faces
of the same smooth surface are flatter by that factor on the mesh."""
NESTED: Final = PathOptions(first_penalty=2.0**14, longest_step=2.0, on_the_way=True)
"""How a path goes on from a coarser mesh: softer penalties would let go of what was reached, and
what is left to do is smooth and long in the edges of a fine mesh."""


def nested_start(
    mesh: Mesh,
    pose: Callable[[Mesh, Frame, Ints], Problem],
    tolerance: float,
    progress: Progress,
) -> Floats | None:
    """(V, 3) vertices to begin with, on the way from a coarser mesh; None where there is none.

    None too where the coarse mesh misses the goal. Which vertices a coarse mesh keeps depends on
    their order where no corner and no irregular vertex decides.

    Parameters
    ----------
    mesh : mean edge one
    pose : coarse mesh in its frame, that frame in the coordinates of `mesh`, (n,) numbers of its
        vertices in `mesh` -> its problem
    tolerance : violation at which the goal is met
    progress : called with the number of each step and what it did
    """
    coarse = coarsened(mesh)
    if coarse is None:
        return None
    levels = [(mesh, coarse)]
    while levels[-1][1].mesh.n_faces >= _COARSEST:
        finer = levels[-1][1].mesh
        further = coarsened(finer)
        if further is None:
            break
        levels.append((finer, further))
    move: Floats | None = None
    for level in range(len(levels) - 1, -1, -1):
        fine, one = levels[level]
        numbers = one.kept
        for _, finer_one in levels[:level][::-1]:
            numbers = finer_one.kept[numbers]
        frame = Frame.of(one.mesh)
        small = frame.inside(one.mesh)
        problem = pose(small, frame, numbers)
        options = PathOptions()
        if move is not None:
            problem, options = begun(problem, move / frame.unit), NESTED
        path = follow(
            problem,
            partial(violation, problem),
            replace(options, tolerance=max(tolerance, _TOLERANCE) * max(1.0, frame.unit)),
            progress,
        )
        if path.status != "converged":
            return None
        there = frame.unit * (problem.vertices(path.value) - small.vertices)
        move = one.prolonged(there, fine.n_vertices)
    assert move is not None
    return mesh.vertices + move


def begun(problem: Problem, move: Floats) -> Problem:
    """A problem with its free vertices moved by (V, 3) at the start."""
    free = problem.free[: move.size]
    start = problem.start.copy()
    start[: move.size] += np.where(free, move.ravel(), 0.0)
    return problem.with_start(start)


def usable(problem: Problem, before: float) -> bool:
    """Whether a start is on the right side of all barriers, and nearer to the goal than before."""
    return Merit(problem).possible(problem.start) and violation(problem, problem.start) < before
