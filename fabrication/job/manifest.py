"""manifest.json: every file and every part; written last, so its presence means complete.

What differs between two runs of one job is not in it but in run.json: the seconds of the steps, and
where the files that it was made from are, as seen from the folder.
"""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any, Final

import numpy as np

from ddgfab.errors import InputError
from ddgfab.io.atomic import atomic_write
from ddgfab.io.regular import read_regular
from ddgfab.mesh import Floats
from fabrication.formats.base import Part
from fabrication.specs import Check, Family, Placement
from fabrication.version import package_version

MANIFEST: Final = "manifest.json"
RUN: Final = "run.json"
UNLISTED: Final = frozenset({MANIFEST, RUN})
"""Files of ours that the manifest does not list."""

FORMAT_VERSION: Final = 1
GENERATOR: Final = "ddgfab"
"""What marks a manifest, and so a folder, as ours."""

LIMIT_BYTES: Final = 1 << 30
"""A larger manifest is none of ours."""

PLACEMENT_DIGITS: Final = 12
"""Decimals of placements [1 and mm] in the manifest."""

_LIBRARIES: Final = ("numpy", "scipy", "cadquery-ocp", "manifold3d")
"""Distributions that shape every product; formats and products name others."""


def part_records(
    families: Sequence[Family], parts: Mapping[str, Part], checks: Mapping[str, Sequence[Check]]
) -> list[dict[str, Any]]:
    """The manifest's parts, by mark.

    Parameters
    ----------
    parts : by part number
    checks : by mark
    """
    records = []
    for family in families:
        part = parts[family.number]
        for instance in family.instances:
            turn, shift = instance.placement[:3, :3], instance.placement[:3, 3]
            placed = part.mesh.vertices @ turn.T + shift
            records.append(
                part_record(
                    mark=instance.mark,
                    number=family.number,
                    role=family.role,
                    placement=instance.placement,
                    volume_mm3=part.properties.volume,
                    mass_kg=part.mass,
                    bbox_mm=np.stack([placed.min(axis=0), placed.max(axis=0)]),
                    checks=checks[instance.mark],
                )
            )
    return sorted(records, key=lambda record: str(record["mark"]))


def part_record(
    *,
    mark: str,
    number: str,
    role: str,
    placement: Placement,
    volume_mm3: float,
    mass_kg: float,
    bbox_mm: Floats,
    checks: Iterable[Check],
) -> dict[str, Any]:
    """A part of the manifest.

    Parameters
    ----------
    placement : (4, 4), written row by row
    bbox_mm : (2, 3) least and greatest corner of the placed piece
    """
    return {
        "mark": mark,
        "number": number,
        "role": role,
        "placement": _rounded(placement, PLACEMENT_DIGITS),
        "volume_mm3": round(float(volume_mm3), 3),
        "mass_kg": round(float(mass_kg), 6),
        "bbox_mm": _rounded(bbox_mm, 3),
        "checks": [check_record(check) for check in checks],
    }


def check_record(check: Check) -> dict[str, Any]:
    """A check of the manifest: name, passed, value, limit; the other piece's mark if there is."""
    record = {
        "name": check.name,
        "passed": bool(check.passed),
        "value": check.value,
        "limit": check.limit,
    }
    return record if check.other is None else {**record, "other": check.other}


def build_manifest(
    *,
    project: str,
    facts: Mapping[str, Any],
    parts: Sequence[Mapping[str, Any]],
    files: Sequence[Mapping[str, Any]],
    extra_checks: Iterable[Check] = (),
    libraries: Iterable[str] = (),
    complete: bool = True,
) -> dict[str, Any]:
    """The whole manifest as plain data; `checks` counts those of the parts and the extra ones.

    Parameters
    ----------
    facts : entries of the product's own, such as input, settings and net
    libraries : distributions whose versions are listed beside those of every product
    """
    outcomes = [check["passed"] for part in parts for check in part["checks"]]
    extra = [check_record(check) for check in extra_checks]
    outcomes += [check["passed"] for check in extra]
    return {
        "format_version": FORMAT_VERSION,
        "generator": GENERATOR,
        "complete": complete,
        "project": project,
        "units": "mm",
        **facts,
        "checks": {
            "passed": sum(outcomes),
            "failed": len(outcomes) - sum(outcomes),
            "job": extra,
        },
        "parts": list(parts),
        "files": list(files),
        "versions": library_versions(libraries),
    }


def file_records(folder: Path) -> list[dict[str, Any]]:
    """Path (relative, with slashes), bytes and sha256 of every file below a folder, by path.

    The manifest itself and the record of the run are left out.
    """
    records = []
    for path in folder.rglob("*"):
        name = path.relative_to(folder).as_posix()
        if path.is_file() and name not in UNLISTED:
            size = path.stat().st_size
            records.append({"path": name, "bytes": size, "sha256": digest_of(path)})
    return sorted(records, key=lambda record: str(record["path"]))


def library_versions(libraries: Iterable[str] = ()) -> dict[str, str]:
    """Versions of ddgfab and of the libraries that shape its output, the given ones included."""
    names = dict.fromkeys((*_LIBRARIES, *libraries))
    return {"ddgfab": package_version(), **{name: _version(name) for name in names}}


