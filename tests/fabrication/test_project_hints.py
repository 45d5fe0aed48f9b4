"""Project files that are not TOML: line, column, and how the line is written."""

from __future__ import annotations

import os
import time
import tomllib
from pathlib import Path

import pytest

from ddgfab.errors import ProjectError
from fabrication.gridshell.load import load_project
from fabrication.project.read import LIMIT_BYTES, read_toml

LINES = {
    r'file = "C:\Users\ann\roof.obj"': r"file = 'C:\Users\ann\roof.obj'",
    r'file = "..\shapes\Xroof.obj"  # mine': r"file = '..\shapes\Xroof.obj'",
    r'file = "\\server\share\roof.obj"': r"file = '\\server\share\roof.obj'",
    r'file = "C:\Users\ann\"': r"file = 'C:\Users\ann\'",
    "file = roof.obj": 'file = "roof.obj"',
    "file = /home/ann/roof.obj  # mine": 'file = "/home/ann/roof.obj"',
    "file = ../roof one.obj": 'file = "../roof one.obj"',
    r"file = C:\Users\roof.obj": r"file = 'C:\Users\roof.obj'",
    'file = "roof.obj': 'file = "roof.obj"',
    "file = 'roof.obj": "file = 'roof.obj'",
    "file = “roof.obj”": 'file = "roof.obj"',
    "kind = mesh": 'kind = "mesh"',
    "flip = True": "flip = true",
    "flip = no": "flip = false",
    "max_size_mm = 2500x1500": "max_size_mm = [2500, 1500]",
    "max_size_mm = 2500 × 1500 # as ordered": "max_size_mm = [2500, 1500]",
    "weld_mm = 1,5": "weld_mm = 1.5",
    "weld_mm = 5 mm": "weld_mm = 5",
    "weld_mm = 2.5mm": "weld_mm = 2.5",
    "weld_mm = 1/2": "weld_mm = 0.5",
    'file = "roof.obj";': 'file = "roof.obj"',
    "flip = true,  # mine": "flip = true",
    'file: "roof.obj"': 'file = "roof.obj"',
    "weld_mm : 2.5 # fine": "weld_mm = 2.5",
}


@pytest.mark.parametrize("line", LINES)
def test_the_line_as_it_is_meant(line: str, tmp_path: Path) -> None:
    path = tmp_path / "a.toml"
    path.write_text(f"[net]\n# a remark\n{line}\n", encoding="utf-8")
    with pytest.raises(ProjectError) as caught:
        load_project(path)
    message = str(caught.value)
    assert caught.value.line in (3, 4)
    assert f"{path}:3: is not TOML: " in message
    assert "(column " in message
    assert message.endswith(LINES[line])
    assert message.count("\n") <= 2
    tomllib.loads(LINES[line])  # what is advised can be read


def test_advice_of_two_lines_keeps_them(tmp_path: Path) -> None:
    path = tmp_path / "a.toml"
    path.write_text('[net]\nfile = "C:\\Users\\ann"\n')
    with pytest.raises(ProjectError) as caught:
        load_project(path)
    *_, advice, line = str(caught.value).split("\n")
    assert advice.startswith("backslashes ")
    assert line == r"file = 'C:\Users\ann'"


def test_backslashes_that_are_valid_escapes(tmp_path: Path) -> None:
    path = tmp_path / "a.toml"
    path.write_text('[net]\nkind = "mesh"\nfile = "C:\\temp\\new.obj"\n')
    with pytest.raises(ProjectError, match=r"character \\t\nbackslashes .* \(single quotes\)"):
        load_project(path)


@pytest.mark.parametrize(
    "text",
    ["[net\n", "= 3\n", "[net]\nkind\n", "a = [1, 2\n", "[a]\n[a]\n", "a = 1\na = 2\n", "\x01"],
)
def test_other_faults_get_no_advice(text: str, tmp_path: Path) -> None:
    path = tmp_path / "a.toml"
    path.write_text(text)
    with pytest.raises(ProjectError, match="is not TOML") as caught:
        read_toml(path)
    assert "\n" not in str(caught.value)
    assert caught.value.line is not None


def test_project_files_are_regular_and_small(tmp_path: Path) -> None:
    path = tmp_path / "a.toml"
    path.write_text("\n" * (LIMIT_BYTES + 1))
    with pytest.raises(ProjectError, match=f"exceed the limit of {LIMIT_BYTES}"):
        read_toml(path)
    for name, reason in [(".", "this is a folder"), ("none.toml", "no such file"), ("a\0", "null")]:
        with pytest.raises(ProjectError, match=reason):
            read_toml(tmp_path / name)
    if hasattr(os, "mkfifo"):
        os.mkfifo(tmp_path / "pipe.toml")
        with pytest.raises(ProjectError, match="this is a named pipe; a project file"):
            read_toml(tmp_path / "pipe.toml")


@pytest.mark.parametrize("key", ["a.", "a . ", '"a b".', "'a'.\"b\"."])
def test_keys_of_many_parts_are_refused_at_once(key: str, tmp_path: Path) -> None:
    path = tmp_path / "a.toml"
    path.write_text(key * (LIMIT_BYTES // 10) + "b = 1\n")
    begin = time.process_time()
    with pytest.raises(ProjectError, match="a key of more than 20 parts"):
        read_toml(path)
    assert time.process_time() - begin < 5
    path.write_text('[a.b.c]\nd.e.f = [1.5, 2.5]\nfile = "' + "x." * 50 + '"\n')
    assert read_toml(path)[0]["a"]["b"]["c"]["d"]["e"]["f"] == [1.5, 2.5]
