"""Checks of written files: STEP, STL and 3MF read back and compared with what went in."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np

from ddgfab.errors import InputError
from ddgfab.mesh import Floats, Ints
from fabrication.checks.mesh import measure_mesh
from fabrication.checks.solid import SolidReport, inspect_solid
from fabrication.formats.step.xcaf import components, free_labels, get_name, read_document
from fabrication.formats.stl import read_stl
from fabrication.formats.threemf import DECIMALS
from fabrication.specs import Check, TriangleMesh

FILE_VOLUME_RELATIVE: Final = 1e-6
"""How far a volume read back may be from the one written, relative to it: STEP's digits, and the
reader's own curves on cylinders (5.6e-8 on a coped tee, 2.6e-7 on a part made by booleans)."""

STEP_UNIT: Final = "millimetre"
"""The length unit of every STEP file that we write, as OCCT's reader names it."""

STL_ROUNDING: Final = 2.0**-23
"""Greatest rounding of a coordinate in an STL (single precision), relative to its size."""

THREEMF_DECIMAL: Final = 0.5 * 10.0**-DECIMALS
"""How far [mm] a coordinate in a 3MF may be rounded; lib3mf then reads single precision."""


@dataclass(frozen=True)
class StepProduct:
    """A product read back: its name, what the kernel says of its shape, its color and layers."""

    name: str
    report: SolidReport


@dataclass(frozen=True, eq=False)
class StepContent:
    """A STEP file read back.

    products : one for each distinct part
    instances : (product name, component name, (4, 4) placement in the root's frame)
    unit : length unit of the file, "millimetre" for ours; several are joined by commas
    """

    products: tuple[StepProduct, ...]
    instances: tuple[tuple[str, str, Floats], ...]
    unit: str


def read_step(path: Path, *, validate: bool = True) -> StepContent:
    """Read a STEP file with OCCT's XCAF reader and measure each product once.

    Without `validate` the products go without BRepCheck.

    The reader mends small faults on the way (tolerances, a shell that is inside out), so a product
    is called valid as this reader sees it.

    Raises
    ------
    InputError
        Missing, truncated or not STEP.
    """
    document, units = read_document(path)
    products: dict[str, StepProduct] = {}
    instances: list[tuple[str, str, Floats]] = []
    for label in free_labels(document):
        _walk(label, np.eye(4), get_name(label), products, instances, validate)
    return StepContent(tuple(products.values()), tuple(instances), ", ".join(units))


def check_step_part(
    path: Path, *, number: str, volume: float, relative: float = FILE_VOLUME_RELATIVE
) -> list[Check]:
    """The checks of one part number's STEP file, read back.

    Parameters
    ----------
    number : the part number, that is the product's name
    volume : [mm3] of the solid that was written

    Returns
    -------
    Checks "file readable", and if it is, "file one solid", "file valid" (closed, BRepCheck),
    "file name", "file unit", "file volume" (relative deviation).
    """
    try:
        content = read_step(path)
    except InputError as error:
        return [Check("file readable", False, str(error))]
    solids = sum(product.report.solids for product in content.products)
    total = sum(product.report.volume for product in content.products)
    sound = all(p.report.valid and p.report.closed for p in content.products)
    names = ", ".join(product.name for product in content.products)
    deviation = abs(total - volume) / max(abs(volume), 1e-300)
    return [
        Check("file readable", True),
        Check("file one solid", solids == 1 == len(content.products), float(solids), 1.0),
        Check("file valid", bool(content.products) and sound),
        Check("file name", names == number, names, number),
        Check("file unit", content.unit == STEP_UNIT, content.unit, STEP_UNIT),
        Check("file volume", total > 0 and deviation <= relative, deviation, relative),
    ]


def check_stl_part(path: Path, mesh: TriangleMesh) -> list[Check]:
    """The checks of one part number's STL file, read back and compared with the mesh written.

    Returns
    -------
    Checks "stl readable", and if it is, "stl triangles" (count), "stl watertight" (open edges after
    welding equal corners), "stl corners" (greatest distance [mm], against single precision).
    """
    try:
        back = read_stl(path)
    except InputError as error:
        return [Check("stl readable", False, str(error))]
    count, expected = len(back.triangles), len(mesh.triangles)
    checks = [
        Check("stl readable", True),
        Check("stl triangles", count == expected, float(count), float(expected)),
    ]
    open_edges = measure_mesh(back).open_edges
    checks.append(Check("stl watertight", count > 0 and open_edges == 0, float(open_edges), 0.0))
    if count == expected and count:
        away = float(np.abs(back.vertices[back.triangles] - mesh.vertices[mesh.triangles]).max())
        limit = STL_ROUNDING * float(np.abs(mesh.vertices).max())
        checks.append(Check("stl corners", away <= limit, away, limit))
    return checks


