"""IFC: read by a second parser and by ifcopenshell, which validates it and measures its solids."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from typing import Any
from uuid import UUID

import numpy as np
import pytest
from part21 import decode
from roofs import barrel
from wholes import whole_of

from ddgfab.errors import InputError
from ddgfab.io import write_mesh
from fabrication.formats.base import Whole
from fabrication.formats.ifc import FORMAT, MODEL
from fabrication.formats.ifc.guid import compressed
from fabrication.formats.ifc.model import model_bytes
from fabrication.formats.registry import find
from fabrication.formats.report import inspect_file
from fabrication.gridshell.design import design
from fabrication.solids import is_valid, kernel_properties

NAME = "Dach 'Nord' \u6771\u4eac; #1"


REJECTED = frozenset({"P-0001", "B-0003"})


def structure(profile: str, radius: float) -> Whole:
    """A barrel of beams of a profile and panes with corners of a radius; two are rejected."""
    made = design(
        barrel(1, 3),
        project={"name": NAME},
        panel={"corner_radius_mm": radius, "thickness_mm": 12.0},
        beam={"profile": profile, "end": "flat"},
    )
    return whole_of(made, REJECTED)


@pytest.fixture(scope="module")
def whole() -> Whole:
    """One of hollow sections and round corners."""
    return structure("RHS 100x50x4", 5.0)


@pytest.fixture(scope="module")
def folder(whole: Whole, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where its model.ifc is."""
    path = tmp_path_factory.mktemp("ifc")
    assert FORMAT.write_whole(path, whole) == []
    return path


def test_every_piece_is_in_it_once_with_its_class_and_number(whole: Whole, folder: Path) -> None:
    text = (folder / MODEL).read_text("ascii")
    # GlobalId, history, name = mark, description, type, placement, shape, tag = part number
    found = re.findall(
        r"=IFC([A-Z]+)\('[^']{22}',\$,('[^']*'),\$,'[^']*',#\d+,#\d+,('[^']*'),", text
    )
    names = {"beam": "MEMBER", "panel": "PLATE", "node": "DISCRETEACCESSORY"}
    wanted = [
        (names[family.role], instance.mark, family.number)
        for family in whole.families
        for instance in family.instances
    ]
    assert sorted((c, decode(mark), decode(number)) for c, mark, number in found) == sorted(wanted)
    assert len(wanted) == 8 + 10 + 3


def test_what_is_rejected_says_so(folder: Path) -> None:
    text = (folder / MODEL).read_text("ascii")
    (status,) = re.findall(
        r"#(\d+)=IFCPROPERTYSINGLEVALUE\('Status',\$,IFCLABEL\('rejected'\)", text
    )
    owners = re.findall(rf"'ddgfab_Part',\$,\((#\d+),[^)]*#{status}\)", text)
    marks = {re.search(rf"{o}=.*IFCLABEL\('([^']*)'\)", text)[1] for o in owners}  # type: ignore[index]
    assert marks == REJECTED
    (shown,) = re.findall(r"LAYERASSIGNMENT\('REJECTED',\$,\(([^)]*)\)", text)
    assert len(shown.split(",")) == len(REJECTED)


