"""Exact solids: sound ones pass, each fault is found."""

from __future__ import annotations

from typing import Any

import pytest
from parts_table import CUT

from fabrication.checks.solid import check_solid, inspect_solid
from fabrication.solids import solid_of

pytestmark = pytest.mark.slow


def box(x: float = 10, y: float = 20, z: float = 30) -> Any:
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox

    return BRepPrimAPI_MakeBox(x, y, z).Solid()


def faces(shape: Any) -> list[Any]:
    from OCP.TopAbs import TopAbs_ShapeEnum
    from OCP.TopExp import TopExp_Explorer
    from OCP.TopoDS import TopoDS

    found, explorer = [], TopExp_Explorer(shape, TopAbs_ShapeEnum.TopAbs_FACE)
    while explorer.More():
        found.append(TopoDS.Face_s(explorer.Current()))
        explorer.Next()
    return found


def failed(shape: Any, volume: float = 6000.0) -> set[str]:
    return {check.name for check in check_solid(shape, volume) if not check.passed}


def test_a_box_passes_and_a_wrong_expectation_does_not() -> None:
    assert failed(box()) == set()
    assert failed(box(), 6000.001) == {"solid volume"}
    assert failed(box(), -6000.0) == {"solid volume"}


@pytest.mark.parametrize("name", list(CUT))
def test_parts_that_booleans_cut_pass_and_a_wrong_volume_does_not(name: str) -> None:
    """The kernel's plain quadrature is 1e-6 off there: jobs with such parts were all rejected."""
    shape, _ = CUT[name]
    solid, volume = solid_of(shape), shape.second_volume()
    assert not [check for check in check_solid(solid, volume) if not check.passed]
    assert failed(solid, volume * (1.0 + 1e-8)) == {"solid volume"}


def test_an_inside_out_solid_has_no_volume() -> None:
    assert "solid volume" in failed(box().Reversed())


def test_two_solids_are_not_one() -> None:
    from OCP.BRep import BRep_Builder
    from OCP.TopoDS import TopoDS_Compound

    both, builder = TopoDS_Compound(), BRep_Builder()
    builder.MakeCompound(both)
    builder.Add(both, box())
    builder.Add(both, box(1, 1, 1))
    assert failed(both, 6001.0) == {"solid one"}


def test_an_open_shell_is_not_closed() -> None:
    from OCP.BRep import BRep_Builder
    from OCP.TopoDS import TopoDS_Shell, TopoDS_Solid

    builder, shell, solid = BRep_Builder(), TopoDS_Shell(), TopoDS_Solid()
    builder.MakeShell(shell)
    for face in faces(box())[1:]:
        builder.Add(shell, face)
    builder.MakeSolid(solid)
    builder.Add(solid, shell)
    assert "solid closed" in failed(solid)
    assert "solid closed" in failed(faces(box())[0])  # no shell at all


def test_a_face_off_its_plane_is_invalid_and_named() -> None:
    from OCP.BRep import BRep_Builder
    from OCP.BRepBuilderAPI import BRepBuilderAPI_Copy
    from OCP.gp import gp_Pnt
    from OCP.TopAbs import TopAbs_ShapeEnum
    from OCP.TopExp import TopExp_Explorer
    from OCP.TopoDS import TopoDS

    shape = BRepBuilderAPI_Copy(box()).Shape()
    vertex = TopoDS.Vertex_s(TopExp_Explorer(shape, TopAbs_ShapeEnum.TopAbs_VERTEX).Current())
    BRep_Builder().UpdateVertex(vertex, gp_Pnt(0.5, 0.5, 0.5), 1e-7)
    report = inspect_solid(shape)
    assert not report.valid
    assert report.faults
    assert "solid valid" in failed(shape)
