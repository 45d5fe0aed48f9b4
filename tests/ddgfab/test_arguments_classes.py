"""A net of another class than a function takes: the error says what makes the right one."""

from __future__ import annotations

import inspect
import typing
from typing import Any

import pytest
from test_arguments import FUNCTIONS, KNET, MESH, POINTS

from ddgfab.errors import ArgumentError
from ddgfab.net import Net
from ddgfab.support import support_structure

GIVEN = {
    "Mesh": MESH,
    "Net": Net.build(POINTS),
    "KNet": KNET,
    "array": POINTS,
    "path": "roof.obj",
    "SupportStructure": support_structure(MESH),
    "nothing": None,
    "number": 3.0,
    "list": [MESH],
}
MADE = {
    "Mesh": ("Mesh.build", "mesh", "to_mesh", "grid_mesh"),
    "Net": ("Net.build", "Net.from_mesh", "to_net"),
    "KNet": ("recover_knet", "knet("),
    "CrabNet": ("crab_net(",),
    "SIsothermic": ("SIsothermic.of(",),
    "SupportStructure": ("support_structure(",),
    "Pose": ("mechanism.pose(",),
    "SplineSurface": ("fit_mesh(",),
    "Network": ("place(",),
    "TracedMesh": ("network_mesh(",),
}


def cases() -> list[tuple[Any, str, type]]:
    found = []
    for function in FUNCTIONS:
        for name, hint in typing.get_type_hints(function).items():
            if name != "return" and isinstance(hint, type) and hint.__name__ in MADE:
                found.append((function, name, hint))
    return found


CASES = cases()


def test_there_are_functions_of_every_class() -> None:
    assert {hint.__name__ for _, _, hint in CASES} >= set(MADE) - {"Net", "SupportStructure"}
    assert len(CASES) > 90


@pytest.mark.parametrize("given", GIVEN)
def test_the_error_says_what_makes_the_right_one(given: str) -> None:
    value = GIVEN[given]
    for function, name, hint in CASES:
        if isinstance(value, hint):
            continue
        others = [
            parameter.name
            for parameter in inspect.signature(function).parameters.values()
            if parameter.default is parameter.empty and parameter.name != name
        ]
        arguments: dict[str, Any] = {name: value}
        # The argument in question is looked at before those that come later; others are left out.
        with pytest.raises(ArgumentError) as caught:
            function(**arguments)
        text = str(caught.value)
        assert text.startswith(f"{function.__qualname__}: {name} is "), (text, others)
        assert any(made in text for made in MADE[hint.__name__]), (function.__name__, text)
