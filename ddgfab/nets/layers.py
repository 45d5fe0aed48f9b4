"""Transformations of nets as further directions: a net and its transforms are one larger net.

Source: Bobenko, Suris, Discrete Differential Geometry, 1.1; mathematics.md 1.9, 1.10.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.errors import DegenerateError, InputError
from ddgfab.mesh import Floats, extent
from ddgfab.nets.cubes import coordinate_surfaces, evolve_nd
from ddgfab.quads import Place, finite
from ddgfab.tolerances import NET_INPUT

Transform = Callable[[Floats], ArrayLike]


def sample(surface: Callable[..., ArrayLike], *parameters: ArrayLike) -> Floats:
    """(n1, ..., nd, dim) net of a smooth map of d variables at given values of each.

    Parameters
    ----------
    surface : d numbers to a point (dim,); called once for each point
    parameters : d arrays (n_k,)
    """
    values = [np.asarray(p, dtype=np.float64) for p in parameters]
    if not values or any(p.ndim != 1 or not len(p) for p in values):
        raise InputError(f"parameters of shapes {[p.shape for p in values]}: lists are needed")
    shape = tuple(len(p) for p in values)
    points = [
        np.asarray(surface(*(float(p[i]) for p, i in zip(values, at, strict=True))), np.float64)
        for at in np.ndindex(*shape)
    ]
    net = np.stack(points).reshape(*shape, -1)
    finite(net, "sampled surface")
    return net


def stack_transforms(nets: Sequence[ArrayLike]) -> Floats:
    """(n1, ..., nd, k, dim) net whose layers in the last direction are the given nets.

    All measures of a class of nets apply to the result unchanged: two parallel meshes are layers
    of a conjugate net, a Ribaucour pair those of a circular one.

    Parameters
    ----------
    nets : k > 1 nets (n1, ..., nd, dim) of one shape

    Raises
    ------
    InputError
        Fewer than two nets, shapes that differ, entries that are not finite; names the sheet.
    """
    sheets = [np.asarray(net, dtype=np.float64) for net in nets]
    if len(sheets) < 2:
        raise InputError(f"{len(sheets)} sheets: two at least are needed")
    for number, sheet in enumerate(sheets):
        if sheet.ndim < 2 or sheet.shape != sheets[0].shape:
            raise InputError(f"sheet {number} has shape {sheet.shape}, sheet 0 {sheets[0].shape}")
        finite(sheet, f"sheet {number}")
    return np.stack(sheets, axis=-2)


def lattice(
    net: ArrayLike,
    transform_a: Transform,
    transform_b: Transform,
    common: Callable[[Floats, Floats, Floats], ArrayLike] | None = None,
) -> Floats:
    """(n1, ..., nd, 2, 2, dim) net of a net, two transforms and their common transform.

    z[..., 0, 0] = x, z[..., 1, 0] = T_a x, z[..., 0, 1] = T_b x, z[..., 1, 1] the common one.

    Parameters
    ----------
    net : (n1, ..., nd, dim)
    transform_a, transform_b : net to net, of the same shape
    common : (x, T_a x, T_b x) to the common transform; by default T_b T_a x, which must be
        T_a T_b x (permutability)

    Raises
    ------
    DegenerateError
        T_b T_a x and T_a T_b x differ; gives the distance.
    InputError
        Shapes that differ.
    """
    x = np.asarray(net, dtype=np.float64)
    a, b = (np.asarray(t(x), dtype=np.float64) for t in (transform_a, transform_b))
    if common is not None:
        both = np.asarray(common(x, a, b), dtype=np.float64)
    else:
        both = np.asarray(transform_b(a), dtype=np.float64)
        other = np.asarray(transform_a(b), dtype=np.float64)
        if both.shape == other.shape:
            size = extent(both)
            gap = float(np.linalg.norm(both - other, axis=-1).max())
            if gap > NET_INPUT * size:
                raise DegenerateError(
                    f"the transforms do not commute: T_b T_a x and T_a T_b x are {gap:g} apart "
                    f"(limit {NET_INPUT * size:g}); give the common transform"
                )
    return np.stack([stack_transforms([x, b]), stack_transforms([a, both])], axis=-3)


def common_transform(
    net: ArrayLike, first: ArrayLike, second: ArrayLike, corner: ArrayLike
) -> Floats:
    """The net that is a transform of two transforms of one net: T_ab x, given its first point.

    Conjugate nets (parallel ones among them) and circular nets (Ribaucour transforms): x, T_a x,
    T_b x and T_ab x are the four layers of a net of two more directions, and 4D consistency makes
    the rest from the first point. For `lattice`.

    Parameters
    ----------
    net, first, second : (n1, ..., nd, dim) x, T_a x, T_b x
    corner : (dim,) first point of T_ab x, in the plane (for circular nets: on the circle) of the
        first points of the three

    Raises
    ------
    DegenerateError
        A quad that is not planar, or layers that are no transforms of the net; as `evolve_nd`.

    Source: Bobenko, Suris, 2.1, 3.1; mathematics.md 1.9.
    """
    x, a, b = (np.asarray(part, dtype=np.float64) for part in (net, first, second))
    origin = (0,) * (x.ndim - 1)
    given = np.stack([stack_transforms([x, b]), stack_transforms([a, a])], axis=-3)
    given[(*origin, 1, 1)] = corner
    made = evolve_nd(coordinate_surfaces(given))
    size = extent(x)
    for name, sheet, layer in (("first", a, made[..., 1, 0, :]), ("second", b, made[..., 0, 1, :])):
        gap = np.linalg.norm(sheet - layer, axis=-1)
        Place(name=f"{name} transform, point").refuse(
            gap > NET_INPUT * size, "it is no transform of the net: distance", gap
        )
    return np.asarray(made[..., 1, 1, :])
