"""Recipes: planarize, circularize, conicalize a mesh, close to the design and fair (`trials`)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Literal, get_args

import numpy as np

from ddgfab.errors import InputError, OptimizeError
from ddgfab.mesh import Floats, Ints, Mesh
from ddgfab.optimize.problem import Term, mean_edge
from ddgfab.optimize.result import OptimizeResult
from ddgfab.optimize.solve import missed_words
from ddgfab.optimize.terms import (
    boundary_glide,
    circularity_terms,
    cone_terms,
    conicality_terms,
    planarity_terms,
)
from ddgfab.optimize.trials import (
    RecipeOptions,
    StageProgress,
    Task,
    Trial,
    climb,
    crooked_faces,
    without_noise,
)

Boundary = Literal["free", "glide", "fixed"]
"""What boundary vertices may do."""

_NAMED = 5
"""How many folded faces a message names."""
_FAR = 0.1
"""Movements beyond this part of the mesh's diameter change the design, not only its faces."""


def _run(
    task: Task, original: Mesh, back: Callable[[Mesh], tuple[Mesh, Floats]], throw: bool
) -> OptimizeResult:
    """Try stiffnesses; carry the best mesh back to the unit and place of the input."""
    best, history = climb(task)
    failed = best.failed(task.options.accepted)
    far = best.moved / task.mesh.diameter
    remarks = best.remarks
    if far > _FAR:
        remarks += (
            f"vertices move by up to {100 * far:.0f} % of the diameter: the design is far from "
            "such a net; let its edges follow other directions",
        )
    mesh, rounded = back(best.mesh)
    residual = _residual(task.hard, rounded)
    result = OptimizeResult(
        task.goal,
        mesh,
        original,
        "missed" if failed else "converged",
        history,
        residual,
        remarks,
    )
    if failed and throw:
        raise OptimizeError(_complaint(task, best), result=result)
    return result


def _residual(hard: tuple[Term, ...], vertices: Floats) -> float:
    """Greatest residual of hard terms."""
    return max((float(np.abs(t.residual(vertices.ravel())).max()) for t in hard), default=0.0)


def _complaint(task: Task, best: Trial) -> str:
    """Worst elements, limits, and what pulls against the goal."""
    accepted, x = task.options.accepted, best.mesh.vertices.ravel()
    lines = [words for term in task.hard if (words := missed_words(term, x, accepted))]
    if len(best.folded):
        names = ", ".join(map(str, best.folded[:_NAMED].tolist()))
        bad = "fold or collapse" if task.goal == "planarize" else "fold, collapse or are not convex"
        lines.append(f"{len(best.folded)} faces {bad}: {names}")
    held = len(task.fixed)
    way = (
        f"{held} of {task.mesh.n_vertices} vertices are fixed, as are the corners of a gliding "
        "boundary, and pull against it: let the boundary go free, or fix fewer"
        if held
        else "the design is far from such a net: follow its principal directions with the edges, "
        "or use a finer mesh"
    )
    return (
        f"{task.goal}: {'; '.join(lines)}\n{way}\n"
        f"the best mesh reached moves vertices by {best.moved:.3g} mean edges at most; it "
        "is kept apart and not taken"
    )


def _recipe(
    goal: str,
    mesh: Mesh,
    terms: Callable[[Mesh], tuple[Term, ...]],
    smooth: bool,
    *,
    fixed: Sequence[int] | Ints,
    boundary: Boundary,
    features: Sequence[int] | Ints | None,
    surface: Mesh | None,
    options: RecipeOptions | None,
    throw: bool,
    progress: StageProgress | None,
) -> OptimizeResult:
    if boundary not in get_args(Boundary):
        raise InputError(f"boundary {boundary!r}; one of {', '.join(get_args(Boundary))}")
    chosen = options or RecipeOptions()
    centre, unit = mesh.vertices[mesh.corners].mean(axis=0), mean_edge(mesh)
    if chosen.max_movement is not None:
        chosen = replace(chosen, max_movement=chosen.max_movement / unit)
    small = mesh.with_vertices((mesh.vertices - centre) / unit)
    hard = terms(small)
    held = _ids(fixed, mesh.n_vertices, "fixed vertex")
    rim = np.flatnonzero(mesh.boundary_vertex)
    if boundary == "fixed":
        held = np.union1d(held, rim)
    elif boundary == "glide":
        sliding, corners = boundary_glide(small, np.setdiff1d(rim, held))
        hard, held = (*hard, *sliding), np.union1d(held, corners)
    met = _residual(hard, small.vertices)
    if met <= chosen.tolerance and not len(crooked_faces(small, hard)):
        return OptimizeResult(goal, mesh, mesh, "converged", (), met)
    sharp = None if features is None else _ids(features, mesh.n_edges, "feature edge")
    large = mesh.n_faces > chosen.search_faces
    task = Task(
        goal,
        small,
        without_noise(small, held, sharp) if large else small,
        hard,
        held,
        sharp,
        None if surface is None else surface.with_vertices((surface.vertices - centre) / unit),
        chosen,
        surface is None and (mesh.n_faces > _FACTORED or (smooth and boundary == "free")),
        progress,
    )

    def back(found: Mesh) -> tuple[Mesh, Floats]:
        """The mesh in its unit, and what rounding there made of the coordinates here."""
        points = found.vertices * unit + centre
        points[held] = mesh.vertices[held]
        return mesh.with_vertices(points), (points - centre) / unit

    return _run(task, mesh, back, throw)


