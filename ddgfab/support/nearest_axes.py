"""Torsion-free axes nearest to the vertex normals, for any mesh: a sequential quadratic programme.

Minimise sum w_v |a_v - n_v|^2 over unit axes a_v under c_e = det(e, a_i, a_j) = 0 for every edge
e = ij (Pottmann, Liu, Wallner, Bobenko, Wang 2007, Def. 5.1; mathematics.md 10.2). Vertices stay
where they are, faces need not be planar. A disk-shaped quad mesh with b boundary edges has a family
of b/2 + 2 such structures, so the programme has room; other meshes may have less, and the solver
then raises instead of returning something near.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.sparse import block_array, csr_array, diags_array, eye_array
from scipy.sparse.linalg import splu

from ddgfab.arguments import checked, of_shape
from ddgfab.errors import SupportError
from ddgfab.measures import torsion
from ddgfab.mesh import Floats, Ints, Mesh, unit
from ddgfab.support.structure import SupportStructure
from ddgfab.symmetric import factored
from ddgfab.tolerances import TORSION_EXACT_DEG


@dataclass(frozen=True)
class AxesOptions:
    """How the sequential quadratic programme runs; every field may be left as it is."""

    max_steps: int = 60
    """Sparse solves before giving up."""
    step_rad: float = 1e-7
    """Converged when no axis turns by more [rad], with torsion below `torsion_deg`."""
    torsion_deg: float = 1e-9
    """Greatest torsion [deg] aimed at; `TORSION_EXACT_DEG` is what a result must keep."""
    regularization: float = 1e-9
    """Weight of the multipliers' proximal term: mends constraints that depend on each other."""
    longest_step: float = 1.0
    """No axis is moved by more than this tangent length in one step (1 = 45 deg)."""
    newton_step: float = 0.15
    """Steps below this [rad] may use the second derivatives of the constraints."""
    newton_contraction: float = 0.2
    """They do when the cheap step has shrunk by less than this factor."""


def tangent_frames(axes: Floats) -> Floats:
    """(V, 2, 3) two orthonormal tangents of the sphere at each of (V, 3) unit axes."""
    helper = np.zeros_like(axes)
    helper[np.arange(len(axes)), np.abs(axes).argmin(axis=1)] = 1.0
    first = unit(np.cross(axes, helper))
    return np.stack([first, np.cross(axes, first)], axis=1)


def constraints(mesh: Mesh, axes: Floats) -> Floats:
    """(E,) values det(e, a_i, a_j) with unit e."""
    start, end = mesh.edges.T
    crossed = np.cross(axes[start], axes[end])
    return np.asarray(np.einsum("ex,ex->e", unit(mesh.edge_vectors), crossed))


def jacobian(mesh: Mesh, axes: Floats, frames: Floats) -> csr_array:
    """(E, 2V) derivative of `constraints` along the two tangents of each axis."""
    start, end = mesh.edges.T
    along = unit(mesh.edge_vectors)
    at_start = np.einsum("ekx,ex->ek", frames[start], np.cross(axes[end], along))
    at_end = np.einsum("ekx,ex->ek", frames[end], np.cross(along, axes[start]))
    row = np.repeat(np.arange(mesh.n_edges), 2)
    return csr_array(
        (
            np.concatenate([at_start.ravel(), at_end.ravel()]),
            (np.tile(row, 2), np.concatenate([_columns(start).ravel(), _columns(end).ravel()])),
        ),
        shape=(mesh.n_edges, 2 * mesh.n_vertices),
    )


def _columns(vertices: Ints) -> Ints:
    return 2 * vertices[:, None] + np.arange(2)


