"""Where the path of a large mesh begins: at the end of that of a coarser one."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Final

import numpy as np

from ddgfab.mesh import Floats, Ints, Mesh
from ddgfab.optimize.coarse import Coarse, coarsened
from ddgfab.optimize.frame import Frame
from ddgfab.optimize.goal import violation
from ddgfab.optimize.merit import Merit
from ddgfab.optimize.path import PathOptions, follow
from ddgfab.optimize.problem import Problem
from ddgfab.optimize.result import Progress

LEAST_FACES: Final = 4000
"""From this number of faces on a path begins at the end of that of a coarser mesh."""
_COARSEST: Final = 2000
"""Meshes of fewer faces are not made coarser."""
_TOLERANCE: Final = 2e-3
"""Violation that is enough for coarse meshes, times their mean edge in those of the mesh: the faces
of the same smooth surface are flatter by that factor on the mesh."""
_PENALTY, _PENALTY_FACES = 2.0**14, 10_000
"""Penalty to go on with, up to this number of faces: softer ones would let go of what was reached.
Beyond, it grows with the root of their number: movements get longer in edges, and cost more."""
_STEPS: Final = 12
"""Steps of a stage on coarse meshes, where they are cheap."""
_PARTS: Final = (1.0, 0.9, 0.7, 0.4)
"""Parts of a movement that are tried where it would fold the finer mesh."""


def onward(mesh: Mesh) -> PathOptions:
    """How a path goes on from a coarser mesh.

    What is left to do is smooth, long in the edges of a fine mesh, and dear; so the last of it is
    left to the polish.
    """
    more = max(1.0, mesh.n_faces / _PENALTY_FACES)
    return PathOptions(
        first_penalty=_PENALTY * float(np.sqrt(more)),
        longest_step=2.0,
        on_the_way=True,
        finish=6e-3,
    )


def nested_start(
    mesh: Mesh,
    pose: Callable[[Mesh, Frame, Ints], Problem],
    tolerance: float,
    progress: Progress,
) -> Floats | None:
    """(V, 3) movement to begin with, on the way from a coarser mesh; None where there is none.

    A coarse mesh that misses the goal is left out: the path begins on the next one. Which vertices
    a coarse mesh keeps depends on their order where no corner and no irregular vertex decides.

    Parameters
    ----------
    mesh : mean edge one
    pose : coarse mesh in its frame, that frame in the coordinates of `mesh`, (n,) numbers of its
        vertices in `mesh` -> its problem
    tolerance : violation at which the goal is met
    progress : called with the number of each step and what it did
    """
    levels: list[tuple[Coarse, Ints]] = []
    finer, numbers = mesh, np.arange(mesh.n_vertices)
    while not levels or finer.n_faces >= _COARSEST:
        coarse = coarsened(finer)
        if coarse is None:
            break
        finer, numbers = coarse.mesh, numbers[coarse.kept]
        levels.append((coarse, numbers))
    move: Floats | None = None
    for one, numbers in reversed(levels):
        frame = Frame.of(one.mesh)
        small = frame.inside(one.mesh)
        problem, options = pose(small, frame, numbers), PathOptions()
        begins = None if move is None else begun(problem, move / frame.unit)
        if begins is not None:
            problem, options = begins, replace(onward(small), steps_per_stage=_STEPS)
        path = follow(
            problem,
            partial(violation, problem),
            replace(options, tolerance=max(tolerance, _TOLERANCE) * max(1.0, frame.unit)),
            progress,
        )
        there = frame.unit * (problem.vertices(path.value) - small.vertices)
        move = one.prolonged(there) if path.status == "converged" else None
    return move


def begun(problem: Problem, move: Floats) -> Problem | None:
    """A problem with its free vertices moved by (V, 3) at the start, or by a part of that.

    None where even a small part is on the wrong side of a barrier.
    """
    free, merit = problem.free[: move.size], Merit(problem)
    for part in _PARTS:
        start = problem.start.copy()
        start[: move.size] += np.where(free, part * move.ravel(), 0.0)
        if merit.possible(start):
            return problem.with_start(start)
    return None
