"""Koebe nets in closed form: of the square grid of circles, and of rotational circle patterns."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.arguments import checked
from ddgfab.errors import DegenerateError, InputError
from ddgfab.grid import grid_mesh
from ddgfab.mesh import Floats
from ddgfab.nets.sisothermic import SIsothermic
from ddgfab.quads import finite, whole


@checked
def koebe_vertex(centers: ArrayLike, radii: ArrayLike) -> tuple[Floats, Floats]:
    """Koebe vertices (..., 3) of circles in the plane, and their distances (...) to the sphere.

    The plane is projected from the north pole: circle (C, r) goes to the vertex
    (2 C, |C|^2 - r^2 - 1) / (1 + |C|^2 - r^2) at tangent length 2 r / (1 + |C|^2 - r^2).

    Parameters
    ----------
    centers : (..., 2)
    radii : (...) or a number, positive

    Raises
    ------
    InputError
        Shapes that do not go together, entries that are not finite, a radius that is not positive.
    DegenerateError
        A circle that goes to a great circle, or whose disc goes to more than half of the sphere;
        names its index.

    Source: mathematics.md 7.2.
    """
    c, r = np.asarray(centers, dtype=np.float64), np.asarray(radii, dtype=np.float64)
    if c.ndim < 1 or c.shape[-1] != 2:
        raise InputError(f"centers have shape {c.shape}; (..., 2) is needed")
    if r.ndim and r.shape != c.shape[:-1]:
        raise InputError(f"radii have shape {r.shape}; {c.shape[:-1]} or one number is needed")
    finite(c, "centers")
    finite(r, "radii")
    if not (r > 0).all():
        raise InputError(f"a circle has the radius {r.min():g}; radii are positive")
    power = np.sum(c * c, axis=-1) - r * r
    below = 1.0 + power
    bad = np.argwhere(below <= 0)
    if len(bad):
        raise DegenerateError(
            f"circle {tuple(bad[0].tolist())} covers half of the sphere or more: its vertex is at "
            "infinity or behind; make the circles smaller"
        )
    points = np.concatenate([2.0 * c, (power - 1.0)[..., None]], axis=-1) / below[..., None]
    return points, 2.0 * r / below


@checked
def enneper_koebe(cells: tuple[int, int], half_step: float) -> SIsothermic:
    """Koebe net of a square grid of circles of radius h at steps 2 h, centered at the south pole.

    Its dual is Enneper's surface. The mesh is oriented with normals out of the sphere.

    Parameters
    ----------
    cells : numbers of cells in both directions
    half_step : h

    Raises
    ------
    InputError
        No cells, or h not positive.
    DegenerateError
        Circles larger than half the sphere (h near 1).

    Source: mathematics.md 7.6.
    """
    cells = (whole(cells[0], 1, "cells of direction 0"), whole(cells[1], 1, "cells of direction 1"))
    if not 0 < half_step < np.inf:
        raise InputError(f"h = {half_step:g}: half a step is a positive number")
    u, v = (half_step * (2.0 * np.arange(n + 1) - n) for n in cells)
    centers = np.stack(np.meshgrid(u, v, indexing="ij"), axis=-1)
    points, radii = koebe_vertex(centers, half_step)
    # Seen from outside, the projected plane is a mirror image: directions change places.
    net = grid_mesh(np.swapaxes(points, 0, 1))
    return SIsothermic(net, radii.T.ravel())


@checked
def catenoid_koebe(around: int, rings: tuple[int, int], columns: int | None = None) -> SIsothermic:
    """Rotational Koebe net about the z axis, whose dual is a catenoid.

    Vertices (sech(I l) e^(i J a) / cos a, tanh(I l)) with a = pi / around, l = asinh(tan a) and
    I, J even.

    Parameters
    ----------
    around : vertices in a full ring
    rings : first and last ring, I / 2, for instance (-3, 3)
    columns : columns of faces of a net cut open; None: closed round the axis

    Raises
    ------
    InputError
        Fewer than three around, no rings, or no columns.

    Source: mathematics.md 7.6.
    """
    closed = columns is None
    around = whole(around, 3, "around")
    count = around - 1 if columns is None else whole(columns, 1, "columns")
    whole(rings[1] - rings[0], 1, f"the rise of rings from {rings[0]} to {rings[1]}")
    alpha = np.pi / around
    step = np.arcsinh(np.tan(alpha))
    i = 2.0 * np.arange(rings[0], rings[1] + 1) * step
    j = 2.0 * np.arange(count + 1) * alpha
    across = 1.0 / (np.cosh(i) * np.cos(alpha))
    points = np.empty((len(j), len(i), 3))
    points[..., 0], points[..., 1] = np.outer(np.cos(j), across), np.outer(np.sin(j), across)
    points[..., 2] = np.tanh(i)
    # |v|^2 - 1 = tan^2(a) sech^2(i), without its cancellation
    radii = np.tan(alpha) / np.cosh(i)
    mesh = grid_mesh(points, closed=(closed, False))
    return SIsothermic(mesh, np.tile(radii, len(j)))
