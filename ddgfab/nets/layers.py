"""Transformations of nets as further directions: a net and its transforms are one larger net.

Source: Bobenko, Suris, Discrete Differential Geometry, 1.1; mathematics.md 1.9, 1.10.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.arguments import checked, is_numeric, of_shape
from ddgfab.errors import DegenerateError, InputError
from ddgfab.mesh import Floats, extent
from ddgfab.nets.asymptotic import star_flatness
from ddgfab.nets.circular import circular_residuals, circularity
from ddgfab.nets.conical import conical_residuals
from ddgfab.nets.conjugate import conjugate_residuals, planarity
from ddgfab.nets.cubes import coordinate_surfaces, evolve_nd
from ddgfab.nets.isothermic import cross_ratio_labels
from ddgfab.nets.moutard import moutard_coefficients
from ddgfab.quads import Place, finite, net_points, pairs
from ddgfab.tolerances import NET_INPUT

Transform = Callable[[Floats], ArrayLike]
Residuals = Callable[[Floats], Mapping[str, float]]


@checked
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


@checked
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


@checked
def lattice(
    net: ArrayLike,
    transform_a: Transform,
    transform_b: Transform,
    common: Callable[[Floats, Floats, Floats], ArrayLike] | None = None,
    *,
    residuals: Residuals | None = None,
    tolerance: float = NET_INPUT,
) -> Floats:
    """(n1, ..., nd, 2, 2, dim) net of a net, two transforms and their common transform.

    z[..., 0, 0] = x, z[..., 1, 0] = T_a x, z[..., 0, 1] = T_b x, z[..., 1, 1] the common one.

    It is a net of the class to which the net with T_a x and the net with T_b x belong (conjugate,
    circular, conical, isothermic, A-net, T-net: all that hold are demanded), also in the quads of
    the two new directions. That the transforms commute is not enough: two Combescure transforms
    may, and their quads be skew.

    Parameters
    ----------
    net : (n1, ..., nd, dim)
    transform_a, transform_b : net to net, of the same shape
    common : (x, T_a x, T_b x) to the common transform; by default T_b T_a x, which must be
        T_a T_b x (permutability)
    residuals : a net of any number of directions to the defects of its class by name, instead of
        the classes above (as `conjugate_residuals`)
    tolerance : on residuals, and on the distance of T_b T_a x and T_a T_b x in parts of the size

    Raises
    ------
    DegenerateError
        T_b T_a x and T_a T_b x differ, by how much; a condition that both transforms fulfil and
        the lattice does not, with the quad of the new directions; without `common` or `residuals`,
        transforms that belong to none of the classes.
    InputError
        Nets of the transforms of another shape than the net's, or not finite; names the transform.

    Source: mathematics.md 1.9.
    """
    x = np.asarray(net, dtype=np.float64)
    if x.ndim < 2 or not x.size:
        raise InputError(f"net has shape {x.shape}; (n1, ..., nd, dim) is needed")
    finite(x, "net")
    a = _sheet(transform_a(x), x, "the net of transform_a")
    b = _sheet(transform_b(x), x, "the net of transform_b")
    if common is not None:
        both = _sheet(common(x, a, b), x, "the net of common")
    else:
        both = _sheet(transform_b(a), x, "the net of transform_b after transform_a")
        other = _sheet(transform_a(b), x, "the net of transform_a after transform_b")
        size = extent(both)
        gap = float(np.linalg.norm(both - other, axis=-1).max())
        if gap > tolerance * size:
            raise DegenerateError(
                f"the transforms do not commute: T_b T_a x and T_a T_b x are {gap:g} apart "
                f"(limit {tolerance * size:g}); give the common transform"
            )
    z = np.stack([stack_transforms([x, b]), stack_transforms([a, both])], axis=-3)
    conditions = _CLASSES if residuals is None else {"the given": residuals}
    layers = [stack_transforms([x, sheet]) for sheet in (a, b)]
    held = {
        name: found
        for name, found in conditions.items()
        if all(_defect(found, layer) <= tolerance for layer in layers) or residuals is not None
    }
    for name, found in held.items():
        defect = _defect(found, z)
        if not defect <= tolerance:
            raise DegenerateError(
                f"the lattice is no {name} net, although the net with each transform is: "
                f"{_worst_quad(name, z, defect)} (limit {tolerance:g})\n"
                "give the common transform (common_transform makes it from one point)"
            )
    if not held and common is None:
        raise DegenerateError(
            "the net with its transforms is not a conjugate, circular, conical, isothermic, A- or "
            "T-net, so that the lattice cannot be checked; give residuals or the common transform"
        )
    return z


def _sheet(given: ArrayLike, net: Floats, what: str) -> Floats:
    if not is_numeric(given):
        raise InputError(f"{what} is not an array of numbers of shape {net.shape}")
    sheet = of_shape(given, net.shape, what)
    finite(sheet, what)
    return sheet


def _defect(found: Residuals, net: Floats) -> float:
    """Greatest residual of a net; infinite where it is not defined."""
    try:
        return max((float(value) for value in found(net).values()), default=0.0)
    except (DegenerateError, InputError):
        return np.inf


def _worst_quad(name: str, z: Floats, defect: float) -> str:
    """Where the quads of the two new directions miss a condition most."""
    axes = z.ndim - 3, z.ndim - 2
    measure = {"conjugate": planarity, "circular": circularity}.get(name)
    if measure is not None:
        try:
            off = np.abs(measure(z, axes))
        except DegenerateError as error:
            return str(error)
        at = tuple(int(i) for i in np.unravel_index(int(off.argmax()), off.shape))
        if off[at] >= 0.5 * defect:
            return f"quad of the two new directions at {at[:-2]}, relative defect {off[at]:.3g}"
    return f"relative defect {defect:.3g}"


def _isothermic(net: Floats) -> dict[str, float]:
    return {"cross-ratio labels": cross_ratio_labels(net)[1]}


def _circular(net: Floats) -> dict[str, float]:
    return {"circularity": circular_residuals(net)["circularity"]}


def _conical(net: Floats) -> dict[str, float]:
    """Planarity, and greatest defect of the cones in pairs of directions with inner vertices."""
    found: dict[str, float] = {}
    for i, j in pairs(net):
        if min(net.shape[i], net.shape[j]) < 3:
            continue
        parts = np.moveaxis(net, (i, j), (-3, -2))
        for part in parts.reshape(-1, *parts.shape[-3:]):
            for name, value in conical_residuals(part).items():
                found[name] = max(value, found.get(name, 0.0))
    if not found:
        raise InputError(f"a net of shape {net.shape} has no inner vertices, so no cones")
    return {**found, **conjugate_residuals(net)}


def _asymptotic(net: Floats) -> dict[str, float]:
    return {"star flatness": float(star_flatness(net).max())}


def _moutard(net: Floats) -> dict[str, float]:
    return {
        "Moutard": max(
            float(moutard_coefficients(net, axes)[1].max(initial=0.0)) for axes in pairs(net)
        )
    }


_CLASSES: Final[dict[str, Residuals]] = {
    "conjugate": conjugate_residuals,
    "circular": _circular,
    "conical": _conical,
    "isothermic": _isothermic,
    "A-": _asymptotic,
    "T-": _moutard,
}


@checked
def common_transform(
    net: ArrayLike,
    first: ArrayLike,
    second: ArrayLike,
    corner: ArrayLike,
    tolerance: float = NET_INPUT,
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
    tolerance : on planarity, and on distances in parts of the net's size

    Raises
    ------
    InputError
        Shapes that do not fit, numbers that are not finite.
    DegenerateError
        A quad that is not planar, or layers that are not transforms of the net; as `evolve_nd`.

    Source: Bobenko, Suris, 2.1, 3.1; mathematics.md 1.9.
    """
    x = net_points(net)
    a, b = of_shape(first, x.shape, "first"), of_shape(second, x.shape, "second")
    corner = of_shape(corner, x.shape[-1:], "corner")
    origin = (0,) * (x.ndim - 1)
    given = np.stack([stack_transforms([x, b]), stack_transforms([a, a])], axis=-3)
    given[(*origin, 1, 1)] = corner
    made = evolve_nd(coordinate_surfaces(given), tolerance=tolerance)
    size = extent(x)
    for name, sheet, layer in (("first", a, made[..., 1, 0, :]), ("second", b, made[..., 0, 1, :])):
        gap = np.linalg.norm(sheet - layer, axis=-1)
        Place(name=f"{name} transform, point").refuse(
            gap > tolerance * size, "it is not a transform of the net: distance", gap
        )
    return np.asarray(made[..., 1, 1, :])
