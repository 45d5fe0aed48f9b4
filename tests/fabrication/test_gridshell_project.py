"""Project files: values, defaults, and every mistake as one clear message."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from ddgfab.errors import ProjectError
from ddgfab.forms.registry import find_generator, kinds
from fabrication.gridshell.load import load_project, make_project, project_for_mesh
from fabrication.gridshell.net_input import load_net
from fabrication.gridshell.project import Project

NET = '[net]\nkind = "mesh"\nfile = "roof.obj"\n'


def load(folder: Path, text: str) -> Project:
    path = folder / "job.toml"
    path.write_text(text, encoding="utf-8")
    return load_project(path)


def test_full_file(tmp_path: Path) -> None:
    project = load(
        tmp_path,
        '[project]\nname = "Atrium"\nunits = "m"\nscale = 2\n'
        + NET
        + '[beam]\nprofile = "RHS 120x60x5"\nend = "cope"\neccentricity_mm = -5\n'
        '[node]\nkind = "tube"\ndiameter_mm = 120\nwall_mm = 10\nseries_mm = [100, 120.5]\n'
        '[panel]\nedge = "mitred"\noffset_mm = 20\nmax_size_mm = [2500, 4500]\n'
        '[checks]\naccept = "cold-bend"\n[output]\nformats = ["step", "csv"]\njobs = 2\n',
    )
    assert project.name == "Atrium"
    assert project.project.factor(median_edge=7.0) == 2000.0
    assert project.mesh_path == tmp_path / "roof.obj"
    assert project.beam.section().depth == 120.0
    assert project.node.series_mm == (100.0, 120.5)
    assert project.panel.offset_mm == 20.0
    assert project.output.formats == ("step", "csv")
    assert project.settings["panel"]["max_size_mm"] == [2500.0, 4500.0]
    assert "file" not in project.settings
    assert "RHS 120x60x5" in repr(project)


def test_changes_on_the_command_line_replace_single_values(tmp_path: Path) -> None:
    path = tmp_path / "job.toml"
    path.write_text(NET + '[output]\njobs = 3\nauthor = "A"\n', encoding="utf-8")
    output = load_project(path, {"output": {"jobs": 1}, "panel": {"kind": "none"}}).output
    assert (output.jobs, output.author) == (1, "A")
    with pytest.raises(ProjectError, match="jobs"):
        load_project(path, {"output": {"jobs": -1}})


def test_defaults_for_a_mesh() -> None:
    project = project_for_mesh("some/roof.off")
    assert project.name == "roof"
    assert project.mesh_path == Path("some/roof.off")
    assert (project.node.diameter_mm, project.panel.offset_mm) == ("auto", "auto")
    assert project.project.factor(3.0) == 1.0
    assert project_for_mesh("a.obj", {"panel": {"kind": "none"}}).panel.kind == "none"


def test_median_edge() -> None:
    project = make_project({"project": {"median_edge_mm": 1500.0}})
    assert project.project.factor(median_edge=0.5) == 3000.0


def test_free_polygon_profile_and_byte_order_mark(tmp_path: Path) -> None:
    text = NET + "[beam]\nprofile = [[-10, 0], [-5, -40], [5, -40], [10, 0]]\n"
    path = tmp_path / "bom.toml"
    path.write_bytes(b"\xef\xbb\xbf" + text.replace("\n", "\r\n").encode())
    assert load_project(path).beam.section().width == 20.0


def test_canopy_parameters_stand_in_net(tmp_path: Path) -> None:
    project = load(tmp_path, '[net]\nkind = "canopy"\npanels_along = 12\n')
    assert project.net.parameters == {"panels_along": 12}
    assert project.mesh_path is None
    with pytest.raises(
        ProjectError, match=r"job.toml:3: \[net\] panels_alon is unknown.*panels_along"
    ):
        load(tmp_path, '[net]\nkind = "canopy"\npanels_alon = 12\n')


def test_every_kind_of_net_takes_its_parameters(tmp_path: Path) -> None:
    for kind in kinds():
        parameters = find_generator(kind).parameters
        parameter = next(p for p in parameters if p.type in (int, float) and p.low <= 9 <= p.high)
        text = f'[net]\nkind = "{kind}"\n{parameter.name} = 9\n'
        assert load(tmp_path, text).net.parameters == {parameter.name: 9}
    conical = make_project({"net": {"kind": "conical", "panels_along": 5, "panels_across": 3}})
    assert load_net(conical).mesh.n_faces == 15


def test_generated_nets_take_a_scale_but_no_other_unit(tmp_path: Path) -> None:
    net = {"kind": "rotational", "panels_around": 12, "rings": 3}
    plain = load_net(make_project({"net": net})).mesh
    twice = load_net(make_project({"net": net, "project": {"scale": 2.0}})).mesh
    assert np.array_equal(twice.vertices, 2.0 * plain.vertices)
    even = load_net(make_project({"net": net, "project": {"median_edge_mm": 1500.0}})).mesh
    assert np.median(even.edge_lengths) == pytest.approx(1500.0)
    with pytest.raises(ProjectError, match=r'job.toml:2: .*units = "m" is for mesh files'):
        load(tmp_path, '[project]\nunits = "m"\n[net]\nkind = "canal"\n')


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (NET + '[beam]\nprofle = "FL 60x8"\n', ["job.toml:5:", "[beam] profle", "profile"]),
        (NET + "[beams]\n", [":4:", "[beams] is unknown", "beam"]),
        (NET + '[beam]\nprofile = "IPE 200"\n', [":5:", "IPE 200", "near"]),
        (NET + "[beam]\nprofile = 5\n", [":5:", "= 5", "text", "a list"]),
        (NET + "[beam]\nclearance_mm = -1\n", [":5:", "= -1", "greater than or equal to 0"]),
        (NET + "[node]\ndiameter_mm = -3\n", [":5:", '"auto"', "greater than 0"]),
        (NET + '[node]\ndiameter_mm = "atuo"\n', ["did you mean auto?"]),
        (NET + '[node]\nbolt = "M12"\n', [":5:", "[node] bolt", '[connection] kind = "stud"']),
        (NET + '[beam]\nbolt = "none"\n', [":5:", "[beam] bolt", 'kind = "welded"']),
        (NET + '[connection]\nkind = "stud"\nbolt = "M13"\n', [":6:", "M13", "M12"]),
        (NET + '[connection]\nkind = "studd"\n', [":5:", "did you mean stud?"]),
        (
            NET + '[connection]\nbolt = "M16"\n',
            ['bolt is for kind = "stud" or "end_plate" or ', 'not for "welded"'],
        ),
        (NET + "[connection]\nweld_mm = 2\n", [":5:", "= 2", "greater than or equal to 3"]),
        (NET + '[panel]\nedge = "mitered"\n', ['"mitred"', "did you mean"]),
        (NET + "[panel]\nmax_size_mm = [1]\n", ["too few values"]),
        (NET + "[panel]\nthickness_mm = inf\n", ["finite"]),
        (NET + "[panel]\ngap_mm = true\n", ["gap_mm", "number"]),
        (NET + "[checks]\nflat_percent = 2\n", ["bend_percent must not be less"]),
        (NET + '[output]\nformats = ["step", "parasolid"]\n', ["parasolid", "known: step, stl"]),
        (NET + "[output]\njobs = 1.5\n", ["jobs", "integer"]),
        (NET + '[output.options]\nstpe.schema = "AP242"\n', ["stpe", "did you mean step?"]),
        (NET + '[output.options]\nstep.scheme = "AP242"\n', ["scheme", "did you mean schema?"]),
        (NET + '[output.options]\nstep.schema = "AP203"\n', ["AP203", "AP214 or AP242"]),
        (NET + '[output.options]\nstl.ascii = "yes"\n', ['"stl" has no options']),
        (NET + "[output.options]\nstep = 3\n", [":4:", "= 3 must be a table"]),
        (NET + '[optimize]\nboundary = "fixed"\n', ["[optimize]", "goal is missing", "planar"]),
        (NET + '[optimize]\ngoal = "plannar"\n', [":5:", "[optimize] goal", "planar"]),
        (NET + '[optimize]\ngoal = "planar"\nfix = [-1]\n', [":6:", "[optimize] fix"]),
        ("[project]\nscale = 2\nmedian_edge_mm = 5\n" + NET, ["median_edge_mm replaces scale"]),
        ('[project]\nunits = "yd"\n' + NET, [":2:", '"mm"']),
        ('[project]\nname = "a"\n', ["needs [net]"]),
        ('[net]\nkind = "mesh"\n', [":1:", "needs file"]),
        ('[net]\nkind = "canopy"\nfile = "a.obj"\n', ["file is for"]),
        ('[net]\nkind = "conicl"\nfile = "a.obj"\n', [":2:", "conicl", "did you mean conical?"]),
        ('[net]\nkind = "zzz"\n', [":2:", "known: mesh, ", "canal"]),
        ('[net]\nkind = "canal"\nturn_deg = 900\n', [":3:", "turn_deg = 900", "-180 to 180"]),
        ('[net]\nkind = "canal"\nturn_deg = "a"\n', [":3:", "turn_deg = 'a' must be a number"]),
        ('[net]\nkind = "canal"\npanels = 3\n', [":3:", "panels is unknown", "panels_a"]),
        (NET + "parameters = {a = 1}\n", ["parameters is unknown"]),
        ("beam = 3\n" + NET, [":1:", "must be a section"]),
        (NET + "x = \n", [":4:", "not TOML"]),
        (NET + "[beam\n", [":4:", "not TOML"]),
    ],
)
def test_mistakes_name_file_line_key_and_value(tmp_path: Path, text: str, words: list[str]) -> None:
    with pytest.raises(ProjectError) as caught:
        load(tmp_path, text)
    message = str(caught.value)
    assert all(word in message for word in ["job.toml", *words]), message
    assert message.count("\n") <= 2


def test_many_mistakes_are_three_lines(tmp_path: Path) -> None:
    with pytest.raises(ProjectError) as caught:
        load(tmp_path, NET + "[beam]\na = 1\nb = 2\nc = 3\nd = 4\n")
    assert str(caught.value).count("\n") == 2
    assert "2 more" in str(caught.value)


def test_files_that_cannot_be_read(tmp_path: Path) -> None:
    with pytest.raises(ProjectError, match=r"absent.toml: no such file"):
        load_project(tmp_path / "absent.toml")
    with pytest.raises(ProjectError, match="this is a folder"):
        load_project(tmp_path)
    binary = tmp_path / "binary.toml"
    binary.write_bytes(b"a = \xff\xfe")
    with pytest.raises(ProjectError, match="UTF-8"):
        load_project(binary)


def test_projects_are_frozen() -> None:
    with pytest.raises(ValueError, match="frozen"):
        make_project({}).beam.end = "cope"  # type: ignore[misc]
