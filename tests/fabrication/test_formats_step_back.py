"""STEP written directly, read back by the kernel: solids, places, names, colors, layers."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from gridshell_kinds import KINDS
from parts_table import CUT, EXACT
from step_products import (
    GLASS,
    INSTANCES,
    ROLES,
    SHAPES,
    STEEL,
    boundary,
    motion,
    products,
    text_of,
)
from xcaf_route import write_by_xcaf

from ddgfab.errors import KernelError
from fabrication.formats.step import (
    StepProduct,
    write_assembly,
)
from fabrication.formats.step.direct import assembly_bytes, part_bytes
from fabrication.formats.step.kernel import KernelShell
from fabrication.formats.step.read import FILE_VOLUME_RELATIVE, check_step_part, matrix, read_step
from fabrication.formats.step.records import product_name
from fabrication.formats.step.whole import check_step_assembly
from fabrication.formats.step.xcaf import components, free_labels, get_name, read_document
from fabrication.solids import properties_of, solid_of

# --- read back --------------------------------------------------------------------------------

# The kernel measures ellipses and crossings on cylinders by curves that it fits to them when it
# reads: what it finds for these is off by the same amount on the XCAF route.
FITTED = dict.fromkeys(("tee coped", "rhs coped", "rhs mixed holes"), FILE_VOLUME_RELATIVE)

UNHEALED = 1.001e-7
"""Greatest tolerance [mm] of what the reader did not have to mend (its default, and rounding)."""


def tolerance(path: Path) -> float:
    """Greatest tolerance [mm] that the reader gave to a vertex, edge or face of a part.

    It mends what does not fit by widening them, and then finds the part valid.
    """
    from OCP.ShapeAnalysis import ShapeAnalysis_ShapeTolerance
    from OCP.XCAFDoc import XCAFDoc_ShapeTool

    document, _ = read_document(path)
    (label,) = free_labels(document)
    return float(ShapeAnalysis_ShapeTolerance().Tolerance(XCAFDoc_ShapeTool.GetShape_s(label), 1))


@pytest.mark.slow
@pytest.mark.parametrize("name", EXACT)
def test_every_shape_comes_back_as_one_valid_solid_of_the_same_volume(
    name: str, tmp_path: Path
) -> None:
    path = tmp_path / "part.step"
    path.write_bytes(text_of(EXACT[name][0]))
    checks = check_step_part(
        path,
        number="BP-001",
        volume=properties_of(EXACT[name][0]).volume,
        relative=FITTED.get(name, 1e-9),
    )
    assert len(checks) == 6
    assert [check for check in checks if not check.passed] == []
    assert tolerance(path) <= UNHEALED


@pytest.mark.slow
def test_a_vertex_off_its_planes_is_found_on_reading(tmp_path: Path) -> None:
    wrong, properties = boundary("BP-002"), properties_of(SHAPES["BP-002"])
    points = wrong.points.copy()
    points[0] += 1e-3
    path = tmp_path / "part.step"
    path.write_bytes(
        part_bytes(replace(products()[1], boundary=replace(wrong, points=points)), path.name)
    )
    checks = check_step_part(path, number="BP-002", volume=properties.volume)
    assert "file volume" in {check.name for check in checks if not check.passed}
    assert tolerance(path) >= 1e-3


def attributes(path: Path) -> dict[str, Any]:
    """What a file says of each product, by number, and its tree, as OCCT's XCAF reader has it."""
    from OCP.Quantity import Quantity_Color, Quantity_TypeOfColor
    from OCP.XCAFDoc import (
        XCAFDoc_Area,
        XCAFDoc_Centroid,
        XCAFDoc_ColorType,
        XCAFDoc_DocumentTool,
        XCAFDoc_ShapeTool,
        XCAFDoc_Volume,
    )

    document, units = read_document(path)
    colors = XCAFDoc_DocumentTool.ColorTool_s(document.Main())
    layers = XCAFDoc_DocumentTool.LayerTool_s(document.Main())
    materials = XCAFDoc_DocumentTool.MaterialTool_s(document.Main())
    found: dict[str, Any] = {"units": units, "tree": []}

    def walk(label: Any, path: tuple[str, ...]) -> None:
        if XCAFDoc_ShapeTool.IsAssembly_s(label):
            for component, target in components(label):
                placement = matrix(XCAFDoc_ShapeTool.GetLocation_s(component))
                here = (*path, get_name(component))
                found["tree"].append((here, get_name(target), np.round(placement, 8).tolist()))
                walk(target, here)
            return
        shape, color = XCAFDoc_ShapeTool.GetShape_s(label), Quantity_Color()
        assert colors.GetColor(shape, XCAFDoc_ColorType.XCAFDoc_ColorSurf, color)
        names = layers.GetLayers(label)
        volume, area, center = XCAFDoc_Volume(), XCAFDoc_Area(), XCAFDoc_Centroid()
        for attribute in (volume, area, center):
            assert label.FindAttribute(attribute.GetID_s(), attribute)
        point = center.Get()
        density = materials.GetDensityForShape_s(label)
        number = get_name(label).removesuffix(" part")
        found[number] = {
            "color": np.round(color.Values(Quantity_TypeOfColor.Quantity_TOC_sRGB), 4).tolist(),
            "layers": [names.Value(i + 1).ToExtString() for i in range(names.Length())],
            "volume": f"{volume.Get():.10e}",
            "area": f"{area.Get():.10e}",
            "centroid": np.round((point.X(), point.Y(), point.Z()), 7).tolist(),
            "density": f"{density:.10e}",
            "material": material_of(label),
        }

    for label in free_labels(document):
        found["root"] = get_name(label)
        walk(label, ())
    return found


