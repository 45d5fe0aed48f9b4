"""Linkages in parts that several tests start from."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from test_linkage_levels import loop

from ddgfab.linkages import Mechanism
from fabrication.formats.stl import read_stl
from fabrication.linkage.detail import detail_linkage
from fabrication.linkage.links import Linkage
from fabrication.linkage.settings import settings_for
from fabrication.specs import TriangleMesh


def kit(mechanism: Mechanism | None = None, **given: Any) -> Linkage:
    return detail_linkage(mechanism or loop(), settings_for(**given))


def meshes_of(folder: Path) -> dict[str, TriangleMesh]:
    return {path.stem: read_stl(path) for path in sorted((folder / "parts/stl").glob("*.stl"))}
