"""Pipes, devices and files that change: no reader waits for them, or takes half of them."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from folder_cases import make_job
from roofs import barrel

from ddgfab.errors import InputError, OutputError
from ddgfab.io import write_obj
from ddgfab.io.regular import digest_regular, unchanged
from fabrication import design
from fabrication.formats.csv import LIMIT_BYTES, inspect_csv
from fabrication.formats.report import inspect_file
from fabrication.job.manifest import MANIFEST, RUN
from fabrication.linkage.kit import kit
from fabrication.surfaces_in.curves import read_curves
from fabrication.surfaces_in.rhino import read_rhino_surfaces

posix = pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="needs named pipes")

READERS: dict[str, tuple[Callable[[Path], Any], str]] = {
    "curves of DXF": (read_curves, ".dxf"),
    "curves of OBJ": (read_curves, ".obj"),
    "curves of CSV": (read_curves, ".csv"),
    "surfaces of Rhino": (read_rhino_surfaces, ".3dm"),
    **{suffix: (inspect_file, suffix) for suffix in (".csv", ".dxf", ".ifc", ".glb", ".3mf")},
}


@pytest.fixture(autouse=True)
def _soon() -> Iterator[None]:
    """What waits for a pipe is ended."""
    if hasattr(signal, "alarm"):
        signal.alarm(60)
    yield
    if hasattr(signal, "alarm"):
        signal.alarm(0)


@posix
@pytest.mark.parametrize(("read", "suffix"), READERS.values(), ids=READERS)
def test_pipes_and_devices_are_refused_at_once(
    read: Callable[[Path], Any], suffix: str, tmp_path: Path
) -> None:
    if suffix == ".3dm":
        pytest.importorskip("rhino3dm")
    pipe, device, folder = (tmp_path / f"{name}{suffix}" for name in ("pipe", "device", "folder"))
    os.mkfifo(pipe)
    device.symlink_to("/dev/zero")
    folder.mkdir()
    for path, what in ((pipe, "a named pipe"), (device, "a device"), (folder, "a folder")):
        with pytest.raises(InputError, match=f"{path.name}: this is {what}; "):
            read(path)
    with pytest.raises(InputError, match="no such file"):
        read(tmp_path / f"missing{suffix}")


@posix
@pytest.mark.parametrize("name", [MANIFEST, RUN])
def test_a_pipe_in_place_of_a_record_is_not_waited_for(name: str, tmp_path: Path) -> None:
    target = tmp_path / "out"
    make_job(target, "old")
    (target / name).unlink()
    os.mkfifo(target / name)
    if name == MANIFEST:
        with pytest.raises(OutputError, match="is not an output folder of ddgfab"):
            make_job(target, "new")
    else:
        make_job(target, "new")
        assert (target / "only-new.txt").is_file()


def test_tables_are_read_up_to_a_limit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "a.csv"
    path.write_text("," * 20_000)
    with pytest.raises(InputError, match="has 20001 columns; 16384 are read"):
        inspect_csv(path)
    path.write_text("a,b\n" + "1\n" * 300)
    found = inspect_csv(path)
    assert found.contents == "300 rows, 2 columns"
    assert len(found.problems) == 101
    assert found.problems[0] == "line 2 has 1 cells, not 2"
    assert found.problems[-1] == "300 lines have more or fewer cells"
    assert path.stat().st_size < LIMIT_BYTES
    monkeypatch.setattr("fabrication.formats.csv.LIMIT_BYTES", 100)
    with pytest.raises(InputError, match="604 bytes exceed the limit of 100"):
        inspect_csv(path)


def test_a_file_that_changes_while_it_is_read_is_told(tmp_path: Path) -> None:
    path = tmp_path / "a.txt"
    path.write_text("one")
    with unchanged(path) as digest:
        assert digest == digest_regular(path)
    with pytest.raises(InputError, match=r"a\.txt: was changed while it was read"), unchanged(path):
        path.write_text("two")
    with pytest.raises(InputError, match=r"a\.txt: no such file"), unchanged(path):
        path.unlink()


def test_records_have_the_content_that_was_read(tmp_path: Path) -> None:
    """The digest of an input is that of the bytes that were used, whatever came after."""
    path = tmp_path / "roof.obj"
    write_obj(path, barrel())
    before = digest_regular(path)
    made = design(path)
    path.write_text("changed")
    assert made.product().facts()["input"]["sha256"] == before
    project = tmp_path / "kit.toml"
    project.write_text('[linkage]\nkind = "bennett"\n')
    before = digest_regular(project)
    linkage = kit(project)
    project.unlink()
    assert linkage.product().facts()["input"]["sha256"] == before


def test_nothing_but_its_size_is_read_of_a_file_that_grows(tmp_path: Path) -> None:
    path, ended = tmp_path / "log.txt", threading.Event()
    path.write_bytes(b"x" * 4096)

    def grow() -> None:
        with path.open("ab") as stream:
            while not ended.is_set() and path.stat().st_size < 1 << 28:
                stream.write(b"x" * 65536)

    writer = threading.Thread(target=grow)
    writer.start()
    try:
        assert len(digest_regular(path)) == 64
    finally:
        ended.set()
        writer.join()
