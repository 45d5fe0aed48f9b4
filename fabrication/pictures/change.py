"""A picture of an optimization: the input, and the result with its distance and creases."""

from __future__ import annotations

from pathlib import Path
from typing import Final

import numpy as np

from ddgfab.optimize import Change
from fabrication.pictures.fields import SIZE, FieldPlot, write_panels
from fabrication.specs import Color

CREASE_DEG: Final = 10.0
"""Edges whose dihedral angle changed by more [deg] are drawn as creases."""

_CREASE_COLOR: Final[Color] = (0.85, 0.1, 0.1)


def write_change(path: Path, change: Change, *, size: tuple[int, int] = SIZE) -> None:
    """Render the input, and beside it the result colored by its distance from the surface [mm].

    Edges that became creases are drawn thick. Written atomically as PNG.

    Raises
    ------
    OutputError
        The file cannot be written, or this machine cannot render; says what to install.
    """
    creased = np.flatnonzero(np.degrees(change.creases) > CREASE_DEG)
    result = FieldPlot(
        change.after,
        change.from_surface,
        "distance [mm]",
        lines=creased,
        line_color=_CREASE_COLOR,
    )
    write_panels(path, [FieldPlot(change.before), result], size=size)
