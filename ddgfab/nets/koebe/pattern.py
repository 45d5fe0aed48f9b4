"""Orthogonal circle patterns in the plane: the convex functional, Newton's method, the layout.

A circle for every vertex and every face of a polyhedron; circles of neighbouring vertices touch,
so do circles of neighbouring faces, at the same point, and a vertex' circle meets that of each of
its faces at right angles. One contact point is sent to infinity: its two vertex and two face
circles become the lines of a rectangle.

Circles are numbered: vertices first, then faces. A corner of the mesh is an incidence of a vertex
and a face, an edge of the bipartite graph on which the functional lives.

Source: Bobenko, Springborn, Variational principles for circle patterns and Koebe's theorem
(2004); mathematics.md 7.1.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_array

from ddgfab.errors import DegenerateError
from ddgfab.mesh import Floats, Ints, Mesh
from ddgfab.symmetric import factored
from ddgfab.trees import tree_sums

GRADIENT_TOLERANCE: Final = 1e-10
"""Newton stops when no angle sum misses 2 pi by more [rad]; a polishing step follows."""

GRADIENT_FLOOR: Final = 1e-8
"""Where rounding lets no step gain any more, angle sums within this [rad] are accepted."""

MAX_STEPS: Final = 100
"""Newton steps; 4 to 8 are usual."""

SHORTEST_STEP: Final = 1e-6
"""A damped step below this part of Newton's step counts as no progress."""


@dataclass(frozen=True, eq=False)
class CirclePattern:
    """The variational problem of the circle pattern of a polyhedron.

    Attributes
    ----------
    mesh : a polyhedron (see `koebe_checks.check_polyhedron`); only its faces are used
    infinity : the edge whose contact point is at infinity
    """

    mesh: Mesh
    infinity: int

    @property
    def count(self) -> int:
        """Number of circles."""
        return self.mesh.n_vertices + self.mesh.n_faces

    @cached_property
    def lines(self) -> NDArray[np.bool_]:
        """(count,) which circles are lines: two vertices and two faces."""
        found = np.zeros(self.count, dtype=bool)
        found[self.mesh.edges[self.infinity]] = True
        found[self.mesh.n_vertices + self.mesh.edge_faces[self.infinity]] = True
        return found

    @cached_property
    def corner_circles(self) -> tuple[Ints, Ints]:
        """Circle of the vertex and of the face of every corner, (C,) each."""
        return self.mesh.corners, self.mesh.n_vertices + self.mesh.corner_face

    @cached_property
    def pairs(self) -> tuple[Ints, Ints]:
        """Those of the corners without lines."""
        v, f = self.corner_circles
        live = ~self.lines[v] & ~self.lines[f]
        return v[live], f[live]

    @cached_property
    def angle_sums(self) -> Floats:
        """(count,) Phi: 2 pi less pi for every neighbour that is a line."""
        v, f = self.corner_circles
        lines = np.bincount(v, self.lines[f], self.count) + np.bincount(
            f, self.lines[v], self.count
        )
        return np.asarray(2.0 * np.pi - np.pi * lines)

    def functional(self, rho: Floats) -> float:
        """S(rho), convex, of the logarithms rho (count,) of the radii; those of lines do not count.

        S = sum over corners of Im Li2(i e^d) + Im Li2(i e^-d) - pi/2 (rho_v + rho_f), with
        d = rho_f - rho_v, plus sum Phi_i rho_i.
        """
        v, f = self.pairs
        d = rho[f] - rho[v]
        # Im Li2(i e^d) = Im Li2(i e^-d) + pi/2 d: no power of e that overflows.
        far = np.abs(d)
        from scipy.special import spence  # heavy: only where it is needed

        terms = 2.0 * spence(1.0 - 1j * np.exp(-far)).imag + 0.5 * np.pi * far
        free = ~self.lines
        linear = float(self.angle_sums[free] @ rho[free])
        return float(terms.sum() - 0.5 * np.pi * (rho[v] + rho[f]).sum()) + linear

    def gradient(self, rho: Floats) -> Floats:
        """(count,) Phi_i - sum 2 atan(e^(rho_j - rho_i)): the missing angles; 0 for lines."""
        v, f = self.pairs
        # 2 atan(e^d) = pi/2 + 2 atan(tanh(d/2)), for differences d of any size
        turn = 2.0 * np.arctan(np.tanh(0.5 * (rho[f] - rho[v])))
        found = np.bincount(v, 0.5 * np.pi + turn, self.count)
        found += np.bincount(f, 0.5 * np.pi - turn, self.count)
        return np.where(self.lines, 0.0, self.angle_sums - found)

    def hessian(self, rho: Floats) -> csc_array:
        """(count, count) Laplacian with weights sech(rho_j - rho_i); zero rows for lines."""
        v, f = self.pairs
        small = np.exp(-np.abs(rho[f] - rho[v]))
        weight = 2.0 * small / (1.0 + small * small)
        diagonal = np.bincount(v, weight, self.count) + np.bincount(f, weight, self.count)
        every = np.arange(self.count)
        return csc_array(
            (
                np.concatenate([diagonal, -weight, -weight]),
                (np.concatenate([every, v, f]), np.concatenate([every, f, v])),
            ),
            shape=(self.count, self.count),
        )

    def first_guess(self) -> Floats:
        """(count,) logarithms of radii in a ring of degree-many equal neighbours."""
        v, f = self.corner_circles
        degree = np.bincount(np.concatenate([v, f]), minlength=self.count)
        return np.asarray(-0.5 * np.log(np.tan(np.pi / degree)))

    def radii(self) -> tuple[Floats, tuple[float, ...]]:
        """(count,) radii, infinite for lines, and the greatest missing angle [rad] of each step.

        Raises
        ------
        DegenerateError
            Newton's method stops short of `GRADIENT_TOLERANCE`; names the circle.
        """
        rho = self.first_guess()
        slope = self.gradient(rho)
        history = [float(np.abs(slope).max())]
        while len(history) <= MAX_STEPS and history[-1] > GRADIENT_TOLERANCE:
            step = self._newton_step(rho, slope)
            size, part = float(np.linalg.norm(slope)), 1.0
            while part >= SHORTEST_STEP:
                trial = self.gradient(rho + part * step)
                if np.linalg.norm(trial) <= (1.0 - 0.1 * part) * size:
                    break
                part *= 0.5
            else:
                break
            rho, slope = rho + part * step, trial
            history.append(float(np.abs(slope).max()))
        if history[-1] > GRADIENT_FLOOR:
            worst = int(np.abs(slope).argmax())
            n = self.mesh.n_vertices
            what = f"vertex {worst}" if worst < n else f"face {worst - n}"
            raise DegenerateError(
                f"the circle pattern was not found: after {len(history) - 1} steps the angles at "
                f"the circle of {what} miss {history[-1]:.1e} rad (limit {GRADIENT_TOLERANCE:g})"
            )
        polished = rho + self._newton_step(rho, slope)
        final = self.gradient(polished)
        if np.abs(final).max() < history[-1]:
            rho = polished
            history.append(float(np.abs(final).max()))
        return np.where(self.lines, np.inf, np.exp(rho)), tuple(history)

    def _newton_step(self, rho: Floats, slope: Floats) -> Floats:
        """Newton's step with one circle fixed, that of the greatest weights."""
        matrix = self.hessian(rho)
        free = np.flatnonzero(~self.lines)
        free = np.delete(free, int(matrix.diagonal()[free].argmax()))
        factor = factored(matrix[free][:, free])
        step = np.zeros(self.count)
        step[free] = -factor.solve(slope[free])
        return step


