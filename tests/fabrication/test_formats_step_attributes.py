"""Attributes of STEP files by OCCT, numbers and marks by FreeCAD, and compressed files."""

from __future__ import annotations

import gzip
import json
import os
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from step_products import INSTANCES, STEEL, products
from test_formats_step_back import material_of
from wholes import whole_of

from ddgfab.errors import InputError
from fabrication.formats.base import Contents, Whole
from fabrication.formats.report import inspect_file
from fabrication.formats.step import assembly_bytes, part_bytes
from fabrication.formats.step.attributes import Attribute
from fabrication.formats.step.compressed import unpacked
from fabrication.formats.step.format import COMPRESSED, FORMAT
from fabrication.formats.step.records import product_name
from fabrication.formats.step.xcaf import (
    components,
    free_labels,
    get_name,
    new_document,
    read_document,
)
from fabrication.gridshell.design import design

BALL = Path(__file__).parents[2] / "examples" / "koebe_ball.toml"


@pytest.fixture(scope="module")
def ball() -> Whole:
    """The structure of examples/koebe_ball.toml: 542 pieces of 8 numbers."""
    return whole_of(design(BALL))


def named_data(path: Path) -> dict[str, dict[str, Any]]:
    """Attributes that OCCT's reader finds, by key, by the names of products and instances."""
    from OCP.STEPCAFControl import STEPCAFControl_Reader
    from OCP.TCollection import TCollection_ExtendedString
    from OCP.TDataStd import TDataStd_NamedData
    from OCP.TDF import TDF_ChildIterator

    reader, document = STEPCAFControl_Reader(), new_document()
    reader.SetNameMode(True)
    reader.SetMetaMode(True)
    reader.ReadFile(str(path))
    assert reader.Transfer(document)
    found: dict[str, dict[str, Any]] = {}
    label = TDF_ChildIterator(document.Main(), True)
    while label.More():
        data = TDataStd_NamedData()
        if label.Value().FindAttribute(TDataStd_NamedData.GetID_s(), data):
            own = found.setdefault(get_name(label.Value()), {})
            for name in ("part number", "mark", "length", "mass", "material"):
                key = TCollection_ExtendedString(name)
                if data.HasReal(key):
                    own[name] = data.GetReal(key)
                if data.HasString(key):
                    own[name] = data.GetString(key).ToExtString()
        label.Next()
    return found


@pytest.mark.slow
def test_numbers_with_thousands_of_pieces_can_be_read(ball: Whole, tmp_path: Path) -> None:
    """OCCT refuses files with strings of 16 kB: all fasteners of large roofs were rejected."""
    part = next(iter(ball.parts.values()))
    (one, *_), marks = part.family.instances, [f"F-{k:04d}" for k in range(4000)]
    many = replace(part.family, instances=tuple(replace(one, mark=mark) for mark in marks))
    path = tmp_path / "part.step"
    steel = replace(part.material, name="\u0416" * 2000)
    FORMAT.write_part(path, replace(part, family=many, material=steel), ball.about)
    (data,) = [d for d in named_data(path).values() if "mark" in d]
    shown, words = data["mark"].split(), data["mark"].split()[-3:]
    assert shown[:-3] == marks[: len(shown) - 3]
    assert words == ["and", str(4000 - len(shown) + 3), "more"]
    assert len(shown) > 100
    assert data["material"].endswith(" ...")


@pytest.mark.slow
def test_occt_finds_the_attributes_by_key(ball: Whole, tmp_path: Path) -> None:
    FORMAT.write_whole(tmp_path, ball)
    found = named_data(tmp_path / "assembly.step")
    assert {number for number in found if number.endswith("part")} == {
        f"{number} part" for number in ball.parts
    }
    for number, part in ball.parts.items():
        own = found[f"{number} part"]
        assert (own["part number"], own["material"]) == (number, part.material.name)
        assert own["mass"] == pytest.approx(part.mass, rel=1e-12)  # kilograms
        assert ("length" in own) == (part.kind.role == "beam")
        if part.kind.role == "beam":
            assert own["length"] == pytest.approx(float(part.shape.dimensions()["length_cut_mm"]))
    for _, mark, _ in ball.standing():
        assert found[mark]["mark"] == mark
    part = ball.parts["PP-001"]
    FORMAT.write_part(tmp_path / "PP-001.step", part, ball.about)
    (own,) = named_data(tmp_path / "PP-001.step").values()
    assert own["mark"].split() == [instance.mark for instance in part.family.instances]


def materials(path: Path) -> dict[str, tuple[str, float]]:
    """Material and density [kg/m3] that OCCT finds for parts, by their names."""
    from OCP.XCAFDoc import XCAFDoc_MaterialTool, XCAFDoc_ShapeTool

    document, _ = read_document(path)
    found = {}

    def walk(label: Any) -> None:
        if XCAFDoc_ShapeTool.IsAssembly_s(label):
            for _, target in components(label):
                walk(target)
            return
        density = XCAFDoc_MaterialTool.GetDensityForShape_s(label)  # g/mm3
        found[get_name(label)] = (material_of(label), round(density * 1e6, 6))

    for label in free_labels(document):
        walk(label)
    return found


