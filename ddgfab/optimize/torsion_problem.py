"""What the recipe torsion-free solves: its options, its terms, its boundary."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.sparse import csr_array, diags_array, vstack

from ddgfab.errors import InputError
from ddgfab.mesh import Ints, Mesh
from ddgfab.optimize.newton import NewtonOptions
from ddgfab.optimize.problem import Problem, Term, mean_edge
from ddgfab.optimize.terms import LinearTerm, VectorTerm, boundary_glide, closeness, planarity_terms
from ddgfab.optimize.terms.shape import laplacian, second_differences
from ddgfab.optimize.torsion_terms import (
    AxisLean,
    Power,
    axis_torsion,
    block_matrix,
    corner_angles,
    edge_stretch,
)


@dataclass(frozen=True)
class TorsionFreeOptions:
    """How the recipe runs; every field may be left as it is. Weights have no unit."""

    fairness: float = 4.0
    """Weight of the smoothness of the movement (bends over the local edge length)."""
    depth: float = 0.01
    """Weight of movement along the surface normal."""
    sliding: float = 0.0004
    """Weight of movement along the surface."""
    upright: float = 0.01
    """Weight of the lean as a whole, besides its limit."""
    angles: float = 1.0
    """Weight of the limit of the corner angles."""
    lengths: float = 0.1
    """Weight of the limit of the edges' change of length."""
    power: int = 4
    """Soft limits are (|r| / limit)^power; their squares are summed."""
    length_power: int = 2
    """The same for the change of length, whose limit is `length_ratio`."""
    length_ratio: float = 2.0
    """No edge gets longer or shorter by more than about this factor."""
    least_angle: float = float(np.radians(35.0))
    """Corner angles below this, or as far above the regular ones, are made better [rad]."""
    angle_slack: float = float(np.radians(10.0))
    """Corner angles may leave the input's range by this [rad]; more is a remark."""
    aim: float = 0.9
    """Soft limits are this part of the limits that a result must keep."""
    planarity: float = 1e-10
    """Greatest distance of diagonals, in parts of their mean, that a result may keep."""
    solver: NewtonOptions = field(default_factory=NewtonOptions)
    """How each rung of the ladder is solved."""


def terms_of(
    mesh: Mesh,
    problem: Problem,
    limits: tuple[float, float],
    options: TorsionFreeOptions,
    features: Sequence[int] | Ints | None = None,
) -> tuple[Term, ...]:
    """The terms of the recipe for a mesh whose mean edge is one, and limits as in `LIMITS`."""
    tilt = AxisLean(mesh=mesh, layout=problem.layout)
    lean_deg, movement = limits
    uneven = (
        max(float(np.abs(t.residual(problem.start)).max()) for t in corner_angles(mesh))
        + 0.5 * options.angle_slack
    )
    corners = [
        Power(
            term=term,
            limit=min(uneven, max(term.regular - options.least_angle, options.angle_slack)),
            power=options.power,
            weight=options.angles,
        )
        for term in corner_angles(mesh)
    ]
    return (
        smooth_change(mesh, options.fairness, features),
        _near_surface(mesh, options),
        replace(tilt, weight=options.upright),
        Power(
            term=tilt,
            width=3,
            limit=float(np.sin(np.radians(options.aim * min(lean_deg, 90.0)))),
            power=options.power,
        ),
        Power(term=closeness(mesh), width=3, limit=options.aim * movement, power=options.power),
        *corners,
        Power(
            term=edge_stretch(mesh),
            limit=float(np.log(options.length_ratio)),
            power=options.length_power,
            weight=options.lengths,
        ),
        axis_torsion(mesh, problem.layout),
        *planarity_terms(mesh),
    )


def smooth_change(
    mesh: Mesh, weight: float, features: Sequence[int] | Ints | None = None
) -> VectorTerm:
    """Bends of the movement along polylines (at inner vertices of odd valence: its Laplacian).

    Divided by the local edge length: the angle by which polylines bend more or less than before,
    so that fine parts of a mesh keep their shape as coarse ones do.
    """
    ids = None if features is None else np.asarray(features, dtype=np.int64)
    straight = second_differences(mesh, ids)
    odd = np.flatnonzero(~mesh.boundary_vertex & (mesh.valences % 2 == 1))
    rows = csr_array(vstack([straight, 2.0 * laplacian(mesh)[odd]], format="csr"))
    total = np.bincount(
        mesh.edges.ravel(), np.repeat(mesh.edge_lengths, 2), minlength=mesh.n_vertices
    )
    local = total / np.maximum(mesh.valences, 1)
    middle = np.concatenate([straight.indices[straight.data < 0], odd])
    scaled = csr_array(diags_array(1.0 / local[middle]) @ rows)
    return VectorTerm(
        name="smooth change", scalar=scaled, target=scaled @ mesh.vertices, weight=weight
    )


def _near_surface(mesh: Mesh, options: TorsionFreeOptions) -> LinearTerm:
    """Movement across the tangent planes of the input, and along them, each with its weight."""
    normals, ids = mesh.vertex_normals, np.arange(mesh.n_vertices)
    across = normals[:, :, None] * normals[:, None, :]
    deep, slide = np.sqrt(options.depth), np.sqrt(options.sliding)
    blocks = (slide * np.eye(3) + (deep - slide) * across) / mean_edge(mesh)
    matrix = block_matrix(blocks, ids, ids, (len(ids), len(ids)))
    return LinearTerm(name="near surface", matrix=matrix, target=matrix @ mesh.vertices.ravel())


def boundary_terms(
    mesh: Mesh, fixed: Sequence[int] | Ints, boundary: str
) -> tuple[tuple[Term, ...], Ints]:
    """Terms of a gliding boundary, and the vertices that stay."""
    held = np.unique(np.asarray(fixed, dtype=np.int64))
    if len(held) and not 0 <= held[0] <= held[-1] < mesh.n_vertices:
        bad = held[0] if held[0] < 0 else held[-1]
        raise InputError(f"fixed vertex {bad}; ids run from 0 to {mesh.n_vertices - 1}")
    rim = np.flatnonzero(mesh.boundary_vertex)
    if boundary == "free":
        return (), held
    if boundary == "fixed":
        return (), np.union1d(held, rim)
    if boundary != "glide":
        raise InputError(f"boundary {boundary!r}; one of free, glide, fixed")
    sliding, corners = boundary_glide(mesh, np.setdiff1d(rim, held))
    return sliding, np.union1d(held, corners)