def corner_turns(mesh: Mesh) -> Ints:
    """(C,) for every corner of a closed mesh the next one counterclockwise round its vertex."""
    order = np.argsort(mesh.corner_edge, kind="stable").reshape(-1, 2)
    twin = np.empty(len(mesh.corners), dtype=np.int64)
    twin[order[:, 0]], twin[order[:, 1]] = order[:, 1], order[:, 0]
    return twin[mesh.corner_previous]


def planar_circles(pattern: CirclePattern, radii: Floats) -> Floats:
    """(count, 4) the circles on the sphere, from their radii in the plane.

    A circle or line in the plane, with the side of it that is its disc, is a unit vector
    (x, y, z, w) of Lorentz space, x^2 + y^2 + z^2 - w^2 = 1: the circle in which the plane
    x X + y Y + z Z = w cuts the unit sphere. Circle (C, r): (2 C, s - 1, s + 1) / 2 r with
    s = |C|^2 - r^2; line n.z = c with its disc where n.z > c: (n, c, c). Touching discs have
    product -1, orthogonal circles 0. The plane was projected from the north pole; seen from
    outside the sphere the circles have the orientation of the mesh.

    Source: layout: mathematics.md 7.1; pole of the circle (x, y, z) / w: 7.2.
    """
    v, f = pattern.corner_circles
    mesh, lines = pattern.mesh, pattern.lines
    # Directions of v -> f; seen from above they turn clockwise, from inside the sphere.
    at_vertex, at_face = np.arctan2(radii[f], radii[v]), np.arctan2(radii[v], radii[f])
    here = np.arange(len(v))
    following, turning = mesh.corner_next, corner_turns(mesh)
    both = lines[v] & lines[f]
    start, end = np.concatenate([here, here]), np.concatenate([following, turning])
    steps = -np.concatenate([at_face + at_face[following], at_vertex + at_vertex[turning]])
    keep = ~both[start] & ~both[end]
    root = int((~both).argmax())
    angle = tree_sums(len(v), start[keep], end[keep], steps[keep], root)[0]
    direction = np.exp(1j * angle)
    live = ~lines[v] & ~lines[f]
    jump = np.hypot(radii[v[live]], radii[f[live]]) * direction[live]
    # From the smallest circle on, so that all circles keep their digits; most at moderate places.
    free = ~lines
    root = int(radii.argmin())
    center = tree_sums(pattern.count, v[live], f[live], jump, root)[0]
    scale = float(np.median(np.abs(center[free])))
    center, radius = center / scale, radii / scale
    vectors = np.empty((pattern.count, 4))
    c, r = center[free], radius[free]
    power = (np.abs(c) - r) * (np.abs(c) + r)
    vectors[free] = np.stack([2.0 * c.real, 2.0 * c.imag, power - 1.0, power + 1.0], axis=1)
    vectors[free] /= 2.0 * r[:, None]
    for line in np.flatnonzero(lines).tolist():
        # Circles orthogonal to a line have their centers on it.
        if line < mesh.n_vertices:
            at = np.flatnonzero((v == line) & ~both)
            normals, on = -direction[at], center[f[at]]
        else:
            at = np.flatnonzero((f == line) & ~both)
            normals, on = direction[at], center[v[at]]
        n = normals.mean()
        n /= abs(n)
        offset = float((n.conjugate() * on).real.mean())
        vectors[line] = [n.real, n.imag, offset, offset]
    return vectors
