"""The lists of each kind of connection, read back from the files, add up and fit each other."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import shop_lists
from roofs import hexagons

from fabrication.gridshell.design import Design, design
from fabrication.job.result import JobResult
from fabrication.job.run import make

PLAIN: dict[str, Any] = {"output": {"formats": ["csv"]}, "checks": {"verify": "none"}}
NET = {"kind": "canopy", "parameters": {"panels_along": 3, "panels_across": 2}}


def canopy(panel_mm: float, **sections: Any) -> Design:
    net = {**NET, "parameters": {**NET["parameters"], "panel_mm": panel_mm}}
    return design(net=net, **PLAIN, **sections)


KINDS: dict[str, Callable[[], Design]] = {
    "welded": lambda: canopy(1800.0),
    "stud": lambda: canopy(1800.0, beam={"profile": "FL 80x40"}, connection={"kind": "stud"}),
    "end_plate": lambda: canopy(
        1800.0,
        beam={"profile": "FL 80x12"},
        connection={"kind": "end_plate", "bolts": 4, "bolt": "M8", "fastener": "bolt"},
    ),
    "bolted_tongue": lambda: canopy(
        1800.0,
        beam={"profile": "FL 160x60"},
        node={"kind": "star"},
        connection={"kind": "bolted_tongue", "bolt": "M16", "fasteners": True},
    ),
    "slotted": lambda: canopy(
        2200.0,
        beam={"profile": "FL 280x120", "density": 420.0, "material": "Timber"},
        node={"kind": "plates"},
        connection={"kind": "slotted", "bolt": "M16", "fasteners": True},
    ),
    "hexagons": lambda: design(
        hexagons(), beam={"profile": "FL 80x40"}, connection={"kind": "stud"}, **PLAIN
    ),
    "boundary": lambda: canopy(
        1800.0,
        beam={"profile": "FL 80x40", "rules": [{"where": "boundary", "profile": "FL 100x50"}]},
        connection={"kind": "stud"},
    ),
}


def lists_of(plan: Design, folder: Path) -> dict[str, list[shop_lists.Row]]:
    """The files of a job that writes lists alone."""
    result = make(plan, folder)
    assert result.exit_code == 0
    return shop_lists.read(folder)


@pytest.mark.parametrize("kind", KINDS)
def test_lists_fit_each_other(kind: str, tmp_path: Path) -> None:
    lists = lists_of(KINDS[kind](), tmp_path / "out")
    assert shop_lists.wrong_totals(tmp_path / "out", lists) == []
    assert shop_lists.unexplained(lists) == []
    assert shop_lists.wrong_bolts(lists) == []
    assert shop_lists.wrong_panes(lists) == []
    assert ("bolts" in lists) == (kind != "welded")
    plates = sum(int(row["quantity"]) for row in lists.get("plates", []))
    arms = sum(int(row["valence"]) for row in lists["nodes"])
    wanted = {"end_plate": arms, "bolted_tongue": arms, "slotted": 2 * len(lists["nodes"])}
    assert plates == wanted.get(kind, 0)


@pytest.fixture(scope="module")
def stud_lists(tmp_path_factory: pytest.TempPathFactory) -> dict[str, list[shop_lists.Row]]:
    """Lists in which everything fits."""
    return lists_of(KINDS["stud"](), tmp_path_factory.mktemp("lists") / "out")


def changed(lists: dict[str, list[shop_lists.Row]], name: str, column: str, text: str) -> Any:
    """The lists with another text in one cell."""
    rows = [dict(row) for row in lists[name]]
    assert rows[3][column] != text
    rows[3][column] = text
    return {**lists, name: rows}


MISTAKES = {
    "the other sign of a mitre": ("beams", "mitre_end_deg", "-"),
    "the other end of a beam": ("bolts", "beam_end", "other"),
    "a hole a tenth lower": ("nodes", "hole_1_mm", "0.1"),
    "a seat a tenth nearer": ("nodes", "seat_1_mm", "0.1"),
    "an offset a tenth larger": ("beams", "offset_start_mm", "0.1"),
    "a shorter stud": ("bolts", "fastener", "DIN 976-1 M12x30"),
}


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_wrong_cell_is_found(mistake: str, stud_lists: dict[str, list[shop_lists.Row]]) -> None:
    """The checker itself: each of these would be a part that does not fit."""
    name, column, how = MISTAKES[mistake]
    cell = stud_lists[name][3][column]
    text = how
    if how == "-":
        text = f"{-float(cell)}"
    elif how == "other":
        text = "start" if cell == "end" else "end"
    elif how == "0.1":
        text = f"{float(cell) - 0.1:.3f}"
    assert shop_lists.wrong_bolts(stud_lists) == []
    assert shop_lists.wrong_bolts(changed(stud_lists, name, column, text))


def test_what_is_stated_is_the_projects_and_what_is_not_is_open() -> None:
    plan = canopy(
        1800.0,
        beam={"profile": "FL 80x40", "grade": "S355J2"},
        connection={"kind": "stud", "bolt_class": "10.9"},
        node={"grade": ""},
        panel={"grade": ""},
        joint={"gasket": "EPDM", "cap": ""},
    )  # the other settings are those of the built-in example
    tables = plan.schedules
    found = {row["setting"]: (row["value"], row["basis"]) for row in tables["order"]}
    assert found["beam.grade"] == ("S355J2", "project")
    assert found["joint.gasket"] == ("EPDM", "project")
    assert found["node.tolerances"] == ("ISO 2768-1 m", "default")
    assert found["beam.tolerances"][0].endswith("+1 -1 mm")  # the clearance at both ends
    assert found["connection.bolt_class"] == ("studs 10.9, washers 300 HV, nuts 10", "project")
    for setting in ("panel.grade", "joint.cap", "node.grade", "connection.grade"):
        assert found[setting] == ("", "not stated")
    assert {row["profile"] for row in tables["strips"] if row["kind"] == "cap"} == {"(not stated)"}
    assert {row["material"] for row in tables["stock"]} == {"steel S355J2", "steel (not stated)"}


def test_lists_of_a_kit_add_up_too(kit_job: JobResult) -> None:
    """Masses and pieces are the manifest's; pins come out of rods, stacks of what is assembled."""
    lists = shop_lists.read(kit_job.folder)
    assert shop_lists.unexplained(lists) == []
    parts = kit_job.manifest["parts"]
    for role in {part["role"] for part in parts}:
        own = [part for part in parts if part["role"] == role]
        rows = [row for row in lists["bom"] if row["role"] == role]
        assert sum(int(row["count"]) for row in rows) == len(own)
        grams = 1000.0 * sum(part["mass_kg"] for part in own)
        assert shop_lists.column_sum(rows, "total_g") == pytest.approx(grams, abs=0.01 * len(own))
    pins = {row["pin"]: row for row in lists["hinges"]}
    assert sorted(mark for row in lists["rods"] for mark in row["marks"].split()) == sorted(pins)
    stacked = {mark: row["stack"].split() for mark, row in pins.items()}
    placed: dict[str, list[str]] = {}
    for row in lists["assembly"]:
        placed.setdefault(row["pin"], []).append(row["part"])
    assert placed == stacked
    links = {row["mark"]: row for row in lists["links"]}
    for mark, row in links.items():
        for end in ("start", "end"):
            assert mark in stacked[row[f"pin_{end}"]]
