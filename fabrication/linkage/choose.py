"""Which of the possible levels a linkage gets: few part numbers, low stacks, a large free range.

Choices are ranked with capsules at sampled driving angles, which is cheap and only a ranking: what
moves freely is certified afterwards, by `fabrication.motion.free_range`.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ddgfab.errors import DetailError
from ddgfab.linkages import Mechanism, Pose
from ddgfab.mesh import Floats, Ints
from fabrication.linkage.settings import LinkageSettings
from fabrication.linkage.shapes import heights_of, link_shapes, slots_of
from fabrication.motion.contacts import segment_difference
from fabrication.parts.link import LinkShape, link_key_of
from fabrication.parts.link.boundary import link_boundary
from fabrication.parts.link.frame import bar_radius, eyes_of
from fabrication.parts.ring import SPACER

Prefer = Literal["parts", "range"]

SAMPLES: Final = 72
"""Driving angles at which choices are compared, besides that of the design pose."""

ALIKE: Final = np.radians(5.0)
"""Free ranges that differ by less [rad] count as equal."""

TRIM: Final = 0.6
"""A stack on a pin counts as a capsule whose axis is shorter at both ends by this part of its
radius: between the capsule inside its cylinder and the one around it."""

PINNED: Final = 0.1
"""Least gap [mm] between bars on one pin, beyond the axial gap of their eyes."""


@dataclass(frozen=True, eq=False)
class Choice:
    """Levels (E, 2), part numbers of links and spacers, estimated free range [rad]."""

    levels: Ints
    numbers: int
    spacers: int
    range: float


def rank_levels(
    mechanism: Mechanism,
    settings: LinkageSettings,
    choices: Iterable[Ints],
    prefer: Prefer = "parts",
) -> list[Choice]:
    """The choices whose links can be made, best first.

    "parts" puts few part numbers before a large range, "range" the other way round; then few
    spacers, and the order given.

    Raises
    ------
    DetailError
        None of them can be made: the fault of the first one, with the bar and its pins.
    """
    swept: _Swept | None = None
    found: list[Choice] = []
    fault: DetailError | None = None
    for levels in choices:
        heights = heights_of(levels, settings)
        shapes = link_shapes(mechanism, heights, settings)
        try:
            check_links(mechanism, shapes)
        except DetailError as error:
            fault = fault or error
            continue
        swept = swept or _Swept(mechanism, settings)
        stacks = slots_of(mechanism, heights, settings)
        spans = np.array([(stack[1].low, stack[-1].high) for stack in stacks])
        numbers = len({link_key_of(shape) for shape in shapes})
        spacers = sum(slot.kind == SPACER for stack in stacks for slot in stack)
        found.append(Choice(levels, numbers, spacers, swept.free_range(shapes, heights, spans)))
    if not found:
        raise fault or DetailError("there are no levels to choose from")

    def order(choice: Choice) -> tuple[float, ...]:
        wide = -round(choice.range / ALIKE)
        first = (choice.numbers, wide) if prefer == "parts" else (wide, choice.numbers)
        return (*first, choice.spacers)

    return sorted(found, key=order)


def check_links(mechanism: Mechanism, shapes: list[LinkShape]) -> None:
    """Raise `DetailError` with the bar and its pins where a link cannot be made."""
    seen: set[object] = set()
    for bar, shape in enumerate(shapes):
        key = link_key_of(shape)
        if key in seen:
            continue
        seen.add(key)
        try:
            link_boundary(shape)
        except DetailError as error:
            i, j = mechanism.bars[bar].tolist()
            raise DetailError(f"L-{bar:04d} from pin H-{i:04d} to H-{j:04d}: {error}") from error


class _Swept:
    """A mechanism at sampled driving angles, and at each the pairs of parts that could be near."""

    def __init__(self, mechanism: Mechanism, settings: LinkageSettings) -> None:
        self.mechanism, self.settings = mechanism, settings
        low, high = mechanism.limits
        inner = low + (high - low) * (np.arange(SAMPLES) + 0.5) / SAMPLES
        self.ts = np.sort(np.append(inner, mechanism.design))
        self.poses: Pose = mechanism.poses(self.ts)
        self.frames = mechanism.bar_frames(self.poses)
        self.pairs: dict[tuple[int, int], tuple[Ints, NDArray[np.bool_]]] = {}

    def free_range(self, shapes: list[LinkShape], heights: Floats, spans: Floats) -> float:
        """Width [rad] of the samples around the design pose at which nothing is too near."""
        s = self.settings
        radius = s.eye_diameter / 2.0
        cut = np.minimum(TRIM * radius, 0.5 * (spans[:, 1] - spans[:, 0]))
        at = np.stack([spans[:, 0] + cut, spans[:, 1] - cut], axis=1)
        radii = np.concatenate([[bar_radius(shape) for shape in shapes], np.full(len(at), radius)])
        exits = np.array([[eye.exit for eye in eyes_of(shape)] for shape in shapes])
        tall = float(np.abs(spans).max())

        def free(sample: int) -> bool:
            frames, pose = self.frames[sample], self.poses[sample]
            bars = np.einsum("eij,ekj->eki", frames[:, :3, :3], exits) + frames[:, None, :3, 3]
            stacks = pose.points[:, None] + at[:, :, None] * pose.axes[:, None]
            ends = np.concatenate([bars, stacks])
            pairs, shared = self._pairs(sample, tall)
            a, b = pairs.T
            least = radii[a] + radii[b] + np.where(shared, PINNED, s.axial_gap)
            apart = np.linalg.norm(segment_difference(ends[a], ends[b]), axis=1)
            return bool((apart >= least).all())

        start = int(np.searchsorted(self.ts, self.mechanism.design))
        if not free(start):
            return 0.0
        first, last = start, start
        while first > 0 and free(first - 1):
            first -= 1
        while last + 1 < len(self.ts) and free(last + 1):
            last += 1
        return float(self.ts[last] - self.ts[first])

    def _pairs(self, sample: int, tall: float) -> tuple[Ints, NDArray[np.bool_]]:
        """Pairs of bars, and of bars and stacks, that could be near; whether they share a pin."""
        key = sample, math.ceil(tall)
        if key not in self.pairs:
            mechanism, points = self.mechanism, self.poses.points[sample]
            bars, hinges = mechanism.bars, np.arange(mechanism.n_hinges)
            middle = np.concatenate([points[bars].mean(axis=1), points])
            size = np.concatenate([0.5 * mechanism.lengths, np.zeros(len(points))])
            pairs = _near(middle, size + key[1] + self.settings.eye_diameter)
            ends = np.concatenate([bars, np.stack([hinges, hinges], axis=1)])
            one, two = ends[pairs[:, 0]], ends[pairs[:, 1]]
            shared = (one[:, :, None] == two[:, None, :]).any(axis=(1, 2))
            # A stack touches its own bars.
            keep = ~(shared & (pairs[:, 1] >= mechanism.n_bars))
            self.pairs[key] = pairs[keep], shared[keep]
        return self.pairs[key]


def _near(points: Floats, reach: Floats) -> Ints:
    """(p, 2) pairs i < j of balls that touch."""
    pairs = cKDTree(points).query_pairs(2.0 * float(reach.max()), output_type="ndarray")
    apart = np.linalg.norm(points[pairs[:, 0]] - points[pairs[:, 1]], axis=1)
    return np.asarray(np.sort(pairs[apart < reach[pairs].sum(axis=1)], axis=1), dtype=np.int64)