def material_of(label: Any) -> str:
    """The name of a label's material."""
    from OCP.TDataStd import TDataStd_TreeNode
    from OCP.XCAFDoc import XCAFDoc, XCAFDoc_Material

    node, material = TDataStd_TreeNode(), XCAFDoc_Material()
    if not label.FindAttribute(XCAFDoc.MaterialRefGUID_s(), node):
        return ""
    assert node.Father().Label().FindAttribute(XCAFDoc_Material.GetID_s(), material)
    return str(material.GetName().ToCString())


@pytest.mark.slow
@pytest.mark.parametrize("schema", ["AP214", "AP242"])
def test_both_routes_say_the_same_of_an_assembly(schema: Any, tmp_path: Path) -> None:
    path = tmp_path / "assembly.step"
    path.write_bytes(
        assembly_bytes(products(), INSTANCES, name="Roof 7", file_name=path.name, schema=schema)
    )
    text = attributes(path)
    write_by_xcaf(path, products(), INSTANCES, name="Roof 7", schema=schema)
    xcaf = attributes(path)
    assert text == xcaf
    assert text["root"] == "Roof 7"
    assert len(text["tree"]) == len({product.kind for product in products()}) + len(INSTANCES)
    for number, shape in SHAPES.items():
        role = ROLES[number[:2]]
        assert text[number]["color"] == list(KINDS[role].color)
        assert text[number]["layers"] == [KINDS[role].layer]
        assert text[number]["material"] == (GLASS if role == "panel" else STEEL).name
        assert float(text[number]["volume"]) == pytest.approx(properties_of(shape).volume)


@pytest.mark.slow
def test_pieces_of_an_assembly_are_valid_and_where_they_were_put(tmp_path: Path) -> None:
    path = tmp_path / "assembly.step"
    write_assembly(path, products(), INSTANCES, name="Roof 7")
    expected = {m: (n, properties_of(SHAPES[n]).volume, p) for n, m, p in INSTANCES}
    assert all(check.passed for check in check_step_assembly(path, expected))
    content = read_step(path)
    assert sorted(product.name for product in content.products) == sorted(map(product_name, SHAPES))
    for product in content.products:
        assert product.report.valid
        assert product.report.closed
        assert product.report.solids == 1
    placed = {name: (product, placement) for product, name, placement in content.instances}
    assert len(content.instances) == len(placed) == len(INSTANCES)
    for number, mark, placement in INSTANCES:
        assert placed[mark][0] == product_name(number)
        np.testing.assert_allclose(placed[mark][1], placement, atol=1e-9)


