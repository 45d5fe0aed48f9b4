"""The examples in the docstrings of ddgfab give what they state."""

from __future__ import annotations

import doctest
import importlib
import pkgutil

import pytest

import ddgfab

MODULES = sorted(
    found.name
    for found in pkgutil.walk_packages(ddgfab.__path__, "ddgfab.")
    if found.name != "ddgfab.__main__"
)


def _examples() -> list[doctest.DocTest]:
    finder = doctest.DocTestFinder(exclude_empty=True)
    tests = (
        test
        for name in MODULES
        for test in finder.find(importlib.import_module(name), name)
        if test.examples
    )
    return sorted({test.name: test for test in tests}.values(), key=lambda test: test.name)


@pytest.mark.parametrize("example", _examples(), ids=lambda example: example.name)
def test_an_example_gives_what_it_states(example: doctest.DocTest) -> None:
    results = doctest.DocTestRunner().run(example)
    assert results.attempted > 0
    assert results.failed == 0


def test_the_main_functions_have_examples() -> None:
    names = {example.name.rpartition(".")[2] for example in _examples()}
    assert {"inspect", "support_structure", "generate", "grid_mesh", "bennett"} <= names