def test_the_same_structure_gives_the_same_bytes_and_ids(
    whole: Whole, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1")
    text = model_bytes(whole, MODEL).decode("ascii")
    assert model_bytes(whole, MODEL).decode("ascii") == text
    ids = re.findall(r"=IFC[A-Z]+\('([0-3][0-9A-Za-z_$]{21})',", text)
    assert len(ids) == len(set(ids)) > 50
    assert compressed(UUID(int=0)) == "0" * 22
    assert compressed(UUID(int=2**128 - 1)) == "3" + "$" * 21


@pytest.mark.parametrize(
    ("pattern", "instead", "check"),
    [
        (r"#\d+=IFCMEMBER\(.*\n", "", "ifc pieces"),
        (r"(=IFCMEMBER\(([^,]*,){7})'[^']*'", r"\1'BP-999'", "ifc numbers"),
        (r"=IFCMEMBER\(", "=IFCPLATE(", "ifc numbers"),
        (r"#\d+=IFCSITE\(.*\n", "", "ifc references"),
        (r"END-ISO-10303-21;\n", "", "ifc readable"),
    ],
)  # fmt: skip
def test_damage_is_found(
    whole: Whole, folder: Path, tmp_path: Path, pattern: str, instead: str, check: str
) -> None:
    text = (folder / MODEL).read_text("ascii")
    (tmp_path / MODEL).write_text(text, "ascii")
    assert all(c.passed for c in FORMAT.check_whole(tmp_path, whole))
    spoilt, count = re.subn(pattern, instead, text, count=1)
    assert count == 1
    (tmp_path / MODEL).write_text(spoilt, "ascii")
    assert check in {c.name for c in FORMAT.check_whole(tmp_path, whole) if not c.passed}


def test_a_piece_that_moved_is_found(whole: Whole, folder: Path, tmp_path: Path) -> None:
    text = (folder / MODEL).read_text("ascii")
    placed = re.search(r"=IFCPLATE\('[^']*',\$,'[^']*',\$,'[^']*',#(\d+)", text)
    assert placed
    axes = re.search(rf"#{placed[1]}=IFCLOCALPLACEMENT\(#\d+,#(\d+)\)", text)
    assert axes
    at = re.search(rf"#{axes[1]}=IFCAXIS2PLACEMENT3D\(#(\d+),", text)
    assert at
    spoilt = re.sub(
        rf"#{at[1]}=IFCCARTESIANPOINT\(\(([^,]*),",
        lambda m: f"#{at[1]}=IFCCARTESIANPOINT(({float(m[1]) + 0.01!r},",
        text,
    )
    (tmp_path / MODEL).write_text(spoilt, "ascii")
    failed = [c for c in FORMAT.check_whole(tmp_path, whole) if not c.passed]
    assert [c.name for c in failed] == ["ifc positions_mm"]
    assert failed[0].value == pytest.approx(0.01, rel=1e-3)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("solid", "no IFC file"),
        ("ISO-10303-21;FILE_SCHEMA(('AUTOMOTIVE_DESIGN'));END-ISO-10303-21;", "AUTOMOTIVE_DESIGN"),
        ("ISO-10303-21;FILE_SCHEMA(('IFC4'));", "truncated"),
        (
            "ISO-10303-21;FILE_SCHEMA(('IFC4'));"
            "#1=IFCPLATE('',$,'a',$,$,#2,$,'',$);#2=IFCLOCALPLACEMENT(#2,#3);END-ISO-10303-21;",
            "#2 stands within itself",
        ),
        (
            "ISO-10303-21;FILE_SCHEMA(('IFC4'));#1=IFCPLATE('',$,'a');END-ISO-10303-21;",
            "3 attributes",
        ),
        (
            "ISO-10303-21;FILE_SCHEMA(('IFC4'));#1=IFCPLATE('',$,'a',$,$,#2,$,'',$);"
            "#2=IFCLOCALPLACEMENT($,#3);#3=IFCAXIS2PLACEMENT3D(#4,#5,$);"
            "#4=IFCCARTESIANPOINT((0.,0.,0.));#5=IFCDIRECTION((0.,0.,0.));END-ISO-10303-21;",
            "#5 has no length",
        ),
        (
            "ISO-10303-21;FILE_SCHEMA(('IFC4'));#1=IFCPLATE('',$,'a',$,$,#2,$,'',$);"
            "#2=IFCLOCALPLACEMENT($,#3);#3=IFCAXIS2PLACEMENT3D(#4,#5,$);"
            "#4=IFCCARTESIANPOINT((0.,0.,0.));#5=IFCDIRECTION((0.,0.,1.E200));END-ISO-10303-21;",
            "at most 1e+60",
        ),
        (
            "ISO-10303-21;FILE_SCHEMA(('IFC4'));#1=IFCPLATE('',$,'a',$,$,#2,$,'',$);"
            "#2=IFCLOCALPLACEMENT($,#3);#3=IFCAXIS2PLACEMENT3D(#4,$,$);"
            "#4=IFCCARTESIANPOINT((0.,0.,1.E999));END-ISO-10303-21;",
            "three finite numbers",
        ),
    ],
)
def test_files_that_are_broken_are_refused(tmp_path: Path, text: str, message: str) -> None:
    (tmp_path / "a.ifc").write_text(text, "ascii")
    with pytest.raises(InputError, match=re.escape(message)) as caught:
        inspect_file(tmp_path / "a.ifc")
    assert "a.ifc" in str(caught.value)


def test_check_counts_elements(folder: Path) -> None:
    report = inspect_file(folder / MODEL)
    assert report.passed
    assert report.contents == "8 IfcDiscreteAccessory, 10 IfcMember, 3 IfcPlate"


def test_a_roof_far_away_names_its_origin(tmp_path: Path) -> None:
    far = (691_000.25, 5_334_000.75, 520.5)  # [m], as surveys have it
    mesh = barrel(1, 2)
    write_mesh(tmp_path / "far.obj", mesh.with_vertices(mesh.vertices / 1000.0 + far))
    made = design(tmp_path / "far.obj", project={"units": "m"})
    near = design(mesh).gridshell.nodes
    for one, two in zip(made.gridshell.nodes, near, strict=True):
        back = one.placement[:3, 3] + made.source.origin
        assert back == pytest.approx(two.placement[:3, 3] + np.multiply(far, 1000.0), abs=1e-3)
    assert made.product().facts()["input"]["origin_mm"] == list(made.source.origin)
    whole = whole_of(made)
    text = model_bytes(whole, MODEL).decode("ascii")
    (found,) = re.findall(r"=IFCMAPCONVERSION\(#\d+,#\d+,([^)]*)\)", text)
    values = [float(value) for value in found.split(",")]
    assert values == pytest.approx([*np.divide(made.source.origin, 1000.0), 1.0, 0.0, 0.001])
    assert "IFCMAPCONVERSION" not in model_bytes(structure("FL 80x10", 0.0), MODEL).decode("ascii")
    find("step").write_whole(tmp_path, whole)
    head = (tmp_path / "assembly.step").read_text("ascii")[:600]
    assert "The origin of all coordinates is at (691" in head.replace("','", "")


