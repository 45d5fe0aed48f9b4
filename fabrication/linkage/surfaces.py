"""K-nets by the names of their surfaces, for [linkage] kind = "knet"; angles in degrees."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np

from ddgfab.errors import InputError
from ddgfab.mesh import Floats
from ddgfab.nets.knet import KNet, knet
from ddgfab.nets.knet.amsler_net import amsler
from ddgfab.nets.knet.breather_net import breather
from ddgfab.nets.knet.dini_net import dini, pseudosphere
from ddgfab.nets.knet.kuen_net import kuen
from ddgfab.suggest import suggestion

Numbers = Mapping[str, float]


@dataclass(frozen=True)
class Surface:
    """A family of K-nets: made from the bars' twists (M,), (N,) [rad] and its own numbers."""

    make: Callable[[Floats, Floats, Numbers], KNet]
    defaults: Numbers


def _straight(alphas: Floats, betas: Floats, given: Numbers) -> KNet:
    turns = [
        np.full(len(angles) - 1, np.radians(given[f"turn_{k}_deg"]))
        for k, angles in enumerate((alphas, betas))
    ]
    return knet((alphas, betas), turns, np.radians(given["corner_deg"]))


def _pseudosphere(alphas: Floats, betas: Floats, given: Numbers) -> KNet:
    if np.ptp([*alphas, *betas]) > 0:
        raise InputError("the bars of a pseudosphere all have one twist; for two take dini")
    m, n, alpha = len(alphas), len(betas), float(alphas[0])
    ring = -np.log(_half_tangent(given)) / np.log(np.tan(np.pi / 4 + alpha / 2))
    return pseudosphere((m, n), alpha, offset=ring - 0.5 * (n - m))


def _dini(alphas: Floats, betas: Floats, given: Numbers) -> KNet:
    sigma = np.radians(given["sigma_deg"])
    way = np.prod(np.cos((sigma + alphas) / 2) / np.cos((sigma - alphas) / 2))
    way *= np.prod(np.sin((sigma + betas) / 2) / np.sin((sigma - betas) / 2))
    return dini(alphas, betas, sigma, t0=_half_tangent(given) / np.sqrt(abs(way)))


def _half_tangent(given: Numbers) -> float:
    """tan(psi / 2) in the middle of a net; psi is a right angle at the rim."""
    if not 0 < given["psi_deg"] < 180:
        raise InputError(f"psi_deg = {given['psi_deg']:g} must lie between 0 and 180")
    return float(np.tan(np.radians(given["psi_deg"]) / 2))


def _breather(alphas: Floats, betas: Floats, given: Numbers) -> KNet:
    start = np.exp(1j * np.radians(given["phase_deg"]))
    return breather(alphas, betas, given["tau"], t0=complex(start))


def _kuen(alphas: Floats, betas: Floats, given: Numbers) -> KNet:
    half = 0.5 * float(np.tan(alphas).sum() + np.tan(betas).sum())
    return kuen(alphas, betas, shift=given["shift"] + half)


SURFACES: Final[dict[str, Surface]] = {
    "cauchy": Surface(_straight, {"corner_deg": 90.0, "turn_0_deg": 0.0, "turn_1_deg": 0.0}),
    "amsler": Surface(
        lambda a, b, p: amsler(a, b, np.radians(p["angle_deg"])), {"angle_deg": 60.0}
    ),
    "pseudosphere": Surface(_pseudosphere, {"psi_deg": 40.0}),
    "dini": Surface(_dini, {"sigma_deg": 75.0, "psi_deg": 40.0}),
    "breather": Surface(_breather, {"tau": 0.3, "phase_deg": 75.0}),
    "kuen": Surface(_kuen, {"shift": 2.65}),
}
"""Surfaces by name; "cauchy" goes along two lines of constant turns."""


def surface_net(name: str, alphas: Floats, betas: Floats, given: Numbers) -> KNet:
    """The K-net of a surface whose bars have the twists (M,), (N,) [rad].

    Raises
    ------
    InputError
        Numbers that the surface does not have, or beyond what it allows.
    DegenerateError
        Numbers that make a degenerate net; names the cell.
    """
    surface = SURFACES[name]
    return surface.make(alphas, betas, {**surface.defaults, **given})


def check_numbers(name: str, given: Numbers) -> None:
    """Raise `ValueError` where a surface or one of its numbers is unknown."""
    if name not in SURFACES:
        raise ValueError(f'surface "{name}" is unknown; {suggestion(name, SURFACES)}')
    known = list(SURFACES[name].defaults)
    for parameter in given:
        if parameter not in known:
            raise ValueError(f"surface {name} has no {parameter}; {suggestion(parameter, known)}")
