"""What is not a design, kit or net is refused by its type, with what makes the right one."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from ddgfab.errors import InputError
from ddgfab.forms.registry import generate
from ddgfab.net import Net
from ddgfab.nets.knet import knet
from ddgfab.support import support_structure
from fabrication import design, kit, make

MESH = generate("conical", {})
NET = Net.build(np.stack([*np.meshgrid(np.arange(4.0), np.arange(3.0)), np.ones((3, 4))], 2))
KNET = knet([np.full(3, 0.3), np.full(2, 0.4)], [np.full(2, 0.1), np.full(1, -0.2)], 1.2)
STRUCTURE = support_structure(MESH)


@pytest.mark.parametrize(
    ("given", "help_"),
    [
        (NET, ".to_mesh()"),
        (KNET, "net.to_net().to_mesh()"),
        (MESH.vertices, "grid_mesh(points)"),
        (3.0, "Mesh.build"),
        ({"net": {}}, "Mesh.build"),
        (int, "Mesh.build"),
    ],
    ids=lambda value: type(value).__name__,
)
def test_design_says_what_it_takes(given: Any, help_: str) -> None:
    with pytest.raises(InputError) as caught:
        design(given)
    assert "a project or mesh file, a Mesh or (vertices, faces) is needed" in str(caught.value)
    assert help_ in str(caught.value)


@pytest.mark.parametrize("given", [NET, KNET, MESH, STRUCTURE, 3.0, "roof.obj", None, {}, design])
def test_make_says_what_it_takes(given: Any) -> None:
    with pytest.raises(InputError, match=r"make\(design\(source\)\)"):
        make(given)


@pytest.mark.parametrize("given", [NET, KNET, MESH, STRUCTURE, 3.0, {}, design])
def test_kit_says_what_it_takes(given: Any) -> None:
    with pytest.raises(InputError, match="a kind of linkage"):
        kit(given)
