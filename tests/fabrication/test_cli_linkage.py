"""`ddgfab linkage`: options, exit codes, and that bad input writes nothing."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from ddgfab.forms import canopy
from ddgfab.io import write_obj
from fabrication.cli import app

EXAMPLES = Path(__file__).resolve().parents[2] / "examples" / "linkages"
QUICK = ["--formats", "csv", "--set", "motion.poses=5"]


def run(*words: str) -> tuple[int, str]:
    result = CliRunner().invoke(app, ["linkage", *words])
    return result.exit_code, result.output


@pytest.fixture(autouse=True)
def _in(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


@pytest.mark.slow
def test_alone_it_makes_the_default_bennett_kit(tmp_path: Path) -> None:
    code, said = run(*QUICK)
    assert code == 0, said
    assert "4 bars on 4 hinges, 1 isogram, 1 degree of freedom" in said
    assert "free range: 6." in said
    manifest = json.loads((tmp_path / "outputs/bennett/manifest.json").read_text("utf-8"))
    assert manifest["settings"]["linkage"]["a_mm"] == 100
    assert {record["path"] for record in manifest["files"]} == {
        "preview.png",
        *(f"schedules/{name}.csv" for name in ("bom", "links", "hinges", "assembly", "rods")),
        "schedules/columns.csv",
        "schedules/order.csv",
    }


@pytest.mark.slow
def test_options_and_settings(tmp_path: Path) -> None:
    words = ["bennett", "-o", "toy", "--a", "80", "--alpha", "30", "--beta", "110", "--no-labels"]
    words += ["--bed", "180x200", "--pin", "printed", "--printer", "sla", "--maximize-range"]
    code, said = run(*words, "--set", "project.name=toy", *QUICK)
    assert code == 0, said
    assert "note: settings as given: free through" in said
    settings = json.loads((tmp_path / "toy/manifest.json").read_text("utf-8"))["settings"]
    assert settings["project"]["name"] == "toy"
    assert settings["linkage"]["beta_deg"] == 110
    assert settings["parts"]["label"] == "none"
    assert settings["parts"]["pin"] == "printed"
    assert settings["printer"] == {
        "preset": "sla", "bed_mm": [180, 200], "margin_mm": 10, "gap_mm": 5,
    }  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("project", sorted(EXAMPLES.glob("*.toml")), ids=lambda path: path.stem)
def test_example_projects(project: Path, tmp_path: Path) -> None:
    code, said = run(str(project), "-o", "out")
    assert code == 0, said
    manifest = json.loads((tmp_path / "out/manifest.json").read_text("utf-8"))
    assert manifest["project"] == project.stem
    assert manifest["checks"]["failed"] == 0
    assert manifest["input"]["file"] == str(project)
    assert len(manifest["input"]["sha256"]) == 64
    low, high = manifest["net"]["free_deg"]
    assert high - low > 120
    assert (tmp_path / "out/report.html").stat().st_size < 1e6
    assert (tmp_path / "out/motion.gif").exists()


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--b", "120", "--beta", "70"], "the loop is rigid"),
        (["--alpha", "0"], "alpha_deg = 0 must be greater than 0"),
        (["--alpha", "180"], "must be less than 180"),
        (["--beta", "40"], "only folds"),
        (["--bed", "100x100"], "a bed of 100 x 100 mm"),
        (["--bed", "wide"], "--bed wide: expected width x depth"),
        (["--pin", "wood"], "pin"),
        (["--printer", "laser"], "laser"),
        (["--set", "parts.pin_diameter_mm=8", "--set", "parts.eye_diameter_mm=10"], "wall of 0.8"),
        (["--set", "linkage.a=3"], "[linkage] a is unknown"),
        (["--set", "part.label=none"], "[part] is unknown; did you mean parts"),
        (["tesseract"], '"tesseract" is neither a kind of linkage'),
        (["none.toml"], "none.toml: no such file"),
        (["roof.obj"], "no K-net"),
    ],
)
def test_bad_input_writes_nothing(words: list[str], message: str, tmp_path: Path) -> None:
    write_obj(tmp_path / "roof.obj", canopy(panels_along=6, panels_across=4))
    code, said = run(*words)
    assert code == 2, said
    assert message in said
    assert "Traceback" not in said
    assert len(said.split("error: ")[1].splitlines()) <= 3
    assert {path.name for path in tmp_path.iterdir()} == {"roof.obj"}


def test_make_sends_kits_to_their_own_command() -> None:
    result = CliRunner().invoke(app, ["make", str(EXAMPLES / "bennett.toml")])
    assert result.exit_code == 2
    assert "bennett.toml:6: [linkage] is for a kit: ddgfab linkage" in result.output


def test_parts_that_meet_in_the_design_pose_are_named(tmp_path: Path) -> None:
    code, said = run("--set", "linkage.design_deg=4")
    assert code == 2
    assert "L-000" in said
    assert "H-000" in said
    assert not list(tmp_path.iterdir())


def test_the_range_is_told_in_the_words_of_the_manifest() -> None:
    from fabrication import kit

    made = kit("bennett")
    low, high = np.degrees([made.motion.low, made.motion.high])
    assert made.facts()["free_deg"] == pytest.approx([low, high], abs=1e-5)
    assert f"{low:.2f} to {high:.2f} deg" in dict(made.motion_facts())["free range"]
    marks = [tuple(contact["parts"]) for contact in made.facts()["contacts"]]
    assert marks == [contact.marks for contact in made.motion.contacts]