@cache
def _version(library: str) -> str:
    try:
        return version(library)
    except PackageNotFoundError:
        return "not installed"


def write_manifest(path: Path, manifest: Mapping[str, Any]) -> None:
    """Write the manifest (atomically), one part or file a line.

    Raises
    ------
    OutputError
        The file cannot be written.
    """
    text = manifest_text(manifest)
    with atomic_write(path) as file:
        file.write(text.encode("utf-8"))


def write_run(path: Path, sources: Mapping[str, Any], seconds: Mapping[str, float]) -> None:
    """Write what a job was made from, and the seconds that each step took, the longest first.

    Raises
    ------
    OutputError
        The file cannot be written.
    """
    ordered = sorted(seconds.items(), key=lambda item: -item[1])
    record = {"made_from": sources, "seconds": {step: round(float(t), 4) for step, t in ordered}}
    text = json.dumps(record, indent=1)  # escaped, since names of files need not be UTF-8
    with atomic_write(path) as file:
        file.write(f"{text}\n".encode("ascii"))


def manifest_text(manifest: Mapping[str, Any]) -> str:
    """JSON of a manifest: keys in their order, lists of parts and files one item a line."""
    lines = []
    for key, value in manifest.items():
        if key in ("parts", "files") and value:
            items = ",\n".join(f"  {_json(item)}" for item in value)
            lines.append(f"{_json(key)}: [\n{items}\n ]")
        else:
            lines.append(f"{_json(key)}: {_json(value)}")
    return "{\n " + ",\n ".join(lines) + "\n}\n"


def read_manifest(path: Path) -> dict[str, Any]:
    """A manifest of ours.

    Raises
    ------
    InputError
        Missing, no JSON, or not written by ddgfab.
    """
    try:
        manifest = json.loads(_text(path))
    except (InputError, ValueError, RecursionError) as error:
        raise InputError(f"no readable manifest ({error})", file=str(path)) from error
    if (
        not isinstance(manifest, dict)
        or manifest.get("generator") != GENERATOR
        or not isinstance(manifest.get("format_version"), int)
    ):
        raise InputError("not a manifest of ddgfab", file=str(path))
    return manifest


def made_from(folder: Path) -> dict[str, Any] | None:
    """What the result in a folder was made from; None where nothing readable says so."""
    try:
        record = json.loads(_text(folder / RUN))
    except (InputError, ValueError, RecursionError):
        return None
    found = record.get("made_from") if isinstance(record, dict) else None
    return found if isinstance(found, dict) else None


def _text(path: Path) -> str:
    """A record in a folder: a regular file, as others may have put a pipe in its place."""
    return read_regular(path, LIMIT_BYTES, InputError, what="a file of JSON").decode("utf-8")


def listed(folder: Path) -> dict[str, dict[str, Any]]:
    """The files that a folder's manifest lists, by path; empty where it has none of ours.

    Records that are not records, and paths that would leave the folder, are passed over.
    """
    try:
        records = read_manifest(folder / MANIFEST).get("files")
    except InputError:
        return {}
    found = {}
    for record in records if isinstance(records, list) else ():
        path = record.get("path") if isinstance(record, dict) else None
        if isinstance(path, str) and _stays_inside(path):
            found[path] = record
    return found


def faults(folder: Path) -> str | None:
    """What is first missing or wrong by the folder's manifest; None where it is complete."""
    try:
        read_manifest(folder / MANIFEST)
    except InputError as error:
        return str(error)
    for name, record in listed(folder).items():
        path = folder / name
        try:
            if path.is_symlink() or path.stat().st_size != record.get("bytes"):
                return f"{name} is not as long as the manifest says"
            if digest_of(path) != record.get("sha256"):
                return f"{name} is not what the manifest says (sha256)"
        except OSError as error:
            return f"{name}: {error.strerror or error}"
    return None


def digest_of(path: Path) -> str:
    """Sha256 of a file."""
    with path.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def _stays_inside(path: str) -> bool:
    parts = path.split("/")
    return "\0" not in path and all(part not in ("", ".", "..") for part in parts)


def _json(value: Any) -> str:
    try:
        return json.dumps(value, ensure_ascii=False, allow_nan=False, default=_plain)
    except ValueError:  # a number that is not finite somewhere: rare, so looked for only then
        return json.dumps(_finite(value), ensure_ascii=False, default=_plain)


def _plain(value: Any) -> Any:
    """What JSON does not know: numpy values as Python's, mappings as dictionaries, else text."""
    if isinstance(value, np.ndarray | np.generic):
        return _finite(value.tolist())
    return dict(value) if isinstance(value, Mapping) else str(value)


def _finite(value: Any) -> Any:
    """The same with null for numbers that are not finite."""
    if isinstance(value, np.ndarray | np.generic):
        value = value.tolist()
    if isinstance(value, Mapping):
        return {str(key): _finite(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _rounded(values: Floats, digits: int) -> list[float] | list[list[float]]:
    """An array as nested lists, rounded, without negative zeros."""
    result: list[float] | list[list[float]] = (np.round(values, digits) + 0.0).tolist()
    return result