def _ids(given: Sequence[int] | Ints, limit: int, noun: str) -> Ints:
    ids = np.unique(np.asarray(given, dtype=np.int64))
    if len(ids) and not 0 <= ids[0] <= ids[-1] < limit:
        raise InputError(
            f"{noun} {ids[0] if ids[0] < 0 else ids[-1]}; ids run from 0 to {limit - 1}"
        )
    return ids


def planarize(
    mesh: Mesh,
    *,
    fixed: Sequence[int] | Ints = (),
    boundary: Boundary = "free",
    features: Sequence[int] | Ints | None = None,
    surface: Mesh | None = None,
    options: RecipeOptions | None = None,
    throw: bool = True,
    progress: StageProgress | None = None,
) -> OptimizeResult:
    """Planar faces: quads, hexagons, any polygons; triangles are planar already.

    Parameters
    ----------
    fixed : ids of vertices that stay where they are
    boundary : "free", "glide" along the boundary as it is (its corners stay), or "fixed"
    features : ids of edges across which polylines may turn
    surface : a mesh to stay near; vertices slide along it, which brings the result several times
        nearer to its shape for more movement. The mesh itself is a good one. Slower: up to some
        10,000 faces
    throw : raise when the goal is missed; otherwise the best mesh comes back, status "missed"
    progress : called with the name of the stage, the number of the step and the step

    Returns
    -------
    OptimizeResult; `remarks` say which wishes (corner angles, smoothness) were not granted

    Raises
    ------
    OptimizeError
        Not planar to `RecipeOptions.accepted`, or a face folded; carries the best result.
    InputError
        An id out of range, an unknown boundary.

    Source: mathematics.md 8.5; Liu, Pottmann, Wallner, Yang, Wang 2006, section 3.
    """
    return _recipe(
        "planarize",
        mesh,
        planarity_terms,
        True,
        fixed=fixed,
        boundary=boundary,
        features=features,
        surface=surface,
        options=options,
        throw=throw,
        progress=progress,
    )


def circularize(
    mesh: Mesh,
    *,
    fixed: Sequence[int] | Ints = (),
    boundary: Boundary = "free",
    features: Sequence[int] | Ints | None = None,
    surface: Mesh | None = None,
    options: RecipeOptions | None = None,
    throw: bool = True,
    progress: StageProgress | None = None,
) -> OptimizeResult:
    """Planar faces with their corners on circles; triangles have a circle already.

    Parameters, return value and errors are those of `planarize`.

    Source: Bobenko, Suris, Discrete Differential Geometry, 3.1; mathematics.md 2.
    """
    return _recipe(
        "circularize",
        mesh,
        lambda m: (*planarity_terms(m), *circularity_terms(m)),
        False,
        fixed=fixed,
        boundary=boundary,
        features=features,
        surface=surface,
        options=options,
        throw=throw,
        progress=progress,
    )


def conicalize(
    mesh: Mesh,
    *,
    fixed: Sequence[int] | Ints = (),
    boundary: Boundary = "free",
    features: Sequence[int] | Ints | None = None,
    surface: Mesh | None = None,
    options: RecipeOptions | None = None,
    throw: bool = True,
    progress: StageProgress | None = None,
) -> OptimizeResult:
    """Planar faces that touch a cone of revolution at every inner vertex.

    Hexagonal meshes are conical as soon as they are planar. A triangle mesh has hardly any freedom:
    six planes round each vertex; expect an error.

    Parameters, return value and errors are those of `planarize`.

    Source: Liu, Pottmann, Wallner, Yang, Wang 2006, section 4; mathematics.md 2.9.
    """
    return _recipe(
        "conicalize",
        mesh,
        lambda m: (*planarity_terms(m), *conicality_terms(m), *cone_terms(m)),
        False,
        fixed=fixed,
        boundary=boundary,
        features=features,
        surface=surface,
        options=options,
        throw=throw,
        progress=progress,
    )


_FACTORED = 20_000
"""Up to this number of faces, angles and curves are solved for with factored systems: fewer, surer
steps. Planarity alone suits conjugate gradients at any size."""
