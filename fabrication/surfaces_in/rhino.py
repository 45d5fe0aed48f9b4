"""Surfaces of Rhino files (.3dm): NURBS surfaces, and faces of polysurfaces with their trims."""

from __future__ import annotations

import io
import json
import sys
from pathlib import Path
from typing import Any, Final

import numpy as np

from ddgfab.errors import InputError, clipped
from ddgfab.io.load import LIMIT_BYTES
from ddgfab.io.regular import read_regular
from ddgfab.io.units import FACTORS
from ddgfab.mesh import Floats
from ddgfab.surfaces.nearest import nearest_points
from ddgfab.surfaces.spline import SplineSurface
from ddgfab.surfaces.trim import polygon_area
from fabrication.meshes_in.rhino import UNITS, in_child, limit_memory, model_of, require_reader
from fabrication.surfaces_in.choice import FaceChoice, chosen, patch_name
from fabrication.surfaces_in.loops import CURVE_POINTS, closed_loop, thinned

_OFF: Final = 1e-3
"""Edges may lie this far from their face, as a part of its size."""


def has_surfaces(path: Path) -> bool:
    """Whether a Rhino file holds NURBS surfaces or polysurfaces.

    Raises
    ------
    InputError
        As `read_rhino_surfaces`.
    """
    return bool(_about(_read(path))["faces"])


def read_rhino_surfaces(path: Path, faces: FaceChoice = None) -> list[SplineSurface]:
    """Faces of the surfaces, polysurfaces and extrusions of a Rhino file [mm].

    Faces are named as the object they belong to. Trimming curves are the edges in space, laid on
    the face.

    Raises
    ------
    InputError
        The library is missing, the file is not a Rhino file or damaged, holds no surface or states
        no unit; faces as `chosen`; a face that is closed and trimmed, or whose edges lie off it.

    Source: openNURBS, `ON_Brep` and `ON_NurbsSurface`, read by rhino3dm.
    """
    found = _read(path)
    about = _about(found)
    rows = about["faces"]
    file = str(path)
    if not rows:
        raise InputError("holds no NURBS surface", file=file)
    if about["unit"] not in UNITS:
        raise InputError(
            f"its unit ({about['unit']}) is none of {', '.join(UNITS.values())}: set the unit of "
            "the model in Rhino and save again",
            file=file,
        )
    factor = FACTORS[UNITS[about["unit"]]]
    names = [(row["name"],) if row["name"] else () for row in rows]
    areas = [factor**2 * _size2(found[f"control{k}"]) for k in range(len(rows))]
    out = []
    for k in chosen(names, areas, faces, file):
        name = patch_name(path.name, k, names[k] if len(rows) > 1 else ())
        out.append(_surface(found, rows[k], k, factor, name))
    return out


def _read(path: Path) -> dict[str, Any]:
    require_reader(str(path))
    data = read_regular(
        path, LIMIT_BYTES, InputError, what="a Rhino file", advice="export the surfaces alone"
    )
    return in_child(data, str(path), __name__)


def _about(found: dict[str, Any]) -> dict[str, Any]:
    about: dict[str, Any] = json.loads(str(found["about"]))
    return about


def _size2(control: Floats) -> float:
    """About the area of a patch: that of its net of control points."""
    points = control[..., :3] / control[..., 3:]
    one, two = np.diff(points, axis=0)[:, :-1], np.diff(points, axis=1)[:-1]
    return float(np.linalg.norm(np.cross(one, two), axis=2).sum())


def _surface(
    found: dict[str, Any], row: dict[str, Any], number: int, factor: float, name: str
) -> SplineSurface:
    control = found[f"control{number}"]
    weights = control[..., 3]
    points = factor * control[..., :3] / weights[..., None]
    knots = [found[f"u{number}"], found[f"v{number}"]]
    knots = [np.concatenate([k[:1], k, k[-1:]]) for k in knots]  # Rhino leaves out the outermost
    degrees = row["degrees"][0], row["degrees"][1]
    plain = np.ptp(weights) <= 1e-14 * weights.max()
    whole = SplineSurface(points, knots, degrees, None if plain else weights, name=name)
    edges = [factor * found[f"edge{number}.{k}"] for k in range(row["edges"])]
    loops = None
    if row["loops"]:
        if any(row["closed"]):
            raise InputError(
                f"{name}: is closed and trimmed: its edges do not tell the side of the seam\n"
                "split it in Rhino (SplitAtSeam or Split by isocurve) and save again"
            )
        loops = [
            _loop(whole, [edges[k] if ahead else edges[k][::-1] for k, ahead in loop])
            for loop in row["loops"]
        ]
        loops = [loop for k, loop in enumerate(loops) if k == 0 or abs(polygon_area(loop)) > 0]
    if row["reversed"]:  # the same side as in the file: exchange u and v
        points, weights = points.transpose(1, 0, 2), weights.T
        knots, degrees = knots[::-1], degrees[::-1]
        loops = None if loops is None else [loop[:, ::-1] for loop in loops]
    return SplineSurface(points, knots, degrees, None if plain else weights, loops, name=name)


