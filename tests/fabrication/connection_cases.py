"""Structures with bolted connections that several tests start from."""

from __future__ import annotations

from typing import Any

from detailing_cases import Case, dome, fan, hexagons

from fabrication.gridshell.detailing.gridshell import Gridshell

NO_GLASS = {"kind": "none"}
BAR = {"profile": "FL 80x40"}
STUD = {"kind": "stud"}
CASES = {"dome": dome, "fan": lambda: fan(5, True), "hexagons": hexagons}


def bolted(case: Case, **sections: Any) -> Gridshell:
    return case.detail(**{"beam": BAR, "connection": STUD, "panel": NO_GLASS, **sections})
