"""Mesh files of all kinds that the program reads: those of `ddgfab.io`, and Rhino files."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from ddgfab import io
from ddgfab.io import ReadResult
from fabrication.meshes_in.rhino import parse_rhino

READERS = {".3dm": parse_rhino}
"""Parsers beside those of `ddgfab.io`, by suffix."""

__all__ = ["READERS", "parse_rhino", "read_mesh"]


def read_mesh(path: str | Path, scale: float = 1.0, **ways: Any) -> ReadResult:
    """As `ddgfab.io.read_mesh`, which it calls; reads .3dm files too (extra `3dm`).

    Raises
    ------
    MeshError
        As `ddgfab.io.read_mesh`; for .3dm files as `parse_rhino`.
    """
    return io.read_mesh(path, scale, readers=READERS, **ways)
