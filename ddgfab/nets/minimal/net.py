"""Discrete minimal surfaces: duals of Koebe nets, with the Koebe net as Gauss image."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ddgfab.arguments import checked
from ddgfab.circles import Circles, Spheres
from ddgfab.errors import DegenerateError, InputError
from ddgfab.measures import mixed_areas, oriented_areas
from ddgfab.mesh import Floats, Ints, Mesh
from ddgfab.nets.integration import CLOSING, integrate
from ddgfab.nets.koebe.grids import catenoid_koebe, enneper_koebe
from ddgfab.nets.sisothermic import SIsothermic
from ddgfab.nets.sisothermic_labels import checked_labels
from ddgfab.tolerances import COORDINATE_LIMIT, NET_INPUT


@dataclass(frozen=True, eq=False, repr=False)
class MinimalNet:
    """A discrete s-isothermic minimal surface, or a member of its associated family.

    Made by `minimal_surface`. Faces of the surface itself (angle 0) are parallel to those of the
    Gauss image, so v + d k_v is at the constant distance d of edges (an edge offset).

    Attributes
    ----------
    mesh : the surface
    gauss : the Koebe net with the same faces: vertex k_v, edges touching the unit sphere
    labels : (E,) +1 and -1, alternating round every face
    angle : of the associated family [rad]; 0: the surface, pi / 2: its conjugate
    scale : factor on the dual of the Gauss image
    closing : how far the worst edge is from closing, in parts of the diameter
    """

    mesh: Mesh
    gauss: SIsothermic
    labels: Ints
    angle: float
    scale: float
    closing: float

    @cached_property
    def radii(self) -> Floats:
        """(V,) radii of the spheres about the vertices, scale / r."""
        return np.asarray(self.scale / self.gauss.radii)

    @property
    def spheres(self) -> Spheres:
        """Sphere about each vertex; spheres at the ends of an edge touch."""
        return Spheres(self.mesh.vertices, self.radii)

    @property
    def circles(self) -> Circles:
        """Incircle of each face of the surface itself.

        Raises
        ------
        InputError
            A member of the associated family at an angle, whose faces are skew.
        """
        self._refuse_angle("have no incircles")
        return SIsothermic(self.mesh, self.radii).incircles

    def mean_curvatures(self) -> Floats:
        """(F,) H = -A(f, k) / A(f) of every face f with the parallel face k of the Gauss image.

        Zero on a minimal net. In parts of |A(k) / A(f)|^(1/2), the curvature of the face.

        Raises
        ------
        InputError
            A member of the associated family at an angle, whose faces are skew.

        Source: Bobenko, Pottmann, Wallner 2010; mathematics.md 8.2, 7.6.
        """
        self._refuse_angle("are not parallel to the Gauss image")
        points, normals = self.mesh.vertices, self.gauss.mesh.vertices
        mixed = mixed_areas(self.mesh, points, normals)
        own, image = oriented_areas(self.mesh), oriented_areas(self.mesh, normals)
        return np.asarray(-mixed / own / np.sqrt(np.abs(image / own)))

    def offset(self, distance: float) -> Floats:
        """(V, 3) v + d k_v: vertices of the parallel net at the distance d of every edge.

        Raises
        ------
        InputError
            A distance that is not finite.
        """
        if not np.isfinite(distance):
            raise InputError(f"distance {distance}: a finite number is needed")
        return np.asarray(self.mesh.vertices + distance * self.gauss.mesh.vertices)

    def associated(self, angle: float) -> MinimalNet:
        """The member at an angle [rad] of the associated family; pi / 2: the conjugate surface.

        Edge e with contact point T of its Koebe edge turns in the tangent plane:
        cos(angle) e + sin(angle) T x e. Edge lengths and contact normals stay; faces get skew.

        Raises
        ------
        DegenerateError
            The member does not close, as on a ring (a catenoid): cut it open first.

        Source: Bobenko, Hoffmann, Springborn 2006, section 7; mathematics.md 7.7.
        """
        return _integrated(self.gauss, self.labels, angle, self.scale)

    def _refuse_angle(self, what: str) -> None:
        if self.angle != 0.0:
            raise InputError(
                f"faces at {np.degrees(self.angle):g} deg of the associated family {what}; "
                "take the surface at angle 0"
            )

    def scaled(self, factor: float) -> MinimalNet:
        """The surface with all lengths times a positive factor; the Gauss image stays.

        Raises
        ------
        InputError
            A factor that is not positive, or huge.
        """
        if not 0 < factor <= COORDINATE_LIMIT:
            raise InputError(f"factor {factor}: a positive number is needed")
        return replace(self, mesh=self.mesh.scaled(factor), scale=self.scale * factor)

    def __repr__(self) -> str:
        return f"MinimalNet({self.mesh!r}, angle {np.degrees(self.angle):g} deg)"


@checked
def minimal_surface(
    gauss: SIsothermic,
    *,
    angle: float = 0.0,
    labels: Ints | None = None,
    scale: float = 1.0,
    tolerance: float | None = None,
) -> MinimalNet:
    """The discrete minimal surface with a Koebe net as Gauss image: its dual.

    Parameters
    ----------
    gauss : edges touch the unit sphere: `KoebePolyhedron.net(faces)`, `enneper_koebe`, ...
    angle : of the associated family [rad]
    labels : (E,) alternating signs; found by default. Other signs give the mirror point image.
    scale : factor on the dual; 1: edges e / (r_i r_j)
    tolerance : by which edges may miss the sphere, and the surface its closing in parts of its
        diameter; by default `NET_INPUT` and `CLOSING`, for files of six digits about 1e-4

    Raises
    ------
    InputError
        Labels of another shape or others than +1 and -1, a scale that is zero or not finite.
    DegenerateError
        An edge that does not touch the unit sphere (names it), or edges that do not close.
    MeshError
        No labelling of the edges exists; names the faces.

    Source: Bobenko, Hoffmann, Springborn, Minimal surfaces from circle patterns (2006);
    Def. 4.4; mathematics.md 7.6, 7.7.
    """
    off = np.abs(np.linalg.norm(gauss.contacts, axis=1) - 1.0)
    sine = np.abs(np.einsum("ex,ex->e", gauss.contacts, gauss.mesh.edge_vectors))
    miss = np.maximum(off, sine / gauss.mesh.edge_lengths)
    worst = int(miss.argmax())
    limit = NET_INPUT if tolerance is None else tolerance
    if not miss[worst] <= limit:
        raise DegenerateError(
            f"the Gauss image is not a Koebe net: edge {worst} misses the unit sphere by "
            f"{miss[worst]:.1e} (limit {limit:g})"
        )
    signs = checked_labels(gauss.mesh, labels)
    if not (np.isfinite(scale) and scale != 0):
        raise InputError(f"scale {scale}: a number other than zero is needed")
    return _integrated(gauss, signs, angle, scale, CLOSING if tolerance is None else tolerance)


def _integrated(
    gauss: SIsothermic, labels: Ints, angle: float, scale: float, limit: float = CLOSING
) -> MinimalNet:
    i, j = gauss.mesh.edges.T
    edges = (scale * labels / (gauss.radii[i] * gauss.radii[j]))[:, None] * gauss.mesh.edge_vectors
    if angle != 0.0:
        edges = np.cos(angle) * edges + np.sin(angle) * np.cross(gauss.contacts, edges)
    points, closing = integrate(gauss.mesh, edges, limit)
    return MinimalNet(gauss.mesh.with_vertices(points), gauss, labels, angle, scale, closing)


@checked
def enneper(cells: tuple[int, int], half_step: float) -> MinimalNet:
    """Enneper's surface over a square grid, dual of `enneper_koebe`, scaled by 2 h^2.

    Vertex (u, v), multiples of 2 h: (u(1 + v^2 + h^2/3) - u^3/3, -v(1 + u^2 + h^2/3) + v^3/3,
    u^2 - v^2) up to a motion.

    Source: mathematics.md 7.6; errors as in `enneper_koebe`.
    """
    return minimal_surface(enneper_koebe(cells, half_step), scale=2.0 * half_step**2)


@checked
def catenoid(around: int, rings: tuple[int, int], columns: int | None = None) -> MinimalNet:
    """The discrete catenoid (cosh(I l) e^(i J a), I sinh l), dual of `catenoid_koebe`.

    Source: mathematics.md 7.6; parameters and errors as in `catenoid_koebe`.
    """
    gauss = catenoid_koebe(around, rings, columns)
    alpha = np.pi / around
    return minimal_surface(gauss, scale=float(np.sin(alpha) ** 2 / np.cos(alpha)))


@checked
def helicoid(around: int, rings: tuple[int, int], columns: int) -> MinimalNet:
    """The discrete helicoid: the conjugate of a catenoid cut open, columns of `around` in a turn.

    Source: mathematics.md 7.7; parameters and errors as in `catenoid_koebe`.
    """
    return catenoid(around, rings, columns).associated(0.5 * np.pi)
