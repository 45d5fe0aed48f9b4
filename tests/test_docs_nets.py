"""docs/nets.md tells every kind with its parameters as they are, and its pictures are there."""

from __future__ import annotations

import importlib
import importlib.util
import re
from pathlib import Path

import pytest

import ddgfab.measures
import ddgfab.offsets
import ddgfab.support
import ddgfab.transforms
from ddgfab.forms.registry import find_generator, kinds
from fabrication.gridshell.load import load_project

DOCS = Path(__file__).resolve().parents[1] / "docs"
PAGE = (DOCS / "nets.md").read_text("utf-8")
LARGEST = 60_000
HERE = tuple(kind for kind in kinds() if find_generator(kind).support != "normals")
"""K-nets have a page of their own, knets.md."""


@pytest.mark.parametrize("kind", HERE)
def test_every_kind_is_told_as_it_is(kind: str) -> None:
    section = PAGE.split(f"\n## {kind}: ")[1].split("\n## ")[0]
    rows = re.findall(r"^\| `(\w+)` \| (\S+) \| (.*?) \| (.*) \|$", section, flags=re.MULTILINE)
    parameters = find_generator(kind).parameters
    assert rows == [(p.name, p.default_text, p.limits, p.text) for p in parameters]
    assert "Exact:" in section
    assert "Source: " in section
    picture = DOCS / "nets" / f"{kind}.png"
    assert f"nets/{kind}.png" in section
    assert 5_000 < picture.stat().st_size <= LARGEST
    assert picture.read_bytes()[:4] == b"\x89PNG"


def test_functions_named_exist() -> None:
    for room, name in re.findall(r"`(offsets|transforms|support|measures)\.(\w+)", PAGE):
        assert hasattr(getattr(ddgfab, room), name), f"{room}.{name}"
    for module, name in re.findall(r"`(ddgfab(?:\.[a-z]+)+)\.(\w+)[(`]", PAGE):
        assert hasattr(importlib.import_module(module), name), f"{module}.{name}"


def test_the_project_snippet_is_valid(tmp_path: Path) -> None:
    (tmp_path / "roof.toml").write_text(re.findall(r"```toml\n(.*?)```", PAGE, re.DOTALL)[0])
    assert load_project(tmp_path / "roof.toml").net.parameters["flare"] == 1.6


def test_pictures_are_made_by_the_script(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("pyvista")
    spec = importlib.util.spec_from_file_location("make_pictures", DOCS / "make_pictures.py")
    assert spec is not None
    assert spec.loader is not None
    script = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(script)
    assert set(script.VIEWS) == set(HERE)
    monkeypatch.setattr(script, "FOLDER", tmp_path)
    assert script.picture("conical").stat().st_size > 5_000
