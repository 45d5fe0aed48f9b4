"""What failed, for people: failing checks gathered by kind, worst first, with the marks."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

from fabrication.formats.base import REJECTED_KIND
from fabrication.specs import Check, Role

SHOWN: Final = 5
"""How many parts a problem names in its text; the manifest names all."""

REJECTED: Final = "rejected"
"""Folder, inside the output folder, of the parts that failed a check or a limit."""

UNITS: Final = {"_deg": "deg", "_mm": "mm", "_percent": "%", "_kg": "kg", "_mm3": "mm3"}
"""Units by the ending of a check's name."""


@dataclass(frozen=True)
class FailedCheck:
    """A check that failed on some parts.

    parts : (mark, value), the worst first
    """

    role: Role
    check: str
    limit: float | str | None
    parts: tuple[tuple[str, float | str | None], ...]

    def __str__(self) -> str:
        name, unit = _words(self.check)
        limit = "" if self.limit is None else f" (limit {_number(self.limit)}{unit})"
        shown = ", ".join(
            mark if value is None else f"{mark} {_number(value)}{unit}"
            for mark, value in self.parts[:SHOWN]
        )
        more = len(self.parts) - SHOWN
        kind = self.role + ("" if len(self.parts) == 1 else "s")
        rest = f" and {more} more" if more > 0 else ""
        return f"{name}: {len(self.parts)} {kind}{limit}: {shown}{rest}"

    def short(self) -> str:
        """The same with the worst part only."""
        name, unit = _words(self.check)
        limit = "" if self.limit is None else f" (limit {_number(self.limit)}{unit})"
        mark, value = self.parts[0]
        worst = mark if value is None else f"{mark} {_number(value)}{unit}"
        kind = self.role + ("" if len(self.parts) == 1 else "s")
        return f"{name}: {len(self.parts)} {kind}{limit}, worst {worst}"

    def to_dict(self) -> dict[str, Any]:
        """As the manifest keeps it."""
        return {
            "role": self.role,
            "check": self.check,
            "limit": self.limit,
            "parts": [{"mark": mark, "value": value} for mark, value in self.parts],
        }


def problems_of(
    roles: Mapping[str, Role], checks: Iterable[tuple[str, Check]]
) -> tuple[FailedCheck, ...]:
    """Failing checks gathered into problems, by role and name.

    Parameters
    ----------
    roles : role of each mark
    checks : (mark, check) of all parts; those that passed are passed over
    """
    found: dict[tuple[Role, str], list[tuple[str, Check]]] = defaultdict(list)
    for mark, check in checks:
        if check.passed:
            continue
        other = check.other
        if other is None:
            found[roles[mark], check.name].append((mark, check))
        elif (roles[mark], mark) < (roles[other], other):  # both pieces have the check
            name = f"{check.name} to {roles[other]}s_mm"
            found[roles[mark], name].append((f"{mark}/{other}", check))
    problems = []
    for (role, name), members in sorted(found.items()):
        # Worst is farthest from the limit, whichever side of it is the wrong one.
        members.sort(key=lambda member: (-_excess(member[1]), member[0]))
        parts = tuple((mark, check.value) for mark, check in members)
        problems.append(FailedCheck(role, name, members[0][1].limit, parts))
    return tuple(problems)


def _excess(check: Check) -> float:
    if isinstance(check.value, int | float) and isinstance(check.limit, int | float):
        return abs(check.value - check.limit)
    return 0.0


def _words(name: str) -> tuple[str, str]:
    for ending, unit in UNITS.items():
        if name.endswith(ending):
            return name.removesuffix(ending).replace("_", " "), f" {unit}"
    return name.replace("_", " "), ""


def _number(value: float | str) -> str:
    return value if isinstance(value, str) else f"{value:.4g}"


def lines_of(checks: Sequence[Check]) -> list[str]:
    """Checks of the whole that failed, a line each."""
    return [
        f"{c.name}: {c.value}" + ("" if c.limit is None else f" (limit {c.limit})")
        for c in checks
        if not c.passed
    ]


def rejections(failed: Sequence[str]) -> list[str]:
    """What became of the pieces that failed, for people."""
    if not failed:
        return []
    more = f" and {len(failed) - SHOWN} more" if len(failed) > SHOWN else ""
    return [
        f"{len(failed)} {'part is' if len(failed) == 1 else 'parts are'} rejected "
        f"({', '.join(failed[:SHOWN])}{more}): do not order "
        f"{'it' if len(failed) == 1 else 'them'}. Schedules have the status, files of part numbers "
        f"are in {REJECTED}/, in the assembly their layer is {REJECTED_KIND.layer}"
    ]