def _hessian(mesh: Mesh, axes: Floats, frames: Floats, pull: Floats, force: Floats) -> csr_array:
    """(2V, 2V) second derivative of the Lagrangian: the sphere's and det(e, t_i, t_j).

    pull : (V,) w <a, n>; force : (E,) multipliers.
    """
    start, end = mesh.edges.T
    turned = np.cross(frames[end], unit(mesh.edge_vectors)[:, None, :])
    block = np.einsum("ekx,elx->ekl", frames[start], turned) * force[:, None, None]
    rows = np.broadcast_to(_columns(start)[:, :, None], block.shape)
    cols = np.broadcast_to(_columns(end)[:, None, :], block.shape)
    size = 2 * mesh.n_vertices
    upper = csr_array((block.ravel(), (rows.ravel(), cols.ravel())), shape=(size, size))
    return upper + upper.T + diags_array(np.repeat(pull, 2))


def _cheap_step(
    matrix: csr_array, gradient: Floats, values: Floats, weight: Floats, force: Floats, eps: float
) -> tuple[Floats, Floats]:
    """Gauss-Newton step through the Schur complement of the diagonal Hessian; new multipliers."""
    scaled = matrix @ diags_array(1.0 / weight)
    schur = scaled @ matrix.T + eps * eye_array(matrix.shape[0])
    force = factored(schur).solve(values - scaled @ gradient + eps * force)
    return -(gradient + matrix.T @ force) / weight, force


def _newton_step(
    matrix: csr_array,
    gradient: Floats,
    values: Floats,
    hessian: csr_array,
    force: Floats,
    eps: float,
) -> tuple[Floats, Floats]:
    """Newton step on the Karush-Kuhn-Tucker system; new multipliers.

    The second derivatives may be indefinite, so this system needs the pivots that `factored` skips.
    """
    system = block_array(
        [[hessian, matrix.T], [matrix, -eps * eye_array(matrix.shape[0])]], format="csc"
    )
    solution = splu(system).solve(np.concatenate([-gradient, -values - eps * force]))
    return solution[: len(gradient)], solution[len(gradient) :]


def _line_search(merit: Callable[[float], float], slope: float, first: float) -> float:
    """Halve a step until the merit falls as its slope promises; after a few halvings, go on."""
    sufficient, halvings = 1e-4, 6  # Armijo's constant; customary (Nocedal, Wright 2006, sec. 3.1)
    start, length = merit(0.0), first
    for _ in range(halvings):
        if merit(length) <= start + sufficient * length * slope:
            break
        length /= 2
    return length


@checked
def torsion_free_axes(
    mesh: Mesh,
    start: Floats | None = None,
    *,
    target: Floats | None = None,
    weights: Floats | None = None,
    options: AxesOptions | None = None,
    throw: bool = True,
) -> SupportStructure:
    """Torsion-free node axes nearest to the vertex normals, vertices fixed.

    Parameters
    ----------
    mesh : any oriented mesh; holes, several components, n-gons and skew faces are allowed
    start : (V, 3) unit axes to begin with; the target by default
    target : (V, 3) unit axes n to stay near; the vertex normals by default
    weights : (V,) positive weights w; 1 by default
    throw : raise when torsion stays above `TORSION_EXACT_DEG`; otherwise the last axes come
        back with status "stopped"

    Returns
    -------
    SupportStructure of kind "optimize", with the greatest torsion [deg] after each step

    Raises
    ------
    SupportError
        Not converged; names the worst edges.

    Source: sequential quadratic programming, Nocedal and Wright 2006, ch. 18.
    """
    chosen = options or AxesOptions()
    used = mesh.valences > 0
    normals, axes, weight = _checked_inputs(mesh, start, target, weights)
    force = np.zeros(mesh.n_edges)
    history: list[float] = []
    last, newton, converged = np.inf, False, False
    for _ in range(chosen.max_steps):
        frames = tangent_frames(axes)
        gradient = -(weight[:, None] * np.einsum("vkx,vx->vk", frames, normals)).ravel()
        move, force = _step(mesh, axes, frames, gradient, (normals, weight, force), chosen, newton)
        turn = np.einsum("vk,vkx->vx", move.reshape(-1, 2), frames)
        longest = float(np.abs(move).max())
        if not np.isfinite(longest):  # the solve broke down: the axes before it stay
            break
        length = min(1.0, chosen.longest_step / longest) if longest > 0 else 1.0
        if longest > chosen.step_rad:
            length = _guarded(mesh, axes, turn, (normals, weight, force), gradient @ move, length)
        axes = unit(axes + length * turn)
        history.append(float(np.degrees(torsion(mesh, axes).max())))
        if longest < chosen.step_rad and history[-1] < chosen.torsion_deg:
            converged = True
            break
        newton = longest < chosen.newton_step and longest > chosen.newton_contraction * last
        last = longest
    if not history:
        history.append(float(np.degrees(torsion(mesh, axes).max())))
    good = converged or history[-1] <= TORSION_EXACT_DEG
    result = SupportStructure.of(
        mesh,
        np.where(used[:, None], axes, 0.0),
        "optimize",
        status="converged" if good else "stopped",
        history_deg=tuple(history),
    )
    if throw and not good:
        raise _failure(result)
    return result


