"""docs/minimal.md: its pictures are there, its functions exist, its code runs."""

from __future__ import annotations

import importlib
import importlib.util
import re
from pathlib import Path

import pytest

import ddgfab.curvature
import ddgfab.nets
import ddgfab.nets.koebe
import ddgfab.nets.minimal
import ddgfab.support
import ddgfab.surfaces
import ddgfab.transforms
from fabrication.gridshell.load import load_project

DOCS = Path(__file__).resolve().parents[1] / "docs"
PAGE = (DOCS / "minimal.md").read_text("utf-8")
LARGEST = 150_000


def test_pictures_are_there_and_small() -> None:
    names = re.findall(r"!\[.*?\]\((minimal/\w+\.png)\)", PAGE)
    assert len(names) == 7
    assert sorted(names) == sorted(f"minimal/{p.name}" for p in (DOCS / "minimal").iterdir())
    for name in names:
        content = (DOCS / name).read_bytes()
        assert content[:4] == b"\x89PNG"
        assert 10_000 < len(content) <= LARGEST


def test_functions_named_exist() -> None:
    found = re.findall(r"`(ddgfab(?:\.[a-z_]+)+)\.(\w+)", PAGE)
    assert len(found) >= 15
    for module, name in found:
        assert hasattr(importlib.import_module(module), name), f"{module}.{name}"
    for row in PAGE.split("## Functions")[1].split("\n"):
        for name in re.findall(r"`(\w+)(?:\(.*?\))?`", row.split("|")[1] if "|" in row else ""):
            rooms = (
                ddgfab.nets,
                ddgfab.nets.koebe,
                ddgfab.nets.minimal,
                ddgfab.support,
                ddgfab.surfaces,
                ddgfab.transforms,
                ddgfab.curvature,
            )
            assert any(hasattr(room, name) for room in rooms), name


def test_code_runs() -> None:
    blocks = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
    assert len(blocks) == 2
    for block in blocks:
        exec(compile(block, "minimal.md", "exec"), {})


def test_the_project_snippet_is_valid(tmp_path: Path) -> None:
    path = tmp_path / "roof.toml"
    path.write_text(re.findall(r"```toml\n(.*?)```", PAGE, re.DOTALL)[0])
    assert load_project(path).net.parameters["piece"] == "piece"


@pytest.mark.slow
def test_pictures_are_made_by_the_script(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("pyvista")
    spec = importlib.util.spec_from_file_location("pictures_minimal", DOCS / "pictures_minimal.py")
    assert spec is not None
    assert spec.loader is not None
    script = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(script)
    assert {*script.GALLERY, "polyhedra"} == {p.stem for p in (DOCS / "minimal").iterdir()}
    monkeypatch.setattr(script, "FOLDER", tmp_path)
    assert script.picture("enneper").stat().st_size > 10_000
