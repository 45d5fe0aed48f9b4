"""The small inputs of ../shared/data/cases, each as its README says; skipped where absent."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from ddgfab.errors import DdgError, MeshError
from ddgfab.io import read_mesh
from ddgfab.measures import torsion
from ddgfab.support import support_structure
from fabrication.cli import app
from fabrication.gridshell.design import design

CASES = Path(__file__).resolve().parents[3] / "shared" / "data" / "cases"


@pytest.fixture
def case(request: pytest.FixtureRequest) -> Path:
    path = CASES / str(request.param)
    if not path.exists():
        pytest.skip(f"{path} is not there")
    return path


def named(*names: str) -> pytest.MarkDecorator:
    return pytest.mark.parametrize("case", names, indirect=True)


@named("off_polycube_6digits.off")
def test_closed_net_of_six_digits(case: Path) -> None:
    found = design(case, project={"median_edge_mm": 1500})
    assert 1e-7 < found.support.torsion_deg_max < 1e-4
    assert found.support.torsion_deg_max < found.project.checks.torsion_deg


@named("obj_soup_6digits_4.off", "obj_unwelded_noise.obj")
def test_soups_are_one_piece(case: Path) -> None:
    mesh = read_mesh(case).mesh
    assert mesh.components.max() == 0
    if case.suffix == ".obj":
        assert (mesh.n_vertices, mesh.n_edges) == (6, 7)


@named("off_free_format.off")
def test_faces_over_lines(case: Path) -> None:
    assert read_mesh(case).mesh.face_sizes.tolist() == [4, 4]


@named("obj_repeated_corner.obj")
def test_triangle_stored_as_a_quad(case: Path) -> None:
    read = read_mesh(case)
    assert sorted(read.mesh.face_sizes.tolist()) == [3, 4]
    assert any("repeated a corner" in note for note in read.notes)


@named("obj_utm.obj")
def test_far_away_is_as_near(case: Path, tmp_path: Path) -> None:
    read = read_mesh(case)
    assert read.origin.tolist() == [456789, 5412345, 430]
    assert any("456789, 5412345, 430" in note for note in read.notes)
    near = tmp_path / "near.obj"
    near.write_text(
        "".join("v {!r} {!r} {!r}\n".format(*p) for p in read.mesh.vertices.tolist())
        + "".join("f " + " ".join(map(str, f + 1)) + "\n" for f in read.mesh.faces)
    )
    far, home = (design(file, project={"units": "m"}) for file in (case, near))
    assert len(far.families) == len(home.families)
    for one, other in zip(far.gridshell.pieces, home.gridshell.pieces, strict=True):
        assert np.allclose(one.placement, other.placement, atol=1e-6)


@named("obj_duplicate_faces.obj", "obj_tjunction.obj")
def test_the_cause_is_named(case: Path) -> None:
    words = {
        "obj_duplicate_faces.obj": r"faces 0 \(line 6\) and 2 \(line 8\) lie on one another",
        "obj_tjunction.obj": r"vertex 4 lies on edge 3-5",
    }
    with pytest.raises(MeshError, match=words[case.name]):
        read_mesh(case)


@named("ply_tripairs.ply")
def test_cut_quads_are_offered_and_merged(case: Path) -> None:
    assert any("--quads" in note for note in read_mesh(case).notes)
    merged = read_mesh(case, quads=True).mesh
    assert merged.face_sizes.tolist() == [4] * 9
    assert np.degrees(torsion(merged, support_structure(merged).axes)).max() < 1e-3


@named("obj_yup.obj")
def test_y_up_is_reported_and_turned(case: Path) -> None:
    assert any("--up y" in note for note in read_mesh(case).notes)
    turned = read_mesh(case, up="y")
    assert not any("upright" in note or "down" in note for note in turned.notes)
    assert turned.mesh.vector_areas.sum(axis=0)[2] > 0


@named("obj_lines_only.obj")
def test_bars_become_faces(case: Path) -> None:
    read = read_mesh(case)
    assert read.mesh.face_sizes.tolist() == [4, 4]
    assert any("polylines 'l'" in note for note in read.notes)


@pytest.mark.slow
@named("stl_two_shells_overlap.stl")
def test_check_names_shells_that_intersect(case: Path) -> None:
    done = CliRunner().invoke(app, ["check", str(case)])
    assert done.exit_code == 1
    assert "intersect" in done.output


@named("obj_index_big.obj", "digits.toml", "deep.toml", "zerodiv.toml", "overflow_profile.toml")
def test_bad_input_is_exit_code_2_and_short(case: Path, tmp_path: Path) -> None:
    own = tmp_path / case.name
    own.write_bytes(case.read_bytes())
    (tmp_path / "s.obj").write_text(
        "v 0 0 0\nv 1500 0 0\nv 1500 1500 0\nv 0 1500 0\nv 3000 0 100\nv 3000 1500 100\n"
        "f 1 2 3 4\nf 2 5 6 3\n"
    )
    words = ["make", str(own), "--verify", "none", "-o", str(tmp_path / "out")]
    done = CliRunner().invoke(app, words)
    said = [row for row in done.output.splitlines() if not row.endswith(" ...")]
    assert done.exit_code == 2, said
    assert said[0].startswith("error: ")
    assert 1 <= len(said) <= 3
    assert not (tmp_path / "out").exists()


@named("esc.obj")
def test_no_escape_sequence_comes_out(case: Path) -> None:
    with pytest.raises(DdgError) as caught:
        read_mesh(case)
    assert all(c.isprintable() or c == "\n" for c in str(caught.value))
