"""A small sound file of every kind that some command reads, and things that are no files."""

from __future__ import annotations

import gzip
import os
import shutil
from functools import cache
from pathlib import Path
from tempfile import mkdtemp
from typing import Any

import numpy as np
from export_files import text_stl, written
from mesh_files import meshes
from projects import ROOF, RULES
from roofs import barrel, hexagons

from ddgfab.forms import generate
from ddgfab.io import write_mesh
from fabrication.formats.step.circles import write_step_circles

DEVICES = ("/dev/zero", "/dev/null", "/dev/full", "/proc/self/maps", "/proc/kmsg", "/", "/dev/fd")


@cache
def folder() -> Path:
    """A folder with all of them; the files are made once in a process."""
    place = Path(mkdtemp(prefix="inputs-"))
    roof = barrel(2, 2)
    scan, knet = barrel(7, 7), generate("knet", {}, place)
    found = {**meshes(), "roof": roof, "cells": hexagons(), "scan": scan, "knet": knet}
    for name, mesh in found.items():
        write_mesh(place / f"{name}.obj", mesh, units="mm")
    write_mesh(place / "scan.off", scan, units="mm")
    for suffix in (".off", ".ply"):
        write_mesh(place / f"roof{suffix}", roof, units="m")
    (place / "roof.obj.gz").write_bytes(gzip.compress((place / "roof.obj").read_bytes()))
    (place / "東京.obj").write_bytes((place / "roof.obj").read_bytes())
    (place / "roof.toml").write_text(ROOF)
    (place / "rules.toml").write_text(ROOF + RULES)
    (place / "surface.toml").write_text('[net]\nkind = "surface"\nsurface = "dome"\n')
    (place / "kit.toml").write_text('[linkage]\nkind = "bennett"\n')
    (place / "scan.toml").write_text('[net]\nkind = "surface"\nfile = "patch.step"\n')
    _exports(place)
    _curves(place)
    _surfaces(place)
    (place / "empty.obj").write_bytes(b"")
    (place / "empty.toml").write_bytes(b"")
    (place / "empty.step").write_bytes(b"")
    (place / "folder.obj").mkdir()
    for suffix in (".obj", ".toml", ".step", ".csv", ".3dm", ".dxf"):
        if hasattr(os, "mkfifo"):
            os.mkfifo(place / f"pipe{suffix}")
        (place / f"link{suffix}").symlink_to("/dev/zero")
    return place


def names() -> tuple[str, ...]:
    """Names of the files, of one that is not there, and of devices."""
    there = sorted(str(p.relative_to(folder())) for p in folder().iterdir())
    return (*there, "missing.obj", "missing.step", "a/b.toml", *DEVICES)


def copied(place: Path) -> None:
    """Fill a folder with them."""
    for path in folder().iterdir():
        if path.is_symlink():
            (place / path.name).symlink_to(path.readlink())
        elif path.is_dir():
            shutil.copytree(path, place / path.name)
        elif path.is_file():
            shutil.copy2(path, place / path.name)
        else:
            os.mkfifo(place / path.name)


def _exports(place: Path) -> None:
    sound, _, parts = written()
    shutil.copytree(sound / "schedules", place / "schedules")
    for path in sound.iterdir():
        if path.is_file():
            shutil.copy2(path, place / path.name)
    shutil.copy2(place / "schedules" / "panels.csv", place / "panels.csv")
    shutil.copy2(place / "schedules" / "schedule.xlsx", place / "schedule.xlsx")
    (place / "text.stl").write_bytes(text_stl(parts["stl"]))


def _curves(place: Path) -> None:
    import ezdxf

    x = np.linspace(0, 4000, 9)
    points = np.stack([x, 300 * np.sin(x / 1e3), 0 * x], axis=1).tolist()
    drawing = ezdxf.new()
    drawing.modelspace().add_polyline3d(points)
    drawing.modelspace().add_circle((1000, 1000), 500)
    drawing.modelspace().add_spline(points)
    drawing.saveas(place / "curves.dxf")
    rows = "".join(f"v {a} {b} {c}\n" for a, b, c in points)
    (place / "curves.obj").write_text(rows + "l " + " ".join(map(str, range(1, 10))) + "\n")
    (place / "curves.csv").write_text("".join(f"{a},{b},{c}\n" for a, b, c in points))


def _surfaces(place: Path) -> None:
    """A patch as STEP, IGES and Rhino file, two faces, a solid, and circles."""
    import build123d
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace
    from OCP.Geom import Geom_BezierSurface
    from OCP.gp import gp_Pnt
    from OCP.IGESControl import IGESControl_Writer
    from OCP.TColgp import TColgp_Array2OfPnt

    poles = TColgp_Array2OfPnt(1, 4, 1, 4)
    for i in range(4):
        for j in range(4):
            poles.SetValue(i + 1, j + 1, gp_Pnt(*_pole(i, j)))
    face = build123d.Face(BRepBuilderAPI_MakeFace(Geom_BezierSurface(poles), 1e-6).Face())
    build123d.export_step(face, str(place / "patch.step"))
    parts = [face, face.moved(build123d.Location((6000, 0, 0)))]
    parts[0].label, parts[1].label = "west", "east"
    build123d.export_step(build123d.Compound(children=parts), str(place / "two.step"))
    build123d.export_step(build123d.Solid.make_box(50, 60, 70), str(place / "box.step"))
    writer = IGESControl_Writer()
    writer.AddShape(face.wrapped)
    writer.Write(str(place / "patch.iges"))
    (place / "patch.3dm").write_bytes(rhino())
    write_step_circles(place / "circles.step", _circles())


def _pole(i: int, j: int) -> tuple[float, float, float]:
    """A control point [mm] of 4 x 4 of a dome with four corners."""
    return 2e3 * i, 2e3 * j, 700.0 * i * (3 - i) + 400.0 * j * (3 - j)


def _circles() -> Any:
    from ddgfab.nets.sisothermic import SIsothermic

    return SIsothermic.of(generate("koebe", {}, Path())).curves()


def rhino() -> bytes:
    """A Rhino file with a NURBS surface, a polysurface, a mesh and a curve."""
    import rhino3dm

    model = rhino3dm.File3dm()
    model.Settings.ModelUnitSystem = rhino3dm.UnitSystem.Millimeters
    surface = rhino3dm.NurbsSurface.Create(3, False, 4, 4, 4, 4)
    for i in range(4):
        for j in range(4):
            surface.Points[i, j] = rhino3dm.Point4d(*_pole(i, j), 1.0)
    for knots in (surface.KnotsU, surface.KnotsV):
        for k in range(6):
            knots[k] = 0.0 if k < 3 else 1.0
    model.Objects.AddSurface(surface)
    model.Objects.AddSphere(rhino3dm.Sphere(rhino3dm.Point3d(2e4, 0, 0), 5e3))
    with_name = Path(mkdtemp(prefix="rhino-"), "a.3dm")
    model.Write(str(with_name), 7)
    return with_name.read_bytes()
