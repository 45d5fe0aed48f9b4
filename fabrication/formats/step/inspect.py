"""`ddgfab check` of STEP files: every product, and what the placed solids share."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from fabrication.checks.overlaps import ROUNDING_MM, ClosedMesh, covered
from fabrication.checks.shells import Shells, examine_shells
from fabrication.formats.solids import BodyReport, SolidsReport, interference, solids_report
from fabrication.formats.step.faceted import FacetedSolid
from fabrication.formats.step.read import StepContent, StepProduct, read_step
from fabrication.specs import Placement


@dataclass(frozen=True, eq=False)
class _Examined:
    """A product as a body of the report, and its solids; None for one that is not sound."""

    body: BodyReport
    solids: tuple[ClosedMesh | None, ...]


def step_report(path: Path) -> SolidsReport:
    """Each product: solids, closed, valid, volume, shells; and what placed solids share.

    Solids with curved faces are compared by facets that are at most
    `fabrication.formats.step.faceted.CHORD_MM` off: overlaps less deep than that of both are not
    seen.

    Raises
    ------
    InputError
        Missing, truncated or not STEP.
    """
    content = read_step(path, facets=True)
    found = [
        _examined(product, content.product_of.count(place))
        for place, product in enumerate(content.products)
    ]
    solids = [solid for examined in found for solid in examined.solids]
    chords = [solid.chord for product in content.products for solid in product.solids]
    standing, groups = [], []
    for group, row in enumerate(_standing(content)):
        standing += row
        groups += [group] * len(row)
    between = interference(solids, standing, chords, groups)
    return solids_report(path, "STEP", content.unit, [examined.body for examined in found], between)


def _standing(content: StepContent) -> Iterator[list[tuple[int, str, Placement]]]:
    """For each instance its solids: which of all solids, name, placement."""
    counts = [len(product.solids) for product in content.products]
    first = np.concatenate([[0], np.cumsum(counts)]).astype(int)
    for place, (_, name, at) in zip(content.product_of, content.instances, strict=True):
        several = counts[place] > 1
        yield [
            (int(first[place]) + k, f"{name} solid {k + 1}" if several else name, at)
            for k in range(counts[place])
        ]


def _examined(product: StepProduct, instances: int) -> _Examined:
    """What the kernel says, and what the facets show: how shells lie, what solids share."""
    report = product.report
    problems = []
    if report.solids == 0:
        problems.append("no solid")
    elif not report.closed:
        problems.append("not closed")
    if not report.valid:
        problems.append("invalid" + (f" ({', '.join(report.faults)})" if report.faults else ""))
    if report.solids and report.volume <= 0:
        problems.append("inside out or without volume")
    several = len(product.solids) > 1
    shells = cavities = 0
    volume, solids = report.volume, []
    for k, solid in enumerate(product.solids, 1):
        found = _shells(solid)
        if found is not None:
            shells, cavities = shells + len(found.volumes), cavities + found.cavities
            at = f"solid {k}: " if several else ""
            if not problems:
                problems += [at + text for text in found.problems]
            volume += found.union - float(found.volumes.sum())
        sound = found is not None and not found.problems
        solids.append(
            ClosedMesh(found.mesh, found.union, product.name) if found and sound else None
        )
    if several:
        placed = [(k, f"solid {k + 1}", np.eye(4)) for k in range(len(solids))]
        shared = interference(solids, placed, [solid.chord for solid in product.solids])
        problems += shared
        if shared:
            known = [solid for solid in solids if solid is not None]
            volume += covered(known) - sum(solid.volume for solid in known)
    body = BodyReport(
        product.name, instances, report.solids, None, volume, tuple(problems), shells, cavities
    )
    return _Examined(body, tuple(solids))


def _shells(solid: FacetedSolid) -> Shells | None:
    """The shells of a solid; None where its facets leave gaps, which the kernel has judged."""
    found = examine_shells(solid.mesh, ROUNDING_MM + 2 * solid.chord)
    return found if isinstance(found, Shells) else None
