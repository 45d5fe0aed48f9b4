"""Transformations of nets as further directions: a net and its transforms are one larger net.

Source: Bobenko, Suris, Discrete Differential Geometry, 1.1; maths.md 1.9, 1.10.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.errors import DegenerateError, InputError
from ddgfab.mesh import Floats
from ddgfab.nets.cells import finite
from ddgfab.tolerances import NET_INPUT

Transform = Callable[[Floats], ArrayLike]


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
            size = float(np.ptp(both.reshape(-1, both.shape[-1]), axis=0).max())
            gap = float(np.abs(both - other).max())
            if gap > NET_INPUT * size:
                raise DegenerateError(
                    f"the transforms do not commute: T_b T_a x and T_a T_b x are {gap:g} apart "
                    f"(limit {NET_INPUT * size:g}); give the common transform"
                )
    return stack_transforms([stack_transforms([x, b]), stack_transforms([a, both])]).swapaxes(
        -3, -2
    )
