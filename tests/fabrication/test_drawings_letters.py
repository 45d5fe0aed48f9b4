"""Letters that fonts and code pages have not are named, never printed as empty boxes or codes."""

from __future__ import annotations

import io
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path

import ezdxf
import pytest
from detailing_cases import dome
from sheet_checks import whole_of

from fabrication import design
from fabrication.drawings.dxf import encoding, sheets_dxf
from fabrication.drawings.pdf import missing
from fabrication.drawings.sheet import A4, Sheet, Text
from fabrication.formats.base import Title, Whole
from fabrication.formats.sheets import FORMAT


@pytest.fixture(scope="module")
def small() -> Whole:
    case = dome(1, 1)
    return whole_of(design(case.mesh, axes=case.axes))


def titled(whole: Whole, title: str, **options: str) -> Whole:
    about = replace(whole.about, title=Title(title), options={"sheets": options})
    return replace(whole, about=about)


def test_missing_characters() -> None:
    assert missing('Dach "Süd" (Ö)') == frozenset()
    assert missing("Střecha Крыша") == frozenset()
    assert missing("屋根 x") == {"屋", "根"}


def test_characters_that_no_font_has_are_named(small: Whole, tmp_path: Path) -> None:
    notes = FORMAT.write_whole(tmp_path, titled(small, "屋根 Süd"))
    assert notes == ['sheets as PDF: no letters for 屋 (U+5C4B), 根 (U+6839), shown as "?"']
    assert FORMAT.write_whole(tmp_path, titled(small, "Střecha „Süd“")) == []
    notes = FORMAT.write_whole(tmp_path, titled(small, "Крыша", dxf="R12"))
    assert len(notes) == 1
    assert notes[0].startswith("sheets as DXF of R12: no letters for К (U+041A), а (U+0430)")
    assert FORMAT.write_whole(tmp_path, titled(small, "Крыша", dxf="R2010")) == []


@pytest.mark.skipif(shutil.which("pdftotext") is None, reason="poppler is not installed")
def test_a_title_is_found_in_the_pdf_by_another_program(small: Whole, tmp_path: Path) -> None:
    FORMAT.write_whole(tmp_path, titled(small, "Střecha „Süd“ 屋"))
    path = tmp_path / "sheets" / "panels.pdf"
    done = subprocess.run(["pdftotext", path, "-"], capture_output=True, check=True)
    assert "Střecha „Süd“ ?" in done.stdout.decode("utf-8")


@pytest.mark.parametrize(
    ("release", "shown"),
    [("R12", 'Süd "é" r ? '), ("R2010", 'Süd "é" ř 屋 ')],
)
def test_texts_of_dxf_are_read_by_ezdxf(release: str, shown: str) -> None:
    sheet = Sheet("s", "s", A4, (Text((50.0, 50.0), 'Süd "é" ř 屋 °Ø'),))
    data = sheets_dxf([sheet], release).encode(encoding(release))
    text = data.decode(encoding(release))
    assert "\\U+" not in text
    document = ezdxf.read(io.StringIO(text))
    assert not document.audit().errors
    [entity] = document.modelspace().query("TEXT")
    assert entity.dxf.text.startswith(shown)


def test_a_file_of_r12_is_read_with_its_code_page(small: Whole, tmp_path: Path) -> None:
    FORMAT.write_whole(tmp_path, titled(small, 'Dach "Süd" Ü', dxf="R12"))
    document = ezdxf.readfile(tmp_path / "sheets" / "dxf" / "overview.dxf")
    texts = {entity.dxf.text for entity in document.modelspace().query("TEXT")}
    assert 'Dach "Süd" Ü' in texts
