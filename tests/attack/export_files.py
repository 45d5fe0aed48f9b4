"""Files that the job wrote, damaged afterwards: `ddgfab check`, reading back, the next job.

    python tests/attack/export_files.py --count 20000      # STL, 3MF, GLB, CSV, XLSX, manifests

STEP files are in `step_files`. Bytes are damaged, and what is in archives, JSON and XML is changed
by its grammar. Reading back ends with checks, `ddgfab check` with a report or a message; the next
job in a folder with a damaged manifest loses nothing.
"""

from __future__ import annotations

import io
import random
import shutil
import struct
import sys
import zipfile
from collections.abc import Callable
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory, mkdtemp
from typing import Any

HERE = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(HERE), str(HERE / "tests" / "attack"), str(HERE / "tests" / "fabrication")]

import folder_cases  # noqa: E402
from damage import damaged  # noqa: E402
from mutations import changed_json, changed_text  # noqa: E402
from roofs import barrel  # noqa: E402
from watch import Watch, run  # noqa: E402

from fabrication import design  # noqa: E402
from fabrication.formats.base import Format, Part, Whole  # noqa: E402
from fabrication.formats.report import inspect_file  # noqa: E402
from fabrication.job.folder import OtherProjectError, OutputFolder  # noqa: E402
from fabrication.job.manifest import write_run  # noqa: E402
from fabrication.job.sources import Sources  # noqa: E402
from fabrication.solids import realise  # noqa: E402

WHOLE = {
    "glb": "model.glb",
    "ifc": "model.ifc",
    "3dm": "model.3dm",
    "compas": "net.json",
    "sheets": "sheets/all.pdf",
    "csv": "schedules/panels.csv",
    "xlsx": "schedules/schedule.xlsx",
}
"""A file of the whole of each format."""


PARTS = ("stl", "3mf", "dxf", "nc1")
"""Formats of part numbers."""

FORMATS: dict[str, Format] = {}
"""All of them, from `written` on."""


@cache
def written() -> tuple[Path, Whole, dict[str, Part]]:
    """A folder with files of every format, what they hold, and a part for each format of parts."""
    made = design(barrel(1, 2)).product()
    parts = {
        f.number: Part.of(f, realise(f.shape, made.chord, solid=False), made.material(f))
        for f in made.families
    }
    tables = {name: list(rows) for name, rows in made.schedules(dict.fromkeys(parts, 1.0)).items()}
    whole = Whole(made.about(), parts, made.families, made.families, tables=tables)
    folder = Path(mkdtemp(prefix="sound-"))
    for name in WHOLE:
        FORMATS[name] = made.format(name)
        FORMATS[name].write_whole(folder, whole)
    of_formats = {}
    for name in PARTS:
        FORMATS[name] = made.format(name)
        of_formats[name] = next(p for p in parts.values() if FORMATS[name].takes(p.family))
        FORMATS[name].write_part(folder / f"part.{name}", of_formats[name], made.about())
    return folder, whole, of_formats


def _zip(data: bytes, rng: random.Random) -> bytes:
    """An archive with one of its texts changed, packed again."""
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        files = {name: archive.read(name) for name in archive.namelist()}
    name = rng.choice(list(files))
    content = changed_text(files[name].decode("utf-8", "replace").replace(">", ">\n"), rng)
    files[name] = content.encode("utf-8", "surrogatepass")
    if rng.random() < 0.1:
        del files[rng.choice(list(files))]
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content_bytes in files.items():
            archive.writestr(name, content_bytes)
    return packed.getvalue()


def _glb(data: bytes, rng: random.Random) -> bytes:
    """A GLB with its JSON changed, lengths right."""
    length = struct.unpack_from("<I", data, 12)[0]
    text = data[20 : 20 + length].decode()
    new = (changed_json if rng.random() < 0.7 else changed_text)(text, rng).encode(
        "utf-8", "surrogatepass"
    )
    new += b" " * (-len(new) % 4)
    rest = data[20 + length :]
    return struct.pack("<4sIIII", b"glTF", 2, 20 + len(new) + len(rest), len(new), 0x4E4F534A) + (
        new + rest
    )


def _text(data: bytes, rng: random.Random) -> bytes:
    return changed_text(data.decode(), rng).encode("utf-8", "surrogatepass")


def _json(data: bytes, rng: random.Random) -> bytes:
    return changed_json(data.decode(), rng).encode("utf-8", "surrogatepass")


