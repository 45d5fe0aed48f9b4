"""Suggestions for misspelt names: the most alike without regard to case, or all names."""

from __future__ import annotations

from ddgfab.suggest import nearest, suggestion

NAMES = ["circular", "conical", "Profile", "end"]


def test_nearest_first_and_as_it_is_spelt() -> None:
    assert nearest("PROFLE", NAMES) == ["Profile"]
    assert nearest("cnical", ["comical", "conical"]) == ["conical", "comical"]
    assert nearest("cnical", ["comical", "conical"], 1) == ["conical"]
    assert nearest("xyz", NAMES) == []


def test_suggestion_is_one_name_or_all() -> None:
    assert suggestion("Conicl", iter(NAMES)) == "did you mean conical?"
    assert suggestion("xyz", iter(NAMES)) == "known: circular, conical, Profile, end"
