"""3MF straight from arrays: named, colored objects in millimeters, placed.

Core specification 1.3: a zip with one model; `<object>` is a mesh, `<item>` places one. Triangles
that no support may touch carry the mark by which PrusaSlicer paints them; other readers skip it.
"""

from __future__ import annotations

import io
import zipfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final
from xml.sax.saxutils import quoteattr

import numpy as np
from numpy.typing import NDArray

from ddgfab.io.atomic import atomic_write
from fabrication.specs import Color, Placement, TriangleMesh

DECIMALS: Final = 6
"""Decimals of the coordinates [mm]: a nanometre, far below a printer and its slicer."""

ROTATION_DECIMALS: Final = 12
"""Decimals of the rotations of placed objects."""

NAMESPACE: Final = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"

PAINT_NAMESPACE: Final = "http://schemas.slic3r.org/3mf/2017/06"
"""Of what PrusaSlicer adds to 3MF."""

BLOCKED: Final = ' slic3rpe:custom_supports="8"'
"""A triangle from which no support grows (PrusaSlicer: a painted support blocker)."""

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


@dataclass(frozen=True, eq=False)
class Body3MF:
    """An object of a 3MF: its name, mesh [mm] and color (sRGB, 0 to 1).

    unsupported : (m,) whether slicers are told to put no support on a triangle; None for nowhere
    """

    name: str
    mesh: TriangleMesh
    color: Color = (0.75, 0.75, 0.75)
    unsupported: NDArray[np.bool_] | None = None


@dataclass(frozen=True, eq=False)
class Item3MF:
    """A placed object: which (position among the bodies), its mark, (4, 4) placement."""

    body: int
    mark: str
    placement: Placement


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
    painted = any(body.unsupported is not None for body in bodies)
    paint = f' xmlns:slic3rpe="{PAINT_NAMESPACE}"' if painted else ""
    colors = list(dict.fromkeys(_hex(body.color) for body in bodies))
    parts = [
        f'{_PROLOGUE}<model unit="millimeter" xml:lang="en-US" xmlns="{NAMESPACE}"{paint}>\n'
        f'<metadata name="Title">{_text(title)}</metadata>\n'
        '<metadata name="Application">ddgfab</metadata>\n<resources>\n<basematerials id="1">'
    ]
    parts += [f'<base name="{color}" displaycolor="{color}"/>' for color in colors]
    parts.append("</basematerials>\n")
    for key, body in enumerate(bodies, 2):
        parts.append(
            f'<object id="{key}" type="model" name={quoteattr(body.name)} '
            f'pid="1" pindex="{colors.index(_hex(body.color))}">\n{_mesh_xml(body)}'
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


def _mesh_xml(body: Body3MF) -> str:
    """A `<mesh>`; one format for all vertices is several times faster than one each."""
    mesh = body.mesh
    point = " ".join(f'{axis}="%.{DECIMALS}f"' for axis in "xyz")
    # Rounded first and with 0 added, so that no coordinate is "-0.000000".
    points = (np.round(mesh.vertices, DECIMALS) + 0.0).ravel().tolist()
    corners = mesh.triangles.ravel().tolist()
    vertices = f"<vertex {point}/>\n" * len(mesh.vertices) % tuple(points)
    triangle = '<triangle v1="%d" v2="%d" v3="%d"{}/>\n'
    kinds = triangle.format(""), triangle.format(BLOCKED)
    if body.unsupported is None:
        rows = kinds[0] * len(mesh.triangles)
    else:
        rows = "".join(kinds[blocked] for blocked in body.unsupported.tolist())
    triangles = rows % tuple(corners)
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