def damaged_anywhere(data: bytes, rng: random.Random) -> bytes:
    """Of a format without a grammar here."""
    return damaged(data, rng.randrange(1 << 30))


GRAMMAR: dict[str, Callable[[bytes, random.Random], bytes]] = {
    "stl": _text,
    "3mf": _zip,
    "xlsx": _zip,
    "glb": _glb,
    "csv": _text,
    "ifc": _text,
    "dxf": _text,
    "nc1": _text,
    "compas": _json,
    "3dm": damaged_anywhere,
    "sheets": damaged_anywhere,
    "manifest.json": _json,
    "run.json": _json,
}


def changed(kind: str, data: bytes, seed: int) -> bytes:
    """Half of the files by their grammar, half anywhere."""
    rng = random.Random(seed)
    if rng.random() < 0.5 and not (kind == "stl" and b"facet" not in data):
        return GRAMMAR[kind](data, rng)
    return damaged(data, seed)


def attack(watch: Watch, seed: int, folder: Path) -> None:
    """One file, of the kind that the seed says."""
    kind = list(GRAMMAR)[seed % len(GRAMMAR)]
    if kind.endswith(".json"):
        watch.call(f"{seed} ({kind})", lambda: next_job(kind, seed, folder))
        return
    sound, whole, parts = written()
    format = FORMATS[kind]
    if kind in WHOLE:
        name = WHOLE[kind]
        place = folder / "whole"
        shutil.rmtree(place, ignore_errors=True)
        shutil.copytree(sound, place)
        path = place / name
        path.write_bytes(changed(kind, path.read_bytes(), seed))
        watch.call(f"{seed} ({kind})", lambda: require_checks(format.check_whole(place, whole)))
    else:
        path = folder / f"part.{kind}"
        data = (sound / path.name).read_bytes()
        if kind == "stl" and seed % 3 == 0:
            data = text_stl(parts[kind])
        path.write_bytes(changed(kind, data, seed))
        watch.call(f"{seed} ({kind})", lambda: require_checks(format.check_part(path, parts[kind])))
    if format.inspects():
        watch.call(f"{seed} ({kind}, check)", lambda: inspect_file(path).text())


def require_checks(found: list[Any]) -> None:
    assert found, "no checks"
    assert all(isinstance(check.passed, bool) for check in found), "a check without an answer"


def text_stl(part: Part) -> bytes:
    """A part as a text STL."""
    rows = ["solid part"]
    for triangle in part.mesh.vertices[part.mesh.triangles]:
        rows += ["facet normal 0 0 0", "outer loop"]
        rows += ["vertex {:.6e} {:.6e} {:.6e}".format(*corner) for corner in triangle]
        rows += ["endloop", "endfacet"]
    return "\n".join([*rows, "endsolid part", ""]).encode()


def next_job(kind: str, seed: int, folder: Path) -> None:
    """A job in a folder whose manifest or record is damaged: it is refused, or nothing is lost."""
    target = folder / "out"
    shutil.rmtree(target, ignore_errors=True)
    mesh = folder / "roof.obj"
    mesh.write_text("mesh")
    sources = Sources(None, mesh)
    with OutputFolder(target, project="roof", sources=sources) as new:
        folder_cases.fill(new, "old")
        write_run(new / "run.json", sources.record(target), {"detail": 0.1})
    (target / "mine.txt").write_text("keep")
    path = target / kind
    path.write_bytes(changed(kind, path.read_bytes(), seed))
    place = OutputFolder(target, project="roof", sources=sources)
    try:
        place.prepare()
        with place as new:
            folder_cases.fill(new, "new")
    except OtherProjectError:
        with OutputFolder(target, project="roof", sources=sources, force=True) as new:
            folder_cases.fill(new, "new")
    finally:
        assert (target / "mine.txt").read_text() == "keep", "a file of others is lost"
        hidden = {path.name for path in folder.iterdir()} - {"out", "roof.obj", "whole"}
        assert not {name for name in hidden if name.startswith(".")}, "a working folder is left"
    assert (target / "only-new.txt").is_file(), "not the new result"


if __name__ == "__main__":
    with TemporaryDirectory(dir="/dev/shm" if Path("/dev/shm").is_dir() else None) as place:
        sys.exit(run(attack, __doc__, 20_000, Path(place)))
