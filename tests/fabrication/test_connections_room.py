"""Fasteners have their room: none in beams and nodes but for threads, heads below the wood."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from connection_cases import bolted
from detailing_cases import Case, central, dome, grid

from fabrication.checks.assembly import check_assembly
from fabrication.families import families
from fabrication.gridshell.detailing.gridshell import Gridshell
from fabrication.solids import mesh_of
from fabrication.standards.fasteners import fastener

KINDS: dict[str, dict[str, Any]] = {
    "stud": {"connection": {"kind": "stud"}},
    "bolt in a hollow section": {
        "beam": {"profile": "RHS 100x60x4"},
        "node": {"kind": "tube", "wall_mm": 20.0},
        "connection": {"kind": "stud", "fastener": "bolt"},
    },
    "end plate": {"connection": {"kind": "end_plate", "bolts": 4}},
    "tongue": {
        "beam": {"profile": "FL 160x60"},
        "node": {"kind": "star"},
        "connection": {"kind": "bolted_tongue"},
    },
    "straps": {
        "beam": {"profile": "FL 80x12"},
        "connection": {"kind": "bolted_tongue", "ends": "doubled"},
    },
    "slotted": {
        "beam": {"profile": "FL 280x120"},
        "node": {"kind": "plates"},
        "connection": {"kind": "slotted", "bolt": "M16"},
    },
}
CHORD = 0.05


def made(case: Case, name: str, **other: Any) -> Gridshell:
    sections = {**KINDS[name], **other}
    connection = {**sections["connection"], "fasteners": True}
    return bolted(case, **{**sections, "connection": connection})


@pytest.mark.slow
@pytest.mark.parametrize("name", KINDS)
def test_fasteners_share_volume_with_threads_alone(name: str) -> None:
    shell = made(central(grid(1, 1), (700.0, 800.0, -5000.0)), name)
    found = families(shell.pieces, shell.family_tolerance)
    meshes = {family.number: mesh_of(family.shape, CHORD) for family in found}
    bolts = {bolt.mark: bolt for bolt in shell.bolts}
    own: dict[str, list[str]] = {}
    for piece in shell.fasteners:
        own.setdefault(piece.bolt, []).append(piece.mark)
    together = frozenset(
        frozenset((a, b)) for marks in own.values() for a in marks for b in marks if a != b
    )
    report = check_assembly(
        found, meshes, {}, tolerance=4 * CHORD, overlap=4 * CHORD, mounted=together
    )
    clashes = {
        (mark, check.other)
        for mark, checks in report.items()
        for check in checks
        if not check.passed and mark.startswith("F-")
    }
    threads = {
        (piece.mark, bolts[piece.bolt].node)
        for piece in shell.fasteners
        if piece.shape.kind in ("stud", "bolt") and bolts[piece.bolt].thread is not None
    }
    assert clashes == threads
    assert bool(threads) == (name in {"stud", "bolt in a hollow section", "end plate"})


def test_heads_in_recesses_lie_below_the_wood_all_round() -> None:
    """Also where the bar is inclined: its top falls towards one side of the recess."""
    shell = made(dome(), "slotted", beam={"profile": "FL 200x120"})
    size = fastener("M16")
    beams = {beam.mark: beam for beam in shell.beams}
    least = np.inf
    for bolt in shell.bolts:
        beam = beams[bolt.beam]
        comb = (beam.shape.start, beam.shape.end)[bolt.end].comb
        turn, shift = beam.placement[:3, :3], beam.placement[:3, 3]
        top = bolt.point + (0.5 * bolt.grip + size.wide[2] + size.head) * bolt.axis
        aside = np.cross(turn[:, 1], bolt.axis)
        for side in (-0.5, 0.5):
            rim = top + side * comb.recess * aside
            least = min(least, -float((rim - shift) @ turn[:, 2]))
    assert 0.0 <= least < 1.0 + 1e-9  # grips are whole even numbers
