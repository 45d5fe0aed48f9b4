"""Projects of kits: kinds, units, and every wrong value named with its key and limit."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ddgfab.errors import DdgError, InputError, ProjectError
from ddgfab.io import read_mesh, write_obj
from fabrication.linkage.kit import find_kit_project, kit
from fabrication.linkage.project import kit_kinds, load_kit_project, make_kit_project
from fabrication.linkage.surfaces import SURFACES

MeshFile = Callable[[str], Path]


@pytest.mark.parametrize("kind", kit_kinds())
def test_every_kind_has_a_default_that_is_a_mechanism(kind: str) -> None:
    project = make_kit_project({"linkage": {"kind": kind}})
    mechanism = project.mechanism()
    assert mechanism.kind == project.linkage.kind == kind == project.name
    assert mechanism.lengths.max() <= 220


def test_the_default_is_the_reference_bennett() -> None:
    mechanism = make_kit_project({}).mechanism()
    assert mechanism.lengths == pytest.approx([100, 100, 146.19022, 146.19022])
    assert np.degrees(mechanism.design) == pytest.approx(90)
    assert mechanism.mobility == 1


def test_the_longest_bar_is_as_long_as_asked() -> None:
    for linkage in ({"kind": "cube"}, {"kind": "knet", "cells": [3, 2], "deltas_deg": [20, 30]}):
        mechanism = make_kit_project({"linkage": {**linkage, "longest_mm": 87.5}}).mechanism()
        assert mechanism.lengths.max() == pytest.approx(87.5)


def test_a_file_and_its_changes(tmp_path: Path) -> None:
    file = tmp_path / "toy.toml"
    file.write_text('[linkage]\nkind = "bennett"\na_mm = 80\n[printer]\nbed_mm = [180, 180]\n')
    project = load_kit_project(file, {"linkage": {"alpha_deg": 30.0}})
    assert project.name == "toy"
    assert project.mechanism().lengths[0] == pytest.approx(80)
    assert str(project.printer.bed()) == "180 x 180 mm"
    assert project.settings["linkage"]["alpha_deg"] == 30
    again = find_kit_project(str(file), {"a_mm": 60.0, "parts": {"pin": "printed"}})
    assert again.mechanism().lengths[0] == pytest.approx(60)
    assert again.part_settings().pin == "printed"


def test_parts_replace_the_printers_defaults() -> None:
    sections = {"printer": {"preset": "sla"}, "parts": {"clearance_mm": 0.3, "label": "none"}}
    settings = make_kit_project(sections).part_settings()
    assert settings.clearance == 0.3
    assert settings.bore == pytest.approx(3.6)
    assert settings.label == "none"


@pytest.mark.parametrize(
    ("sections", "message"),
    [
        ({"linkage": {"kind": "benett"}}, r'kind = "benett" is unknown; did you mean bennett'),
        ({"linkage": {"a_m": 3.0}}, r"\[linkage\] a_m is unknown; did you mean a_mm"),
        ({"linkage": {"a_mm": -3.0}}, r"\[linkage\] a_mm = -3 must be greater than 0"),
        ({"linkage": {"alpha_deg": 180.0}}, r"alpha_deg = 180 must be less than 180"),
        ({"printer": {"preset": "fdm-0.3"}}, r"fdm-0.3"),
        ({"printer": {"bed_mm": [220.0]}}, r"\[printer\] bed_mm"),
        ({"parts": {"pin": "wood"}}, r'\[parts\] pin = "wood" must be .metal. or .printed.'),
        ({"part": {}}, r"\[part\] is unknown; did you mean parts"),
        ({"output": {"formats": ["obj"]}}, r"\[output\] formats"),
        ({"linkage": {"kind": "knet", "file": "a.obj", "cells": [2, 2]}}, r"file and cells excl"),
        (
            {"linkage": {"kind": "knet", "surface": "dinni"}},
            r'"dinni" is unknown; did you mean dini',
        ),
        (
            {"linkage": {"kind": "knet", "surface": "dini", "parameters": {"sigma": 1.0}}},
            r"surface dini has no sigma; did you mean sigma_deg",
        ),
        ({"linkage": {"kind": "knet", "patch": [0, 2, 0, 2]}}, r"patch is for file"),
    ],
)
def test_wrong_projects_are_explained(sections: dict[str, Any], message: str) -> None:
    with pytest.raises(ProjectError, match=message):
        make_kit_project(sections)


@pytest.mark.parametrize(
    ("linkage", "message"),
    [
        ({"b_mm": 120.0, "beta_deg": 70.0}, r"relative difference 0.18.*the loop is rigid"),
        ({"b_mm": 160.0}, r"b = 160 mm is too long"),
        ({"beta_deg": 40.0}, r"only folds"),
        ({"kind": "cube", "twists_deg": [40.0, 40.0, 70.0]}, r"twists 0 and 1 are both 40 deg"),
        ({"kind": "cube", "rates": [0.0, 0.0]}, r"must not be zero"),
    ],
)
def test_linkages_that_do_not_move_are_refused(linkage: dict[str, Any], message: str) -> None:
    with pytest.raises(DdgError, match=message):
        make_kit_project({"linkage": linkage}).mechanism()


@pytest.mark.parametrize(
    ("parts", "message"),
    [
        ({"pin_diameter_mm": 8.0, "eye_diameter_mm": 10.0}, r"leaves a wall of 0.8 mm"),
        ({"bar_width_mm": 0.8}, r"bars of 0.8 x 5 mm"),
        ({"pin": "printed", "pin_diameter_mm": 2.5}, r"printed pin of 2.5 mm breaks"),
    ],
)
def test_parts_that_no_printer_makes_are_refused(parts: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        make_kit_project({"parts": parts}).part_settings()


@pytest.mark.parametrize("surface", SURFACES)
def test_surfaces_by_name_are_linkages(surface: str) -> None:
    linkage = {"kind": "knet", "surface": surface, "cells": [3, 4], "longest_mm": 60.0}
    mechanism = make_kit_project({"linkage": linkage}).mechanism()
    assert (mechanism.n_bars, mechanism.n_hinges, mechanism.mobility) == (31, 20, 6)
    assert mechanism.lengths.max() == pytest.approx(60)
    assert 2 <= len(np.unique(mechanism.lengths.round(9) * np.sign(mechanism.twists))) <= 4


@pytest.mark.slow
@pytest.mark.parametrize("surface", SURFACES)
def test_surfaces_by_name_move(surface: str) -> None:
    made = kit("knet", surface=surface, deltas_deg=[12.0, 12.0])
    assert made.motion.proven
    assert np.degrees(made.motion.range) > 90


def test_a_surface_with_two_twists_that_has_one(mesh_file: MeshFile) -> None:
    linkage = {"kind": "knet", "surface": "pseudosphere", "deltas_deg": [20.0, 25.0]}
    with pytest.raises(InputError, match="all have one twist"):
        make_kit_project({"linkage": linkage}).mechanism()


def test_a_knet_from_a_file_and_a_patch_of_it(mesh_file: MeshFile) -> None:
    source = str(mesh_file("knet1.obj"))
    whole = find_kit_project(source, {})
    assert whole.name == "knet1"
    linkage = {"patch": [2, 5, 3, 5], "longest_mm": 60.0}
    mechanism = find_kit_project(source, linkage).mechanism()
    assert (mechanism.n_hinges, mechanism.n_bars, mechanism.mobility) == (12, 17, 4)
    assert mechanism.lengths.max() == pytest.approx(60)
    with pytest.raises(InputError, match=r"patch \[0, 900, 0, 3\]: the net has vertices 0\.\."):
        find_kit_project(source, {"patch": [0, 900, 0, 3]}).mechanism()


def test_a_mesh_that_is_no_knet_names_its_worst_vertices(
    mesh_file: MeshFile, tmp_path: Path
) -> None:
    with pytest.raises(InputError, match=r"heart\.obj: no K-net: \d+ of \d+ vertices.*\n.*\(\d+, "):
        find_kit_project(str(mesh_file("heart.obj")), {}).mechanism()
    with pytest.raises(InputError, match=r"tri_dome\.obj.*no grid"):
        find_kit_project(str(mesh_file("tri_dome.obj")), {}).mechanism()
    bent = read_mesh(mesh_file("knet1.obj")).mesh
    points = bent.vertices.copy()
    points[40] += 0.02 * bent.diameter
    write_obj(tmp_path / "bent.obj", type(bent).build(points, bent.faces))
    with pytest.raises(InputError, match=r"bent\.obj: no K-net"):
        find_kit_project(str(tmp_path / "bent.obj"), {}).mechanism()


def test_missing_files_and_other_words(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"none\.obj"):
        find_kit_project(str(tmp_path / "none.obj"), {}).mechanism()
    with pytest.raises(ProjectError, match=r"none\.toml: no such file"):
        find_kit_project(str(tmp_path / "none.toml"), {})
    (tmp_path / "roof.toml").write_text('[net]\nkind = "canopy"\n')
    with pytest.raises(ProjectError, match=r"needs \[linkage\]"):
        find_kit_project(str(tmp_path / "roof.toml"), {})
    (tmp_path / "odd.toml").write_text('[linkge]\nkind = "cube"\n')
    with pytest.raises(ProjectError, match=r"odd\.toml:1: \[linkge\] .*did you mean linkage"):
        find_kit_project(str(tmp_path / "odd.toml"), {})
    with pytest.raises(InputError, match=r'"cubee" is neither a kind of linkage \(bennett, cube'):
        find_kit_project("cubee", {})
