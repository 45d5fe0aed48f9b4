"""docs/knets.md: kinds of K-nets as they are, pictures of net and surface in one place, code."""

from __future__ import annotations

import importlib
import importlib.util
import re
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from scipy.spatial import cKDTree

import ddgfab.curvature
import ddgfab.surfaces
from ddgfab.forms.registry import find_generator, kinds
from fabrication.gridshell.load import load_project

DOCS = Path(__file__).resolve().parents[1] / "docs"
PAGE = (DOCS / "knets.md").read_text("utf-8")
LARGEST = 60_000
HERE = tuple(kind for kind in kinds() if find_generator(kind).support == "normals")


@pytest.mark.parametrize("kind", HERE)
def test_every_kind_is_told_as_it_is(kind: str) -> None:
    section = PAGE.split(f"\n## {kind}: ")[1].split("\n## ")[0]
    rows = re.findall(r"^\| `(\w+)` \| (\S+) \| (.*?) \| (.*) \|$", section, flags=re.MULTILINE)
    parameters = find_generator(kind).parameters
    assert rows == [(p.name, p.default_text, p.limits, p.text) for p in parameters]
    assert "Exact:" in section
    assert "Source: " in section
    assert f"knets/{kind}.png" in section


def test_pictures_are_there_and_small() -> None:
    names = re.findall(r"!\[.*?\]\(knets/(\w+)\.png\)", PAGE)
    assert len(names) == 9
    assert sorted(names) == sorted(p.stem for p in (DOCS / "knets").iterdir())
    for name in names:
        content = (DOCS / "knets" / f"{name}.png").read_bytes()
        assert content[:4] == b"\x89PNG"
        assert 10_000 < len(content) <= LARGEST


def test_functions_named_exist() -> None:
    found = re.findall(r"`(ddgfab(?:\.[a-z_]+)+)\.(\w+)[(`]", PAGE)
    assert len(found) >= 15
    for module, name in found:
        room = importlib.import_module(module)
        assert hasattr(room, name) or importlib.import_module(f"{module}.{name}"), name
    for room, rest in re.findall(r"^\| `(surfaces|curvature)\.(.*?) \|", PAGE, re.MULTILINE):
        for name in re.findall(r"(?:^|`|`surfaces\.|`curvature\.)(\w+)[`(]", rest):
            assert hasattr(getattr(ddgfab, room), name), f"{room}.{name}"


def test_code_runs() -> None:
    blocks = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
    assert len(blocks) == 1
    for block in blocks:
        exec(compile(block, "knets.md", "exec"), {})


def test_the_project_snippet_is_within_its_limits(tmp_path: Path) -> None:
    from fabrication import design

    path = tmp_path / "crab.toml"
    path.write_text(re.findall(r"```toml\n(.*?)```", PAGE, re.DOTALL)[0])
    assert load_project(path).net.parameters["twist_deg"] == 14
    assert list(design(path).gridshell.failures()) == []


def script(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.syspath_prepend(str(DOCS))
    spec = importlib.util.spec_from_file_location("pictures_knets", DOCS / "pictures_knets.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    monkeypatch.setitem(importlib.sys.modules, "pictures_knets", module)  # type: ignore[attr-defined]
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize(
    "name", ["amsler", "breather", "crab", "dini", "knet", "kuen", "pseudosphere"]
)
def test_both_halves_of_a_picture_are_near(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Nodes of the net lie on the smooth surface but for the error of its steps."""
    net, sheet = script(monkeypatch).pair(name)
    gap = cKDTree(sheet.mesh.vertices).query(net.vertices)[0]
    size = np.linalg.norm(np.ptp(net.vertices, axis=0))
    assert np.median(gap) < 0.02 * size
    assert gap.max() < 0.06 * size


@pytest.mark.slow
def test_pictures_are_made_by_the_script(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("pyvista")
    module = script(monkeypatch)
    assert {p.stem for p in (DOCS / "knets").iterdir()} == set(module.GALLERY)
    monkeypatch.setattr(module, "FOLDER", tmp_path)
    assert module.picture("crab").stat().st_size > 10_000
