"""`trace`: from a surface and a spacing to a net with its quality."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.arguments import checked
from ddgfab.errors import DegenerateError, InputError, MeshError
from ddgfab.mesh import Mesh
from ddgfab.surfaces.spline import SplineSurface
from ddgfab.trace.drawn import followed, laid_curves
from ddgfab.trace.field import ConjugateField, Field, PrincipalField, plane_sections, turned
from ddgfab.trace.mesh import TracedMesh, network_mesh
from ddgfab.trace.placing import Network, place
from ddgfab.trace.report import TraceQuality, quality

_NEARLY: Final = (1.0, 1.02, 0.98, 1.05, 0.95)
"""Where lines touch or make no cells, as noise near the rim makes them, spacings as near as these
parts of the given one are tried."""


@dataclass(frozen=True, eq=False)
class Traced:
    """A net traced on a surface: its lines, its mesh with tags, its quality."""

    network: Network
    traced: TracedMesh
    quality: TraceQuality

    @property
    def mesh(self) -> Mesh:
        """The mesh itself."""
        return self.traced.mesh


@checked
def trace(
    surface: SplineSurface,
    spacing: float | tuple[float, float],
    *,
    along: ArrayLike | None = None,
    turn: float | None = None,
    drawn: Sequence[ArrayLike] | None = None,
    through: ArrayLike | None = None,
    ends: ArrayLike | None = None,
) -> Traced:
    """A net on a surface whose edges follow principal, or conjugate, directions.

    Parameters
    ----------
    spacing : distance of neighboring lines, of both families or of each; up to 5 % more or
        less is tried where no cells come of it (`network.spacing` says what it became)
    along : normal (3,) of parallel planes: one family is the sections with them, the other
        conjugate to it
    turn : angle [rad] from the principal directions to one family, the other is conjugate to it
    drawn : curves (m, 3) of points on the surface: one family follows them, the other is conjugate
        to it; each curve is a line of the net
    through : (k, 3) points of the surface through which lines of both families run
    ends : (k, 3) points of the rim at which lines end, as those of the net beside it do

    Raises
    ------
    InputError
        A spacing that does not suit the surface, more than one of `along`, `turn` and `drawn`.
    DegenerateError
        Principal directions that are not determined, families that are nearly parallel, lines that
        make no cells; names the place.
    """
    given = {"along": along, "turn": turn, "drawn": drawn}
    names = [name for name, value in given.items() if value is not None]
    if len(names) > 1:
        raise InputError(f"{' and '.join(names)} both give the first family: choose one")
    first: ArrayLike | None = None
    field: Field = PrincipalField(surface)
    if along is not None:
        field = ConjugateField(surface, plane_sections(along))
    elif turn is not None:
        field = ConjugateField(surface, turned(turn))
    elif drawn is not None:
        laid = laid_curves(surface, drawn)
        field = ConjugateField(surface, followed(surface, laid))
        first = np.array([curve[len(curve) // 2] for curve in laid])
    one, two = spacing if isinstance(spacing, tuple) else (spacing, spacing)
    for factor in _NEARLY:
        network = place(
            field,
            (factor * float(one), factor * float(two)),
            through,
            first=first,
            ends=ends,
        )
        try:
            found = network_mesh(network)
        except (DegenerateError, MeshError):
            if factor == _NEARLY[-1]:
                raise
        else:
            break
    return Traced(network, found, quality(network, found))
