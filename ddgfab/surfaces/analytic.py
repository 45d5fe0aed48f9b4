"""Analytic surfaces by name, each from a few lengths [mm]: what `ddgfab trace NAME` starts from."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from typing import Any, Final

import numpy as np

from ddgfab.errors import InputError
from ddgfab.mesh import Floats
from ddgfab.suggest import suggestion
from ddgfab.surfaces.sampled import interpolated
from ddgfab.surfaces.spline import SplineSurface


def _height(
    function: Callable[[Floats, Floats], Floats], width: float, depth: float, name: str
) -> SplineSurface:
    """The graph of a function of x and y over a rectangle round the origin."""
    box = (-width / 2, width / 2, -depth / 2, depth / 2)
    return interpolated(lambda x, y: np.stack([x, y, function(x, y)], axis=-1), box, name=name)


def ellipsoid_cap(
    semi_x_mm: float = 9000.0,
    semi_y_mm: float = 6000.0,
    semi_z_mm: float = 3000.0,
    width_mm: float = 14000.0,
    depth_mm: float = 5000.0,
) -> SplineSurface:
    """Upper part of an ellipsoid over a rectangle; its umbilics may lie inside."""
    if (width_mm / semi_x_mm) ** 2 + (depth_mm / semi_y_mm) ** 2 >= 3.9:
        raise InputError(
            f"ellipsoid-cap: the rectangle {width_mm:g} x {depth_mm:g} reaches the equator of the "
            f"ellipsoid {semi_x_mm:g}, {semi_y_mm:g}: make it smaller"
        )
    return _height(
        lambda x, y: semi_z_mm * np.sqrt(1 - (x / semi_x_mm) ** 2 - (y / semi_y_mm) ** 2),
        width_mm,
        depth_mm,
        "ellipsoid-cap",
    )


def saddle(
    width_mm: float = 20000.0,
    depth_mm: float = 16000.0,
    radius_x_mm: float = 24000.0,
    radius_y_mm: float = 18000.0,
) -> SplineSurface:
    """Saddle x^2 / 2 radius_x - y^2 / 2 radius_y over a rectangle."""
    return _height(
        lambda x, y: x**2 / (2 * radius_x_mm) - y**2 / (2 * radius_y_mm),
        width_mm,
        depth_mm,
        "saddle",
    )


def monkey_saddle(
    width_mm: float = 20000.0, depth_mm: float = 20000.0, height_mm: float = 2500.0
) -> SplineSurface:
    """Monkey saddle, proportional to x^3 - 3 x y^2: one umbilic of index -1/2 in the middle."""
    half = width_mm / 2
    return _height(
        lambda x, y: height_mm * ((x / half) ** 3 - 3 * (x / half) * (y / half) ** 2),
        width_mm,
        depth_mm,
        "monkey-saddle",
    )


def dome(
    width_mm: float = 20000.0,
    depth_mm: float = 20000.0,
    radius_x_mm: float = 26000.0,
    radius_y_mm: float = 19000.0,
) -> SplineSurface:
    """Paraboloid dome with two radii at the top over a rectangle."""
    return _height(
        lambda x, y: -(x**2) / (2 * radius_x_mm) - y**2 / (2 * radius_y_mm),
        width_mm,
        depth_mm,
        "dome",
    )


def torus_piece(
    radius_mm: float = 20000.0,
    tube_radius_mm: float = 8000.0,
    turn_deg: float = 80.0,
    from_deg: float = 15.0,
    to_deg: float = 105.0,
) -> SplineSurface:
    """Piece of a torus: part of a turn about the axis, part of the circle of the tube."""

    def point(turn: Floats, tube: Floats) -> Floats:
        far = radius_mm + tube_radius_mm * np.cos(tube)
        return np.stack(
            [far * np.cos(turn), far * np.sin(turn), tube_radius_mm * np.sin(tube)], axis=-1
        )

    box = (0.0, np.radians(turn_deg), np.radians(from_deg), np.radians(to_deg))
    return interpolated(point, box, name="torus-piece")


def wave_roof(
    width_mm: float = 24000.0,
    depth_mm: float = 16000.0,
    rise_mm: float = 3000.0,
    wave_mm: float = 600.0,
) -> SplineSurface:
    """Free-form roof: a vault with a wave along it and one side lower than the other."""

    def height(x: Floats, y: Floats) -> Floats:
        s, t = 2 * x / width_mm, 2 * y / depth_mm
        vault = rise_mm * (1 - 0.75 * t**2 - 0.2 * s**2)
        return vault + wave_mm * np.sin(2.2 * s + 0.4) * (0.6 + 0.4 * t)

    return _height(height, width_mm, depth_mm, "wave-roof")


def enneper(size_mm: float = 20000.0, half_u: float = 0.7, half_v: float = 0.6) -> SplineSurface:
    """Enneper's minimal surface over |u| <= half_u, |v| <= half_v, about size_mm wide."""

    def point(u: Floats, v: Floats) -> Floats:
        x, y = u - u**3 / 3 + u * v**2, v - v**3 / 3 + v * u**2
        return np.stack([x, -y, u**2 - v**2], axis=-1) * size_mm / (2 * half_u)

    return interpolated(point, (-half_u, half_u, -half_v, half_v), name="enneper")


SURFACES: Final[dict[str, Callable[..., SplineSurface]]] = {
    "dome": dome,
    "ellipsoid-cap": ellipsoid_cap,
    "enneper": enneper,
    "monkey-saddle": monkey_saddle,
    "saddle": saddle,
    "torus-piece": torus_piece,
    "wave-roof": wave_roof,
}
"""Surfaces by name."""


SMALLEST: Final = 1e-3
LARGEST: Final = 1e9
"""Lengths [mm] and other sizes of a surface lie between these."""


def surface_parameters(name: str) -> dict[str, float]:
    """Parameters of a surface of `SURFACES`, with their defaults."""
    known = inspect.signature(SURFACES[name]).parameters
    return {key: parameter.default for key, parameter in known.items()}


def named_surface(name: str, parameters: Mapping[str, Any] | None = None) -> SplineSurface:
    """A surface of `SURFACES` with its parameters, the others at their defaults.

    Raises
    ------
    InputError
        An unknown name or parameter (names the nearest), or a value that is not a finite number, or
        a length that is not positive.
    """
    if name not in SURFACES:
        raise InputError(f'surface "{name}" is unknown; {suggestion(name, SURFACES)}')
    known = surface_parameters(name)
    for key, value in (parameters or {}).items():
        if key not in known:
            raise InputError(f"{name}: {key} is unknown; {suggestion(key, known)}")
        if isinstance(value, bool) or not isinstance(value, int | float) or not np.isfinite(value):
            raise InputError(f"{name}: {key} = {value!r} must be a finite number")
        if not key.endswith("_deg") and not SMALLEST <= value <= LARGEST:
            raise InputError(
                f"{name}: {key} = {value:g} must lie between {SMALLEST:g} and {LARGEST:g}"
            )
    return SURFACES[name](**dict(parameters or {}))
