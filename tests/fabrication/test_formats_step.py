"""STEP files of kernel solids: opened again by OCCT's reader, cadquery, build123d and FreeCAD."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from gridshell_kinds import KINDS

from ddgfab.errors import KernelError, OutputError
from fabrication.formats.step import Header, Material, StepProduct, write_part
from fabrication.formats.step import write_assembly as write
from fabrication.formats.step.read import check_step_part, read_step
from fabrication.formats.step.records import product_name
from fabrication.formats.step.whole import check_step_assembly
from fabrication.formats.step.xcaf import (
    components,
    free_labels,
    get_name,
    read_document,
)
from fabrication.parts.beam import BEAM
from fabrication.parts.panel import PANEL
from fabrication.specs import Properties

pytestmark = pytest.mark.slow

STEEL = Material("S355J2", 7850.0)
GLASS = Material("Glas für Dächer", 2500.0)
HEADER = Header(author="J. Müller", organization="Werk O'Neil")


def box(x: float, y: float, z: float) -> Any:
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox

    return BRepPrimAPI_MakeBox(x, y, z).Solid()


def box_properties(x: float, y: float, z: float) -> Properties:
    return Properties(x * y * z, 2 * (x * y + y * z + z * x), (x / 2, y / 2, z / 2))


def motion(seed: int) -> np.ndarray:
    """A random rigid motion."""
    rng = np.random.default_rng(seed)
    q, r = np.linalg.qr(rng.normal(size=(3, 3)))
    q *= np.sign(np.diag(r))
    if np.linalg.det(q) < 0:
        q[:, 0] *= -1
    placement = np.eye(4)
    placement[:3, :3], placement[:3, 3] = q, rng.uniform(-2e4, 2e4, 3)
    return placement


SIZES = {"BP-001": (1200.0, 60.0, 8.0), "NP-001": (80.0, 80.0, 120.0), "PP-001": (1400, 1300, 16)}
PRODUCTS = [("BP-001", "beam", STEEL), ("NP-001", "node", STEEL), ("PP-001", "panel", GLASS)]
INSTANCES = [
    *(("BP-001", f"B-{i:04d}", motion(i)) for i in range(5)),
    *(("NP-001", f"N-{i:04d}", motion(10 + i)) for i in range(3)),
    ("PP-001", "P-0000", motion(20)),
]


def products() -> list[StepProduct]:
    return [
        StepProduct(
            number, KINDS[role], box(*SIZES[number]), box_properties(*SIZES[number]), material
        )
        for number, role, material in PRODUCTS
    ]


@pytest.fixture(scope="module")
def assembly(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("step") / "assembly.step"
    write(path, products(), INSTANCES, name="Roof 7", header=HEADER)
    return path


def test_instances_come_back_with_their_marks_products_and_placements(assembly: Path) -> None:
    content = read_step(assembly)
    assert content.unit == "millimetre"
    found = {name: (product, placement) for product, name, placement in content.instances}
    assert len(content.instances) == len(INSTANCES) == len(found)
    for number, mark, placement in INSTANCES:
        assert found[mark][0] == product_name(number)
        np.testing.assert_allclose(found[mark][1], placement, atol=1e-9)


def test_each_product_is_one_valid_solid_of_the_same_volume(assembly: Path) -> None:
    content = read_step(assembly)
    by_name = {product_name(number): size for number, size in SIZES.items()}
    assert sorted(p.name for p in content.products) == sorted(by_name)
    for product in content.products:
        assert product.report.solids == 1
        assert product.report.closed
        assert product.report.valid
        assert product.report.volume == pytest.approx(np.prod(by_name[product.name]), rel=1e-9)


def test_the_check_of_an_assembly_passes_and_names_what_differs(assembly: Path) -> None:
    expected = {m: (n, float(np.prod(SIZES[n])), placement) for n, m, placement in INSTANCES}
    assert all(check.passed for check in check_step_assembly(assembly, expected))
    number, volume, placement = expected["B-0003"]
    moved = placement.copy()
    moved[0, 3] += 1e-3
    wrong = expected | {"B-0003": ("NP-001", volume * 1.01, moved)}
    failed = {c.name: c.value for c in check_step_assembly(assembly, wrong) if not c.passed}
    assert failed["assembly part numbers"] == "B-0003"
    assert failed["assembly positions_mm"] == pytest.approx(1e-3, rel=1e-3)
    assert set(failed) == {"assembly part numbers", "assembly positions_mm", "assembly volume"}
    missing = expected | {"B-0009": (number, 0.0, placement)}
    failed = {c.name: c.value for c in check_step_assembly(assembly, missing) if not c.passed}
    assert failed == {"assembly marks": len(INSTANCES)}


def product_labels(path: Path) -> tuple[Any, dict[str, Any]]:
    document, _ = read_document(path)
    labels = {}
    (root,) = free_labels(document)
    assert get_name(root) == "Roof 7"
    for _, group in components(root):
        for _, target in components(group):
            labels[get_name(target)] = target
    return document, labels


def test_colors_layers_materials_and_validation_properties_come_back(assembly: Path) -> None:
    from OCP.Quantity import Quantity_Color, Quantity_TypeOfColor
    from OCP.XCAFDoc import (
        XCAFDoc_Area,
        XCAFDoc_Centroid,
        XCAFDoc_ColorType,
        XCAFDoc_DocumentTool,
        XCAFDoc_MaterialTool,
        XCAFDoc_ShapeTool,
        XCAFDoc_Volume,
    )

    document, labels = product_labels(assembly)
    colors = XCAFDoc_DocumentTool.ColorTool_s(document.Main())
    layers = XCAFDoc_DocumentTool.LayerTool_s(document.Main())
    for number, role, material in PRODUCTS:
        label = labels[product_name(number)]
        shape = XCAFDoc_ShapeTool.GetShape_s(label)
        color = Quantity_Color()
        assert colors.GetColor(shape, XCAFDoc_ColorType.XCAFDoc_ColorSurf, color)
        back = color.Values(Quantity_TypeOfColor.Quantity_TOC_sRGB)
        np.testing.assert_allclose(back, KINDS[role].color, atol=1e-4)
        names = layers.GetLayers(label)
        assert [names.Value(i + 1).ToExtString() for i in range(names.Length())] == [
            KINDS[role].layer
        ]
        density = XCAFDoc_MaterialTool.GetDensityForShape_s(label)
        assert density == pytest.approx(material.density * 1e-6)  # g/mm3, as the reader counts
        expected = box_properties(*SIZES[number])
        volume, area, center = XCAFDoc_Volume(), XCAFDoc_Area(), XCAFDoc_Centroid()
        assert label.FindAttribute(XCAFDoc_Volume.GetID_s(), volume)
        assert label.FindAttribute(XCAFDoc_Area.GetID_s(), area)
        assert label.FindAttribute(XCAFDoc_Centroid.GetID_s(), center)
        assert volume.Get() == pytest.approx(expected.volume, rel=1e-9)
        assert area.Get() == pytest.approx(expected.area, rel=1e-9)
        point = center.Get()
        np.testing.assert_allclose((point.X(), point.Y(), point.Z()), expected.centroid)


def test_cadquery_opens_the_same_tree(assembly: Path) -> None:
    # cadquery wraps OCCT too: a second reader of the tree, not a second kernel.
    import cadquery

    root = cadquery.Assembly.importStep(str(assembly))
    leaves = {}

    def walk(node: Any) -> None:
        for child in node.children:
            walk(child)
        if not node.children:
            leaves[node.name.split("/")[-1]] = node

    walk(root)
    assert set(leaves) >= {mark for _, mark, _ in INSTANCES}
    total = sum(solid.Volume() for solid in root.toCompound().Solids())
    assert total == pytest.approx(sum(np.prod(SIZES[n]) for n, _, _ in INSTANCES), rel=1e-9)


def test_freecad_opens_the_assembly_with_numbers_and_instances(
    assembly: Path, tmp_path: Path
) -> None:
    # FreeCAD gathers equal instances in one link array, and a group of one product becomes that
    # array; its console import crashes with merge=True, also on cadquery's own files (0.20).
    if shutil.which("freecadcmd") is None:
        pytest.skip("freecadcmd is not installed")
    program = tmp_path / "look.py"
    program.write_text(
        "import FreeCAD, Import\n"
        "document = FreeCAD.newDocument('x')\n"
        f"Import.insert({str(assembly)!r}, 'x', merge=False)\n"
        "for o in document.Objects:\n"
        "    print('\\nOBJECT', o.TypeId, o.Label, o.Shape.Volume,\n"
        "          getattr(o, 'ElementCount', 1),\n"
        "          any(user.TypeId == 'App::Link' for user in o.InList), sep='|')\n"
    )
    done = subprocess.run(
        ["freecadcmd", str(program)],
        capture_output=True,
        text=True,
        timeout=120,
        env={**os.environ, "HOME": str(tmp_path)},
    )
    objects = [line.split("|")[1:] for line in done.stdout.splitlines() if "OBJECT|" in line]
    labels = {label for _, label, *_ in objects}
    assert labels >= {"BP-001 part", "NP-001 part", "Beams", "Nodes", "Panels", "Roof 7"}, (
        done.stdout
    )
    (whole,) = [float(volume) for _, label, volume, *_ in objects if label == "Roof 7"]
    assert whole == pytest.approx(sum(np.prod(SIZES[n]) for n, _, _ in INSTANCES), rel=1e-9)
    placed = sum(
        int(count)
        for kind, _, _, count, linked in objects
        if kind == "App::Link" or (kind == "Part::Feature" and linked == "False")
    )
    assert placed == len(INSTANCES)


def test_build123d_opens_the_part_with_its_name(tmp_path: Path) -> None:
    import build123d

    size = (300.0, 40.0, 20.0)
    write_part(
        tmp_path / "BP-007.step", StepProduct("BP-007", BEAM, box(*size), box_properties(*size))
    )
    shape = build123d.import_step(str(tmp_path / "BP-007.step"))
    assert shape.label == "BP-007_part"  # build123d has no spaces
    assert len(shape.solids()) == 1
    assert shape.volume == pytest.approx(np.prod(size), rel=1e-9)


def test_header_material_and_units_are_in_the_text(tmp_path: Path, monkeypatch: Any) -> None:
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1700000000")
    path = tmp_path / "PP-001.step"
    size = SIZES["PP-001"]
    write_part(
        path,
        StepProduct("PP-001", PANEL, box(*size), box_properties(*size), material=GLASS),
        header=HEADER,
    )
    text = re.sub(r"\s+", "", path.read_text("ascii"))
    assert r"('J.M\X2\00FC\X0\ller'),('WerkO''Neil')" in text
    assert "'2023-11-14T22:13:20'" in text
    assert "'ddgfab" in text
    assert "AUTOMOTIVE_DESIGN" in text
    assert r"Glasf\X2\00FC\X0\rD\X2\00E4\X0\cher" in text
    assert "PCURVE" not in text
    # 2500 kg/m3 is 2.5 g/cm3: gram to the power 1, centimetre to the power -3.
    assert "POSITIVE_RATIO_MEASURE(2.5)" in text
    gram, centimetre = (
        re.search(rf"#(\d+)=\({unit}", text).group(1)  # type: ignore[union-attr]
        for unit in (r"MASS_UNIT\(\)", r"LENGTH_UNIT\(\)NAMED_UNIT\(\*\)SI_UNIT\(\.CENTI")
    )
    assert f"DERIVED_UNIT_ELEMENT(#{gram},1.)" in text
    assert f"DERIVED_UNIT_ELEMENT(#{centimetre},-3.)" in text


def test_ap242_is_written_when_asked_for_and_ap214_again_after_it(tmp_path: Path) -> None:
    for schema, words in (("AP242", b"AP242"), ("AP214", b"AUTOMOTIVE_DESIGN")):
        path = tmp_path / f"{schema}.step"
        write_part(
            path, StepProduct("BP-001", BEAM, box(1, 2, 3), box_properties(1, 2, 3)), schema=schema
        )
        assert words in path.read_bytes().split(b"DATA;")[0]


def test_same_content_gives_the_same_bytes_twice_and_in_another_process(
    tmp_path: Path, monkeypatch: Any, capfd: Any
) -> None:
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "0")
    path = tmp_path / "assembly.step"
    write(path, products(), INSTANCES, name="Roof")
    first = path.read_bytes()
    write(path, products(), INSTANCES, name="Roof")
    assert path.read_bytes() == first
    here = Path(__file__)
    program = (
        f"import sys; sys.path[:0] = [{str(here.parent)!r}, {str(here.parents[2])!r}]\n"
        "import test_formats_step as t; from pathlib import Path\n"
        f"t.write(Path({str(path)!r}), t.products(), t.INSTANCES, name='Roof')\n"
    )
    subprocess.run(
        [sys.executable, "-c", program], check=True, env={**os.environ, "PYTHONHASHSEED": "7"}
    )
    assert path.read_bytes() == first
    assert capfd.readouterr().out == ""  # OCCT's statistics are muted


def test_the_check_of_a_part_file_fails_on_what_differs(tmp_path: Path) -> None:
    path = tmp_path / "BP-001.step"
    write_part(path, StepProduct("BP-001", BEAM, box(10, 20, 30), box_properties(10, 20, 30)))
    assert all(c.passed for c in check_step_part(path, number="BP-001", volume=6000.0))
    wrong = check_step_part(path, number="BP-002", volume=6000.1)
    assert {c.name for c in wrong if not c.passed} == {"file name", "file volume"}
    text = path.read_bytes()
    inches = tmp_path / "metre.step"
    inches.write_bytes(text.replace(b"SI_UNIT(.MILLI.,.METRE.)", b"SI_UNIT($,.METRE.)"))
    failed = {
        c.name for c in check_step_part(inches, number="BP-001", volume=6000.0) if not c.passed
    }
    assert {"file unit", "file volume"} <= failed
    path.write_bytes(text[: len(text) // 2])
    (broken,) = check_step_part(path, number="BP-001", volume=6000.0)
    assert not broken.passed
    assert "BP-001.step" in str(broken.value)


def test_errors_name_the_piece_and_the_path(tmp_path: Path) -> None:
    with pytest.raises(KernelError, match="B-0001 is an instance of BP-009"):
        write(tmp_path / "a.step", products(), [("BP-009", "B-0001", np.eye(4))], name="x")
    with pytest.raises(OutputError, match="nowhere"):
        write(tmp_path / "nowhere" / "a.step", products(), INSTANCES, name="x")
    assert list(tmp_path.iterdir()) == []
