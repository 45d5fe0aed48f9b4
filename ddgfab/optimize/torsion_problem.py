"""Terms that only the goal families uses: smooth movement by local angles, gliding boundaries."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.sparse import csr_array, diags_array, vstack

from ddgfab.errors import InputError
from ddgfab.mesh import Ints, Mesh
from ddgfab.optimize.problem import Term
from ddgfab.optimize.terms import VectorTerm, boundary_glide
from ddgfab.optimize.terms.shape import laplacian, second_differences


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
