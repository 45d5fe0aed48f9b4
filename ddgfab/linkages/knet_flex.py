"""Deform a K-net with fixed bars: the turns and the corner angles are free.

Source: mathematics.md 4.4; Bobenko, Pinkall 1996.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.arguments import checked
from ddgfab.errors import InputError
from ddgfab.nets.knet.net import KNet


@checked
def flex(knet: KNet, dturns: Sequence[ArrayLike], dcorner: ArrayLike) -> KNet:
    """The K-net after its Cauchy turns and corner angles change; lengths and twists stay.

    Parameters
    ----------
    dturns : per direction, a number or (n_k - 2,) changes of the turns [rad]
    dcorner : a number or (d - 1,) changes of the corner angles [rad]

    Raises
    ------
    InputError
        Changes that do not fit the net or are not finite; names the direction.

    Source: mathematics.md 4.4, rebuilt by 3.5 with the same deltas.
    """
    data = knet.cauchy()
    if len(dturns) != knet.d:
        raise InputError(f"{len(dturns)} arrays of turns for a net of {knet.d} directions")
    turns = []
    for k, (turn, change) in enumerate(zip(data.turns, dturns, strict=True)):
        step = np.asarray(change, dtype=np.float64)
        if step.shape not in ((), turn.shape):
            raise InputError(
                f"turns of direction {k}: changes of shape {step.shape}, not {turn.shape}"
            )
        if not np.isfinite(step).all():
            raise InputError(f"turns of direction {k}: a change is not finite")
        turns.append(turn + step)
    corner = np.asarray(dcorner, dtype=np.float64)
    if corner.shape not in ((), data.corner_angles.shape) or not np.isfinite(corner).all():
        raise InputError(
            f"corner changes {corner!r} do not fit {len(data.corner_angles)} corner angles"
        )
    return replace(data, turns=tuple(turns), corner_angles=data.corner_angles + corner).build()
