"""Rhino: model.3dm, a block for each part number, an instance for each piece, layers by role."""

from __future__ import annotations

import io
import json
import sys
from pathlib import Path
from typing import Any, Final

import numpy as np

from ddgfab.errors import InputError, KernelError, clipped
from ddgfab.io.regular import read_regular
from fabrication.formats.base import FAILED_COLOR, REJECTED_KIND, Contents, Format, Part, Whole
from fabrication.meshes_in.rhino import in_child, limit_memory, model_of
from fabrication.specs import Check, Color, Kind, Placement, TriangleMesh

MODEL: Final = "model.3dm"
"""Name of the file of the whole."""

VERSION: Final = 7
"""Rhino versions from this one on read the file."""

LIMIT_BYTES: Final = 1 << 30
"""Larger files are not read back."""

PLACED: Final = 1e-9
"""How far [mm] an instance may stand from where its piece does, at 1 mm from the origin."""


class Rhino(Format):
    """3DM: meshes as blocks, pieces as their instances with user text.

    The file has ids and a date of its own in every run: it is not the same byte by byte. It cannot
    be inspected: a damaged one may end the process that reads it.
    """

    name = "3dm"
    suffixes = (".3dm",)
    needs = {"rhino3dm": "rhino3dm"}  # noqa: RUF012
    libraries = ("rhino3dm",)

    def whole_files(self, contents: Contents) -> list[str]:
        """model.3dm."""
        return [MODEL]

    def write_whole(self, folder: Path, whole: Whole) -> list[str]:
        """Every part number as a block of its mesh, every piece as an instance of it.

        Raises
        ------
        KernelError
            rhino3dm refused a part, or the file.
        """
        model = _Model(whole)
        for number, mark, placement in whole.standing():
            model.piece(whole.parts[number], mark, placement)
        if not model.file.Write(str(folder / MODEL), VERSION):
            raise KernelError(f"rhino3dm cannot write {MODEL}")
        return []

    def check_whole(self, folder: Path, whole: Whole) -> list[Check]:
        """Read back: every piece once, of its number, on its layer, where it was placed."""
        try:
            found = read_pieces(folder / MODEL)
        except InputError as error:
            return [Check("3dm readable", False, str(error))]
        wanted = list(whole.standing())
        wrong, away = 0, 0.0
        for number, mark, placement in wanted:
            layer = _kind_of(whole, whole.parts[number], mark).layer
            block, on, at = found.get(mark, ("", "", placement))
            wrong += (block, on) != (number, layer)
            size = max(1.0, float(np.abs(placement[:3, 3]).max()))
            off = float(np.abs(at - placement).max()) / size
            away = max(away, off if off < np.inf else np.inf)  # what is no number is far away
        return [
            Check("3dm readable", True),
            Check("3dm pieces", len(found) == len(wanted), float(len(found)), float(len(wanted))),
            Check("3dm numbers", wrong == 0, float(wrong), 0.0),
            Check("3dm positions", away <= PLACED, away, PLACED),
        ]


FORMAT: Final = Rhino()


def read_pieces(path: Path) -> dict[str, tuple[str, str, Placement]]:
    """Block, layer and placement [units of the file] of every instance, by its name.

    The library that reads the format runs in a process of its own: a damaged file can end that
    process, not this one.

    Raises
    ------
    InputError
        Missing, too large, not a Rhino file, or damaged.
    """
    data = read_regular(path, LIMIT_BYTES, InputError, what="a Rhino file", advice="split it")
    found = in_child(data, str(path), __name__)
    names = json.loads(str(found["names"]))
    pieces = {}
    for (name, block, layer), at in zip(names, found["at"], strict=True):
        if name in pieces:
            text = f"{clipped(name)} is the name of several instances"
            raise InputError(text, file=str(path))
        pieces[name] = (block, layer, at)
    return pieces


