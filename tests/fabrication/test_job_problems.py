"""What failed, for people: gathered by kind, the worst first, each clash once."""

from __future__ import annotations

from dataclasses import replace

import pytest

from fabrication.gridshell.design import Design
from fabrication.gridshell.room import clearances
from fabrication.job.problems import problems_of
from fabrication.specs import Check

ROLES = {"B-0000": "beam", "B-0001": "beam", "B-0002": "beam", "N-0000": "node", "P-0000": "panel"}


@pytest.mark.parametrize(
    ("name", "limit", "values"),
    [("lean_deg", 30.0, (31.0, 48.0, 36.0)), ("least_angle_deg", 25.0, (24.0, 7.0, 19.0))],
)
def test_the_worst_comes_first(name: str, limit: float, values: tuple[float, ...]) -> None:
    """Farthest from the limit, above a greatest and below a least value."""
    checks = [
        (mark, Check(name, False, value, limit)) for mark, value in zip(ROLES, values, strict=False)
    ]
    (problem,) = problems_of(ROLES, [*checks, ("N-0000", Check(name, True, limit, limit))])
    assert [mark for mark, _ in problem.parts] == ["B-0001", "B-0002", "B-0000"]
    assert str(problem).endswith(
        f"B-0001 {values[1]:g} deg, B-0002 {values[2]:g} deg, B-0000 {values[0]:g} deg"
    )


def test_a_clash_is_listed_once_under_both_marks() -> None:
    def clash(gap: float, other: str) -> Check:
        return Check("clearance", False, gap, 1.0, other)

    found = problems_of(
        ROLES,
        [
            ("N-0000", clash(0.2, "B-0001")),
            ("B-0001", clash(0.2, "N-0000")),
            ("B-0000", clash(-3.0, "N-0000")),
            ("N-0000", clash(-3.0, "B-0000")),
        ],
    )
    assert [(p.role, p.check) for p in found] == [("beam", "clearance to nodes_mm")]
    assert [mark for mark, _ in found[0].parts] == ["B-0000/N-0000", "B-0001/N-0000"]


@pytest.mark.parametrize("count", [1, 2, 5])
def test_parts_are_counted_in_the_singular_and_the_plural(count: int) -> None:
    marks = [f"B-{k:04d}" for k in range(count)]
    roles: dict[str, str] = dict.fromkeys(marks, "beam")
    (problem,) = problems_of(roles, [(m, Check("lean_deg", False, 31.0, 30.0)) for m in marks])
    noun = "1 beam " if count == 1 else f"{count} beams "
    assert noun in str(problem)
    assert noun in problem.short().replace(",", " ")


def test_a_name_is_never_taken_apart() -> None:
    """A check may have " to " in its name without being one between two pieces."""
    found = problems_of(ROLES, [("B-0000", Check("file open to readers", False, 1.0, 2.0))])
    assert [p.check for p in found] == ["file open to readers"]


def test_members_may_be_off_on_either_side_of_a_gap(small_design: Design) -> None:
    """A gap is lost twice over: by the piece on this side, and by the one beyond."""

    def with_deviation(size: float) -> Design:
        found = tuple(replace(family, deviation=size) for family in small_design.families)
        return replace(small_design, families=found)

    exact, off = clearances(with_deviation(0.0)), clearances(with_deviation(0.1))
    assert exact["panel", "panel"] == small_design.project.panel.gap_mm
    assert exact["panel", "panel"] - off["panel", "panel"] == pytest.approx(0.2)
    assert exact["beam", "node"] - off["beam", "node"] == pytest.approx(0.2)
