"""Build-ups of panes, and mitred panes: thickness, mass, bevels."""

from __future__ import annotations

import re

import pytest
from detailing_cases import dome, fan

from ddgfab.errors import ProjectError
from fabrication.gridshell.load import make_project
from fabrication.gridshell.schedules import schedules
from fabrication.standards.glass import build_up


@pytest.mark.parametrize(
    ("text", "thickness", "mass"),
    [
        ("12", 12.0, 30.0),
        ("6.6", 12.76, 30.0 + 0.76 * 1.07),
        ("6.6.4", 13.52, 30.0 + 1.52 * 1.07),
        ("8/16Ar/6.6", 36.76, 50.0 + 0.76 * 1.07 + 16 * 1.699e-3),
        ("4/12/4/12Kr/4.4.1", 40.38, 40.0 + 0.38 * 1.07 + 12 * (1.232 + 3.560) * 1e-3),
    ],
)
def test_build_ups(text: str, thickness: float, mass: float) -> None:
    made = build_up(text)
    assert made.thickness == pytest.approx(thickness)
    assert made.mass == pytest.approx(mass)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("8/16Ar", "has 2 elements"),
        ("7", "no float glass of 7 mm"),
        ("8/16Xe/6", 'no gas "Xe"'),
        ("8/99/6", "6 to 24 mm wide"),
        ("8.8.8", 'plies are written with their films, "8.8.8.2"'),
        ("8//6", "is not a cavity"),
        ("8/16Ar/6,6", "is not a pane"),
        ("٨", "is not a pane"),
        ("4" * 99, "99 characters"),
        ("4/12/4/12/4/12/4/12/4", "has 9 elements"),
    ],
)
def test_wrong_build_ups_name_element_and_limit(text: str, message: str) -> None:
    with pytest.raises(ProjectError, match=re.escape(message)):
        build_up(text)
    with pytest.raises(ProjectError, match=r"\[panel\]"):
        make_project({"panel": {"build_up": text}})


def test_a_build_up_sets_thickness_and_mass_and_contradicts_no_other_key() -> None:
    made = make_project({"panel": {"build_up": "8/16Ar/6.6"}})
    assert made.panel.thickness_mm == pytest.approx(36.76)
    again = make_project({"panel": made.settings["panel"]})  # both keys, agreeing
    assert again.panel == made.panel
    shell = dome().detail(panel={"build_up": "8/16Ar/6.6"})
    row = schedules(shell)["panels"][0]
    assert row["mass_kg"] == pytest.approx(row["area_m2"] * build_up("8/16Ar/6.6").mass, rel=1e-6)
    with pytest.raises(ProjectError, match="thickness_mm = 12 is not that of build_up"):
        make_project({"panel": {"build_up": "8/16Ar/6.6", "thickness_mm": 12}})
    with pytest.raises(ProjectError, match="needs a build_up of two panes"):
        make_project({"panel": {"step_mm": 20}})


def test_bevels_of_mitred_panes_follow_the_dihedral_angles() -> None:
    """Where two panes meet in a joint's plane of symmetry, the bevels are half the dihedral."""
    shell = fan(5, closed=True).detail(panel={"edge": "mitred"})
    for row in schedules(shell)["panels"]:
        for k in range(1, 4):
            if row[f"neighbour_{k}"]:
                half = 0.5 * row[f"dihedral_{k}_deg"]
                assert row[f"bevel_{k}_deg"] == pytest.approx(-half, abs=0.01)
