"""report.html in a browser: parts and rows clicked, sliders moved, keys, a phone, paper."""

from __future__ import annotations

import re
import subprocess
from collections.abc import Iterator
from pathlib import Path
from shutil import which

import numpy as np
import pytest
from browser import CHROMIUM, Page, page
from roofs import barrel

from fabrication.gridshell.design import design
from fabrication.job.result import JobResult
from fabrication.job.run import make

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(CHROMIUM is None, reason="no Chromium on this machine"),
]

READY = "document.documentElement.dataset.ready === 'model' && view.dataset.calls"
HEADING = "(document.querySelector('#selection h3') || {}).textContent || ''"
FIRST = ("mark", "number", "step", "edge", "hinge")
"""First columns of schedules that name what a row is about."""

WIDTHS = ((1280, 900), (390, 844))

# A pixel at which a piece is seen, and its mark.
PIECE = """(() => {
  const view = ddgfab.view, box = view.renderer.domElement.getBoundingClientRect();
  for (let i = 0; i < 2000; i++) {
    const x = box.left + box.width * (0.5 + 0.45 * Math.sin(i));
    const y = box.top + box.height * (0.5 + 0.45 * Math.cos(1.7 * i));
    const hit = view.at(x, y);
    if (hit && y < innerHeight) return [x, y, ddgfab.model.pieces[hit.piece].mark];
  }
})()"""


@pytest.fixture(scope="module", params=WIDTHS, ids=["screen", "phone"])
def size(request: pytest.FixtureRequest) -> tuple[int, int]:
    found: tuple[int, int] = request.param
    return found


@pytest.fixture(scope="module")
def roof(
    small_job: JobResult, size: tuple[int, int], tmp_path_factory: pytest.TempPathFactory
) -> Iterator[Page]:
    path = small_job.folder / "report.html"
    with page(tmp_path_factory.mktemp("profile"), path, *size) as found:
        found.wait(READY)
        yield found


@pytest.fixture(scope="module")
def kit(
    kit_job: JobResult, size: tuple[int, int], tmp_path_factory: pytest.TempPathFactory
) -> Iterator[Page]:
    path = kit_job.folder / "report.html"
    with page(tmp_path_factory.mktemp("profile"), path, *size) as found:
        found.wait(READY)
        yield found


@pytest.fixture(autouse=True)
def silence(roof: Page, kit: Page) -> Iterator[None]:
    """After every test the consoles have said nothing, and nothing was fetched."""
    yield
    assert roof.told + kit.told == []


def pixels(found: Page, path: Path) -> np.ndarray:
    from PIL import Image

    found.picture(path)
    return np.asarray(Image.open(path).convert("RGB")).astype(int)


def orange(picture: np.ndarray) -> int:
    """Pixels in the color of what is selected."""
    red, green, blue = (picture[:, :, k] for k in range(3))
    return int(((red > 180) & (green > 70) & (green < 190) & (blue < 110)).sum())


def middle(found: Page, selector: str) -> tuple[float, float]:
    """Where an element is in the window."""
    x, y = found.run(
        f"(() => {{ const e = document.querySelector({selector!r}); e.scrollIntoView("
        "{ block: 'center' }); const b = e.getBoundingClientRect(); "
        "return [b.left + b.width / 2, b.top + b.height / 2]; })()"
    )
    return float(x), float(y)


def test_a_click_on_a_part_shows_its_row_drawing_and_checks(roof: Page, tmp_path: Path) -> None:
    roof.run("scrollTo(0, 0); ddgfab.panel.select([])")
    before = orange(pixels(roof, tmp_path / "before.png"))
    x, y, mark = roof.run(PIECE)
    roof.click(x, y)
    assert roof.wait(HEADING).startswith(f"{mark} ")
    roof.run("new Promise(done => setTimeout(done, 200))")
    assert orange(pixels(roof, tmp_path / "after.png")) > before + 50
    inside = roof.run("document.getElementById('selection').innerText")
    assert re.search(r"\d+ checks, 0 failed", inside)
    assert mark in inside.split("\n", 1)[1]  # its row of a schedule names it again
    assert roof.run("document.querySelectorAll('#selection svg path').length") == 3
    assert roof.run("document.querySelector('#selection svg').getBoundingClientRect().width") > 150


