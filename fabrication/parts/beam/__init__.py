"""Beams: a profile swept between two cuts, each flat or coped, with round holes across."""

from __future__ import annotations

from fabrication.parts.beam.comb import CombEnd
from fabrication.parts.beam.congruence import fibre_ends
from fabrication.parts.beam.shape import (
    BEAM,
    BeamShape,
    CrossHole,
    EndCut,
    PlateEnd,
    SlotEnd,
    StudEnd,
)
from fabrication.parts.beam.straps import StrapEnd

__all__ = [
    "BEAM",
    "BeamShape",
    "CombEnd",
    "CrossHole",
    "EndCut",
    "PlateEnd",
    "SlotEnd",
    "StrapEnd",
    "StudEnd",
    "fibre_ends",
]