@pytest.mark.slow
def test_ifcopenshell_validates_it_and_finds_the_volumes(
    whole: Whole, folder: Path, tmp_path: Path
) -> None:
    pytest.importorskip("ifcopenshell")
    import ifcopenshell.validate

    model = ifcopenshell.open(str(folder / MODEL))
    log = ifcopenshell.validate.json_logger()
    ifcopenshell.validate.validate(model, log, express_rules=True)
    assert log.statements == []
    assert model.by_type("IfcProject")[0].Name == NAME
    measured = volumes(model, tmp_path)
    assert len(measured) == len(whole.parts)
    assert types(model) == {"SweptSolid", "Clipping", "AdvancedBrep"}
    assert max(abs(found / stated - 1.0) for found, stated in measured) < 1e-9
    plain = structure("FL 80x10", 0.0)
    far = replace(plain, about=replace(plain.about, origin=(6.9e8, 5.3e9, 5e5)))
    (tmp_path / MODEL).write_bytes(model_bytes(far, MODEL))
    model = ifcopenshell.open(str(tmp_path / MODEL))
    assert model.by_type("IfcMapConversion")[0].Eastings == pytest.approx(6.9e5)
    measured = volumes(model, tmp_path)
    assert max(abs(found / stated - 1.0) for found, stated in measured) < 1e-9


def types(model: Any) -> set[str]:
    """Types of the representations of all parts."""
    return {
        shape.MappedRepresentation.RepresentationType
        for shape in model.by_type("IfcRepresentationMap")
    }


@pytest.mark.slow
def test_parts_of_cylinders_and_fasteners_are_exact(tmp_path: Path) -> None:
    pytest.importorskip("ifcopenshell")
    import ifcopenshell.validate

    made = design(
        barrel(1, 1),
        beam={"profile": "RHS 120x60x5", "end": "flat"},
        connection={"kind": "end_plate", "fasteners": True},
    )
    (tmp_path / MODEL).write_bytes(model_bytes(whole_of(made), MODEL))
    model = ifcopenshell.open(str(tmp_path / MODEL))
    log = ifcopenshell.validate.json_logger()
    ifcopenshell.validate.validate(model, log, express_rules=True)
    assert log.statements == []
    assert "Tessellation" not in types(model)
    assert len(model.by_type("IfcMechanicalFastener")) == len(made.gridshell.fasteners) > 0
    measured = volumes(model, tmp_path)
    assert max(abs(found / stated - 1.0) for found, stated in measured) < 1e-9


def volumes(model: Any, folder: Path) -> list[tuple[float, float]]:
    """Of the exact solid of each part number, and as its quantities state it [m3]."""
    import ifcopenshell.geom
    import ifcopenshell.util.element
    from OCP.BRep import BRep_Builder
    from OCP.BRepTools import BRepTools
    from OCP.TopoDS import TopoDS_Shape

    settings = ifcopenshell.geom.settings()
    settings.set("iterator-output", ifcopenshell.ifcopenshell_wrapper.SERIALIZED)
    every = {e.Tag: e for e in model.by_type("IfcElement") if not e.is_a("IfcElementAssembly")}
    out = []
    for element in every.values():
        brep = folder / "solid.brep"
        brep.write_text(ifcopenshell.geom.create_shape(settings, element).geometry.brep_data)
        solid = TopoDS_Shape()
        assert BRepTools.Read_s(solid, str(brep), BRep_Builder())
        assert is_valid(solid)
        sets = ifcopenshell.util.element.get_psets(element)
        (stated,) = (values["NetVolume"] for values in sets.values() if "NetVolume" in values)
        out.append((kernel_properties(solid).volume, stated))
    return out


@pytest.mark.slow
def test_every_element_meets_a_specification_of_marks(folder: Path) -> None:
    """An IDS (buildingSMART): every member has a mark, a number and a mass."""
    ifcopenshell = pytest.importorskip("ifcopenshell")
    ids = pytest.importorskip("ifctester.ids")
    wanted = ids.Ids(title="marks")
    for entity in ("IFCMEMBER", "IFCPLATE", "IFCDISCRETEACCESSORY"):
        rule = ids.Specification(name=entity, ifcVersion=["IFC4"])
        rule.applicability.append(ids.Entity(name=entity))
        for name, kind in (
            ("Mark", "IFCLABEL"),
            ("PartNumber", "IFCLABEL"),
            ("Mass_kg", "IFCREAL"),
        ):
            rule.requirements.append(
                ids.Property(propertySet="ddgfab_Part", baseName=name, dataType=kind)
            )
        wanted.specifications.append(rule)
    wanted.validate(ifcopenshell.open(str(folder / MODEL)))
    for rule in wanted.specifications:
        assert rule.status is True
        assert len(rule.applicable_entities) > 0
