"""Every sheet of the examples and of the built-in products: no text on another, none off the frame.

All sheets of small ones, and of larger ones the plans with every twelfth part.
"""

from __future__ import annotations

from pathlib import Path

import pytest
from sheet_checks import faults, whole_of

from fabrication import design, kit
from fabrication.formats.sheets import PLANS, sheets_of_whole

EXAMPLES = Path(__file__).parents[2] / "examples"
SURFACES = ("surface_roof.toml", "surface_torus.toml")
"""They are traced and optimized first, which takes a minute; their parts are like others."""

ALL = 60
"""So many sheets are all looked at."""


def wrong(made: object) -> list[str]:
    sheets = list(sheets_of_whole(whole_of(made)))
    assert sheets
    step = 1 if len(sheets) <= ALL else 12
    return [
        f"{sheet.title}: {fault}"
        for n, (group, sheet) in enumerate(sheets)
        if group in PLANS or n % step == 0
        for fault in faults(sheet)
    ]


@pytest.mark.slow
@pytest.mark.parametrize(
    "path",
    [path for path in sorted(EXAMPLES.glob("*.toml")) if path.name not in SURFACES],
    ids=lambda path: path.stem,
)
def test_sheets_of_examples(path: Path) -> None:
    assert wrong(design(path)) == []


@pytest.mark.slow
def test_sheets_of_the_built_in_canopy() -> None:
    assert wrong(design()) == []


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["bennett", "cube"])
def test_sheets_of_kits(kind: str) -> None:
    assert wrong(kit(kind)) == []
