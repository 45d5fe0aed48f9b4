"""Lines that bound faces: what crosses, what is left without free ends, and how long it takes."""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np
import pytest

from ddgfab.errors import MeshError
from ddgfab.io import read_mesh
from ddgfab.io.wires import Wires, _crossing, _without_free_ends
from ddgfab.mesh import Floats, Ints


def crosses(flat: Floats, one: Ints, two: Ints) -> bool:
    """Two bars without a common point cross between their ends: exactly, by fractions."""
    from fractions import Fraction

    a, b, c, d = ([Fraction(float(x)) for x in flat[k]] for k in (*one, *two))

    def side(p: list[Fraction], q: list[Fraction], r: list[Fraction]) -> Fraction:
        return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])

    return side(a, b, c) * side(a, b, d) < 0 and side(c, d, a) * side(c, d, b) < 0


@pytest.mark.parametrize("seed", range(40))
def test_crossings_are_those_of_all_pairs(seed: int) -> None:
    """Short bars, long ones, both; parallel to the axes, on a grid, in a heap far away."""
    rng = np.random.default_rng(seed)
    count = int(rng.integers(2, 60))
    start = rng.uniform(0, 1, (count, 2)) * rng.choice([1.0, 1e6])
    reach = rng.choice([0.01, 0.05, 2.0], (count, 1)) * np.ptp(start, axis=0).max()
    end = start + reach * rng.normal(size=(count, 2)) * rng.choice([0.0, 1.0], (1, 2), p=[0.2, 0.8])
    if seed % 3 == 0:
        start, end = np.round(start, 1), np.round(end, 1)
    flat = np.concatenate([start, end]) + rng.choice([0.0, -1e7])
    bars = np.stack([np.arange(count), count + np.arange(count)], axis=1)
    expected = [(i, j) for i in range(count) for j in range(i) if crosses(flat, bars[i], bars[j])]
    found = _crossing(flat, bars, "a.obj")
    assert (found is None) == (not expected)
    if found is not None:
        assert (max(found), min(found)) in expected


@pytest.mark.parametrize("seed", range(10))
def test_free_ends_go_again_and_again(seed: int) -> None:
    rng = np.random.default_rng(seed)
    points = int(rng.integers(3, 30))
    pairs = np.sort(rng.integers(0, points, (int(rng.integers(1, 40)), 2)), axis=1)
    bars = np.unique(pairs[pairs[:, 0] != pairs[:, 1]], axis=0)
    wires = Wires(np.zeros((points, 3)), bars, np.arange(len(bars)))
    left, own = _without_free_ends(wires)
    expected = bars
    while len(expected):
        degree = np.bincount(expected.ravel(), minlength=points)
        keep = (degree[expected] > 1).all(axis=1)
        if keep.all():
            break
        expected = expected[keep]
    assert left.tolist() == expected.tolist()
    assert bars[own].tolist() == left.tolist()


def text(points: Floats, edges: list[tuple[int, int]]) -> str:
    rows = ["v {:.6f} {:.6f} {:.6f}".format(*p) for p in points.tolist()]
    return "\n".join([*rows, *(f"l {a + 1} {b + 1}" for a, b in edges), ""])


def ring(count: int) -> Floats:
    turn = 2 * np.pi * np.arange(count) / count
    return np.stack([np.cos(turn), np.sin(turn), 0 * turn], axis=1) * 1e5


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kind", "said"),
    [("path", "bound none"), ("spokes", "the limit is"), ("crossing", "cross|limit")],
)
def test_twenty_thousand_lines_end_soon(kind: str, said: str, tmp_path: Path) -> None:
    n = 20_000
    points = np.random.default_rng(0).uniform(0, 1e5, (n, 3))
    edges = [(k, k + 1) for k in range(n - 1)]
    if kind == "spokes":
        half = n // 2
        points = np.concatenate([ring(half), [[0, 0, 0]]])
        edges = [(k, half) for k in range(half)] + [(k, (k + 1) % half) for k in range(half)]
    elif kind == "crossing":
        edges.append((n - 1, 0))
    path = tmp_path / "a.obj"
    path.write_text(text(points, edges))
    begin = time.process_time()
    with pytest.raises(MeshError, match=said):
        read_mesh(path)
    assert time.process_time() - begin < 5.0


def test_a_wheel_of_many_spokes_is_read(tmp_path: Path) -> None:
    n = 1500
    points = np.concatenate([ring(n), [[0, 0, 0]]])
    edges = [(k, n) for k in range(n)] + [(k, (k + 1) % n) for k in range(n)]
    (tmp_path / "a.obj").write_text(text(points, edges))
    assert read_mesh(tmp_path / "a.obj").mesh.n_faces == n
