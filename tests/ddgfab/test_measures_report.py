"""`inspect`: the words for kinds of nets, the numbers in the report, the time and imports."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from ddgfab.io import read_mesh
from ddgfab.measures import inspect, kind_names
from ddgfab.mesh import Floats, Mesh


def grid(points: Floats) -> Mesh:
    """Mesh of an (m, n, 3) net."""
    m, n, _ = points.shape
    at = (np.arange(m - 1)[:, None] * n + np.arange(n - 1)).ravel()
    return Mesh.build(points.reshape(-1, 3), np.stack([at, at + n, at + n + 1, at + 1], axis=1))


def revolution(azimuths: Floats) -> Mesh:
    """Meridians and parallels of a bulging column."""
    z, t = np.meshgrid(np.linspace(0, 3, 6), azimuths, indexing="ij")
    r = 2 + 0.5 * np.sin(z)
    return grid(np.stack([-r * np.cos(t), r * np.sin(t), z], axis=-1))


def translation() -> Mesh:
    """Sum of two curves: all faces are parallelograms."""
    i, j = np.meshgrid(np.arange(5.0), np.arange(6.0), indexing="ij")
    return grid(np.stack([i, j + 0.1 * i, 0.1 * i**2 + 0.05 * j**3], axis=-1))


def paraboloid() -> Mesh:
    """z = x y with edges on its straight lines."""
    i, j = np.meshgrid(np.arange(5.0), np.arange(4.0), indexing="ij")
    return grid(np.stack([i, j, i * j], axis=-1))


def pseudosphere(n: int = 9, alpha: float = np.pi / 8) -> Mesh:
    """Exact discrete pseudosphere, a rotational K-net (mathematics.md 3.9)."""
    i, j = np.meshgrid(np.arange(n), np.arange(n) + 12, indexing="ij")
    p = j - i
    length = np.log(np.tan(np.pi / 4 + alpha / 2))
    turn = (i + j) * alpha
    radius = 1 / np.cosh(p * length)
    height = np.tanh(p * length) - p * np.sin(alpha)
    return grid(np.stack([radius * np.cos(turn), radius * np.sin(turn), height], axis=-1))


def bumpy() -> Mesh:
    rng = np.random.default_rng(0)
    i, j = np.meshgrid(np.arange(5.0), np.arange(5.0), indexing="ij")
    return grid(np.stack([i, j, rng.uniform(0, 0.4, i.shape)], axis=-1))


def flat() -> Mesh:
    i, j = np.meshgrid(np.arange(4.0), np.arange(4.0), indexing="ij")
    return grid(np.stack([i, j + 0.2 * i, 0 * i], axis=-1))


def triangles() -> Mesh:
    return Mesh.build([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 1]], [[0, 1, 2], [1, 3, 2]])


def skew_polygons() -> Mesh:
    points = [[0, 0, 0], [1, 0, 0], [1, 1, 0.2], [0, 1, 0], [2, 0.5, 1]]
    return Mesh.build(points, [[0, 1, 2, 3], [1, 4, 2]])


@pytest.mark.parametrize(
    ("mesh", "names", "words"),
    [
        # Constant azimuth steps: conical as well (mathematics.md 2.9); unequal ones: circular only.
        (
            revolution(np.linspace(0, 2, 8)),
            ("conical", "circular", "planar", "isothermic", "quad"),
            "conical and circular net (quads, planar to ",
        ),
        (
            revolution(np.array([0, 0.2, 0.6, 0.7, 1.3])),
            ("circular", "planar", "isothermic", "quad"),
            "circular net (quads, planar to ",
        ),
        (
            translation(),
            ("planar", "translation", "Chebyshev", "quad"),
            "planar quad mesh (PQ mesh, conjugate net; planar to ",
        ),
        (paraboloid(), ("A-net", "quad"), "A-net along asymptotic lines (quads, not planar"),
        (pseudosphere(), ("K-net", "A-net", "Chebyshev", "quad"), "K-net: A-net along"),
        (bumpy(), ("quad",), "general quad mesh, not planar, up to "),
        (
            flat(),
            ("flat", "planar", "translation", "Chebyshev", "quad"),
            "flat mesh (quads, planar to ",
        ),
        (triangles(), ("triangle",), "triangle mesh"),
        (skew_polygons(), ("polygon",), "general polygon mesh, not planar, up to "),
    ],
    ids=lambda value: "-".join(value) if isinstance(value, tuple) else "",
)
def test_kinds_in_words(mesh: Mesh, names: tuple[str, ...], words: str) -> None:
    for factor in (1e-6, 1.0, 1e6):
        report = inspect(mesh.scaled(factor))
        assert report.kinds == names == kind_names(mesh.scaled(factor))
        assert report.kind.startswith(words)


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("conical1.obj", "conical net (quads, planar to 0.0041 %)"),
        ("six_quad.obj", "planar quad mesh (PQ mesh, conjugate net; planar to 0.0061 %)"),
        ("quad_dome.obj", "general quad mesh, not planar, up to 1.4 %"),
        ("chebyshev_sphere.obj", "Chebyshev net: opposite sides equal"),
        ("knet1.obj", "K-net: A-net along asymptotic lines, opposite sides equal"),
        ("tri_dome.obj", "triangle mesh"),
    ],
)
def test_kinds_of_meshes_of_others(name: str, words: str, mesh_file: Callable[[str], Path]) -> None:
    assert inspect(read_mesh(mesh_file(name)).mesh).kind.startswith(words)


def test_numbers_of_a_small_mesh() -> None:
    # 2 x 2 unit squares, one corner vertex (8) lifted: only face 3 is skew.
    i, j = np.meshgrid(np.arange(3.0), np.arange(3.0), indexing="ij")
    z = np.zeros((3, 3))
    z[2, 2] = 0.1
    report = inspect(grid(np.stack([i, j, z], axis=-1)), worst=2)
    assert (report.vertices, report.edges, report.faces, report.components) == (9, 12, 4, 1)
    assert report.face_sizes == {4: 4}
    assert report.valences_inner == {4: 1}
    assert report.valences_boundary == {2: 4, 3: 4}
    assert report.boundary_loops == (8,)
    assert report.edge_length == pytest.approx((1, 1, np.sqrt(1.01)))
    measure = report.measures["planarity_percent"]
    assert [face for face, _ in measure.worst] == [3, 0]
    assert measure.greatest == measure.worst[0][1] == pytest.approx(4 * measure.mean)
    assert report.measures["normal_torsion_deg"].of == "edges"


def test_report_is_plain_deterministic_and_readable() -> None:
    report = inspect(bumpy(), unit="m")
    text = json.dumps(report.to_dict(), sort_keys=True, allow_nan=False)
    again = inspect(bumpy(), unit="m")
    assert json.dumps(again.to_dict(), sort_keys=True) == text
    assert json.loads(text)["measures"]["planarity"]["unit"] == "m"
    assert json.loads(text)["valences_inner"] == {"4": 9}
    lines = report.lines()
    assert report.text() == "\n".join(lines)
    assert "general quad mesh" in lines[0]
    assert any("planarity" in line and " m;" in line for line in lines)
    assert any("torsion of normals" in line and " deg;" in line for line in lines)
    assert "general quad mesh" in repr(report)
    assert max(map(len, lines)) < 160


def test_closed_and_triangle_meshes_have_reports_too() -> None:
    points = [[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]]
    report = inspect(Mesh.build(points, [[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]]))
    assert report.boundary_loops == ()
    assert report.valences_boundary == {}
    assert report.measures["planarity"].worst == ()
    # Dihedral angle of the tetrahedron: normals enclose acos(-1/3).
    assert report.measures["dihedral_deg"].greatest == pytest.approx(np.degrees(np.arccos(-1 / 3)))
    assert "none" in report.text()
    json.dumps(report.to_dict(), allow_nan=False)


def test_inspect_loads_no_cad_and_few_modules() -> None:
    code = (
        "import sys, ddgfab.io, ddgfab.measures\n"
        "bad = {'OCP', 'build123d', 'cadquery', 'vtkmodules', 'pandas', 'scipy.optimize',"
        " 'scipy.spatial', 'scipy.linalg.interpolative'} & set(sys.modules)\n"
        "sys.exit(' '.join(sorted(bad)) or 0)"
    )
    root = Path(__file__).resolve().parents[2]
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=root, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
