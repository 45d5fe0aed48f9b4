"""3MF straight from arrays: named, colored objects in millimetres, placed; and back to meshes.

Core specification 1.3: a zip with one model; `<object>` is a mesh, `<item>` places one.
"""

from __future__ import annotations

import io
import zipfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final
from xml.etree import ElementTree
from xml.sax.saxutils import quoteattr

import numpy as np

from ddgfab.errors import InputError
from ddgfab.io.atomic import atomic_write
from ddgfab.mesh import Floats
from fabrication.specs import Placement, TriangleMesh

LARGEST_MODEL: Final = 1_000_000_000
"""Greatest size [bytes] of the model inside a 3MF once unpacked."""

DECIMALS: Final = 6
"""Decimals of the coordinates [mm]: a nanometre, far below a printer and its slicer."""

ROTATION_DECIMALS: Final = 12
"""Decimals of the rotations of placed objects."""

NAMESPACE: Final = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"

Color = tuple[float, float, float]

_CORE: Final = f"{{{NAMESPACE}}}"
_MODEL: Final = "3D/3dmodel.model"
_DATE: Final = (1980, 1, 1, 0, 0, 0)  # the earliest of a zip: the same model, the same bytes
_RELATION: Final = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"
_PACKAGE: Final = "http://schemas.openxmlformats.org/package/2006"
_PROLOGUE: Final = '<?xml version="1.0" encoding="UTF-8"?>\n'
_TYPES: Final = (
    f'{_PROLOGUE}<Types xmlns="{_PACKAGE}/content-types">'
    '<Default Extension="rels" ContentType='
    '"application/vnd.openxmlformats-package.relationships+xml"/>'
    '<Default Extension="model" ContentType='
    '"application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>'
)
_RELATIONS: Final = (
    f'{_PROLOGUE}<Relationships xmlns="{_PACKAGE}/relationships">'
    f'<Relationship Target="/{_MODEL}" Id="rel0" Type="{_RELATION}"/></Relationships>'
)
_MILLIMETRES: Final = {
    "micron": 0.001,
    "millimeter": 1.0,
    "centimeter": 10.0,
    "inch": 25.4,
    "foot": 304.8,
    "meter": 1000.0,
}


@dataclass(frozen=True, eq=False)
class Body3MF:
    """An object of a 3MF: its name, mesh [mm] and color (sRGB, 0 to 1)."""

    name: str
    mesh: TriangleMesh
    color: Color = (0.75, 0.75, 0.75)


@dataclass(frozen=True, eq=False)
class Item3MF:
    """A placed object: which (position among the bodies), its mark, (4, 4) placement."""

    body: int
    mark: str
    placement: Placement


@dataclass(frozen=True, eq=False)
class Content3MF:
    """A 3MF read back, in millimetres.

    unit : of the file
    bodies : the meshes with their names; the color is not read
    placed : how often the build places each body, through components too
    """

    unit: str
    bodies: tuple[Body3MF, ...]
    placed: tuple[int, ...]


def threemf_bytes(
    bodies: Sequence[Body3MF], items: Sequence[Item3MF] | None = None, title: str = ""
) -> bytes:
    """A 3MF of meshes; the same input always gives the same bytes.

    Parameters
    ----------
    items : what is built, and where; by default every body once, as it lies
    """
    if items is None:
        items = [Item3MF(i, body.name, np.eye(4)) for i, body in enumerate(bodies)]
    colors = list(dict.fromkeys(_hex(body.color) for body in bodies))
    parts = [
        f'{_PROLOGUE}<model unit="millimeter" xml:lang="en-US" xmlns="{NAMESPACE}">\n'
        f'<metadata name="Title">{_text(title)}</metadata>\n'
        '<metadata name="Application">ddgfab</metadata>\n<resources>\n<basematerials id="1">'
    ]
    parts += [f'<base name="{color}" displaycolor="{color}"/>' for color in colors]
    parts.append("</basematerials>\n")
    for key, body in enumerate(bodies, 2):
        parts.append(
            f'<object id="{key}" type="model" name={quoteattr(body.name)} '
            f'pid="1" pindex="{colors.index(_hex(body.color))}">\n{_mesh_xml(body.mesh)}'
            "</object>\n"
        )
    parts.append("</resources>\n<build>\n")
    parts += [
        f'<item objectid="{item.body + 2}" partnumber={quoteattr(item.mark)} '
        f'transform="{_transform(item.placement)}"/>\n'
        for item in items
    ]
    parts.append("</build>\n</model>\n")
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in (
            ("[Content_Types].xml", _TYPES),
            ("_rels/.rels", _RELATIONS),
            (_MODEL, "".join(parts)),
        ):
            info = zipfile.ZipInfo(name, _DATE)
            info.compress_type = zipfile.ZIP_DEFLATED
            info.create_system = 3  # the same on every system
            archive.writestr(info, content.encode("utf-8"))
    return stream.getvalue()


def write_threemf(
    path: Path, bodies: Sequence[Body3MF], items: Sequence[Item3MF] | None = None
) -> None:
    """Write a 3MF (atomically); see `threemf_bytes`. The title is the file's stem.

    Raises
    ------
    OutputError
        The file cannot be written.
    """
    with atomic_write(path) as file:
        file.write(threemf_bytes(bodies, items, path.stem))


