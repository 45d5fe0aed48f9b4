"""The Bennett isogram: four bars a, b, a, b with twists alpha, beta, alpha, beta.

Source: Bennett 1903; Bobenko, Pinkall 1996; mathematics.md 3.6, 3.7, 4.1.
"""

from __future__ import annotations

import numpy as np

from ddgfab.arguments import checked
from ddgfab.errors import InputError
from ddgfab.linkages.assemble import assemble
from ddgfab.linkages.grid import Grid
from ddgfab.linkages.lattice import Lattice
from ddgfab.linkages.lengths import positive_length, proper_twist, same_ratio, second_twist
from ddgfab.linkages.mechanism import Mechanism

FOLDED_RATIO = 1e-9
"""Below this value of tan(phi / 2) tan(psi / 2) the loop stays folded."""

BESIDE_RIGHT_DEG = 60.0
"""Twist that is advised where the other one is a right angle."""

DESIGN = np.pi / 2
"""Driving angle [rad] of the design pose when none is asked for."""


def _other_twist(a: float, alpha: float) -> str:
    """A twist beta that moves beside the bar a, alpha; for messages.

    At the same length there is the twist of the other hand, 180 deg - alpha, unless that is alpha
    too: then another length goes with another twist.
    """
    other = 180.0 - np.degrees(alpha)
    if abs(other - 90.0) >= 1.0:
        return f"beta = {other:g} deg"
    length = a / np.sin(alpha) * np.sin(np.radians(BESIDE_RIGHT_DEG))
    return f"beta = {BESIDE_RIGHT_DEG:g} deg without b (it is then {length:.6g} mm)"


def _refuse_folded(a: float, alpha: float, beta: float, design: float) -> None:
    """Raise `InputError` where a Bennett linkage only folds, or its design pose is folded."""
    ratio = np.sin((beta - alpha) / 2) / np.sin((beta + alpha) / 2)
    if abs(ratio) < FOLDED_RATIO:
        raise InputError(
            f"alpha = beta = {np.degrees(alpha):g} deg with a = b: this loop only folds "
            f"(tan(phi/2) tan(psi/2) = {ratio:.3g}); take twists that differ, such as "
            f"{_other_twist(a, alpha)}"
        )
    if not 0 < design < 2 * np.pi or abs(design - np.pi) < FOLDED_RATIO:
        raise InputError(
            f"driving angle {np.degrees(design):g} deg: it lies between 0 and 360 deg and is not "
            "180 deg, where the loop is folded"
        )


@checked
def bennett(
    a: float,
    alpha: float,
    *,
    b: float | None = None,
    beta: float | None = None,
    driver: float | None = None,
) -> Mechanism:
    """Bennett linkage a / sin(alpha) = b / sin(beta); twists of one hand, as in Denavit-Hartenberg.

    Hinges 0, 2, 3, 1 in order around the loop; bars 0 = (0, 2) and 1 = (1, 3) of length a, bars
    2 = (0, 1) and 3 = (2, 3) of length b. The driving angle phi is the angle at hinge 0 from bar 0
    to bar 2, over (0, 2 pi); the joint angle of textbooks is theta = pi - phi. At hinges 1 and 2
    the angle psi has tan(phi/2) tan(psi/2) = sin((beta - alpha)/2) / sin((beta + alpha)/2).

    A bar of twist beta of the other hand is one of twist pi - beta: turn an axis round.

    Parameters
    ----------
    a, b : lengths [mm]
    alpha, beta : twists [rad], in (0, pi); at least one of b and beta is given; from b alone beta
        is the acute one of the two
    driver : driving angle of the design pose [rad], by default a right angle

    Raises
    ------
    InputError
        Lengths that are not positive, twists outside (0, pi), ratios that differ by more than
        1e-9, alpha = beta (the loop only folds), neither b nor beta, a driver outside (0, 2 pi).

    Examples
    --------
    >>> import numpy as np
    >>> linkage = bennett(60.0, np.radians(30), beta=np.radians(90))
    >>> linkage.lengths.round(6)
    array([ 60.,  60., 120., 120.])

    Source: mathematics.md 4.1.
    """
    a, alpha = positive_length(a, "a"), proper_twist(alpha, "alpha")
    r = a / np.sin(alpha)
    if beta is not None:
        beta = proper_twist(beta, "beta")
        b = r * np.sin(beta) if b is None else positive_length(b, "b")
    elif b is not None:
        b = positive_length(b, "b")
        beta = second_twist(r, b, "b")
    else:
        raise InputError("a Bennett linkage needs b or beta beside a and alpha")
    same_ratio(a, alpha, b, beta)
    design = DESIGN if driver is None else float(driver)
    _refuse_folded(a, alpha, beta, design)
    none = np.zeros(0)
    # In the K-net's gauge the twists are +delta_0 and -delta_1; -(pi - beta) is beta.
    lattice = Lattice(
        (np.array([alpha]), np.array([np.pi - beta])),
        (none, none),
        np.array([design]),
        r,
        (0, 0),
        design,
        (none, none),
        np.ones(1),
    )
    return assemble(
        "bennett",
        lattice,
        Grid.build(lattice.shape),
        design=lattice.design,
        limits=(0.0, 2 * np.pi),
        driver="angle at hinge 0 from bar 0 to bar 2",
        path="one degree of freedom",
    )
