"""Print plates: everything on the bed, nothing on anything else, and beds that are too small."""

from __future__ import annotations

import numpy as np
import pytest

from ddgfab.errors import InputError
from fabrication.linkage.plates import Bed, Printed, plates
from fabrication.specs import TriangleMesh


def box(*size: float) -> TriangleMesh:
    grid = np.stack(np.meshgrid([0.0, 1], [0.0, 1], [0.0, 1], indexing="ij"), axis=-1)
    quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    triangles = np.array([[q[0], q[i], q[i + 1]] for q in quads for i in (1, 2)])
    return TriangleMesh(grid.reshape(-1, 3) * size - np.array(size) / 3, triangles)


def part(number: str, count: int, *size: float, lying: np.ndarray | None = None) -> Printed:
    marks = tuple(f"{number}-{i}" for i in range(count))
    return Printed(number, box(*size), np.eye(4) if lying is None else lying, marks)


def boxes_on(parts: list[Printed], bed: Bed) -> list[np.ndarray]:
    """Bounding boxes (n, 2, 3) of what stands on each plate; checks that each piece stands once."""
    found, marks = [], []
    for plate in plates(parts, bed):
        placed = [
            parts[s.part].mesh.vertices @ s.placement[:3, :3].T + s.placement[:3, 3] for s in plate
        ]
        found.append(np.array([[p.min(axis=0), p.max(axis=0)] for p in placed]))
        marks += [s.mark for s in plate]
        for s in plate:
            assert np.abs(s.placement[:3, :3] @ s.placement[:3, :3].T - np.eye(3)).max() < 1e-12
            assert np.linalg.det(s.placement[:3, :3]) > 0
            assert s.mark in parts[s.part].marks
    assert sorted(marks) == sorted(mark for p in parts for mark in p.marks)
    return found


@pytest.mark.parametrize("seed", range(4))
def test_nothing_overlaps_and_everything_is_on_the_bed(seed: int) -> None:
    rng = np.random.default_rng(seed)
    tilt = np.eye(4)
    tilt[:3, :3] = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    tilt[:3, 0] *= np.linalg.det(tilt[:3, :3])
    parts = [
        part(f"L-{i:03d}", 1 + i % 4, *rng.uniform(3, 120, 2), 8.0, lying=tilt if i % 2 else None)
        for i in range(14)
    ]
    bed = Bed(200, 180, margin=4, gap=3)
    found = boxes_on(parts, bed)
    assert len(found) > 1
    for placed in found:
        assert np.abs(placed[:, 0, 2]).max() < 1e-9  # on the bed
        assert placed[:, 0, :2].min() > 4 - 1e-9
        assert (placed[:, 1, :2] < np.array([196, 176]) + 1e-9).all()
        for i in range(len(placed)):
            gap = np.maximum(placed[i, 0] - placed[:, 1], placed[:, 0] - placed[i, 1])[:, :2]
            assert np.delete(gap.max(axis=1), i).min(initial=9) > 3 - 1e-9


def test_four_links_share_a_plate_and_the_order_is_stable() -> None:
    parts = [part("LP-001", 2, 110, 12, 10), part("LP-002", 2, 156, 12, 10)]
    first, again = plates(parts), plates(parts)
    assert len(first) == 1
    assert [s.mark for s in first[0]] == ["LP-001-0", "LP-001-1", "LP-002-0", "LP-002-1"]
    for a, b in zip(first[0], again[0], strict=True):
        assert np.array_equal(a.placement, b.placement)


def test_a_link_longer_than_the_bed_lies_across_it() -> None:
    (plate,) = plates([part("LP-001", 1, 260, 12, 10)])
    assert 20 < np.degrees(np.arctan2(*plate[0].placement[1::-1, 0])) < 70
    assert len(boxes_on([part("LP-001", 1, 260, 12, 10)], Bed())) == 1


def test_a_link_of_the_length_of_the_land_just_fits() -> None:
    placed = boxes_on([part("LP-001", 1, 200, 12, 10)], Bed())[0]
    assert placed[0, :, 0] == pytest.approx([10, 210])


def test_a_bed_that_is_too_small_is_named_with_the_link() -> None:
    with pytest.raises(InputError, match=r"LP-007 \(LP-007-0\) lies on 310.0 x 12.0 mm.*220 x 220"):
        plates([part("LP-007", 1, 310, 12, 10)])
    with pytest.raises(InputError, match="--bed"):
        plates([part("P", 1, 30, 30, 1)], Bed(48, 200))
