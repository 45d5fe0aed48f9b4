"""STL files whose numbers are none."""

from __future__ import annotations

import struct
from pathlib import Path

import pytest

from ddgfab.errors import MeshError
from ddgfab.io import read_mesh


@pytest.mark.filterwarnings("error")
def test_a_signaling_nan_is_refused_as_any_other(tmp_path: Path) -> None:
    path = tmp_path / "a.stl"
    record = struct.pack("<3fI8fH", 0, 0, 0, 0x7FA00000, *[0.0] * 8, 0)
    path.write_bytes(b" " * 80 + struct.pack("<I", 1) + record)
    with pytest.raises(MeshError, match="finite"):
        read_mesh(path)
