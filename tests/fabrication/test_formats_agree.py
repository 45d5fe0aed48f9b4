"""Models say what the schedules do: pieces, numbers, masses, lengths, materials, status."""

from __future__ import annotations

import json
import struct
from pathlib import Path
from typing import Any

import pytest
from roofs import barrel
from sheet_checks import whole_of
from test_formats_step_attributes import named_data

from fabrication.formats.base import Whole
from fabrication.formats.registry import find
from fabrication.gridshell.design import design
from fabrication.linkage.kit import kit

BOLTED = design(
    barrel(1, 1),
    project={"name": "=Dach 'Süd' 屋根"},
    beam={"profile": "RHS 120x60x5", "end": "flat", "grade": "S355J2, verzinkt"},
    node={"grade": 'S235JR "roh"'},
    panel={"build_up": "8/16Ar/6.6.2", "grade": "ESG-H, außen"},
    connection={"kind": "end_plate", "fasteners": True, "grade": "hot-dip galvanized"},
)


@pytest.fixture(scope="module", params=["roof", "kit"])
def whole(request: pytest.FixtureRequest) -> Whole:
    """A roof of bolted tubes, every kind of part with a grade; a kit on metal pins."""
    return whole_of(BOLTED if request.param == "roof" else kit("bennett"))


def listed(whole: Whole) -> dict[str, dict[str, Any]]:
    """Of each piece that is put together, by its mark: what the schedules say."""
    assert whole.tables is not None
    parts = {row["number"]: row for row in whole.tables["bom"]}
    lengths = {row["mark"]: row["length_cut_mm"] for row in whole.tables.get("beams", ())}
    out = {}
    for number, mark, _ in whole.standing():
        row = parts[number]
        assert mark in row["marks"].split()
        mass = row["unit_mass_kg"] if "unit_mass_kg" in row else row["mass_g"] / 1000.0
        own = {"number": number, "role": row["role"], "material": row["material"], "mass": mass}
        out[mark] = {**own, **({"length": lengths[mark]} if mark in lengths else {})}
    return out


def compared(found: dict[str, dict[str, Any]], wanted: dict[str, dict[str, Any]]) -> None:
    """Every piece once, and of each what a format states of it."""
    assert found.keys() == wanted.keys()
    for mark, own in found.items():
        for key, value in own.items():
            expected = wanted[mark][key]
            if isinstance(value, float):
                expected = pytest.approx(expected, rel=1e-5)
            assert value == expected, (mark, key)


def test_parts_are_of_the_materials_in_the_parts_list(whole: Whole) -> None:
    assert whole.tables is not None
    stated = {row["number"]: row["material"] for row in whole.tables["bom"]}
    assert {number: part.material.name for number, part in whole.parts.items()} == stated


def test_glb_says_what_the_schedules_do(whole: Whole, tmp_path: Path) -> None:
    find("glb").write_whole(tmp_path, whole)
    data = (tmp_path / "model.glb").read_bytes()
    (size,) = struct.unpack_from("<I", data, 12)
    root, *nodes = json.loads(data[20 : 20 + size])["nodes"]
    assert root["name"] == whole.about.project
    texts = [node["extras"] for node in nodes if "extras" in node]
    keys = {"number": "number", "role": "role", "mass": "mass_kg"}
    compared({t["mark"]: {k: t[v] for k, v in keys.items()} for t in texts}, listed(whole))


def test_3dm_says_what_the_schedules_do(whole: Whole, tmp_path: Path) -> None:
    rhino3dm = pytest.importorskip("rhino3dm")
    find("3dm").write_whole(tmp_path, whole)
    found = {}
    for item in rhino3dm.File3dm.Read(str(tmp_path / "model.3dm")).Objects:
        if isinstance(item.Geometry, rhino3dm.InstanceReference):
            text = dict(item.Attributes.GetUserStrings())
            assert item.Attributes.Name == text["mark"]
            own = {key: text[key] for key in ("number", "role", "material")}
            found[text["mark"]] = {**own, "mass": float(text["mass_kg"])}
    compared(found, listed(whole))


@pytest.mark.slow
def test_step_says_what_the_schedules_do(whole: Whole, tmp_path: Path) -> None:
    """Attributes by key, and the material that OCCT finds beside them."""
    find("step").write_whole(tmp_path, whole)
    stated = named_data(tmp_path / "assembly.step")
    found = {}
    for number, mark, _ in whole.standing():
        assert stated[mark]["mark"] == mark
        own = dict(stated[f"{number} part"])
        assert ("length" in own) == ("length" in listed(whole)[mark])
        # OCCT takes each byte of UTF-8 in a text for a letter.
        own["material"] = own["material"].encode("latin-1").decode()
        found[mark] = {"number": own.pop("part number"), **own}
    compared(found, listed(whole))


@pytest.mark.slow
def test_ifc_says_what_the_schedules_do(whole: Whole, tmp_path: Path) -> None:
    ifcopenshell = pytest.importorskip("ifcopenshell")
    import ifcopenshell.util.element as elements
    from ifcopenshell import validate

    find("ifc").write_whole(tmp_path, whole)
    model = ifcopenshell.open(str(tmp_path / "model.ifc"))
    log = validate.json_logger()
    validate.validate(model, log, express_rules=False)
    assert log.statements == []
    assert model.by_type("IfcProject")[0].Name == whole.about.project
    found = {}
    for element in model.by_type("IfcElement"):
        if element.is_a("IfcElementAssembly"):
            continue
        sets, material = elements.get_psets(element), elements.get_material(element)
        own = sets["ddgfab_Part"]
        assert (own["Mark"], own["PartNumber"]) == (element.Name, element.Tag)
        (quantities,) = (values for values in sets.values() if "NetVolume" in values)
        density = elements.get_psets(material)["Pset_MaterialCommon"]["MassDensity"]
        assert quantities["NetWeight"] == pytest.approx(quantities["NetVolume"] * density)
        assert material.Category == whole.parts[element.Tag].material.category.lower()
        found[element.Name] = {
            "number": element.Tag,
            "role": element.ObjectType,
            "material": material.Name,
            "mass": quantities["NetWeight"],
        }
        if element.is_a("IfcMember"):
            found[element.Name]["length"] = quantities["Length"]
    compared(found, listed(whole))
