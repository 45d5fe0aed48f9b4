"""Triangles that are quads cut in two: what is advised is the quads, and it helps."""

from __future__ import annotations

from pathlib import Path

import pytest

from ddgfab.errors import SupportError
from ddgfab.forms.registry import generate
from ddgfab.io import write_obj
from ddgfab.mesh import Mesh
from fabrication.gridshell.design import design
from fabrication.job.limits import LimitError, check_limits


@pytest.fixture(scope="module")
def cut(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A conical net with its quads cut in two, as many programs export it."""
    mesh = generate("conical")
    quads = (face.tolist() for face in mesh.faces)
    triangles = [t for a, b, c, d in quads for t in ([a, b, c], [a, c, d])]
    path = tmp_path_factory.mktemp("cut") / "roof.obj"
    write_obj(path, Mesh.build(mesh.vertices, triangles))
    return path


def test_without_axes_the_quads_are_advised(cut: Path) -> None:
    with pytest.raises(SupportError, match=r"\[net\] quads = true \(--quads\)"):
        design(cut)


def test_normals_that_twist_are_not_told_to_twist_more(cut: Path) -> None:
    with pytest.raises(LimitError) as caught:
        check_limits(design(cut, support={"kind": "normals"}).product())
    assert list(caught.value.settings) == [("net", "quads", True)]
    found = design(cut, net={"quads": True})
    assert found.support.torsion_deg_max < 1e-6
    check_limits(found.product())