def read_threemf(path: Path) -> Content3MF:
    """The meshes of a 3MF's main model (core specification 1.3, chapters 3 and 4), unplaced.

    Placements are taken as rigid motions: the meshes are as they are written.

    Raises
    ------
    InputError
        Missing, no 3MF, or broken; names the file and what is wrong.
    """
    root = _model(path)
    unit = root.get("unit", "millimeter")
    if unit not in _MILLIMETRES:
        raise InputError(f"3MF with the unknown unit {unit!r}", file=str(path))
    placed: dict[str, int] = {}
    components: dict[str, list[str]] = {}
    meshes: dict[str, Body3MF] = {}
    for item in root.iterfind(f"{_CORE}resources/{_CORE}object"):
        key = item.get("id", "")
        mesh = item.find(f"{_CORE}mesh")
        if mesh is not None:
            meshes[key] = Body3MF(item.get("name", ""), _mesh(mesh, _MILLIMETRES[unit], path))
        components[key] = [
            part.get("objectid", "")
            for part in item.iterfind(f"{_CORE}components/{_CORE}component")
        ]
    for build in root.iterfind(f"{_CORE}build/{_CORE}item"):
        placed[build.get("objectid", "")] = placed.get(build.get("objectid", ""), 0) + 1
    order = {key: at for at, key in enumerate(components)}
    for key in reversed(components):
        for part in components[key]:
            if order.get(part, len(order)) >= order[key]:
                raise InputError(
                    f"3MF object {key} has a part {part} that does not come before it",
                    file=str(path),
                )
            placed[part] = placed.get(part, 0) + placed.get(key, 0)
    return Content3MF(unit, tuple(meshes.values()), tuple(placed.get(key, 0) for key in meshes))


# --- writing -------------------------------------------------------------------------------------
def _mesh_xml(mesh: TriangleMesh) -> str:
    """A `<mesh>`; one format for all vertices is several times faster than one each."""
    point = " ".join(f'{axis}="%.{DECIMALS}f"' for axis in "xyz")
    # Rounded first and with 0 added, so that no coordinate is "-0.000000".
    points = (np.round(mesh.vertices, DECIMALS) + 0.0).ravel().tolist()
    corners = mesh.triangles.ravel().tolist()
    vertices = f"<vertex {point}/>\n" * len(mesh.vertices) % tuple(points)
    triangle = '<triangle v1="%d" v2="%d" v3="%d"/>\n'
    triangles = triangle * len(mesh.triangles) % tuple(corners)
    points_xml = f"<vertices>\n{vertices}</vertices>\n"
    return f"<mesh>\n{points_xml}<triangles>\n{triangles}</triangles>\n</mesh>\n"


def _transform(placement: Placement) -> str:
    """The twelve numbers of a placement: 3MF multiplies row vectors, so transposed."""
    turn = np.round(placement[:3, :3].T, ROTATION_DECIMALS).ravel() + 0.0
    shift = np.round(placement[:3, 3], DECIMALS) + 0.0
    return " ".join(f"{value:.15g}" for value in [*turn.tolist(), *shift.tolist()])


def _hex(color: Color) -> str:
    return "#" + "".join(f"{round(255 * channel):02X}" for channel in color)


def _text(text: str) -> str:
    return quoteattr(text)[1:-1]


# --- reading -------------------------------------------------------------------------------------
def _model(path: Path) -> ElementTree.Element:
    """The root of a 3MF's main model; refused when it declares entities or unpacks to too much."""
    try:
        with zipfile.ZipFile(path) as archive:
            info = archive.getinfo(_MODEL)
            if info.file_size > LARGEST_MODEL:
                raise InputError(
                    f"3MF model of {info.file_size} bytes; the limit is {LARGEST_MODEL}",
                    file=str(path),
                )
            data = archive.read(info)
        if b"<!DOCTYPE" in data or b"<!ENTITY" in data:
            raise InputError("3MF with a document type: refused", file=str(path))
        return ElementTree.fromstring(data)
    except (OSError, zipfile.BadZipFile, KeyError, ElementTree.ParseError) as error:
        raise InputError(f"not a readable 3MF file ({error})", file=str(path)) from error


def _mesh(element: ElementTree.Element, scale: float, path: Path) -> TriangleMesh:
    """A 3MF mesh in millimetres."""
    try:
        vertices: Floats = scale * np.array(
            [
                [float(v.attrib[axis]) for axis in "xyz"]
                for v in element.iterfind(f"{_CORE}vertices/{_CORE}vertex")
            ]
        ).reshape(-1, 3)
        triangles = np.array(
            [
                [int(t.attrib[corner]) for corner in ("v1", "v2", "v3")]
                for t in element.iterfind(f"{_CORE}triangles/{_CORE}triangle")
            ],
            dtype=np.int64,
        ).reshape(-1, 3)
    except (KeyError, ValueError) as error:
        raise InputError(f"3MF with a bad vertex or triangle ({error})", file=str(path)) from error
    if len(triangles) and not 0 <= triangles.min() <= triangles.max() < len(vertices):
        raise InputError(
            f"3MF triangle names vertex {triangles.max()}; there are {len(vertices)}",
            file=str(path),
        )
    if not np.isfinite(vertices).all():
        raise InputError("3MF with a coordinate that is not finite", file=str(path))
    return TriangleMesh(vertices, triangles)