def test_attributes_are_not_taken_for_materials(tmp_path: Path) -> None:
    """OCCT takes all representations of a product for its material: a mass was its density."""
    path = tmp_path / "a.step"
    stated: list[Attribute] = [
        ("material", "of another name", "text"),
        ("mass", 12.5, "mass"),
        ("length", 1234.5, "length"),
        ("part number", "BP-001", "text"),
    ]
    for order in (stated, stated[::-1]):
        made = [replace(product, attributes=tuple(order)) for product in products()]
        expected = {
            product_name(product.number): (product.material.name, product.material.density)
            for product in made
            if product.material
        }
        path.write_bytes(assembly_bytes(made, INSTANCES, name="Roof", file_name="a.step"))
        assert materials(path) == expected
        path.write_bytes(part_bytes(made[0], "a.step"))
        assert materials(path) == {name: expected[name] for name in [product_name(made[0].number)]}


def freecad(path: Path, folder: Path, **settings: bool) -> list[str]:
    """Labels of all objects that FreeCAD's importer makes."""
    program, answer = folder / "look.py", folder / "labels.json"
    program.write_text(
        "import json, os, FreeCAD, ImportGui\n"
        "for name in ('', '/hSTEP'):\n"
        "    own = FreeCAD.ParamGet("
        "'User parameter:BaseApp/Preferences/Mod/Import' + name)\n"
        f"    for key, value in {settings!r}.items(): own.SetBool(key, value)\n"
        "FreeCAD.newDocument('x')\n"
        f"ImportGui.insert({str(path)!r}, 'x')\n"
        "labels = [o.Label for o in FreeCAD.ActiveDocument.Objects]\n"
        f"json.dump(labels, open({str(answer)!r}, 'w'))\n"
        "os._exit(0)\n"
    )
    environment = {**os.environ, "HOME": str(folder), "QTWEBENGINE_DISABLE_SANDBOX": "1"}
    done = subprocess.run(
        ["xvfb-run", "-a", "freecad", str(program)],
        capture_output=True,
        text=True,
        timeout=300,
        env=environment,
    )
    assert answer.exists(), done.stdout + done.stderr
    return [str(label) for label in json.loads(answer.read_text())]


@pytest.mark.slow
@pytest.mark.skipif(
    shutil.which("freecad") is None or shutil.which("xvfb-run") is None,
    reason="FreeCAD or Xvfb is not installed",
)
def test_freecad_makes_no_false_numbers_and_shows_marks(ball: Whole, tmp_path: Path) -> None:
    FORMAT.write_whole(tmp_path, ball)
    path = tmp_path / "assembly.step"
    off = {"ReadShapeCompoundMode": False, "ReduceObjects": False}
    groups = {"Beams", "Nodes", "Panels", "koebe-ball"}
    labels = freecad(path, tmp_path, **off)
    shown = sorted(label.split(" part")[0] for label in labels if label not in groups)
    assert shown == sorted(number for number, _, _ in ball.standing())
    # By its setting "Use base name" it shows the parts' names, without it those of the pieces.
    labels = freecad(path, tmp_path, **off, UseBaseName=False)
    numbers = {f"{number} part" for number in ball.parts}
    marks = [label for label in labels if label not in groups | numbers]
    assert sorted(marks) == sorted(mark for _, mark, _ in ball.standing())


@pytest.mark.slow
def test_a_compressed_assembly_is_the_same_file(ball: Whole, tmp_path: Path) -> None:
    about = replace(ball.about, options={"step": {"assembly": "stpZ"}})
    small = replace(ball, about=about)
    assert FORMAT.whole_files(Contents(about, ball.families, (), 0)) == [COMPRESSED]
    FORMAT.write_whole(tmp_path, small)
    FORMAT.write_whole(tmp_path, ball)
    path, plain = tmp_path / COMPRESSED, tmp_path / "assembly.step"
    kept = [line for line in plain.read_bytes().splitlines() if b"FILE_NAME" not in line]
    unzipped = gzip.decompress(path.read_bytes()).splitlines()
    assert [line for line in unzipped if b"FILE_NAME" not in line] == kept
    assert path.stat().st_size < 0.2 * plain.stat().st_size
    assert all(check.passed for check in FORMAT.check_whole(tmp_path, small))


def test_compressed_files_are_read_and_damaged_ones_named(tmp_path: Path) -> None:
    data = assembly_bytes(products(), INSTANCES, name="Roof", file_name="a.step")
    path = tmp_path / "a.STPZ"
    path.write_bytes(gzip.compress(data))
    report = inspect_file(path)
    assert report.file == str(path)
    assert report.to_dict()["bodies"]
    for damaged in (data, gzip.compress(data)[:-40], b"", gzip.compress(data)[:5]):
        path.write_bytes(damaged)
        with pytest.raises(InputError, match=r"a\.STPZ: not compressed by gzip, or truncated"):
            inspect_file(path)
    path.write_bytes(gzip.compress(data[:2000]))
    with pytest.raises(InputError, match=r"a\.STPZ: ") as caught:
        inspect_file(path)
    assert "unpacked" not in str(caught.value)
    assert STEEL.name.encode() in data


def test_what_unpacks_to_too_much_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("fabrication.formats.step.compressed.UNPACKED_BYTES", 10_000_000)
    path = tmp_path / "bomb.stpZ"
    path.write_bytes(gzip.compress(bytes(20_000_000)))
    with (
        pytest.raises(InputError, match="unpacks to more than 10000000 bytes"),
        unpacked(path),
    ):
        pass
