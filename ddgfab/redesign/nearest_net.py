"""The net of a goal nearest to a mesh: equations met exactly at the least change of the surface.

Sequential quadratic programming: movements along the normal cost one, along the surface a tenth,
and they are kept smooth, since between smooth solutions zigzags cost less. Source: Nocedal, Wright
2006, 18.1.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from scipy.sparse import (
    block_array,
    coo_array,
    csr_array,
    diags_array,
    eye_array,
    kron,
    vstack,
)

from ddgfab.errors import DegenerateError
from ddgfab.mesh import Floats, Ints, Mesh, unit
from ddgfab.optimize.frame import Frame
from ddgfab.optimize.problem import Term
from ddgfab.optimize.quality import folded_faces
from ddgfab.optimize.terms import circularity_terms, planarity_terms
from ddgfab.optimize.terms.planarity import polygon_corners
from ddgfab.optimize.terms.shape import polyline_triples, second_differences
from ddgfab.symmetric import factored

_SLIDE, _SMOOTH = 0.1, 10.0
"""Weights of movements along the surface, and of their second differences."""
_STEPS: Final = 25
_MET, _STILL = 1e-9, 1e-4
"""Residual of the equations and step [mean edges] at which the search ends."""
_LONGEST: Final = 2.0
"""A step further than this [mean edges] is not a small change: the search gives up."""
_SOFT, _REFINED = 1e-9, 3
"""Softness of the equations that keeps pivots apart from zero, and how often it is made good."""
_FLAT, _BENT = 30.0, 300.0
"""Weights of planar faces, and of the asked difference of curvatures, against movements."""
_ROUNDS: Final = 5
_CLEAR: Final = 0.25
"""Polylines that differ by more than this part of the goal keep which of them bends more."""


@dataclass(frozen=True, eq=False)
class NearestNet:
    """A mesh that meets a goal, the greatest residual of its equations, the steps taken."""

    mesh: Mesh
    residual: float
    steps: int


def goal_terms(mesh: Mesh, goal: str) -> list[Term]:
    """Equations of "planar" (conjugate lines) or "principal" (planar faces on circles)."""
    terms: list[Term] = [*planarity_terms(mesh)]
    return terms if goal == "planar" else [*terms, *circularity_terms(mesh)]


def nearest_net(mesh: Mesh, goal: str, target: Floats | None = None) -> NearestNet | None:
    """The nearest mesh whose faces are planar, or lie on circles; None where none is found near.

    Parameters
    ----------
    target : (V, 3) what to stay near to and to begin with; the vertices by default
    """
    frame = Frame.of(mesh)
    small = frame.inside(mesh)
    terms = goal_terms(small, goal)
    if not terms:
        return NearestNet(mesh, 0.0, 0)
    aim = small.vertices.ravel()
    if target is not None:
        aim = ((target - frame.center) / frame.unit).ravel()
    weight = _metric(small)
    x = aim.copy()
    worst, steps = np.inf, 0
    for _ in range(_STEPS):
        values = np.concatenate([term.residual(x) for term in terms])
        lines = vstack([term.jacobian(x) for term in terms])
        step = _kkt(weight, lines, weight @ (aim - x), -values)
        longest = float(np.abs(step).max()) if np.isfinite(step).all() else np.inf
        if longest > _LONGEST:
            return None
        x = x + step
        steps += 1
        worst = max(float(np.abs(term.residual(x)).max(initial=0.0)) for term in terms)
        if worst < _MET and longest < _STILL:
            break
    after = frame.outside(small.vertices, x.reshape(-1, 3))
    if worst > _MET or len(folded_faces(after, mesh)):
        return None
    return NearestNet(after, worst, steps)


def heights_only(mesh: Mesh, up: Floats) -> Mesh:
    """The mesh of planar faces over the same plan with the least change of heights.

    Parameters
    ----------
    up : (3,) unit vector across the plan

    Source: mathematics.md 1.3; a face over a plan is planar where its heights meet k - 3 rows.
    """
    axes = np.linalg.svd(up[None])[2][1:]
    plan = mesh.vertices @ axes.T
    heights = mesh.vertices @ up
    rows, columns, data, count = [], [], [], 0
    for size in np.unique(mesh.face_sizes[mesh.face_sizes > 3]).tolist():
        _, corners = polygon_corners(mesh, size)
        basis = _not_tilts(plan[corners])
        number = basis.shape[0] * basis.shape[1]
        rows.append(np.repeat(count + np.arange(number), size))
        columns.append(np.repeat(corners, size - 3, axis=0).ravel())
        data.append(basis.ravel())
        count += number
    if not count:
        return mesh
    entries = np.concatenate(data), (np.concatenate(rows), np.concatenate(columns))
    lines = csr_array(coo_array(entries, shape=(count, mesh.n_vertices)))
    size = mesh.diameter
    weight = csr_array(eye_array(mesh.n_vertices))
    move = _kkt(weight, lines, np.zeros(mesh.n_vertices), -(lines @ heights) / size)
    return mesh.with_vertices(mesh.vertices + size * move[:, None] * up)


def bent_further(mesh: Mesh, difference: Floats) -> Floats:
    """(V, 3) the mesh moved along its normals until its polylines bend as differently as asked.

    Per inner vertex of valence 4 the normal curvatures along its two polylines,
    2 <x_q - x_v, n> / |e|^2, differ by `difference` or more; faces become planar to first order.

    Parameters
    ----------
    difference : (V,) asked least difference of the curvatures
    """
    frame = Frame.of(mesh)
    small = frame.inside(mesh)
    normal = small.vertex_normals
    triples = polyline_triples(small)
    triples = triples[~small.boundary_vertex[triples[:, 1]]]
    four = small.valences[triples[:, 1]] == 4
    triples = triples[four]
    half = len(triples) // 2  # all first polylines, then all second ones, of the same vertices
    first, second = triples[:half], triples[half:]
    center = first[:, 1]
    bends, slopes = zip(*(_bend(small, rows, normal) for rows in (first, second)), strict=True)
    asked = frame.unit * difference[center]
    gap = bends[0] - bends[1]
    sign = _signs(small, first, second, gap, asked)
    gap = sign * gap
    lines = csr_array(diags_array(sign) @ (slopes[0] - slopes[1]))
    flat = planarity_terms(small)
    along = csr_array(
        coo_array(
            (
                normal.ravel(),
                (np.arange(normal.size), np.repeat(np.arange(small.n_vertices), 3)),
            ),
            shape=(normal.size, small.n_vertices),
        )
    )
    x = small.vertices.ravel()
    slope = csr_array(vstack([term.jacobian(x) for term in flat]) @ along)
    skew = np.concatenate([term.residual(x) for term in flat])
    move = np.zeros(small.n_vertices)
    active = np.zeros(half, dtype=bool)
    base = eye_array(small.n_vertices) + _FLAT**2 * (slope.T @ slope)
    for _ in range(_ROUNDS):
        short = gap + lines @ move < asked - 1e-9 * np.abs(asked).max()
        if not (short & ~active).any():
            break
        active |= short
        chosen = lines[active]
        matrix = base + _BENT**2 * (chosen.T @ chosen)
        right = -(_FLAT**2) * (slope.T @ skew) + _BENT**2 * (chosen.T @ (asked - gap)[active])
        move = factored(matrix).solve(right)
    return np.asarray(mesh.vertices + frame.unit * move[:, None] * normal)


def _not_tilts(plan: Floats) -> Floats:
    """(n, k - 3, k) orthonormal rows that vanish on heights which are linear over (n, k, 2)."""
    center = plan.mean(axis=1, keepdims=True)
    size = np.abs(plan - center).max(axis=(1, 2), keepdims=True)
    ones = np.ones((len(plan), 1, plan.shape[1]))
    rows = np.concatenate([ones, ((plan - center) / size).transpose(0, 2, 1)], axis=1)
    return np.asarray(np.linalg.svd(rows, full_matrices=True)[2][:, 3:])


def _metric(mesh: Mesh) -> csr_array:
    """(3V, 3V) what movements cost on a mesh whose mean edge is one."""
    normal = mesh.vertex_normals
    blocks = normal[:, :, None] * normal[:, None, :] + _SLIDE * np.eye(3)
    start = 3 * np.arange(mesh.n_vertices)[:, None, None]
    row = np.broadcast_to(start + np.arange(3)[:, None], blocks.shape)
    column = np.broadcast_to(start + np.arange(3), blocks.shape)
    near = coo_array((blocks.ravel(), (row.ravel(), column.ravel())))
    second = second_differences(mesh)
    return csr_array(near + _SMOOTH * kron(second.T @ second, eye_array(3)))


def _kkt(weight: csr_array, lines: csr_array, right: Floats, values: Floats) -> Floats:
    """Step d of least d W d / 2 - right d with lines d = values."""
    count = lines.shape[0]
    exact = csr_array(block_array([[weight, lines.T], [lines, None]]))
    shift = np.concatenate([np.zeros(weight.shape[0]), np.full(count, -_SOFT)])
    try:
        factors = factored(exact + diags_array(shift))
    except RuntimeError as error:
        raise DegenerateError(f"the equations of the net are singular ({error})") from None
    wanted = np.concatenate([right, values])
    solved = factors.solve(wanted)
    for _ in range(_REFINED):
        solved = solved + factors.solve(wanted - exact @ solved)
    return np.asarray(solved[: weight.shape[0]])


def _bend(mesh: Mesh, triples: Ints, normal: Floats) -> tuple[Floats, csr_array]:
    """(m,) normal curvatures along polylines, (m, V) their derivatives by normal movements."""
    x, center = mesh.vertices, triples[:, 1]
    total, entries = np.zeros(len(triples)), []
    for k in (0, 2):
        edge = x[triples[:, k]] - x[center]
        factor = 1.0 / np.einsum("mx,mx->m", edge, edge)  # half of both sides' 2 / |e|^2
        total += factor * np.einsum("mx,mx->m", edge, normal[center])
        tilt = np.einsum("mx,mx->m", normal[triples[:, k]], normal[center])
        entries += [(triples[:, k], factor * tilt), (center, -factor)]
    row = np.arange(len(triples))
    matrix = coo_array(
        (
            np.concatenate([value for _, value in entries]),
            (np.tile(row, 4), np.concatenate([column for column, _ in entries])),
        ),
        shape=(len(triples), mesh.n_vertices),
    )
    return total, csr_array(matrix)


def _signs(mesh: Mesh, first: Ints, second: Ints, gap: Floats, asked: Floats) -> Floats:
    """(m,) which polyline is to bend more: where it is not clear, as on the whole.

    The families of vertices next to each other are matched by direction.
    """
    x = mesh.vertices
    way = unit(x[first[:, 2]] - x[first[:, 0]])
    other = unit(x[second[:, 2]] - x[second[:, 0]])
    index = np.full(mesh.n_vertices, -1)
    index[first[:, 1]] = np.arange(len(first))
    ends = index[mesh.edges]
    ends = ends[(ends >= 0).all(axis=1)]
    same = np.abs(np.einsum("mx,mx->m", way[ends[:, 0]], way[ends[:, 1]]))
    turned = np.abs(np.einsum("mx,mx->m", way[ends[:, 0]], other[ends[:, 1]]))
    flip = np.where(same >= turned, 1.0, -1.0)
    label = np.zeros(len(first))
    after: list[list[tuple[int, float]]] = [[] for _ in range(len(first))]
    for (a, b), change in zip(ends.tolist(), flip.tolist(), strict=True):
        after[a].append((b, change))
        after[b].append((a, change))
    sign = np.ones(len(first))
    for seed in range(len(first)):
        if label[seed]:
            continue
        label[seed], todo, group = 1.0, [seed], []
        while todo:
            i = todo.pop()
            group.append(i)
            for j, change in after[i]:
                if not label[j]:
                    label[j] = change * label[i]
                    todo.append(j)
        ids = np.array(group)
        total = float(label[ids] @ gap[ids])
        sign[ids] = label[ids] * (1.0 if total >= 0 else -1.0)
    return np.where(np.abs(gap) > _CLEAR * asked, np.sign(gap), sign)
