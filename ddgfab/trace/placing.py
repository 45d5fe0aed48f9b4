"""Where the lines of a network run: evenly, from rim to rim, without ends in the open.

First lines through points at the given spacing on a line of the other family; more where
the surface is bare; then lines that are squeezed go. Source: Jobard, Lefer 1997 (idea of filling).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial import cKDTree

from ddgfab.arguments import checked
from ddgfab.errors import DegenerateError, InputError
from ddgfab.mesh import Floats
from ddgfab.surfaces.spline import SplineSurface
from ddgfab.trace.certainty import check_rest
from ddgfab.trace.field import LEAST_ANGLE_DEG, Field, PrincipalField, sines
from ddgfab.trace.lines import Line, Tracer
from ddgfab.trace.samples import Samples
from ddgfab.trace.starts import points_on, rim_seeds
from ddgfab.trace.umbilics import Umbilic, check_anisotropy, check_curved, umbilics

_STEP: Final = 0.25
"""A step, as a part of the spacing."""
_BARE, _APART, _ROUNDS = 0.75, 3.0, 30
"""Samples further than this from all lines start one; distance of starts in a round; rounds."""
_SQUEEZED, _COVERED = 0.6, 1.0
"""Lines nearer than this may go while all samples stay within the second of a line."""
_LONGEST: Final = 3.0
"""Longest line, in diameters of the surface."""
_FINEST: Final = 1e-3
"""Least spacing, as a part of the size of the surface."""


@dataclass(frozen=True, eq=False)
class Network:
    """Lines of two families on a surface.

    Attributes
    ----------
    lines : of family 0, of family 1
    umbilics : inside the trim; empty for conjugate families
    spacing : that was asked for, of family 0 and 1
    """

    field: Field
    samples: Samples
    lines: tuple[list[Line], list[Line]]
    umbilics: tuple[Umbilic, ...]
    spacing: tuple[float, float]

    @property
    def spirals(self) -> int:
        """How many lines were given up for their length."""
        return sum("long" in line.ends for family in self.lines for line in family)


@checked
def place(
    field: Field,
    spacing: tuple[float, float],
    through: ArrayLike | None = None,
    *,
    first: ArrayLike | None = None,
    ends: ArrayLike | None = None,
) -> Network:
    """Lines of both families, evenly spaced.

    Parameters
    ----------
    spacing : distance of the lines of family 0, and of family 1
    through : (k, 3) points of the surface: a line of each family runs through each of them (a
        ridge, a line of the facade), and the others are counted from the first
    first : (k, 3) points through which lines of family 0 run
    ends : (k, 3) points of the rim at which lines end, of the family that meets it more steeply

    Raises
    ------
    InputError
        A spacing that is not positive, larger than the surface, or too fine.
    DegenerateError
        A spherical or plane surface, a line of umbilics; families that are nearly parallel; names
        the place.
    """
    samples = Samples.of(field.surface)
    name = field.surface.name
    if not samples.inside.any():
        raise InputError(f"{name}: its trim is too small for {len(samples.inside)} samples")
    for given in spacing:
        if not (np.isfinite(given) and given > 0):
            raise InputError(f"spacing {given:g}: a length greater than 0 is needed")
        if given > samples.diameter / 2 or given < _FINEST * samples.diameter:
            raise InputError(
                f"{name}: spacing {given:g} for a surface of size {samples.diameter:.4g}; "
                f"{_FINEST * samples.diameter:.3g} to {samples.diameter / 2:.3g} makes a net (are "
                "both in the same unit?)"
            )
    found: tuple[Umbilic, ...] = ()
    if isinstance(field, PrincipalField):
        check_anisotropy(samples)
        check_rest(samples, min(spacing))
        found = umbilics(samples)
    else:
        check_curved(samples)
        _check_angles(field, samples)
    poles = np.array([umbilic.x for umbilic in found]).reshape(-1, 3)
    tracers = [
        Tracer(field, family, _STEP * spacing[family], _LONGEST * samples.diameter, poles)
        for family in (0, 1)
    ]
    fixed = points_on(field.surface, through, samples.diameter)
    start = fixed[:1] if len(fixed) else _start(samples, poles, min(spacing))[None]
    asked = [[fixed, points_on(field.surface, first, samples.diameter, "first")], [fixed]]
    for family, seeds in enumerate(rim_seeds(tracers, ends, samples.diameter)):
        asked[family].append(seeds)
    lines: list[list[Line]] = []
    for family in (0, 1):
        across = tracers[1 - family].lines(start)
        kept = tracers[family].lines(np.concatenate(asked[family]))
        seeds = _along(across, spacing[family], start if len(fixed) else None) if across else start
        if len(kept) > len(fixed):
            seeds = _clear(seeds, kept, field.surface, spacing[family])
        own = [*kept, *tracers[family].lines(seeds)]
        own = _filled(own, tracers[family], samples, spacing[family])
        lines.append(_thinned(own, samples, spacing[family], len(kept)))
    for family in (0, 1):
        if len(lines[family]) < 2:
            raise DegenerateError(
                f"{name}: {len(lines[family])} lines of family {family} at spacing "
                f"{spacing[family]:g}; 2 are needed: choose a smaller spacing"
            )
    return Network(field, samples, (lines[0], lines[1]), found, spacing)


def _check_angles(field: Field, samples: Samples) -> None:
    """Raise where the families meet at less than `LEAST_ANGLE_DEG`."""
    sine = np.where(samples.inside, sines(field, samples.jets), np.inf)
    least = int(sine.argmin())
    if sine[least] < np.sin(np.radians(LEAST_ANGLE_DEG)):
        u, v = samples.uv.reshape(-1, 2)[least]
        x, y, z = samples.jets.x[least]
        raise DegenerateError(
            f"{field.surface.name}: the families meet at {np.degrees(np.arcsin(sine[least])):.1f} "
            f"deg at u = {u:.4g}, v = {v:.4g} ({x:.4g}, {y:.4g}, {z:.4g}); {LEAST_ANGLE_DEG:g} are "
            "needed\nturn the given family away from the asymptotic directions"
        )


def _start(samples: Samples, poles: Floats, spacing: float) -> Floats:
    """The sample farthest from rim and umbilics."""
    fixed = np.concatenate([samples.rim(spacing / 2), poles])
    far = cKDTree(fixed).query(samples.points)[0]
    return np.asarray(samples.parameters[int(far.argmax())])


def _clear(seeds: Floats, kept: list[Line], surface: SplineSurface, spacing: float) -> Floats:
    """The seeds that no line is near to."""
    tree = cKDTree(np.concatenate([_dense(line) for line in kept]))
    return np.asarray(seeds[tree.query(surface.points(seeds))[0] > _BARE * spacing])


def _along(lines: list[Line], spacing: float, start: Floats | None = None) -> Floats:
    """Parameters at equal arc lengths, about the spacing, half of one from ends in the rim.

    With a start (1, 2) on the line, at whole spacings from it, without itself.
    """
    out = []
    for line in lines[:1]:
        if start is None:
            count = max(1, round(line.length / spacing))
            s = (np.arange(count) + 0.5) * line.length / count
        else:
            at = line.s[int(np.linalg.norm(line.uv - start, axis=1).argmin())]
            steps = np.arange(np.ceil(-at / spacing), np.floor((line.length - at) / spacing) + 1)
            s = at + steps[steps != 0] * spacing
            s = s[(s > 0) & (s < line.length)]
        out.append(line.at(s))
    return np.concatenate(out)


def _dense(line: Line) -> Floats:
    """(n, 3) points of a line and the middles of its chords."""
    return np.concatenate([line.x, 0.5 * (line.x[1:] + line.x[:-1])])


def _filled(lines: list[Line], tracer: Tracer, samples: Samples, spacing: float) -> list[Line]:
    """More lines, until all samples lie near one."""
    points, uv = samples.points, samples.parameters
    far = np.full(len(points), np.inf)

    def update(new: list[Line]) -> None:
        if new:
            near = cKDTree(np.concatenate([_dense(line) for line in new])).query(points)[0]
            np.minimum(far, near, out=far)

    update(lines)
    given_up = np.zeros(len(points), dtype=bool)
    for _ in range(_ROUNDS):
        wanting = np.flatnonzero((far > _BARE * spacing) & ~given_up)
        chosen: list[int] = []
        for i in wanting[np.argsort(-far[wanting], kind="stable")]:
            apart = np.linalg.norm(points[chosen] - points[i], axis=1)
            if not len(chosen) or apart.min() >= _APART * spacing:
                chosen.append(int(i))
        if not chosen:
            break
        new = tracer.lines(uv[chosen])
        given_up[chosen] = True
        lines = lines + new
        update(new)
    return lines


def _thinned(lines: list[Line], samples: Samples, spacing: float, kept: int = 0) -> list[Line]:
    """Without lines that come near to others, most squeezed first, as long as none is missed.

    The first `kept` lines stay.
    """
    clouds = [_dense(line) for line in lines]
    owner = np.repeat(np.arange(len(lines)), [len(cloud) for cloud in clouds])
    tree = cKDTree(np.concatenate(clouds))
    close = tree.sparse_distance_matrix(tree, _SQUEEZED * spacing, output_type="coo_matrix")
    nearest = np.full((len(lines), len(lines)), np.inf)
    np.minimum.at(nearest, (owner[close.row], owner[close.col]), close.data)
    np.fill_diagonal(nearest, np.inf)
    touch = cKDTree(samples.points).sparse_distance_matrix(
        tree, _COVERED * spacing, output_type="coo_matrix"
    )
    covers = np.zeros((len(lines), len(samples.points)), dtype=bool)
    covers[owner[touch.col], touch.row] = True
    count = covers.sum(axis=0)
    alive = np.ones(len(lines), dtype=bool)
    refused = np.arange(len(lines)) < kept
    while True:
        table = np.where(alive[:, None] & alive[None], nearest, np.inf)
        least = np.where(refused, np.inf, table.min(axis=1))
        squeezed = float(least.min())
        if not np.isfinite(squeezed):
            break
        pair = np.flatnonzero(least == squeezed)
        # of a pair the one that more samples can do without
        alone = [int((covers[i] & (count == 1)).sum()) for i in pair]
        worst = int(pair[int(np.argmin(alone))])
        if (count[covers[worst]] > 1).all():
            alive[worst] = False
            count = count - covers[worst]
        else:
            refused[worst] = True
    return [line for line, keep in zip(lines, alive, strict=True) if keep]