def _checked_inputs(
    mesh: Mesh, start: Floats | None, target: Floats | None, weights: Floats | None
) -> tuple[Floats, Floats, Floats]:
    """(V, 3) axes to stay near, (V, 3) axes to begin with, (V,) weights; z where no edge ends."""
    shape = mesh.vertices.shape
    start = None if start is None else of_shape(start, shape, "start")
    target = None if target is None else of_shape(target, shape, "target")
    weights = None if weights is None else of_shape(weights, shape[:1], "weights")
    used = (mesh.valences > 0)[:, None]
    aim = mesh.vertex_normals if target is None else target
    normals = np.where(used, aim, np.array([0.0, 0.0, 1.0]))
    axes = np.where(used, normals if start is None else start, normals)
    return normals, axes, np.ones(mesh.n_vertices) if weights is None else weights


def _step(
    mesh: Mesh,
    axes: Floats,
    frames: Floats,
    gradient: Floats,
    terms: tuple[Floats, Floats, Floats],
    options: AxesOptions,
    newton: bool,
) -> tuple[Floats, Floats]:
    """(2V,) tangent lengths of one step and (E,) new multipliers."""
    normals, weight, force = terms
    values, matrix = constraints(mesh, axes), jacobian(mesh, axes, frames)
    eps = options.regularization
    if not newton:
        return _cheap_step(matrix, gradient, values, np.repeat(weight, 2), force, eps)
    pull = weight * np.einsum("vx,vx->v", axes, normals)
    hessian = _hessian(mesh, axes, frames, pull, force)
    return _newton_step(matrix, gradient, values, hessian, force, eps)


def _failure(result: SupportStructure) -> SupportError:
    """What is raised where torsion stays; names the worst edges."""
    names = ", ".join(
        f"{i} ({np.degrees(result.torsion[i]):.2g} deg)" for i in result.worst_edges(3)
    )
    return SupportError(
        f"no torsion-free axes found in {len(result.history_deg)} steps: torsion stays at "
        f"{result.history_deg[-1]:.2g} deg (limit {TORSION_EXACT_DEG:g}); worst edges {names}\n"
        "the mesh allows none near its vertex normals: optimize the vertices, or cut the mesh "
        "open where it closes up"
    )


def _guarded(
    mesh: Mesh,
    axes: Floats,
    turn: Floats,
    terms: tuple[Floats, Floats, Floats],
    descent: float,
    first: float,
) -> float:
    """Step length by line search on distance + penalty * |constraints| (exact l1 merit)."""
    normals, weight, force = terms
    penalty = 1.5 * float(np.abs(force).max())  # above the multipliers, so that the merit is exact

    def merit(length: float) -> float:
        moved = unit(axes + length * turn)
        away = weight @ (1.0 - np.einsum("vx,vx->v", moved, normals))
        return float(away + penalty * np.abs(constraints(mesh, moved)).sum())

    slope = descent - penalty * float(np.abs(constraints(mesh, axes)).sum())
    return _line_search(merit, slope, first)
