"""The workbook as people print it: LibreOffice makes a PDF, which is read again."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import pytest

from fabrication.job.result import JobResult

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(
        not all(shutil.which(name) for name in ("soffice", "pdftotext", "pdfinfo")),
        reason="needs LibreOffice and poppler",
    ),
]

A3_MM = (420.0, 297.0)
POINT_MM = 25.4 / 72.0


def printed(workbook: Path, folder: Path) -> Path:
    """The PDF of a workbook, by a profile of its own."""
    profile = f"-env:UserInstallation=file://{folder}/profile"
    command = ["soffice", profile, "--headless", "--convert-to", "pdf", "--outdir", str(folder)]
    subprocess.run([*command, str(workbook)], check=True, capture_output=True, timeout=300)
    return folder / f"{workbook.stem}.pdf"


def test_pages_are_landscape_with_headers_and_the_manifests_totals(
    small_job: JobResult, tmp_path: Path
) -> None:
    pdf = printed(small_job.folder / "schedules" / "schedule.xlsx", tmp_path)
    about = subprocess.run(
        ["pdfinfo", "-f", "1", "-l", "999", str(pdf)], check=True, capture_output=True, text=True
    ).stdout
    sizes = re.findall(r"size:\s+([\d.]+) x ([\d.]+) pts", about)
    assert sizes
    for size in sizes:
        assert [POINT_MM * float(s) for s in size] == pytest.approx(A3_MM, abs=0.5)
    text = subprocess.run(
        ["pdftotext", "-layout", str(pdf), "-"], check=True, capture_output=True, text=True
    ).stdout
    pages = text.split("\f")[:-1]
    assert len(pages) == len(sizes)
    for number, page in enumerate(pages, 1):
        assert re.search(rf"page {number} of {len(pages)}\b", page)
    legend = [page for page in pages if re.search(r"Columns\s+page", page)]
    assert len(legend) > 1  # the header of the longest sheet is on each of its pages
    assert all(page.split("\n")[0].split() == ["sheet", "column", "meaning"] for page in legend)
    parts = small_job.manifest["parts"]
    listed = [page for page in pages if re.search(r"Parts list\s+page", page)]
    (total,) = re.findall(r"Total\s+(\d+)\s+([\d.]+)", listed[-1])
    assert int(total[0]) == len(parts)
    mass = sum(part["mass_kg"] for part in parts)
    assert float(total[1]) == pytest.approx(mass, abs=0.005 + 5e-4 * len(parts))
