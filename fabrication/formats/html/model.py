"""The model of the page as data: meshes once a part number, pieces, checks, and what moves."""

from __future__ import annotations

import base64
import zlib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np

from fabrication.formats.base import FAILED_COLOR, Whole
from fabrication.formats.html.page import Motion, Subject
from fabrication.formats.tables import plain
from fabrication.specs import Check, Color, Family, Kind

STEPS: Final = 65535
"""Coordinates are whole numbers of so many parts of the box of a mesh."""

DIGITS: Final = 6
"""Decimals of the values of checks."""


def packed(data: bytes) -> str:
    """Bytes as text, compressed (zlib, base64)."""
    return base64.b64encode(zlib.compress(data, 9)).decode("ascii")


def model_of(whole: Whole, subject: Subject, folder: Path) -> tuple[dict[str, Any], bytes]:
    """What the page shows: plain data, and the numbers of meshes and placements as bytes.

    The bytes are, each padded to four: coordinates (uint16), corners (uint16 or uint32) of the
    meshes one after another, placements (float32, 3 x 4, row by row) of all pieces, and those of
    the poses, pose by pose.
    """
    kinds = list(dict.fromkeys(family.kind for family in whole.shown))
    files = files_of_parts(folder)
    bodies, chunks = _meshes(whole, subject)
    numbers = []
    for family, body in zip(whole.shown, bodies, strict=True):
        part = whole.parts[family.number]
        numbers.append(
            {
                "number": family.number,
                "kind": kinds.index(family.kind),
                "mass_kg": round(part.mass, 4),
                "material": part.material.name,
                "color": css(whole.colors.get(family.number, family.kind.color)),
                "count": len(family.instances),
                "files": files.get(family.number, []),
                **body,
            }
        )
    index = {family.number: n for n, family in enumerate(whole.shown)}
    pieces = [(index[f.number], i) for f in whole.shown for i in f.instances]
    data: dict[str, Any] = {
        "kinds": [{**_kind(kind), "labelled": kind.role in subject.labelled} for kind in kinds],
        "failed_color": css(FAILED_COLOR),
        "numbers": numbers,
        "pieces": [
            [instance.mark, n, int(instance.mark in whole.failed)] for n, instance in pieces
        ],
        "checks": checks_of([instance.mark for _, instance in pieces], whole.checks),
    }
    placed = np.array([i.placement[:3] for _, i in pieces], "<f4").reshape(-1, 12)
    chunks.append(placed.tobytes())
    if subject.motion is not None:
        data["motion"] = _motion(subject.motion)
        poses = len(subject.motion.values_deg)
        moves = subject.motion.placements
        still = {i.mark: np.tile(i.placement, (poses, 1, 1)) for _, i in pieces}
        every = np.stack([moves.get(i.mark, still[i.mark]) for _, i in pieces], axis=1)
        chunks.append(every[:, :, :3].astype("<f4").tobytes())
    return data, b"".join(chunks)


def _kind(kind: Kind) -> dict[str, Any]:
    return {
        "role": kind.role,
        "title": kind.title,
        "color": css(kind.color),
        "glass": kind.finish == "glass",
        "form": kind.form,
    }


def _meshes(whole: Whole, subject: Subject) -> tuple[list[dict[str, Any]], list[bytes]]:
    """Of each part number: box and counts; and all coordinates and corners."""
    about, points, corners = [], [], []
    for family in whole.shown:
        mesh = subject.meshes.get(family.number, whole.parts[family.number].mesh)
        low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
        step = np.maximum(high - low, 1e-9) / STEPS
        points.append(np.rint((mesh.vertices - low) / step).astype("<u2"))
        corners.append(mesh.triangles)
        about.append(
            {
                "low": [float(f"{x:.7g}") for x in low],
                "size": [float(f"{x:.7g}") for x in high - low],
                "points": len(mesh.vertices),
                "triangles": len(mesh.triangles),
            }
        )
    wide = any(len(p) > STEPS for p in points)
    kind = "<u4" if wide else "<u2"
    for record in about:
        record["wide"] = wide
    both = [
        np.concatenate([np.zeros((0, 3), "<u2"), *points]).tobytes(),
        np.concatenate([np.zeros((0, 3), np.int64), *corners]).astype(kind).tobytes(),
    ]
    return about, [chunk + b"\0" * (-len(chunk) % 4) for chunk in both]


def _motion(motion: Motion) -> dict[str, Any]:
    return {
        "driver": motion.driver,
        "values": np.round(motion.values_deg, 4).tolist(),
        "design": motion.design,
        "touches": [
            {"pose": touch.pose, "at": np.round(touch.at, 3).tolist(), "text": touch.text}
            for touch in motion.touches
        ],
    }


def checks_of(marks: Sequence[str], checks: Mapping[str, Sequence[Check]]) -> dict[str, Any]:
    """Checks as columns: names, limits, and for each piece (name, passed, value, limit, other)."""
    names: dict[str, int] = {}
    limits: dict[Any, int] = {}
    rows = []
    for mark in marks:
        own = []
        for check in checks.get(mark, ()):
            limit = plain(check.limit, DIGITS)
            record = [
                names.setdefault(check.name, len(names)),
                int(check.passed),
                plain(check.value, DIGITS),
                limits.setdefault(limit, len(limits)),
            ]
            own.append(record if check.other is None else [*record, check.other])
        rows.append(own)
    return {"names": list(names), "limits": list(limits), "rows": rows}


def files_of_parts(folder: Path) -> dict[str, list[str]]:
    """Paths below the output folder of the files of each part number, those rejected too."""
    found: dict[str, list[str]] = {}
    for place in ("parts", "rejected", "sheets/dxf"):
        pattern = "*" if place.startswith("sheets") else "*/*"
        for path in sorted((folder / place).glob(pattern)):
            found.setdefault(path.name.split(".")[0], []).append(
                path.relative_to(folder).as_posix()
            )
    return found


def css(color: Color) -> str:
    """A color (sRGB, 0 to 1) as CSS has it."""
    return "#" + "".join(f"{round(255 * channel):02x}" for channel in color)


def pieces_of(families: Sequence[Family]) -> dict[str, int]:
    """The place of each piece among the pieces of the page, by mark."""
    marks = [instance.mark for family in families for instance in family.instances]
    return {mark: n for n, mark in enumerate(marks)}
