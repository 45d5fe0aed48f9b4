"""Fixtures that several rooms share."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

MESHES = Path(__file__).resolve().parents[2] / "shared" / "data" / "meshes"


@pytest.fixture(scope="session")
def mesh_file() -> Callable[[str], Path]:
    """Path of a mesh made by others; skips where that folder is absent."""

    def find(name: str) -> Path:
        path = MESHES / name
        if not path.exists():
            pytest.skip(f"{name} is not in ../shared/data/meshes of this checkout")
        return path

    return find
