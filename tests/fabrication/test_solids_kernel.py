"""Kernel solids: valid for BRepCheck, same volume, area and centroid as the closed form."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator

import numpy as np
import pytest
from parts_table import BEAMS, CUT, EXACT

from ddgfab.errors import KernelError
from fabrication.solids import (
    genus_of,
    is_valid,
    kernel_properties,
    load_kernel,
    mesh_of,
    properties_of,
    second_volume_of,
    solid_of,
    volume_of,
)
from fabrication.solids.kernel import REPAIR


@pytest.mark.slow
@pytest.mark.parametrize("name", EXACT)
def test_valid_and_of_the_same_measure(name: str) -> None:
    shape = EXACT[name][0]
    solid = solid_of(shape)
    assert is_valid(solid)
    here, there = properties_of(shape), kernel_properties(solid)
    assert there.volume == pytest.approx(here.volume, rel=1e-10)
    assert there.area == pytest.approx(here.area, rel=1e-10)
    assert np.allclose(there.centroid, here.centroid, atol=1e-7)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["bar coped holes", "valence 5 holes", "quad mitred round"])
def test_shares_its_vertices_and_edges(name: str) -> None:
    k = load_kernel()
    solid = solid_of(EXACT[name][0])
    counts = []
    for kind in (k.TopAbs_ShapeEnum.TopAbs_EDGE, k.TopAbs_ShapeEnum.TopAbs_VERTEX):
        found = k.TopTools_IndexedMapOfShape()
        k.TopExp.MapShapes_s(solid, kind, found)
        counts.append(found.Extent())
    from fabrication.solids import boundary_of

    boundary = boundary_of(EXACT[name][0])
    assert boundary is not None
    assert counts == [len(boundary.edges), len(boundary.points)]


@pytest.mark.slow
@pytest.mark.parametrize("name", CUT)
def test_cut_parts(name: str) -> None:
    manifold3d = pytest.importorskip("manifold3d")
    shape, genus = CUT[name]
    solid = solid_of(shape)
    assert is_valid(solid)
    measured = kernel_properties(solid, adaptive=True)
    assert volume_of(shape) == second_volume_of(shape)
    assert measured.volume == pytest.approx(volume_of(shape), rel=1e-9)
    chord = 0.1
    mesh = mesh_of(shape, chord)
    body = manifold3d.Manifold(manifold3d.Mesh64(mesh.vertices, mesh.triangles.astype(np.uint64)))
    assert body.status() == manifold3d.Error.NoError
    assert body.genus() == genus == genus_of(shape)
    assert len(body.decompose()) == 1
    assert abs(body.volume() - measured.volume) <= chord * measured.area


@pytest.mark.slow
def test_a_cut_agrees_with_the_exact_boundary() -> None:
    # A profile that needs no cut, sent through the booleans all the same.
    from fabrication.parts.beam.boundary import beam_cut
    from fabrication.solids.booleans import cut_solid

    shape = BEAMS["box coped holes"][0]
    solid = cut_solid(beam_cut(shape))
    assert is_valid(solid)
    here, there = properties_of(shape), kernel_properties(solid, adaptive=True)
    assert there.volume == pytest.approx(here.volume, rel=1e-9)
    assert there.area == pytest.approx(here.area, rel=1e-9)


@pytest.fixture
def fresh_guard() -> Iterator[None]:
    load_kernel.cache_clear()
    yield
    load_kernel.cache_clear()


@pytest.mark.usefixtures("fresh_guard")
def test_a_missing_kernel_says_how_to_repair(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "OCP", None)
    with pytest.raises(KernelError, match="cannot be loaded") as caught:
        solid_of(BEAMS["bar mitred"][0])
    assert str(caught.value).endswith(REPAIR)
    assert str(caught.value).count("\n") <= 2


@pytest.mark.slow
@pytest.mark.usefixtures("fresh_guard")
def test_another_build_says_how_to_repair(monkeypatch: pytest.MonkeyPatch) -> None:
    import OCP

    monkeypatch.setattr(OCP, "__version__", "8.0.0")
    with pytest.raises(KernelError, match=r"build 8\.0\.0, not 7\.9\.3") as caught:
        load_kernel()
    assert REPAIR == "pip install --force-reinstall --no-deps cadquery-ocp==7.9.3.1.1"
    assert REPAIR in str(caught.value)


def test_volumes_and_meshes_leave_the_kernel_alone() -> None:
    program = (
        "import sys; sys.path[:0] = ['.', 'tests/fabrication']\n"
        "from parts_table import EXACT, CUT\n"
        "from fabrication.solids import mesh_of, volume_of, properties_of, genus_of\n"
        "for shape, genus in EXACT.values():\n"
        "    mesh_of(shape); properties_of(shape)\n"
        "for shape, genus in CUT.values():\n"
        "    assert volume_of(shape) > 0 and genus_of(shape) == genus\n"
        "bad = {'OCP', 'cadquery', 'build123d'} & set(sys.modules)\n"
        "assert not bad, bad\n"
    )
    subprocess.run([sys.executable, "-c", program], check=True, timeout=60)