def main() -> None:
    """Read a Rhino file from standard input, and write its instances to standard output."""
    limit_memory()
    model = model_of(sys.stdin.buffer.read())
    layers = [layer.Name for layer in model.Layers]
    names, places = [], [np.empty((0, 4, 4))]
    for item in model.Objects:
        shape = item.Geometry
        if type(shape).__name__ != "InstanceReference":
            continue
        block = model.InstanceDefinitions.FindId(shape.ParentIdefId)
        index = item.Attributes.LayerIndex
        layer = layers[index] if 0 <= index < len(layers) else ""
        names.append((item.Attributes.Name, "" if block is None else block.Name, layer))
        at = [[getattr(shape.Xform, f"M{i}{j}") for j in range(4)] for i in range(4)]
        places.append(np.array([at], dtype=np.float64))
    out = io.BytesIO()
    np.savez(out, names=np.array(json.dumps(names)), at=np.concatenate(places))
    sys.stdout.buffer.write(out.getvalue())


class _Model:
    """The file being made."""

    def __init__(self, whole: Whole) -> None:
        import rhino3dm

        self.rhino: Any = rhino3dm
        self.whole, self.file = whole, self.rhino.File3dm()
        self.file.ApplicationName = "ddgfab"
        self.file.Settings.ModelUnitSystem = rhino3dm.UnitSystem.Millimeters
        self.file.Settings.ModelAbsoluteTolerance = 0.001
        self._layers: dict[str, int] = {}
        self._blocks: dict[str, Any] = {}
        for k, remark in enumerate(whole.about.remarks):
            self.file.Strings[f"ddgfab remark {k + 1}"] = remark

    def piece(self, part: Part, mark: str, placement: Placement) -> None:
        """An instance of the part's block."""
        kind = _kind_of(self.whole, part, mark)
        attributes = self.rhino.ObjectAttributes()
        attributes.Name = mark
        attributes.LayerIndex = self._layer(kind)
        texts = {
            "mark": mark,
            "number": part.number,
            "role": part.kind.role,
            "mass_kg": f"{part.mass:.6g}",
            "material": part.material.name,
            "status": "rejected" if mark in self.whole.failed else "ok",
        }
        for key, text in texts.items():
            attributes.SetUserString(key, text)
        motion = self.rhino.Transform(1.0)
        for i, row in enumerate(np.asarray(placement)[:3].tolist()):
            for j, value in enumerate(row):
                setattr(motion, f"M{i}{j}", value)
        reference = self.rhino.InstanceReference(self._block(part), motion)
        self.file.Objects.AddInstanceObject(reference, attributes)

    def _layer(self, kind: Kind) -> int:
        """The layer of a kind, by its name."""
        if kind.layer not in self._layers:
            layer = self.rhino.Layer()
            layer.Name = kind.layer
            layer.Color = _color(FAILED_COLOR if kind == REJECTED_KIND else kind.color)
            self._layers[kind.layer] = self.file.Layers.Add(layer)
        return self._layers[kind.layer]

    def _block(self, part: Part) -> Any:
        """Id of the block of a part number."""
        if part.number not in self._blocks:
            attributes = self.rhino.ObjectAttributes()
            attributes.Name = part.number
            attributes.LayerIndex = self._layer(part.kind)
            # By the layer of the instance, so that those that failed are red.
            attributes.ColorSource = self.rhino.ObjectColorSource.ColorFromParent
            index = self.file.InstanceDefinitions.Add(
                part.number,
                f"{part.kind.role} {part.number}",
                "",
                "",
                self.rhino.Point3d(0.0, 0.0, 0.0),
                (_mesh(self.rhino, part.mesh),),
                (attributes,),
            )
            if index < 0:
                raise KernelError(f"rhino3dm refused {part.number}")
            self._blocks[part.number] = self.file.InstanceDefinitions.FindIndex(index).Id
        return self._blocks[part.number]


def _kind_of(whole: Whole, part: Part, mark: str) -> Kind:
    return REJECTED_KIND if mark in whole.failed else part.kind


def _color(color: Color) -> tuple[int, int, int, int]:
    red, green, blue = (round(255.0 * value) for value in color)
    return (red, green, blue, 255)


def _mesh(rhino: Any, mesh: TriangleMesh) -> Any:
    made = rhino.Mesh()
    for x, y, z in mesh.vertices.tolist():
        made.Vertices.Add(x, y, z)
    for a, b, c in mesh.triangles.tolist():
        made.Faces.AddFace(a, b, c)
    made.Normals.ComputeNormals()
    return made
