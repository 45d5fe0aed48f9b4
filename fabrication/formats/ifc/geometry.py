"""Solids of IFC: sections swept between two planes, else exact faces, else closed meshes."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np

from ddgfab.mesh import Floats
from fabrication.formats.base import Part
from fabrication.formats.ifc.brep import advanced_brep
from fabrication.formats.ifc.lines import Lines, listed, rows
from fabrication.formats.step.text import quoted, real
from fabrication.solids.prism import Cap, Prism, prism
from fabrication.solids.section import segments
from fabrication.specs import Loop, TriangleMesh

BEYOND: Final = 1.0
"""How far [mm] a section is swept beyond a cap that is not perpendicular to it, which clips it."""


@dataclass(frozen=True)
class Body:
    """A solid in a file: its reference, and the type of representation that it belongs to."""

    reference: str
    type: str
    prism: Prism | None


def body(lines: Lines, part: Part) -> Body:
    """The solid of a part, in the part's own frame."""
    boundary = part.boundary
    swept = None
    if boundary is not None:
        swept = prism(boundary, "shortest" if part.kind.form == "sheet" else "longest")
    if swept is None and boundary is not None:
        return Body(advanced_brep(lines, boundary), "AdvancedBrep", None)
    if swept is None:
        return Body(_mesh(lines, part.mesh), "Tessellation", None)
    solid, clipped = _swept(lines, swept, part.number)
    return Body(solid, "Clipping" if clipped else "SweptSolid", swept)


def _swept(lines: Lines, swept: Prism, name: str) -> tuple[str, bool]:
    """IfcExtrudedAreaSolid, clipped by half spaces where its caps are not perpendicular to it."""
    low = swept.span[0] - (0.0 if swept.low.straight else BEYOND)
    high = swept.span[1] + (0.0 if swept.high.straight else BEYOND)
    at = swept.frame.copy()
    at[:3, 3] = at[:3, :3] @ (0.0, 0.0, low) + at[:3, 3]
    section = _section(lines, swept.loops, name)
    up = lines.direction(0.0, 0.0, 1.0)
    depth = real(high - low)
    solid = lines.add(f"IFCEXTRUDEDAREASOLID({section},{lines.axes(at)},{up},{depth})")
    clipped = False
    for cap, outward in ((swept.low, -1.0), (swept.high, 1.0)):
        if not cap.straight:
            plane = lines.add(f"IFCPLANE({lines.axes(_cap_frame(swept, cap, outward))})")
            beyond = lines.add(f"IFCHALFSPACESOLID({plane},.F.)")
            solid = lines.add(f"IFCBOOLEANCLIPPINGRESULT(.DIFFERENCE.,{solid},{beyond})")
            clipped = True
    return solid, clipped


def _cap_frame(swept: Prism, cap: Cap, outward: float) -> Floats:
    """(4, 4) of a cap's plane, its z pointing out of the part."""
    turn = swept.frame[:3, :3]
    a, b = cap.slope
    steep, wide = math.hypot(a, b, 1.0) * outward, math.hypot(1.0, a)
    normal = (-a / steep, -b / steep, 1.0 / steep)
    across = (1.0 / wide, 0.0, a / wide)
    beside = (
        normal[1] * across[2],
        normal[2] * across[0] - normal[0] * across[2],
        -normal[1] * across[0],
    )
    frame = swept.frame.copy()
    frame[:3, :3] = turn @ np.array([across, beside, normal]).T
    frame[:3, 3] += turn[:, 2] * cap.height
    return frame


def _section(lines: Lines, loops: tuple[Loop, ...], name: str) -> str:
    """IfcArbitraryClosedProfileDef, with voids where there are holes."""
    outer, *holes = [_curve(lines, loop) for loop in loops]
    if not holes:
        return lines.add(f"IFCARBITRARYCLOSEDPROFILEDEF(.AREA.,{quoted(name)},{outer})")
    inner = listed(holes)
    return lines.add(f"IFCARBITRARYPROFILEDEFWITHVOIDS(.AREA.,{quoted(name)},{outer},{inner})")


def _curve(lines: Lines, loop: Loop) -> str:
    """A loop of lines and arcs as IfcIndexedPolyCurve; an arc has a point in its middle."""
    points: list[tuple[float, float]] = []
    parts: list[str] = []
    pieces = segments(loop)
    for s in pieces:
        points.append((s.u0, s.v0))
        here = len(points)
        if s.turn:
            points.append(
                (
                    s.center[0] + s.radius * math.cos(s.middle),
                    s.center[1] + s.radius * math.sin(s.middle),
                )
            )
        after = 1 if s is pieces[-1] else len(points) + 1
        parts.append(
            f"IFCARCINDEX(({here},{here + 1},{after}))"
            if s.turn
            else f"IFCLINEINDEX(({here},{after}))"
        )
    table = lines.add(f"IFCCARTESIANPOINTLIST2D({rows(points)})")
    return lines.add(f"IFCINDEXEDPOLYCURVE({table},{listed(parts)},.F.)")


def _mesh(lines: Lines, mesh: TriangleMesh) -> str:
    """IfcTriangulatedFaceSet, closed."""
    table = lines.add(f"IFCCARTESIANPOINTLIST3D({rows(mesh.vertices.tolist())})")
    corners = listed(f"({a},{b},{c})" for a, b, c in (mesh.triangles + 1).tolist())
    return lines.add(f"IFCTRIANGULATEDFACESET({table},$,.T.,{corners},$)")
