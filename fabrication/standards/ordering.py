"""What orders name beside sizes: standards of profiles, and tolerances where a project has none."""

from __future__ import annotations

from typing import Final

from fabrication.specs import Profile
from fabrication.standards.data import table
from fabrication.standards.glass import build_up

STEEL: Final = "Steel"
"""The material of bars whose profiles have a standard here."""


def profile_standard(section: Profile, material: str) -> str:
    """Standard that bars of a profile are made to; empty where there is none for it.

    >>> from fabrication.standards import profile
    >>> [profile_standard(profile(name), "Steel") for name in ("FL 80x10", "FL 280x120")]
    ['EN 10058', 'cut from plate, EN 10029']
    """
    rule = table("profiles").get(section.name.partition(" ")[0])
    if rule is None or material != STEEL:
        return ""
    largest = rule.get("rolled_to")
    sizes = sorted((section.depth, section.width), reverse=True)
    too_large = largest and any(size > most for size, most in zip(sizes, largest, strict=True))
    if too_large or section.name not in rule.get("rolled", [section.name]):
        return str(rule["larger"])
    return str(rule["standard"])


def bar_tolerances(material: str, clearance: float) -> str:
    """Tolerances of bars between nodes that leave a clearance [mm] at each end."""
    rule = table("tolerances")
    room = 2.0 * clearance
    short = max(room, rule["least_short_mm"])
    kind = rule["steel" if material == STEEL else "timber"]
    return f"{kind}; lengths between the cuts +{room:g} -{short:g} mm"


def node_tolerances() -> str:
    """Tolerances of nodes."""
    return str(table("tolerances")["steel"])


def pane_tolerances(text: str) -> str:
    """Standards of the tolerances of a pane, by its build-up; empty text: one ply of glass."""
    rule = table("tolerances")
    if not text:
        return str(rule["pane"])
    made = build_up(text)
    if len(made.panes) > 1:
        return str(rule["unit"])
    return str(rule["laminate" if len(made.panes[0].plies) > 1 else "pane"])
