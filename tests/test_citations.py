"""Citations of docs/mathematics.md and docs/parts.md name sections that exist."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
FOLDERS = ("ddgfab", "fabrication", "tests", "docs", "examples", "benchmarks")
ENDINGS = {".py", ".md", ".toml"}

HEADING = re.compile(r"^#{2,3} (\d+[a-c]?(?:\.\d+)?) ", flags=re.MULTILINE)
NUMBER = r"\d+[a-c]?(?:\.\d+)?(?!\w)"
BREAK = r"(?:\s|\n\s*#)*"  # citations go on over lines, also of comments
NUMBERS = re.compile(rf"mathematics\.md{BREAK}({NUMBER}(?:{BREAK}(?:,|-|and|to){BREAK}{NUMBER})*)")
PARTS = re.compile(r"docs/parts\.md((?:,\s+[A-Z][a-z]+(?: [a-z]+)*)+)")


def sections() -> list[str]:
    """Numbers of the sections of docs/mathematics.md, in order."""
    return HEADING.findall((ROOT / "docs/mathematics.md").read_text("utf-8"))


def cited_numbers(text: str) -> list[str]:
    """Section numbers of docs/mathematics.md that a text cites; of ranges both ends."""
    return [n for found in NUMBERS.findall(text) for n in re.findall(NUMBER, found)]


def cited_parts(text: str) -> list[str]:
    """Section names of docs/parts.md that a text cites."""
    return [
        " ".join(name.split())
        for found in PARTS.findall(text)
        for name in found.removeprefix(",").split(",")
    ]


def texts() -> Iterator[tuple[str, str]]:
    """Every text of the project that may cite: its path and content."""
    for folder in FOLDERS:
        for path in sorted((ROOT / folder).rglob("*")):
            if path.suffix in ENDINGS and path != Path(__file__).resolve():
                yield str(path.relative_to(ROOT)), path.read_text("utf-8")
    yield "README.md", (ROOT / "README.md").read_text("utf-8")


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("Source: mathematics.md 3.4, 3.5; Bobenko 1996, 4.2.", ["3.4", "3.5"]),
        ("(mathematics.md 2.8 -\n2.10)", ["2.8", "2.10"]),
        ("mathematics.md\n    10.2-10.4.", ["10.2", "10.4"]),
        ("# see mathematics.md 2.7,\n# 11b.", ["2.7", "11b"]),
        ("mathematics.md 2.9 and 12: 2e-17", ["2.9", "12"]),
        ("mathematics.md 3.8, 1e-12 of the size", ["3.8"]),
        ("formulas are in mathematics.md. 3 of them", []),
    ],
)
def test_numbers_are_found(text: str, found: list[str]) -> None:
    assert cited_numbers(text) == found


def test_section_numbers_are_unique() -> None:
    numbers = sections()
    assert len(numbers) == len(set(numbers)) > 80


def test_cited_sections_exist() -> None:
    known = set(sections())
    cited = [(path, number) for path, text in texts() for number in cited_numbers(text)]
    assert len(cited) > 200
    assert [entry for entry in cited if entry[1] not in known] == []


def test_cited_parts_exist() -> None:
    headings = re.findall(r"^## (.+)$", (ROOT / "docs/parts.md").read_text("utf-8"), re.MULTILINE)
    cited = [(path, name) for path, text in texts() for name in cited_parts(text)]
    assert {"Beam", "Node element", "Panel", "Linkages"} <= {name for _, name in cited}
    assert [entry for entry in cited if entry[1] not in headings] == []
