"""The files of the whole: one task a format, and the preview. Runs in any process."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Final

from ddgfab.errors import OutputError
from fabrication.formats.base import Format, Whole
from fabrication.pictures.preview import write_preview
from fabrication.specs import Check

PREVIEW: Final = "preview.png"
"""Name of the picture."""


def write_whole(
    format: Format, folder: Path, whole: Whole, verify: bool
) -> tuple[list[str], list[Check], dict[str, float]]:
    """Write a format's files of the whole and, if asked, read them back.

    Returns what could not be written, the checks, and the seconds by step.
    """
    begin = time.perf_counter()
    warnings = format.write_whole(folder, whole)
    written = time.perf_counter()
    seconds = {f"{format.name} of the whole": written - begin}
    checks: list[Check] = []
    if verify and not warnings:
        checks = format.check_whole(folder, whole)
        seconds[f"read back {format.name} of the whole"] = time.perf_counter() - written
    return warnings, checks, seconds


def draw(folder: Path, whole: Whole) -> tuple[list[str], list[Check], dict[str, float]]:
    """Write preview.png; what is returned is as for `write_whole`.

    A machine without graphics is not a fault of the structure: no preview then, and a warning.
    """
    begin = time.perf_counter()
    meshes = {number: part.mesh for number, part in whole.parts.items()}
    try:
        write_preview(folder / PREVIEW, whole.shown, meshes, whole.failed, whole.colors)
    except OutputError as error:
        return [f"no {PREVIEW}: {error}"], [], {}
    return [], [], {"preview": time.perf_counter() - begin}
