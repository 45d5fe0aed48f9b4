"""docs/architecture.md names every room in the order of imports, and records that exist."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
TEXT = (ROOT / "docs/architecture.md").read_text("utf-8")
STARTS = {"__init__", "__main__"}


def table(title: str) -> list[str]:
    """First cells of the table below a heading."""
    _, _, below = TEXT.partition(f"\n## {title}\n")
    section = below.partition("\n## ")[0]
    rows = [line.split("|")[1].strip() for line in section.splitlines() if line.startswith("|")]
    return rows[2:]


def names(cells: list[str]) -> list[str]:
    """What is in backticks, without the slash of folders."""
    return [name.rstrip("/") for cell in cells for name in re.findall(r"`([^`]+)`", cell)]


def rooms(package: str) -> set[str]:
    """Modules, and folders that are packages."""
    files = (ROOT / package).glob("*.py")
    return {f.stem for f in files} | {f.parent.name for f in (ROOT / package).glob("*/__init__.py")}


def order(name: str) -> list[str]:
    """A list of names in .ci/check_imports.py."""
    tree = ast.parse((ROOT / ".ci/check_imports.py").read_text("utf-8"))
    (found,) = [
        node.value
        for node in tree.body
        if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == name
    ]
    return [str(room) for room in ast.literal_eval(found)]


@pytest.mark.parametrize(
    ("package", "name"), [("ddgfab", "GEOMETRY_ROOMS"), ("fabrication", "ROOMS")]
)
def test_every_room_is_named_in_the_order_of_imports(package: str, name: str) -> None:
    named = names(table(package))
    assert set(named) == rooms(package) - STARTS
    assert named == [room for room in order(name) if room not in STARTS]


def test_records_exist() -> None:
    defined = {
        node.name
        for package in ("ddgfab", "fabrication")
        for path in (ROOT / package).rglob("*.py")
        for node in ast.walk(ast.parse(path.read_text("utf-8")))
        if isinstance(node, ast.ClassDef)
    }
    named = names(table("The records, and why each exists"))
    assert len(named) > 20
    assert not set(named) - defined


def test_modules_and_files_that_the_text_names_exist() -> None:
    dotted = set(re.findall(r"`([a-z_]+(?:\.[a-zA-Z_]+)+)(?:\(\))?`", TEXT))
    assert len(dotted) > 15
    for name in dotted:
        parts = name.split(".")
        places = [ROOT.joinpath(package, *parts[:-1]) for package in ("ddgfab", "fabrication")]
        assert any(
            (place / parts[-1]).is_dir()
            or (place / f"{parts[-1]}.py").is_file()
            or defines(place, parts[-1])
            for place in places
        ), name
    for file in re.findall(r"`((?:tests|\.ci)/[\w/.]+)`", TEXT):
        assert (ROOT / file).is_file(), file


def defines(place: Path, name: str) -> bool:
    """Whether a module or a package's files define a class or function."""
    files = [place.with_suffix(".py")] if place.with_suffix(".py").is_file() else place.glob("*.py")
    return any(
        isinstance(node, ast.ClassDef | ast.FunctionDef) and node.name == name
        for path in files
        for node in ast.parse(path.read_text("utf-8")).body
    )