def _loop(surface: SplineSurface, edges: list[Floats]) -> Floats:
    """(m, 2) parameters of a trimming loop from the points of its edges."""
    size = float(np.ptp(surface.control.reshape(-1, 3), axis=0).max())
    parts = []
    for edge in edges:
        laid = nearest_points(surface, edge)
        worst = int(laid.distance.argmax())
        if laid.distance[worst] > _OFF * size:
            x, y, z = edge[worst]
            raise InputError(
                f"{surface.name}: an edge lies {laid.distance[worst]:.3g} mm off its face at "
                f"({x:.6g}, {y:.6g}, {z:.6g}) (limit {_OFF * size:.3g})\nrebuild the edges in "
                "Rhino (RebuildEdges)"
            )
        parts.append(thinned(laid.uv))
    u0, u1, v0, v1 = surface.domain
    return closed_loop(parts, [(u0, u1), (v0, v1)])


def main() -> None:
    """Child process: a file on standard input, its faces as arrays on standard output."""
    limit_memory()
    import rhino3dm

    model = model_of(sys.stdin.buffer.read())
    rows: list[dict[str, Any]] = []
    arrays: dict[str, Any] = {}
    for item in model.Objects:
        if item.Attributes.IsInstanceDefinitionObject:
            continue
        shape: Any = item.Geometry
        name = clipped(str(item.Attributes.Name or ""))
        if isinstance(shape, rhino3dm.Extrusion):
            shape = shape.ToBrep(True)
        if isinstance(shape, rhino3dm.Brep):
            faces: Any = shape.Faces
            for i in range(len(faces)):
                rows.append(_put(arrays, len(rows), faces[i], shape, name))
        elif isinstance(shape, rhino3dm.Surface):
            rows.append(_put(arrays, len(rows), shape, None, name))
    arrays["about"] = np.array(
        json.dumps({"unit": model.Settings.ModelUnitSystem.name, "faces": rows})
    )
    out = io.BytesIO()
    np.savez(out, **arrays)
    sys.stdout.buffer.write(out.getvalue())


def _put(arrays: dict[str, Any], k: int, face: Any, brep: Any, name: str) -> dict[str, Any]:
    """Arrays of a face; what else is to know of it."""
    patch = (face if brep is None else face.UnderlyingSurface()).ToNurbsSurface()
    for way, raised in enumerate((patch.IncreaseDegreeU, patch.IncreaseDegreeV)):
        if patch.Degree(way) < 2:
            raised(2)
    p = patch.Points
    control = [
        [(c.X, c.Y, c.Z, c.W) for c in (p.GetControlPoint(i, j) for j in range(p.CountV))]
        for i in range(p.CountU)
    ]
    arrays[f"control{k}"] = np.array(control, dtype=np.float64)
    for letter, knots in (("u", patch.KnotsU), ("v", patch.KnotsV)):
        arrays[f"{letter}{k}"] = np.array([knots[i] for i in range(len(knots))])
    closed = [bool(patch.IsClosed(0)), bool(patch.IsClosed(1))]
    loops: list[list[tuple[int, bool]]] = []
    edges = 0
    if brep is not None:
        outer = "Outer"
        used: list[int] = []
        for i in range(len(face.Loops)):
            loop, row = face.Loops[i], []
            for j in range(loop.TrimCount):
                trim = loop.Trims[j]
                if trim.EdgeIndex < 0:  # a side that is a point
                    continue
                used.append(trim.EdgeIndex)
                curve = brep.Edges[trim.EdgeIndex]
                span = curve.Domain
                at = np.linspace(span.T0, span.T1, CURVE_POINTS + 1).tolist()
                points = [(q.X, q.Y, q.Z) for q in (curve.PointAt(t) for t in at)]
                arrays[f"edge{k}.{edges}"] = np.array(points, dtype=np.float64)
                row.append((edges, not trim.IsReversed))
                edges += 1
            place = 0 if loop.LoopType.name == outer else len(loops)
            loops.insert(place, row)
        if len(loops) == 1 and len(used) == 4 and len(set(used)) < 4:
            loops = []  # two sides, and the seam twice: the whole patch
    return {
        "name": name,
        "degrees": [patch.Degree(0), patch.Degree(1)],
        "closed": closed,
        "reversed": brep is not None and bool(face.OrientationIsReversed),
        "loops": loops,
        "edges": edges,
    }