def test_a_click_on_a_row_shows_the_part(roof: Page) -> None:
    roof.run("document.querySelector('details.table[data-t=\"1\"] summary').scrollIntoView()")
    tables = roof.run("ddgfab.model.tables.map(table => table.name)")
    t = tables.index("panels")
    roof.run("ddgfab.panel.select([])")
    roof.run(f"document.querySelector('details.table[data-t=\"{t}\"]').open = true")
    row = f'details.table[data-t="{t}"] tr[data-r="5"]'
    roof.wait(f"document.querySelector({row!r}) !== null")
    mark = roof.run(f"document.querySelector({row!r}).cells[0].textContent")
    roof.click(*middle(roof, f"{row} td:nth-child(2)"))
    assert roof.wait(HEADING).startswith(f"{mark} ")
    assert roof.run(f"document.querySelector({row!r}).classList.contains('chosen')")
    assert roof.run("ddgfab.view.selected.size") == 1


def test_rows_are_reached_and_taken_by_keys(roof: Page) -> None:
    roof.run("ddgfab.panel.select([])")
    roof.run("document.querySelector('details.table summary').focus()")
    roof.run(
        "document.querySelectorAll('details.table').forEach(d => { d.open = d.dataset.t == '1'; })"
    )
    roof.wait("document.querySelector('details.table[data-t=\"1\"] button.link') !== null")
    for _ in range(60):
        roof.key("Tab")
        if roof.run("document.activeElement.className") == "link":
            break
    name = roof.run("document.activeElement.textContent")
    roof.key("Enter", "\r")
    assert name in roof.wait(HEADING)


def test_arrow_keys_turn_the_model(roof: Page) -> None:
    roof.run("document.querySelector('canvas').focus()")
    before = roof.run("ddgfab.view.camera.position.toArray()")
    roof.key("ArrowLeft")
    after = roof.run("ddgfab.view.camera.position.toArray()")
    assert np.linalg.norm(np.subtract(before, after)) > 10


def test_colors_roles_explosion_and_section_change_what_is_seen(roof: Page) -> None:
    roof.run("ddgfab.panel.select([]); document.querySelector('[data-look=all]').click()")
    state = (
        "(() => { ddgfab.view.drawNow(); return ddgfab.view.renderer.domElement.toDataURL(); })()"
    )
    seen = {roof.run(state)}

    def change(script: str) -> None:
        roof.run(script)
        picture = roof.run(state)
        assert picture not in seen, script
        seen.add(picture)

    names = roof.run("[...document.getElementById('color').options].map(o => o.value)")
    assert {"role", "part number", "status", "torsion [deg]", "lean [deg]", "planarity [%]"} <= set(
        names
    )
    assert any("length" in name for name in names)
    choose = (
        "(() => {{ const e = document.getElementById('{0}'); e.value = '{1}'; "
        "e.dispatchEvent(new Event('{2}')); }})()"
    )
    change(choose.format("color", "Beams: length cut [mm]", "change"))
    assert roof.run("document.getElementById('legend').textContent").strip()
    change(choose.format("color", "part number", "change"))
    change(choose.format("explode", "0.5", "input"))
    change(choose.format("axis", "x", "change"))
    change(choose.format("section", "0.3", "input"))
    change("document.querySelector('#roles input').click()")
    count = roof.run("ddgfab.view.visible.filter(Boolean).length")
    assert count == roof.run("ddgfab.model.pieces.filter(p => p.number.kind !== 0).length")
    for undo in (("color", "role", "change"), ("explode", "0", "input"), ("axis", "", "change")):
        roof.run(choose.format(*undo))
    roof.run("document.querySelector('#roles input').click()")


def test_two_clicks_measure(roof: Page) -> None:
    roof.run("scrollTo(0, 0); document.querySelector('[data-look=all]').click()")
    roof.run("document.getElementById('measure').click()")
    x, y, _ = roof.run(PIECE)
    roof.click(x, y)
    roof.click(x + 3, y + 3)
    assert re.search(r"\d mm \(x ", roof.wait("measured.textContent"))
    roof.run("document.getElementById('measure').click()")


def test_few_draw_calls(roof: Page, kit: Page) -> None:
    for found in (roof, kit):
        assert 0 < int(found.run("view.dataset.calls")) < 10


