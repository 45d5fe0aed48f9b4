"""Surfaces and curves from files: faces by number and name, Rhino patches, drawn curves."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from ddgfab.errors import DdgError, InputError
from fabrication.surfaces_in.choice import chosen
from fabrication.surfaces_in.curves import read_curves
from fabrication.surfaces_in.damage import check_spline_surfaces

NAMES = [("east", "roof"), ("west", "roof"), ("roof",)]
AREAS = [1e6, 2e6, 3e6]


@pytest.mark.parametrize(
    ("choice", "numbers"),
    [(1, [1]), ("2", [2]), ("west", [1]), ("roof", [2]), (["west", 0], [1, 0]), ("all", [0, 1, 2])],
)
def test_faces_are_chosen(choice: object, numbers: list[int]) -> None:
    assert chosen(NAMES, AREAS, choice, "f.step") == numbers  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("choice", "message"),
    [
        (None, r"has 3 faces: 0 \(east, 1 m2\), 1 \(west, 2 m2\)"),
        (3, "has no face 3; faces are 0 to 2"),
        ("-1", "has no face -1"),
        ("eas", "did you mean east"),
        (["east", 0], "chosen twice"),
        ([], "no face is chosen"),
    ],
)
def test_wrong_choices_are_named(choice: object, message: str) -> None:
    with pytest.raises(InputError, match=message):
        chosen(NAMES, AREAS, choice, "f.step")  # type: ignore[arg-type]
    with pytest.raises(InputError, match="2 faces have the name b: choose by number"):
        chosen([("a", "b"), ("c", "b")], [1, 1], "b", "f.step")


def test_rhino_surfaces_trims_units_and_names(tmp_path: Path) -> None:
    rhino3dm = pytest.importorskip("rhino3dm")
    from fabrication.surfaces_in.find import find_surfaces

    model = rhino3dm.File3dm()
    model.Settings.ModelUnitSystem = rhino3dm.UnitSystem.Meters
    patch = rhino3dm.NurbsSurface.Create(3, True, 4, 4, 5, 6)
    for i in range(5):
        for j in range(6):
            z = 3 - 0.4 * (i - 2) ** 2 - 0.3 * (j - 2.5) ** 2
            patch.Points[(i, j)] = rhino3dm.Point4d(5 * i - 10, 2.8 * j - 7, z, 1)
    patch.KnotsU.CreateUniformKnots(1.0)
    patch.KnotsV.CreateUniformKnots(1.0)
    named = rhino3dm.ObjectAttributes()
    named.Name = "roof"
    model.Objects.AddBrep(rhino3dm.Brep.CreateFromSurface(patch), named)
    tube = rhino3dm.Cylinder(rhino3dm.Circle(2.0), 6.0)
    named.Name = "tube"
    model.Objects.AddBrep(tube.ToBrep(True, True), named)
    path = tmp_path / "model.3dm"
    model.Write(str(path), 7)
    (roof,) = find_surfaces(path, faces="roof")
    corner = roof.points(np.array(roof.trim.loops[0][:1]))[0]
    assert corner[:2] == pytest.approx([-10e3, -7e3])  # metres in the file
    u, v = 0.3 * patch.Domain(0).T1, 0.7 * patch.Domain(1).T1
    point = patch.PointAt(u, v)
    assert roof.points(np.array([[u, v]]))[0] == pytest.approx(
        [1e3 * point.X, 1e3 * point.Y, 1e3 * point.Z]
    )
    (wall,) = find_surfaces(path, faces=1)  # rational, closed, whole
    x, y, _ = wall.points(np.random.default_rng(1).uniform(0, 1, (20, 2)) * [12, 6]).T
    assert np.hypot(x, y) == pytest.approx(2e3)
    (lid,) = find_surfaces(path, faces=2)  # a plane with a round trim
    assert np.linalg.norm(lid.points(lid.trim.loops[0])[:, :2], axis=1) == pytest.approx(2e3)
    with pytest.raises(DdgError, match=r"has 4 faces: 0 \(roof"):
        find_surfaces(path)
    with pytest.raises(DdgError, match="3 faces have the name tube"):
        find_surfaces(path, faces="tube")
    with pytest.raises(DdgError, match="units and scale are for meshes"):
        find_surfaces(path, units="m")


def test_damaged_rhino_file_is_named(tmp_path: Path) -> None:
    pytest.importorskip("rhino3dm")
    from fabrication.surfaces_in.find import find_surfaces

    path = tmp_path / "bad.3dm"
    path.write_bytes(b"3D Geometry File Format " + bytes(range(200)))
    with pytest.raises(DdgError, match=r"bad\.3dm: is (not a Rhino file|damaged)"):
        find_surfaces(path)


SIMPLE = (
    "#3 = PRODUCT('a;b');\n#7 = B_SPLINE_SURFACE_WITH_KNOTS('',3,3,((#1,#2),\n(#3,#4)),"
    ".UNSPECIFIED.,.F.,.F.,.F.,(4,1,4),(4,4),(0.,{0},1.),\n(0.,1.),.UNSPECIFIED.);\n"
)
RATIONAL = (
    "#9=(BOUNDED_SURFACE() B_SPLINE_SURFACE(2,2,((#1,#2),(#3,#4)),.UNSPECIFIED.,.F.,.F.,.F.)\n"
    "B_SPLINE_SURFACE_WITH_KNOTS((3,3),(3,3),(0.,1.),(0.,1.),.UNSPECIFIED.) "
    "RATIONAL_B_SPLINE_SURFACE(((1.,0.5),\n({0},1.))) REPRESENTATION_ITEM('') SURFACE());"
)


def test_spline_surfaces_that_the_kernel_leaves_out_are_named() -> None:
    check_spline_surfaces(SIMPLE.format("0.5") + RATIONAL.format("2."), "a.step")
    with pytest.raises(
        InputError, match=r"a\.step: surface #7: knots along u .*: knot 2 is 1 after"
    ):
        check_spline_surfaces(SIMPLE.format("2."), "a.step")
    for weight in ("-0.5", "0."):
        message = rf"surface #9: weight {float(weight):g} of control point \(1, 0\)"
        with pytest.raises(InputError, match=message):
            check_spline_surfaces(SIMPLE.format("0.5") + RATIONAL.format(weight), "a.step")
    check_spline_surfaces("B_SPLINE_SURFACE_WITH_KNOTS(((.,.)),,1,.", "a.step")  # the kernel's


@pytest.mark.slow
def test_creased_surfaces_and_damaged_weights_of_step_files(tmp_path: Path) -> None:
    """Degree 1 with knots inside; a weight turned negative in a file that was good before."""
    import build123d
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace
    from OCP.Geom import Geom_BSplineSurface
    from OCP.gp import gp_Pnt
    from OCP.TColgp import TColgp_Array2OfPnt
    from OCP.TColStd import TColStd_Array1OfInteger, TColStd_Array1OfReal, TColStd_Array2OfReal

    from fabrication.surfaces_in.cad import read_cad_surface

    def write(degree: int, name: str) -> Path:
        poles, weights = TColgp_Array2OfPnt(1, 4, 1, 4), TColStd_Array2OfReal(1, 4, 1, 4)
        for i in range(4):
            for j in range(4):
                poles.SetValue(i + 1, j + 1, gp_Pnt(2e3 * i, 2e3 * j, 300.0 * i * (3 - i)))
                weights.SetValue(i + 1, j + 1, 0.77777 if (i, j) == (1, 2) else 1.0)
        count = 5 - degree
        knots, times = TColStd_Array1OfReal(1, count), TColStd_Array1OfInteger(1, count)
        for k in range(count):
            knots.SetValue(k + 1, k / (count - 1))
            times.SetValue(k + 1, degree + 1 if k in (0, count - 1) else 1)
        made = Geom_BSplineSurface(poles, weights, knots, knots, times, times, degree, degree)
        face = build123d.Face(BRepBuilderAPI_MakeFace(made, 1e-6).Face())
        build123d.export_step(face, str(tmp_path / name))
        return tmp_path / name

    with pytest.raises(InputError, match=r"degree 1 along u with 2 knots inside, .* u = 0\.333"):
        read_cad_surface(write(1, "creased.step"))
    path = write(3, "good.step")
    assert read_cad_surface(path).weights is not None
    path.write_text(path.read_text().replace("0.77777", "-0.77777"))
    with pytest.raises(InputError, match=r"weight -0\.77777 of control point \(1, 2\)"):
        read_cad_surface(path)


@pytest.mark.slow
def test_faces_of_step_by_name(tmp_path: Path) -> None:
    """Names of ADVANCED_FACE, and of the bodies that faces belong to, moved as these are."""
    import build123d

    from fabrication.surfaces_in.cad import read_cad_surface

    parts = [build123d.Face.make_rect(2000, 1000), build123d.Face.make_rect(800, 600)]
    parts[1] = parts[1].moved(build123d.Location((5000, 0, 0)))
    parts[0].label, parts[1].label = "floor", "porch"
    whole = build123d.Compound(children=parts)
    path = tmp_path / "two.step"
    build123d.export_step(whole, str(path))
    surface = read_cad_surface(path, "porch")
    assert surface.points(surface.trim.loops[0])[:, 0].min() == pytest.approx(4600)
    text = path.read_text()
    at = text.index("ADVANCED_FACE('")
    path.write_text(text[: at + 15] + "slab" + text[at + 15 :])
    assert read_cad_surface(path, "slab").name == "two.step face 0 (slab)"
    assert read_cad_surface(path, "floor").name == "two.step face 0 (slab)"
    with pytest.raises(InputError, match="did you mean porch"):
        read_cad_surface(path, "porhc")


def test_curves_of_three_kinds_of_files_agree(tmp_path: Path) -> None:
    import ezdxf

    x = np.linspace(0, 4, 9)
    points = np.stack([x, np.sin(x), 0.1 * x], axis=1)
    drawing = ezdxf.new()
    drawing.header["$INSUNITS"] = 6
    drawing.modelspace().add_polyline3d(points.tolist())
    drawing.modelspace().add_circle((1, 1), 2)
    drawing.modelspace().add_text("note")
    drawing.saveas(tmp_path / "a.dxf")
    rows = "".join(f"v {a} {b} {c}\n" for a, b, c in points.tolist())
    lines = "".join(f"l {k} {k + 1}\n" for k in range(1, 9))
    (tmp_path / "a.obj").write_text(f"# units: m\n{rows}{lines}l -1 -9\n")
    rows = "".join(f"{1e3 * a};{1e3 * b};{1e3 * c}\n" for a, b, c in points.tolist())
    (tmp_path / "a.csv").write_text(f"x;y;z\n{rows}\n0;0;0\n1;1;1\n")
    one, circle = read_curves(tmp_path / "a.dxf")
    assert np.hypot(*(circle[:, :2] - 1000).T) == pytest.approx(2000)
    assert len(circle) > 20
    for name in ("a.obj", "a.csv"):
        curves = read_curves(tmp_path / name)
        np.testing.assert_allclose(curves[0][:9], one, atol=1e-9)
    assert len(read_curves(tmp_path / "a.obj")) == 1  # pieces that follow one another
    assert len(read_curves(tmp_path / "a.csv")) == 2
    (tmp_path / "b.csv").write_text("east,0,0,0\neast,1,0,0\nwest,0,1,0\nwest,1,1,0\n")
    assert len(read_curves(tmp_path / "b.csv")) == 2


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("a.csv", "1,2,3\n4,x,6\n", r"a\.csv:2: 4 x 6 is not a point"),
        ("a.csv", "x,y,z\n", "holds no curve: a row a point"),
        ("a.obj", "v 0 0 0\nl 1 2\n", r"a\.obj:2: a line of vertices beyond 1"),
        ("a.obj", "v 0 0 0\n", "lines 'l' are read"),
        ("a.dxf", "no drawing", "no[t a]* DXF file|holds no curve"),
        ("a.svg", "", "unknown kind of curve file"),
    ],
)
def test_bad_curves_are_named(name: str, text: str, message: str, tmp_path: Path) -> None:
    (tmp_path / name).write_text(text)
    with pytest.raises(InputError, match=message):
        read_curves(tmp_path / name)


@pytest.mark.slow
def test_closed_surfaces_are_cut_at_their_period(tmp_path: Path) -> None:
    """A whole sphere and a tube: the kernel's knots reach beyond the period."""
    import build123d

    from fabrication.surfaces_in.cad import read_cad_surface

    for solid, name in (
        (build123d.Solid.make_sphere(5000), "sphere.step"),
        (build123d.Solid.make_cylinder(2000, 3000), "tube.step"),
    ):
        face = max(solid.faces(), key=lambda f: f.area)
        build123d.export_step(face, str(tmp_path / name))
        surface = read_cad_surface(tmp_path / name)
        u0, u1, v0, v1 = surface.domain
        uv = np.random.default_rng(2).uniform(0.1, 0.9, (30, 2)) * [u1 - u0, v1 - v0] + [u0, v0]
        x = surface.points(uv)
        far = np.linalg.norm(x if name == "sphere.step" else x[:, :2], axis=1)
        assert far == pytest.approx(5000 if name == "sphere.step" else 2000)
