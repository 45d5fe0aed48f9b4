"""Circular nets in three and more directions: Miquel's theorem carries circles through cubes.

Source: Bobenko, Suris, Discrete Differential Geometry, Theorem 3.2; mathematics.md 2.4.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import combinations

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.arguments import checked
from ddgfab.errors import InputError
from ddgfab.mesh import Floats
from ddgfab.nets.circular import circularity, circularity_kernel, evolve_by_angles
from ddgfab.nets.cubes import cube_point, evolve_nd
from ddgfab.quads import Place, columns, net_points
from ddgfab.tolerances import NET_INPUT


@checked
def miquel_point(
    x: ArrayLike,
    x1: ArrayLike,
    x2: ArrayLike,
    x3: ArrayLike,
    x12: ArrayLike,
    x13: ArrayLike,
    x23: ArrayLike,
    tolerance: float = NET_INPUT,
) -> Floats:
    """(..., dim) eighth vertex of cubes with circular quads: on the circles of all further faces.

    All eight vertices lie on one sphere.

    Parameters
    ----------
    x, x1, x2, x3, x12, x13, x23 : (..., dim) with circular quads at x
    tolerance : on their circularity, relative

    Raises
    ------
    DegenerateError
        A quad at x that is not circular, or as `cubes.cube_point`; names the index of the cube.

    Source: Miquel; mathematics.md 2.4.
    """
    points = columns(x, x1, x2, x3, x12, x13, x23)
    for (k, m), corner in zip(((1, 2), (1, 3), (2, 3)), points[4:], strict=True):
        place = Place(name="cube")
        off = circularity_kernel(points[0], points[k], points[m], corner, place)
        place.refuse(off > tolerance, f"quad ({k - 1}, {m - 1}) is not circular", off)
    return cube_point(x, x1, x2, x3, x12, x13, x23, tolerance)


@checked
def evolve_circular(
    surfaces: Mapping[tuple[int, int], ArrayLike],
    *,
    verify: bool = False,
    tolerance: float = NET_INPUT,
) -> Floats:
    """(n1, ..., nd, dim) circular net from its circular coordinate surfaces, d > 2.

    Parameters
    ----------
    surfaces : by pairs (k, l), k < l < d: (n_k, n_l, dim) circular nets with common axes
    verify, tolerance : as in `cubes.evolve_nd`; the tolerance also on circularity

    Raises
    ------
    InputError, DegenerateError
        As `cubes.evolve_nd`; and a quad of a surface that is not circular.

    Source: mathematics.md 2.4.
    """
    for pair, surface in surfaces.items():
        net = net_points(surface)
        if min(net.shape[:2]) > 1:
            off = circularity(net)
            place = Place(name=f"surface {pair}, quad")
            place.refuse(off > tolerance, f"it is not circular, limit {tolerance:g}", off)
    return evolve_nd(surfaces, verify=verify, tolerance=tolerance)


@checked
def evolve_circular_by_angles(
    lines: Sequence[ArrayLike],
    angles: Mapping[tuple[int, int], ArrayLike],
    *,
    convex: bool = False,
    verify: bool = False,
) -> Floats:
    """(n1, ..., nd, dim) circular net from d polylines and the angles on coordinate surfaces.

    Parameters
    ----------
    lines : d > 1 polylines (n_k, dim) from one point
    angles : by pairs (k, l), k < l: (n_k - 1, n_l - 1) or number [rad], see `evolve_by_angles`
    convex : whether to refuse quads of the coordinate surfaces that are not convex
    verify : as in `cubes.evolve_nd`

    Raises
    ------
    InputError, DegenerateError
        As `evolve_by_angles` and `cubes.evolve_nd`.

    Source: mathematics.md 2.3, 2.4.
    """
    wanted = list(combinations(range(len(lines)), 2))
    if not wanted or sorted(angles) != wanted:
        raise InputError(f"angles for directions {sorted(angles)}; {wanted} are needed")
    surfaces = {
        (k, m): evolve_by_angles(lines[k], lines[m], angles[k, m], convex=convex) for k, m in wanted
    }
    if len(lines) == 2:
        return surfaces[0, 1]
    return evolve_nd(surfaces, verify=verify)


@checked
def sphere_defect(points: ArrayLike) -> Floats:
    """(n1 - 1, n2 - 1, n3 - 1) distance of the cubes' vertices from one sphere, by its radius.

    The sphere through x, x_1, x_2, x_3; where these are in one plane, 0 is not to be expected.

    Parameters
    ----------
    points : (n1, n2, n3, 3)

    Raises
    ------
    DegenerateError
        Edges at the first corner in one plane; names the cube.

    Source: mathematics.md 2.4.
    """
    x = net_points(points, 3)
    if x.ndim != 4:
        raise InputError(f"a net of three directions is needed; this has shape {x.shape}")
    corner = {
        shift: x[tuple(slice(s, n - 1 + s) for s, n in zip(shift, x.shape[:3], strict=True))]
        for shift in np.ndindex(2, 2, 2)
    }
    origin = corner[0, 0, 0]
    away = np.stack([p - origin for p in corner.values()], axis=-2)
    edges = away[..., [4, 2, 1], :]
    lengths = np.linalg.norm(edges, axis=-1)
    Place(name="cube").refuse((lengths == 0).any(axis=-1), "an edge has no length")
    system = edges / lengths[..., None]
    volume = np.abs(np.linalg.det(system))
    place = Place(name="cube")
    place.refuse(volume <= NET_INPUT, "the edges at its first corner are in one plane", volume)
    center = np.linalg.solve(system, 0.5 * lengths[..., None])[..., 0]
    radius = np.linalg.norm(center, axis=-1)
    off = np.abs(np.linalg.norm(away - center[..., None, :], axis=-1) - radius[..., None])
    return np.asarray(off.max(axis=-1) / radius)