def test_nothing_is_wider_than_the_window(roof: Page, kit: Page, size: tuple[int, int]) -> None:
    for found in (roof, kit):
        assert found.run("document.documentElement.scrollWidth") <= size[0]


def test_the_slider_moves_the_linkage(kit: Page, tmp_path: Path) -> None:
    kit.run("scrollTo(0, 0)")
    before = pixels(kit, tmp_path / "before.png")
    placed = "[...ddgfab.view.model.pieces.find(p => p.mark === 'L-0003').matrix.elements]"
    start = kit.run(placed)
    kit.run("pose.value = 0; pose.dispatchEvent(new Event('input'))")
    assert "6.1" in kit.run("reading.textContent")
    assert "meets" in kit.run("touches.textContent")
    assert np.abs(np.subtract(start, kit.run(placed))).max() > 1
    kit.run("new Promise(done => setTimeout(done, 200))")
    assert np.abs(pixels(kit, tmp_path / "after.png") - before).max(axis=2).sum() > 10_000
    kit.run("pose.value = ddgfab.model.motion.design; pose.dispatchEvent(new Event('input'))")


def test_labels_name_links_and_hinges(kit: Page) -> None:
    assert kit.run("document.getElementById('marks').checked")
    labels = kit.run(
        "[...document.querySelectorAll('#labels span')].map(s => s.textContent).sort()"
    )
    assert labels == [f"{role}-000{n}" for role in "HL" for n in range(4)]


def test_steps_show_their_parts_and_say_which_way_they_go(kit: Page) -> None:
    for _ in range(3):
        kit.run("document.getElementById('after').click()")
    assert "link L-0000 (LP-001) onto H-0000: label up" in kit.run("steptext.textContent")
    assert kit.run("ddgfab.view.visible.filter(Boolean).length") == 3
    assert kit.run("[...ddgfab.view.selected].map(k => ddgfab.model.pieces[k].mark)") == ["L-0000"]
    for _ in range(3):
        kit.run("document.getElementById('before').click()")
    assert kit.run("ddgfab.view.visible.every(Boolean)")


@pytest.mark.skipif(which("pdftotext") is None, reason="no pdftotext")
def test_paper_holds_every_row_and_step(roof: Page, kit: Page, tmp_path: Path) -> None:
    for n, found in enumerate((roof, kit)):
        path = tmp_path / f"{n}.pdf"
        found.pdf(path)
        text = subprocess.run(
            ["pdftotext", "-layout", str(path), "-"], capture_output=True, text=True, check=True
        ).stdout
        for table in found.run("ddgfab.model.tables"):
            assert table["title"] in text
            if table["columns"][0]["name"] in FIRST:
                for row in table["rows"]:
                    assert re.search(rf"^\s*{row[0]}\s", text, re.M), (table["name"], row[0])
        for step in found.run("ddgfab.model.steps"):
            # Long lines are broken: the beginning is enough.
            assert " ".join(step["title"].split()[:3]) in re.sub(r"\s+", " ", text)
    assert len(found.run("ddgfab.model.steps")) == 20


def test_problems_are_one_click_away(roof: Page, tmp_path: Path, size: tuple[int, int]) -> None:
    output = {"formats": ["csv", "html"]}
    made = design(barrel(), output=output, checks={"verify": "none", "min_angle_deg": 91})
    result = make(made, tmp_path / "out", anyway=True)
    with page(tmp_path / "profile", tmp_path / "out" / "report.html", *size) as found:
        found.wait(READY)
        assert found.run("state.textContent").startswith(f"{len(result.problems)} problem")
        assert found.run("document.querySelectorAll('#problems li.bad').length") == len(
            result.problems
        )
        found.click(*middle(found, "#failed button"))
        found.wait("ddgfab.view.selected.size")
        marks = found.run("[...ddgfab.view.selected].map(k => ddgfab.model.pieces[k].mark).sort()")
        assert set(marks) <= set(result.manifest["rejected"])
        assert marks
        assert found.told == []


def test_an_address_with_a_mark_opens_at_the_part(
    small_job: JobResult, tmp_path: Path, size: tuple[int, int], roof: Page
) -> None:
    path = small_job.folder / "report.html"
    with page(tmp_path / "profile", path, *size, anchor="#P-0003") as found:
        found.wait(READY)
        assert found.wait(HEADING).startswith("P-0003 ")
