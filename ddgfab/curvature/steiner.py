"""Mean and Gaussian curvature of a mesh with a parallel Gauss image, by Steiner's formula.

A(f + t sigma) = A(f) + 2 t A(f, sigma) + t^2 A(sigma) = A(f) (1 - 2 H t + K t^2).
Source: Bobenko, Pottmann, Wallner 2010, A curvature theory for discrete surfaces based on mesh
parallelity; mathematics.md 8.2.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.arguments import checked
from ddgfab.errors import DegenerateError, MeshError
from ddgfab.measures import mixed_areas, oriented_areas
from ddgfab.mesh import Floats, Mesh
from ddgfab.tolerances import COORDINATE_LIMIT, RELATIVE_DEGENERATE

PARALLEL_SINE: Final = 1e-6
"""Edges of a Gauss image may turn away from the mesh's by this sine."""


@dataclass(frozen=True, eq=False)
class Curvatures:
    """Mean and Gaussian curvature of each face (F,), by the unit of length and its square.

    A sphere of radius R whose normals point outward has H = -1 / R, K = 1 / R^2.
    """

    mean: Floats
    gauss: Floats

    @property
    def principal(self) -> tuple[Floats, Floats]:
        """(F,) principal curvatures H +- sqrt(H^2 - K), larger first.

        Equal ones where the root would be imaginary: H^2 < K happens on meshes that are not
        circular, conical or Koebe.
        """
        root = np.sqrt(np.maximum(self.mean**2 - self.gauss, 0.0))
        return self.mean + root, self.mean - root


@checked
def steiner_curvatures(
    mesh: Mesh, gauss_image: ArrayLike, tolerance: float = PARALLEL_SINE
) -> Curvatures:
    """H = -A(f, sigma) / A(f) and K = A(sigma) / A(f) of every face.

    Parameters
    ----------
    gauss_image : (V, 3) vertices sigma of a mesh parallel to this one: unit normals of a circular
        net, vertices of the Koebe polyhedron of an s-isothermic one, ...
    tolerance : on the sine between the edges of the two; files of few digits need more

    Raises
    ------
    MeshError
        A Gauss image of the wrong shape, with entries that are not finite (names the vertex), or
        whose edges are not parallel (names the edge).
    DegenerateError
        A face without area; names it.

    Examples
    --------
    A cube that touches the unit sphere is its own Gauss image.

    >>> from ddgfab.forms.registry import generate
    >>> from ddgfab.mesh import Mesh
    >>> cube = Mesh.build(
    ...     [[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)],
    ...     [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]],
    ... )
    >>> curvatures = steiner_curvatures(cube, cube.vertices)
    >>> curvatures.mean, curvatures.gauss
    (array([-1., -1., -1., -1., -1., -1.]), array([1., 1., 1., 1., 1., 1.]))

    Source: mathematics.md 8.2 (with K = +A(sigma) / A(f), as Steiner's formula says).
    """
    sigma = np.asarray(gauss_image, dtype=np.float64)
    if sigma.shape != mesh.vertices.shape:
        raise MeshError(f"the Gauss image has shape {sigma.shape}; {mesh.vertices.shape} needed")
    bad = np.flatnonzero(~(np.abs(sigma) <= COORDINATE_LIMIT).all(axis=1))
    if len(bad):
        raise MeshError(
            f"vertex {bad[0]} of the Gauss image is {sigma[bad[0]]}, not finite numbers below "
            f"{COORDINATE_LIMIT:g}"
        )
    image = sigma[mesh.edges[:, 1]] - sigma[mesh.edges[:, 0]]
    length = np.linalg.norm(image, axis=1)
    turned = np.linalg.norm(np.cross(mesh.edge_vectors, image), axis=1)
    # Short edges of the image are measured by its size: their direction means nothing.
    size = float(length.max(initial=0.0))
    off = turned > tolerance * mesh.edge_lengths * np.maximum(length, tolerance * size)
    if off.any():
        edge = int(np.argmax(off))
        sine = turned[edge] / (mesh.edge_lengths[edge] * length[edge])
        a, b = mesh.edges[edge]
        raise MeshError(
            f"the Gauss image is not parallel: its edge {edge} ({a}-{b}) turns away from the "
            f"mesh's by a sine of {sine:.2g} (limit {tolerance:g})"
        )
    area = oriented_areas(mesh)
    longest = np.maximum.reduceat(mesh.edge_lengths[mesh.corner_edge], mesh.face_start[:-1])
    flat = np.flatnonzero(~(area > RELATIVE_DEGENERATE * longest**2))
    if len(flat):
        raise DegenerateError(f"face {flat[0]} has area {area[flat[0]]:.3g}: no curvature there")
    mixed = mixed_areas(mesh, mesh.vertices, sigma)
    return Curvatures(-mixed / area, oriented_areas(mesh, sigma) / area)
