"""`ddgfab init`: the file has every key, means what would be made without it, and replaces none."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pydantic import BaseModel
from roofs import barrel
from typer.testing import CliRunner

from ddgfab.forms.registry import find_generator, kinds
from ddgfab.io import write_obj
from ddgfab.surfaces.analytic import surface_parameters
from fabrication.cli import app
from fabrication.gridshell.design import find_project
from fabrication.gridshell.load import load_project, make_project
from fabrication.gridshell.net_input import load_net
from fabrication.gridshell.net_settings import NetSettings
from fabrication.gridshell.project import Project
from fabrication.linkage.kit import find_kit_project
from fabrication.linkage.project import KITS, KitProject, load_kit_project
from fabrication.project.template import meanings, settings_of
from fabrication.project.toml import toml_text


def init(*words: object) -> tuple[int, str]:
    result = CliRunner().invoke(app, ["init", *map(str, words)])
    return result.exit_code, result.output


@pytest.fixture(autouse=True)
def _here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def written(name: str) -> str:
    return Path(name).read_text("utf-8")


def keys_in(text: str) -> dict[str, set[str]]:
    """Keys by section, those in comments too."""
    found: dict[str, set[str]] = {}
    section = ""
    for line in text.splitlines():
        bare = line.removeprefix("# ")
        if line.startswith("["):
            section = line.strip("[]")
        elif " =" in bare and bare.split(" =")[0].isidentifier():
            found.setdefault(section, set()).add(bare.split(" =")[0])
    return found


def assert_same(model: BaseModel, other: BaseModel, *but: str) -> None:
    one, two = ({k: v for k, v in m.model_dump().items() if k not in but} for m in (model, other))
    assert one == two


def sections_of(model: type[BaseModel], net: str) -> dict[str, set[str]]:
    """The keys that every section but [net] has."""
    fields = model.model_fields.items()
    return {
        name: set(field.annotation.model_fields)  # type: ignore[union-attr]
        for name, field in fields
        if name not in ("file", net)
    }


def test_alone_it_writes_the_built_in_example() -> None:
    code, said = init()
    assert code == 0, said
    assert "next: ddgfab make canopy.toml --dry-run" in said
    made, example = load_project("canopy.toml"), find_project(None, {})
    assert_same(made, example, "file", "net")
    assert np.array_equal(load_net(made).mesh.vertices, load_net(example).mesh.vertices)


@pytest.mark.parametrize("kind", kinds())
def test_every_kind_of_net_with_all_its_parameters(kind: str) -> None:
    code, said = init(kind, "-o", "p.toml")
    assert code == 0, said
    keys = keys_in(written("p.toml"))
    parameters = find_generator(kind).parameters
    assert {parameter.name for parameter in parameters} <= keys["net"]
    for section, wanted in sections_of(Project, "net").items():
        assert keys[section] == wanted
    made = load_project("p.toml")
    assert made.net.parameters == {parameter.name: parameter.default for parameter in parameters}
    assert_same(made, make_project({"net": {"kind": kind}}), "file", "net", "project")


def test_a_mesh_and_a_surface(tmp_path: Path) -> None:
    write_obj(tmp_path / "roof.obj", barrel())
    (tmp_path / "sub").mkdir()
    code, said = init("roof.obj", "-o", "sub/roof.toml", "--set", "beam.profile=RHS 100x50x4")
    assert code == 0, said
    made, text = load_project("sub/roof.toml"), written("sub/roof.toml")
    assert keys_in(text)["net"] >= NetSettings.keys()
    assert made.mesh_path is not None
    assert made.mesh_path.samefile("roof.obj")
    assert '(default: "FL 60x8")\nprofile = "RHS 100x50x4"' in text
    direct = find_project("roof.obj", {"beam": {"profile": "RHS 100x50x4"}})
    assert_same(made, direct, "file", "net", "project")
    assert made.net.model_copy(update={"file": None}) == direct.net.model_copy(
        update={"file": None}
    )
    code, said = init("roof.step")  # need not be there yet
    assert code == 0, said
    surface = load_project("roof.toml")
    assert_same(surface, find_project("roof.step", {}), "file", "project")
    code, said = init(*("canopy", "--set", "net.kind=surface", "--set", "net.surface=dome"))
    assert code == 0, said
    assert surface_parameters("dome").keys() <= keys_in(written("surface.toml"))["net"]


def test_make_gives_the_same_with_the_file_and_without(tmp_path: Path) -> None:
    write_obj(tmp_path / "roof.obj", barrel())
    assert init("roof.obj")[0] == 0
    for source in ("roof.obj", "roof.toml"):
        words = ["make", source, "-o", source[-4:], "--set", "output.formats=['csv']", "-q"]
        result = CliRunner().invoke(app, [*words, "--jobs", "1"])
        assert result.exit_code == 0, result.output
    for name in ("panels", "beams", "nodes"):
        one, two = (Path(f"{place}/schedules/{name}.csv") for place in (".obj", "toml"))
        assert one.read_bytes() == two.read_bytes()


@pytest.mark.parametrize("kind", KITS)
def test_linkages(kind: str) -> None:
    code, said = init("--linkage", kind)
    assert code == 0, said
    assert f"next: ddgfab linkage {kind}.toml" in said
    keys = keys_in(written(f"{kind}.toml"))
    project = find_kit_project(kind, {})
    assert keys["linkage"] == set(type(project.linkage).model_fields)
    for section, wanted in sections_of(KitProject, "linkage").items():
        assert keys[section] == wanted
    assert_same(load_kit_project(f"{kind}.toml"), project, "file", "project")


def test_a_kind_that_only_linkages_have_needs_no_option() -> None:
    assert init("bennett")[0] == 0
    assert load_kit_project("bennett.toml").linkage.kind == "bennett"
    code, said = init("bennett.toml", "-o", "again.toml")
    assert code == 0, said
    assert_same(load_kit_project("again.toml"), load_kit_project("bennett.toml"), "file")


@pytest.mark.parametrize("model", [*(KITS[kind] for kind in KITS), Project])
def test_every_setting_has_a_meaning(model: type[BaseModel]) -> None:
    for name, field in model.model_fields.items():
        if name in ("file", "linkage"):
            continue
        section: Any = field.annotation
        assert set(section.model_fields) == set(meanings(section)), name
        values = section.model_construct()
        for setting in settings_of(values):
            (*_, last) = setting.lines()
            assert last == (
                f"# {setting.key} ="
                if setting.default is None
                else f"{setting.key} = {toml_text(setting.default)}"
            )


def test_it_replaces_nothing_unasked() -> None:
    Path("roof.toml").write_text("mine")
    code, said = init("canopy", "-o", "roof.toml")
    assert code == 2
    assert "roof.toml: exists already; --force replaces it" in said
    assert written("roof.toml") == "mine"
    assert init("canopy", "-o", "roof.toml", "--force")[0] == 0
    assert tomllib.loads(written("roof.toml"))["net"]["kind"] == "canopy"


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["canop"], "did you mean canopy"),
        (["--linkage", "benet"], "neither a kind of linkage"),
        (["canopy", "-o", "roof.txt"], "a project file ends in .toml"),
        (["canopy", "-o", "none/roof.toml"], "cannot be written"),
        (["canopy", "--set", "panel.gap=3"], "did you mean gap_mm"),
        (["missing.toml"], "missing.toml: "),
        (["roof.txt"], ".txt is not read"),
    ],
)
def test_mistakes(words: list[str], message: str, tmp_path: Path) -> None:
    code, said = init(*words)
    assert code == 2, said
    assert message in said
    assert list(tmp_path.iterdir()) == []
