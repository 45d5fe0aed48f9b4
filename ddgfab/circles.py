"""Circles and spheres in space as plain data, and as curves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ddgfab.errors import InputError
from ddgfab.mesh import Floats, unit


@dataclass(frozen=True, eq=False)
class Circles:
    """Circles in space.

    Attributes
    ----------
    centers : (N, 3)
    normals : (N, 3) unit normals of their planes
    radii : (N,)
    """

    centers: Floats
    normals: Floats
    radii: Floats

    def __len__(self) -> int:
        return len(self.radii)

    def frames(self) -> tuple[Floats, Floats]:
        """Unit vectors x, y of each plane, (N, 3) each, with x, y, normal right-handed."""
        smallest = np.abs(self.normals).argmin(axis=1)
        x = unit(np.cross(self.normals, np.eye(3)[smallest]))
        return x, np.cross(self.normals, x)

    def points(self, count: int) -> Floats:
        """(N, count, 3) points at equal steps round each circle, the first not repeated.

        Raises
        ------
        InputError
            Fewer than three points.
        """
        if count < 3:
            raise InputError(f"{count} points round a circle: 3 or more are needed")
        x, y = self.frames()
        angle = np.arange(count) * (2.0 * np.pi / count)
        around = np.cos(angle)[:, None] * x[:, None] + np.sin(angle)[:, None] * y[:, None]
        return np.asarray(self.centers[:, None] + self.radii[:, None, None] * around)

    def scaled(self, factor: float) -> Circles:
        """The circles with all lengths times a positive factor."""
        return Circles(self.centers * factor, self.normals, self.radii * factor)


@dataclass(frozen=True, eq=False)
class Spheres:
    """Spheres.

    Attributes
    ----------
    centers : (N, 3)
    radii : (N,)
    """

    centers: Floats
    radii: Floats

    def __len__(self) -> int:
        return len(self.radii)

    def great_circles(self) -> Circles:
        """(3 N) circles of each sphere in planes across x, y and z."""
        return Circles(
            np.repeat(self.centers, 3, axis=0),
            np.tile(np.eye(3), (len(self), 1)),
            np.repeat(self.radii, 3),
        )

    def scaled(self, factor: float) -> Spheres:
        """The spheres with all lengths times a positive factor."""
        return Spheres(self.centers * factor, self.radii * factor)


def circles_on_sphere(vectors: Floats) -> Circles:
    """Circles (N, 4) of Lorentz space, (a, b) for the plane <a, x> = b, on the unit sphere.

    <a, a> - b^2 = 1: the radius is 1 / |a|, the center b a / |a|^2.
    """
    size = np.linalg.norm(vectors[:, :3], axis=1)
    normals = vectors[:, :3] / size[:, None]
    return Circles(normals * (vectors[:, 3] / size)[:, None], normals, 1.0 / size)