@pytest.mark.slow
def test_parts_without_an_exact_boundary_stand_beside_the_others(tmp_path: Path) -> None:
    exact = products()
    cut = [
        StepProduct(f"NP-{k:03d}", KINDS["node"], solid_of(shape), properties_of(shape), STEEL)
        for k, (shape, _) in enumerate(CUT.values(), start=2)
    ]
    extra = [(product.number, f"N-{k:04d}", motion(k)) for k, product in enumerate(cut, start=2)]
    path = tmp_path / "assembly.step"
    path.write_bytes(
        assembly_bytes([*cut, *exact], [*INSTANCES, *extra], name="Roof", file_name=path.name)
    )
    volumes = {product.number: product.properties.volume for product in (*cut, *exact)}
    numbers = {product_name(number): number for number in volumes}
    expected = {mark: (number, volumes[number], p) for number, mark, p in [*INSTANCES, *extra]}
    assert [c for c in check_step_assembly(path, expected) if not c.passed] == []
    assert attributes(path)["NP-002"]["material"] == STEEL.name
    for product in read_step(path).products:
        assert product.report.valid
        assert product.report.volume == pytest.approx(volumes[numbers[product.name]], rel=1e-6)


@pytest.mark.slow
def test_a_solid_that_is_no_single_shell_is_refused_by_name() -> None:
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox, BRepPrimAPI_MakeSphere
    from OCP.gp import gp_Pnt
    from OCP.TopAbs import TopAbs_ShapeEnum
    from OCP.TopExp import TopExp_Explorer

    hollow = BRepAlgoAPI_Cut(
        BRepPrimAPI_MakeBox(10, 10, 10).Shape(), BRepPrimAPI_MakeSphere(gp_Pnt(5, 5, 5), 2).Shape()
    ).Shape()
    solid = TopExp_Explorer(hollow, TopAbs_ShapeEnum.TopAbs_SOLID).Current()
    with pytest.raises(KernelError, match="one closed shell"):
        KernelShell(solid)
    with pytest.raises(KernelError, match="NP-007"):
        assembly_bytes(
            [StepProduct("NP-007", KINDS["node"], solid, properties_of(SHAPES["NP-001"]))],
            [],
            name="R",
            file_name="a",
        )


@pytest.mark.slow
def test_both_routes_use_the_same_kinds_of_entities(tmp_path: Path) -> None:
    path = tmp_path / "assembly.step"
    write_by_xcaf(path, products(), INSTANCES, name="Roof 7")
    text = assembly_bytes(products(), INSTANCES, name="Roof 7", file_name=path.name)

    def kinds(step: bytes) -> set[str]:
        data = re.sub(r"\s+|'[^']*'", "", step.decode("ascii").split("DATA;")[1])
        return set(re.findall(r"[A-Z_0-9]{4,}(?=\()", data))

    ours, theirs = kinds(text), kinds(path.read_bytes())
    # The outer bound is named, as the standard has it for planes with holes; attributes are ours.
    attributes = {"GENERAL_PROPERTY", "GENERAL_PROPERTY_ASSOCIATION"}
    assert ours - theirs <= {"FACE_OUTER_BOUND", *attributes}
    assert theirs - ours == set()


@pytest.mark.slow
def test_cadquery_opens_the_same_tree(tmp_path: Path) -> None:
    import cadquery

    path = tmp_path / "assembly.step"
    write_assembly(path, products(), INSTANCES, name="Roof 7")
    root = cadquery.Assembly.importStep(str(path))
    names = [child.name.split("/")[-1] for child in root.children]
    assert names == ["Beams", "Nodes", "Panels"]
    marks = [piece.name.split("/")[-1] for group in root.children for piece in group.children]
    assert marks == [mark for _, mark, _ in INSTANCES]
    total = sum(solid.Volume() for solid in root.toCompound().Solids())
    expected = sum(properties_of(SHAPES[number]).volume for number, _, _ in INSTANCES)
    assert total == pytest.approx(expected, rel=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize(
    "name",
    ["Dach O'Neil #7 ~ 100 % ü", "C:\\roof\\X2\\", 'say "日本"', "tab\there", "x\U0001f600y"],
)
def test_names_with_all_sorts_of_characters_come_back(name: str, tmp_path: Path) -> None:
    path = tmp_path / "assembly.step"
    write_assembly(path, products()[:1], [("BP-001", name, np.eye(4))], name=name)
    kept = name.replace("\t", " ")  # ISO 10303-21 has no control characters
    assert [instance[1] for instance in read_step(path).instances] == [kept]
    assert attributes(path)["root"] == kept
