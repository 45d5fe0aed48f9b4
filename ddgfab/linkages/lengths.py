"""The ratio of a K-net from lengths and twists of bars: r = a / sin(alpha), checked.

Source: mathematics.md 3.5, 3.6, 4.1.
"""

from __future__ import annotations

import numpy as np

from ddgfab.errors import InputError
from ddgfab.tolerances import RELATIVE_DEGENERATE

RATIO_MISMATCH = 1e-9
"""Relative difference of a / sin(alpha) and b / sin(beta) up to which a linkage closes."""


def positive_length(value: float, name: str) -> float:
    """The length [mm] as a float, or `InputError` where it is none."""
    number = float(value)
    if not 0 < number < np.inf:
        raise InputError(f"{name} = {number:g} mm: a bar needs a positive length")
    return number


def proper_twist(value: float, name: str) -> float:
    """The twist [rad] as a float in (0, pi), or `InputError`: else a bar's axes are parallel."""
    number = float(value)
    if not (0 < number < np.pi and np.sin(number) > RELATIVE_DEGENERATE):
        raise InputError(
            f"{name} = {np.degrees(number):g} deg: twists lie between 0 and 180 deg; at the ends "
            "the hinge axes are parallel and the quad is planar"
        )
    return number


def second_twist(r: float, length: float, name: str) -> float:
    """The acute twist [rad] of a bar of a length in a linkage of ratio r, or `InputError`."""
    if not length < r:
        raise InputError(
            f"{name} = {length:g} mm is too long: a / sin(alpha) = {r:g} mm, "
            "and every bar is shorter than that"
        )
    return float(np.arcsin(length / r))


def same_ratio(
    a: float, alpha: float, b: float, beta: float, names: tuple[str, str] = ("a", "b")
) -> float:
    """a / sin(alpha) [mm], or `InputError` when b / sin(beta) is another; names of the bars."""
    first, second = a / np.sin(alpha), b / np.sin(beta)
    gap = abs(first - second) / max(first, second)
    if gap > RATIO_MISMATCH:
        one, two = names
        raise InputError(
            f"length / sin(twist) is {first:.9g} mm for {one} but {second:.9g} mm for {two} "
            f"(relative difference {gap:.2g}, limit {RATIO_MISMATCH:g}): the loop is rigid. "
            f"With its twist of {np.degrees(beta):g} deg the length of {two} is "
            f"{first * np.sin(beta):.9g} mm"
        )
    return float(first)
