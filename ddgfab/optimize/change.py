"""What an optimisation did to a design: distance both ways, rise, volume, creases, edges, faces."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np

from ddgfab.measures import dihedral_angles, interior_angles
from ddgfab.mesh import Floats, Ints, Mesh
from ddgfab.optimize.problem import mean_edge
from ddgfab.optimize.quality import folded_faces, reflex_faces, zigzag
from ddgfab.optimize.surface import SmoothSurface, beyond

_QUAD: Final = 4
_FLAT: Final = 1e-2
"""Meshes that rise by less than this part of their width are flat: nothing to keep."""
_HOLLOW: Final = 0.05
"""Volumes below this part of area times rise are differences of bumps and dents: none is named."""
_PERCENTILE: Final = 99.0
_STRETCHES: Final = (5.0, 50.0, 95.0)


@dataclass(frozen=True, eq=False)
class Change:
    """A mesh before and after, compared. Lengths in the unit of the meshes, angles in radians.

    Attributes
    ----------
    before, after : the same faces on other vertices
    reference : the surface that distances are measured from: `before`, or another mesh
    """

    before: Mesh
    after: Mesh
    reference: Mesh

    @cached_property
    def edge(self) -> float:
        """Mean edge of the mesh before."""
        return mean_edge(self.before)

    @cached_property
    def movement(self) -> Floats:
        """(V,) how far each vertex moved."""
        moved: Floats = np.linalg.norm(self.after.vertices - self.before.vertices, axis=1)
        return moved

    @cached_property
    def from_surface(self) -> Floats:
        """(V,) distance of each vertex of the result from the surface."""
        return SmoothSurface(self.reference).distance(self.after.vertices)

    @cached_property
    def _both(self) -> tuple[tuple[float, float], tuple[float, float]]:
        away = distances(self.after, self.reference)
        within = None if self.reference is self.before else self.before
        back = distances(self.reference, self.after, within)
        return away, back

    @property
    def distance_mean(self) -> float:
        """Mean distance between result and surface: the greater of both directions.

        One direction alone can be cheated: a mesh that slid together has no distance from the
        surface, but leaves parts of it bare.
        """
        return max(self._both[0][0], self._both[1][0])

    @property
    def distance_max(self) -> float:
        """Greatest distance between result and surface, of both directions."""
        return max(self._both[0][1], self._both[1][1])

    @property
    def distance_out(self) -> tuple[float, float]:
        """Mean and greatest distance from the result to the surface."""
        return self._both[0]

    @property
    def distance_back(self) -> tuple[float, float]:
        """Mean and greatest distance from the surface to the result."""
        return self._both[1]

    @cached_property
    def rise_kept(self) -> float | None:
        """Extent along the least principal axis, after over before; None for flat meshes."""
        before = self.before
        center, axes, width = _axes(before)
        rise = [np.ptp((m.vertices[m.corners] - center) @ axes[0]) for m in (before, self.after)]
        return float(rise[1] / rise[0]) if rise[0] > _FLAT * width else None

    @cached_property
    def volume_kept(self) -> float | None:
        """Volume below the surface, boundaries closed by cones, after over before."""
        center, axes, width = _axes(self.before)
        before, after = (enclosed_volume(m, center) for m in (self.before, self.after))
        rise = float(np.ptp((self.before.vertices[self.before.corners] - center) @ axes[0]))
        least = _HOLLOW * max(rise, _FLAT * width) * float(self.before.face_areas.sum())
        return after / before if abs(before) > least else None

    @cached_property
    def creases(self) -> Floats:
        """(E,) how much dihedral angles changed [rad]; 0 at the boundary."""
        turned: Floats = np.abs(dihedral_angles(self.after) - dihedral_angles(self.before))
        turned = np.minimum(turned, 2 * np.pi - turned)
        turned[self.before.boundary_edge] = 0.0
        return turned

    @property
    def crease(self) -> tuple[float, float]:
        """99th percentile and greatest change of dihedral angles [rad]."""
        inner = self.creases[~self.before.boundary_edge]
        if not len(inner):
            return 0.0, 0.0
        return float(np.percentile(inner, _PERCENTILE)), float(inner.max())

    @cached_property
    def zigzags(self) -> tuple[Floats, Floats]:
        """(E,) before and after: by how much the bend at an edge differs from those beside it."""
        return zigzag(self.before), zigzag(self.after)

    @property
    def zigzag(self) -> tuple[float, float]:
        """Root mean square of `zigzags` over the inner edges, before and after [rad]."""
        inner = ~self.before.boundary_edge
        if not inner.any():
            return 0.0, 0.0
        before, after = (float(np.sqrt((z[inner] ** 2).mean())) for z in self.zigzags)
        return before, after

    @cached_property
    def corner_angles(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """Least and greatest interior angle [rad], before and after."""
        one, two = (interior_angles(m) for m in (self.before, self.after))
        return (float(one.min()), float(one.max())), (float(two.min()), float(two.max()))

    @cached_property
    def edge_ratios(self) -> Floats:
        """(E,) length of each edge over what it was."""
        was = np.maximum(self.before.edge_lengths, np.finfo(float).tiny)
        ratios: Floats = self.after.edge_lengths / was
        return ratios

    @property
    def edge_ratio(self) -> tuple[float, float]:
        """Least and greatest length of an edge over what it was."""
        return float(self.edge_ratios.min()), float(self.edge_ratios.max())

    @property
    def edge_stretch(self) -> tuple[float, float, float]:
        """The same ratio at 5, 50 and 95 of 100 edges."""
        low, middle, high = np.percentile(self.edge_ratios, _STRETCHES).tolist()
        return low, middle, high

    @cached_property
    def _reflex(self) -> Ints:
        new: Ints = np.setdiff1d(reflex_faces(self.after), reflex_faces(self.before))
        return new

    @property
    def reflex_quads(self) -> Ints:
        """Ids of faces of up to four corners that have a reflex corner and had none."""
        found: Ints = self._reflex[self.before.face_sizes[self._reflex] <= _QUAD]
        return found

    @property
    def reflex_polygons(self) -> Ints:
        """The same for larger faces: on saddles planar hexagons have reflex corners."""
        found: Ints = self._reflex[self.before.face_sizes[self._reflex] > _QUAD]
        return found

    @cached_property
    def folded(self) -> Ints:
        """Ids of faces that are folded or collapsed and were not."""
        return folded_faces(self.after, self.before)


def distances(one: Mesh, other: Mesh, within: Mesh | None = None) -> tuple[float, float]:
    """Mean and greatest distance of the faces of a mesh from another mesh.

    Sampled at vertices, edge midpoints and face centroids; the mean is weighted by area (linear
    interpolation between the samples of each face).

    Parameters
    ----------
    within : samples off the boundary of this mesh do not count, as where a surface is larger
    """
    sizes = one.face_sizes
    ends = one.vertices[one.corners], one.vertices[one.corners[one.corner_next]]
    centers = np.add.reduceat(ends[0], one.face_start[:-1]) / sizes[:, None]
    hub = centers[one.corner_face]
    area = 0.5 * np.linalg.norm(np.cross(ends[0] - hub, ends[1] - hub), axis=1)
    middles = one.vertices[one.edges].mean(axis=1)
    used = np.flatnonzero(one.valences > 0)
    weights = np.concatenate(
        [
            np.bincount(one.corners, area / 6, one.n_vertices)[used]
            + np.bincount(one.corners[one.corner_next], area / 6, one.n_vertices)[used],
            np.bincount(one.corner_edge, area / 3, one.n_edges),
            np.bincount(one.corner_face, area / 3, one.n_faces),
        ]
    )
    points = np.concatenate([one.vertices[used], middles, centers])
    if within is not None:
        inside = ~beyond(within, points)
        points, weights = points[inside], weights[inside]
    if not len(points):
        return 0.0, 0.0
    far = SmoothSurface(other).distance(points)
    total = max(float(weights.sum()), np.finfo(float).tiny)
    return float(far @ weights) / total, float(far.max())


def _axes(mesh: Mesh) -> tuple[Floats, Floats, float]:
    """Area-weighted center of a mesh, its principal axes, the least first, and its width."""
    centers = np.add.reduceat(mesh.vertices[mesh.corners], mesh.face_start[:-1])
    centers /= mesh.face_sizes[:, None]
    area = mesh.face_areas
    total = max(float(area.sum()), np.finfo(float).tiny)
    center = area @ centers / total
    away = centers - center
    axes = np.linalg.eigh((away * area[:, None]).T @ away)[1].T
    return center, axes, float(np.sqrt(total))


def enclosed_volume(mesh: Mesh, center: Floats) -> float:
    """Signed volume of a mesh whose boundary loops are closed by cones from their centroids."""
    points = mesh.vertices - center
    first = np.add.reduceat(points[mesh.corners], mesh.face_start[:-1]) / mesh.face_sizes[:, None]
    a, b = points[mesh.corners], points[mesh.corners[mesh.corner_next]]
    total = np.einsum("cx,cx->", first[mesh.corner_face], np.cross(a, b))
    for loop in mesh.boundary_loops:
        rim = points[loop]
        total -= np.einsum("x,cx->", rim.mean(axis=0), np.cross(rim, np.roll(rim, -1, axis=0)))
    return float(total) / 6