def check_threemf(path: Path, expected: Sequence[tuple[str, TriangleMesh, int]]) -> list[Check]:
    """The checks of one 3MF file, read back by lib3mf and compared with the meshes written.

    Parameters
    ----------
    expected : the objects in their order: name, mesh [mm], how often it is placed

    Returns
    -------
    Checks "3mf readable", and if it is, "3mf objects" (names in their order), "3mf unit",
    "3mf manifold" (lib3mf: manifold and oriented), "3mf instances", and where the counts agree
    "3mf corners" (greatest distance [mm] of a corner, against single precision).
    """
    import lib3mf

    wrapper = lib3mf.get_wrapper()
    model = wrapper.CreateModel()
    reader = model.QueryReader("3mf")
    reader.SetStrictModeActive(True)
    try:
        reader.ReadFromFile(str(path))
    except lib3mf.ELib3MFException as error:
        return [Check("3mf readable", False, str(error))]
    warnings = "; ".join(reader.GetWarning(i)[1] for i in range(reader.GetWarningCount()))
    objects, unit = _mesh_objects(model), model.GetUnit() == lib3mf.ModelUnit.MilliMeter
    names = [found.GetName() for found in objects]
    wanted = [name for name, _, _ in expected]
    sound = all(found.IsManifoldAndOriented() for found in objects)
    build = model.GetBuildItems()
    placed = [0] * len(objects)
    keys = [found.GetResourceID() for found in objects]
    while build.MoveNext():
        placed[keys.index(build.GetCurrent().GetObjectResourceID())] += 1
    counts = [count for _, _, count in expected]
    checks = [
        Check("3mf readable", not warnings, warnings or None),
        Check("3mf objects", names == wanted, ", ".join(names), ", ".join(wanted)),
        Check("3mf unit", unit, None, "millimetre"),
        Check("3mf manifold", bool(objects) and sound),
        Check("3mf instances", placed == counts, float(sum(placed)), float(sum(counts))),
    ]
    meshes = [mesh for _, mesh, _ in expected]
    away = limit = 0.0
    for found, mesh in zip(objects, meshes, strict=False):
        vertices, triangles = _lib3mf_mesh(found)
        if vertices.shape != mesh.vertices.shape or not np.array_equal(triangles, mesh.triangles):
            away = np.inf
            break
        away = max(away, float(np.abs(vertices - mesh.vertices).max()))
        single = STL_ROUNDING * float(np.abs(mesh.vertices).max())
        limit = max(limit, THREEMF_DECIMAL + single)
    checks.append(Check("3mf corners", away <= limit, away, limit))
    return checks


def _mesh_objects(model: Any) -> list[Any]:
    """The mesh objects of a lib3mf model in their order."""
    objects, found = model.GetMeshObjects(), []
    while objects.MoveNext():
        found.append(objects.GetCurrentMeshObject())
    return found


def _lib3mf_mesh(body: Any) -> tuple[Floats, Ints]:
    """(n, 3) vertices and (m, 3) triangles of a lib3mf mesh object."""
    vertices = np.array([list(point.Coordinates) for point in body.GetVertices()])
    triangles = np.array([list(corner.Indices) for corner in body.GetTriangleIndices()])
    return vertices.reshape(-1, 3), triangles.reshape(-1, 3)


def _walk(
    label: Any,
    motion: Floats,
    name: str,
    products: dict[str, StepProduct],
    instances: list[tuple[str, str, Floats]],
    validate: bool,
) -> None:
    """Collect products and placed instances below a label."""
    from OCP.XCAFDoc import XCAFDoc_ShapeTool

    if XCAFDoc_ShapeTool.IsAssembly_s(label):
        for component, target in components(label):
            placed = motion @ matrix(XCAFDoc_ShapeTool.GetLocation_s(component))
            _walk(target, placed, get_name(component), products, instances, validate)
        return
    product = get_name(label)
    instances.append((product, name, motion))
    entry = str(label.Tag())
    if entry not in products:
        shape = XCAFDoc_ShapeTool.GetShape_s(label)
        products[entry] = StepProduct(product, inspect_solid(shape, validate=validate))


def matrix(location: Any) -> Floats:
    """The (4, 4) matrix of a TopLoc_Location."""
    motion = location.Transformation()
    result = np.eye(4)
    result[:3] = [[motion.Value(i, j) for j in range(1, 5)] for i in range(1, 4)]
    return result
