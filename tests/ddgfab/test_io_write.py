"""Writing: exact, deterministic, whole or not at all."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from ddgfab.errors import OutputError
from ddgfab.io import atomic_path, atomic_write, read_mesh, write_obj, write_off, write_ply
from ddgfab.mesh import Mesh

WRITERS = {
    "obj": write_obj,
    "off": write_off,
    "ply": write_ply,
    "text.ply": lambda path, mesh: write_ply(path, mesh, binary=False),
}


def awkward() -> Mesh:
    """Mixed polygons on coordinates that decimals do not reach."""
    rng = np.random.default_rng(2)
    angle = np.arange(6) * np.pi / 3
    ring = np.stack([np.cos(angle), np.sin(angle), rng.normal(size=6) * 1e-3], axis=1)
    outer = np.array([[3.0, 1 / 3, -1e-17], [3.0, 2.0, np.pi]])
    points = np.concatenate([ring, outer]) * np.array([1e8 / 3, 1 / 7, 1.0])
    return Mesh.build(points, [[0, 1, 2, 3, 4, 5], [1, 0, 6, 7], [2, 1, 7]])


@pytest.mark.parametrize("name", WRITERS)
def test_round_trip_is_exact_and_deterministic(name: str, tmp_path: Path) -> None:
    mesh = awkward()
    path = tmp_path / f"a.{name}"
    WRITERS[name](path, mesh)
    back = read_mesh(path, merge=0)
    assert all("stands upright" in note for note in back.notes)
    assert (back.mesh.vertices == mesh.vertices).all()  # bit for bit
    assert [f.tolist() for f in back.mesh.faces] == [f.tolist() for f in mesh.faces]
    first = path.read_bytes()
    WRITERS[name](path, back.mesh)
    assert path.read_bytes() == first
    assert [p.name for p in tmp_path.iterdir()] == [path.name]


def _half_written(path: Path, stop: BaseException) -> None:
    with atomic_write(path) as stream:
        stream.write(b"half")
        raise stop


@pytest.mark.parametrize("stop", [KeyboardInterrupt(), ValueError()], ids=repr)
def test_failed_block_leaves_the_old_file_and_nothing_else(
    stop: BaseException, tmp_path: Path
) -> None:
    path = tmp_path / "a.txt"
    path.write_text("old")
    with pytest.raises(type(stop)):
        _half_written(path, stop)
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_full_disk_is_an_output_error(tmp_path: Path) -> None:
    full = OSError(28, "No space left on device")
    with pytest.raises(OutputError, match=r"a\.txt: cannot be written: the disk is full"):
        _half_written(tmp_path / "a.txt", full)
    assert list(tmp_path.iterdir()) == []


def test_missing_folder_is_an_output_error(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match="cannot be written: No such file"):
        write_obj(tmp_path / "none" / "a.obj", awkward())


def test_target_that_is_a_folder_is_an_output_error(tmp_path: Path) -> None:
    (tmp_path / "a.obj").mkdir()
    with pytest.raises(OutputError, match="cannot be written"):
        write_obj(tmp_path / "a.obj", awkward())
    assert [p.name for p in tmp_path.iterdir()] == ["a.obj"]


def test_writers_by_name_get_the_suffix_and_the_same_folder(tmp_path: Path) -> None:
    target = tmp_path / "part.step"
    with atomic_path(target) as temporary:
        assert temporary.suffix == ".step"
        assert temporary.parent == tmp_path
        assert not target.exists()
        temporary.write_text("solid")
        assert not target.exists()
    assert target.read_text() == "solid"
    assert list(tmp_path.iterdir()) == [target]


def test_new_files_have_the_usual_permissions(tmp_path: Path) -> None:
    write_off(tmp_path / "a.off", awkward())
    (tmp_path / "b").write_text("")
    assert (tmp_path / "a.off").stat().st_mode == (tmp_path / "b").stat().st_mode
