"""What a message on a connection that does not fit names, and that what it advises fits."""

from __future__ import annotations

from typing import Any

import pytest
from detailing_cases import dome

from ddgfab.errors import DetailError

STUD = {"kind": "stud"}
STAR = {"kind": "star"}
TONGUE = {"kind": "bolted_tongue"}
TIMBER = {"kind": "slotted", "bolt": "M16"}

Sections = dict[str, dict[str, Any]]
CASES: dict[str, tuple[Sections, list[str], Sections]] = {
    "bar of 12 mm": (
        {"beam": {"profile": "FL 80x12"}, "connection": STUD},
        ["node N-0000, beam B-0000", "6.0 mm", "16.2 mm", '"FL 70x35"'],
        {"beam": {"profile": "FL 70x35"}},
    ),
    "stud in a small section": (
        {"beam": {"profile": "RHS 60x40x4"}, "connection": {**STUD, "bolt": "M16"}},
        ["20.0 mm", "21.0 mm", 'bolt = "M6"'],
        {"connection": {**STUD, "bolt": "M6"}},
    ),
    "coped": (
        {"beam": {"profile": "FL 80x40", "end": "cope"}, "connection": STUD},
        ['take [beam] end = "flat"'],
        {"beam": {"profile": "FL 80x40", "end": "flat"}},
    ),
    "wall of a tube": (
        {
            "beam": {"profile": "FL 80x40"},
            "node": {"kind": "tube", "diameter_mm": 101.6, "wall_mm": 6.0},
            "connection": STUD,
        },
        ["node N-", "beams B-", "1.90 mm", "at least 2 mm", "wall_mm = 17"],
        {"node": {"kind": "tube", "diameter_mm": 101.6, "wall_mm": 17.0}},
    ),
    "cheeks": (
        {"beam": {"profile": "FL 100x12"}, "node": STAR, "connection": TONGUE},
        ["cheeks of 0.0 mm", "6 mm each", 'ends = "doubled"', '"FL 35x25"'],
        {"connection": {**TONGUE, "ends": "doubled"}},
    ),
    "discs of plates": (
        {"beam": {"profile": "FL 80x40"}, "node": {"kind": "plates"}, "connection": STUD},
        ["node N-0000", '"plates" is for', '[node] kind = "cylinder"'],
        {"node": {"kind": "cylinder"}},
    ),
    "timber of a hollow section": (
        {"beam": {"profile": "RHS 100x60x4"}, "node": {"kind": "plates"}, "connection": TIMBER},
        ["node N-0000, beam B-0000", "only flat bars", 'kind = "end_plate" with round nodes'],
        {"node": {}, "connection": {"kind": "end_plate"}},
    ),
    "slanting sides": (
        {
            "beam": {"profile": [[-30, -100], [30, -100], [10, 0], [-10, 0]]},
            "connection": STUD,
        },
        ["node N-0000, beam B-0000", "upright sides", '"FL 70x35"'],
        {"beam": {"profile": "FL 70x35"}},
    ),
    "wide bar": (
        {"beam": {"profile": "FL 280x120"}, "connection": STUD},
        ["turns by 29 deg", "at least 30 deg", 'bolt = "M14"'],
        {"connection": {**STUD, "bolt": "M14"}},
    ),
    "tube too thin for wide seats": (
        {"beam": {"profile": "FL 280x120"}, "node": {"kind": "tube"}, "connection": {}},
        ["node N-", "at least 2 mm", "wall_mm = 16"],
        {"node": {"kind": "tube", "wall_mm": 16.0}},
    ),
    "plates wider than any round bar": (
        {"beam": {"profile": "FL 280x120"}, "connection": {"kind": "end_plate"}},
        ["node N-", "series ends at 250 mm", "diameter_mm = 300"],
        {"node": {"diameter_mm": 300.0}},
    ),
    "straps on a hollow section": (
        {
            "beam": {"profile": "RHS 100x60x4"},
            "node": STAR,
            "connection": {**TONGUE, "ends": "doubled"},
        },
        ["node N-0000, beam B-0000", "only flat bars", 'kind = "end_plate" with round nodes'],
        {"node": {}, "connection": {"kind": "end_plate"}},
    ),
    "slanting sides of a slotted bar": (
        {
            "beam": {"profile": [[-30, -100], [30, -100], [20, 0], [-20, 0]]},
            "node": STAR,
            "connection": TONGUE,
        },
        ["node N-0000, beam B-0000", "only flat bars", "such as FL 80x40"],
        {"beam": {"profile": "FL 80x40"}},
    ),
    "not a flat bar": (
        {"beam": {"profile": "RHS 100x60x4"}, "node": STAR, "connection": TONGUE},
        ["node N-0000, beam B-0000", "only flat bars", 'kind = "end_plate" with round nodes'],
        {"node": {}, "connection": {"kind": "end_plate"}},
    ),
    "shallow timber": (
        {"beam": {"profile": "FL 160x120"}, "node": {"kind": "plates"}, "connection": TIMBER},
        ["node N-", "beam B-", "need 122 mm", "mm deep"],
        {"beam": {"profile": "FL 280x120"}},
    ),
    "narrow timber": (
        {"beam": {"profile": "FL 280x60"}, "node": {"kind": "plates"}, "connection": TIMBER},
        ["30.0 mm", "48.0 mm", "table 8.4", "profile 96 mm wide"],
        {"beam": {"profile": "FL 280x96"}},
    ),
    "rows of bolts": (
        {"beam": {"profile": "FL 80x40"}, "connection": {"kind": "end_plate", "bolts": 8}},
        ["node N-0000, beam B-0000", "4 rows of M12", "bolts = 6"],
        {"connection": {"kind": "end_plate", "bolts": 6}},
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_what_is_advised_fits(name: str) -> None:
    bad, words, better = CASES[name]
    plain = {"panel": {"kind": "none"}}
    with pytest.raises(DetailError) as caught:
        dome().detail(**plain, **bad)
    assert all(word in str(caught.value) for word in words), str(caught.value)
    dome().detail(**plain, **{**bad, **better})
