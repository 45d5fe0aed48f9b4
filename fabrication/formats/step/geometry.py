"""Geometry of STEP files as text straight from exact boundaries, without the CAD kernel.

Parts with the same topology share one text, in which only the numbers differ: a part costs one
formatting of its numbers.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ddgfab.errors import DegenerateError
from ddgfab.mesh import Floats
from fabrication.boundary import Boundary, cross_rows
from fabrication.solids.polynomials import crossing_poles

DECIMALS: Final = 12
"""Decimals of every coordinate [mm] and direction. With seven, faces were invalid on reading."""

SAME_RADIUS: Final = 1e-12
"""Half-axes that differ by less than this part make a circle."""

LOCAL: Final = "~"
"""Stands before the ids of one product in templates; becomes "#" and the product's own digits."""

_REAL: Final = f"%.{DECIMALS}f"
_TRIPLE: Final = f"({_REAL},{_REAL},{_REAL})"
_WHOLE: Final = "." + DECIMALS * "0"
"""The end of whole numbers, written as "." only: saves a third of the size."""


@dataclass(frozen=True)
class _Topology:
    """What boundaries must share to share a text: counts, and the arrays' bytes.

    poles : how many of each arc, where cylinders cross; 0 for arcs of circles and ellipses
    """

    points: int
    edges: bytes
    edge_arc: bytes
    poles: tuple[int, ...]
    ellipse: bytes
    face_cylinder: bytes
    face_inward: bytes
    loop_face: bytes
    loop_start: bytes
    coedges: bytes


@dataclass(frozen=True, eq=False)
class Template:
    """A closed shell as text with `%` for the numbers.

    Attributes
    ----------
    text : the entities; local ids follow `LOCAL`, with leading zeros
    ids : how many local ids there are, counted from 0 to one past the last
    arc_numbers : (A * 11,) which of center, normal, xdir and the two radii are written
    face_numbers : (F * 10,) which of origin, axis, xdir and radius are written
    """

    text: str
    ids: int
    arc_numbers: NDArray[np.bool_]
    face_numbers: NDArray[np.bool_]


class BoundaryShell:
    """The CLOSED_SHELL of an exact boundary, and all that hangs below it, as text.

    Attributes
    ----------
    ids : how many ids it takes
    """

    def __init__(self, boundary: Boundary) -> None:
        self.ids = count_ids(boundary)
        self._boundary = boundary

    def text(self, prefix: str, first: int, width: int) -> str:
        """The entities; an id is the prefix and a number of that width, `first` the shell's."""
        template, numbers = shell(self._boundary, first, width)
        return filled(template.text, numbers, prefix)


def filled(text: str, numbers: tuple[float, ...], prefix: str) -> str:
    """The text of a template with its numbers, its local ids after a prefix."""
    return (text.replace(LOCAL, prefix) % numbers).replace(_WHOLE, ".")


def shell(boundary: Boundary, first: int, width: int) -> tuple[Template, tuple[float, ...]]:
    """The CLOSED_SHELL of a boundary, and all that hangs below it: text and numbers [mm].

    Parameters
    ----------
    first : local id of the shell; its parts follow
    width : digits of local ids

    Returns
    -------
    The template and the numbers for it: ``template.text % numbers``.

    Raises
    ------
    DegenerateError
        An edge has no length, or a number is not finite: a file would hold "nan".
    """
    boundary = boundary.major_first()
    large = np.sqrt(np.einsum("ai,ai->a", boundary.arc_a, boundary.arc_a))
    small = np.sqrt(np.einsum("ai,ai->a", boundary.arc_b, boundary.arc_b))
    poles = crossing_poles(boundary)
    template = _template(
        _Topology(
            len(boundary.points),
            boundary.edges.astype(np.int64, copy=False).tobytes(),
            boundary.edge_arc.astype(np.int64, copy=False).tobytes(),
            tuple(len(poles.get(arc, ())) for arc in range(len(boundary.arc_center))),
            (large - small > SAME_RADIUS * large).tobytes(),
            boundary.face_cylinder.tobytes(),
            (boundary.face_sign < 0.0).tobytes(),
            boundary.loop_face.astype(np.int64, copy=False).tobytes(),
            boundary.loop_start.astype(np.int64, copy=False).tobytes(),
            boundary.coedges.astype(np.int64, copy=False).tobytes(),
        ),
        first,
        width,
    )
    numbers = np.concatenate(
        [
            boundary.points.ravel(),
            _line_directions(boundary).ravel(),
            _arc_numbers(boundary, large, small).ravel()[template.arc_numbers],
            *(poles[arc].ravel() for arc in sorted(poles)),
            _face_numbers(boundary).ravel()[template.face_numbers],
        ]
    )
    if not np.isfinite(numbers).all():
        raise DegenerateError("the boundary has an edge without length or a number not finite")
    numbers[np.abs(numbers) < 0.5 * 10.0**-DECIMALS] = 0.0  # else "-0." would appear
    return template, tuple(numbers.tolist())


def count_ids(boundary: Boundary) -> int:
    """How many ids the shell of a boundary takes."""
    lines = int(np.count_nonzero(boundary.edge_arc < 0))
    cylinders = int(np.count_nonzero(boundary.face_cylinder))
    return (
        1  # the shell
        + 2 * len(boundary.points)  # and its vertex
        + 3 * lines  # direction, vector, line
        + 5 * int(np.count_nonzero(~boundary.arc_crosses))  # point, directions, placement, curve
        + sum(len(poles) + 1 for poles in crossing_poles(boundary).values())  # poles, curve
        + len(boundary.edges)
        + len(boundary.coedges)
        + 2 * len(boundary.loop_face)  # loop, bound
        + 5 * boundary.n_faces  # two directions, placement, surface, face
        + cylinders  # their origins
    )


def _line_directions(boundary: Boundary) -> Floats:
    """Unit directions of the edges that are lines, in their order."""
    ends = boundary.points[boundary.edges[boundary.edge_arc < 0]]
    along = ends[:, 1] - ends[:, 0]
    with np.errstate(invalid="ignore"):  # an edge without length is refused by its caller
        return np.asarray(along / np.sqrt(np.einsum("ei,ei->e", along, along))[:, None])


def _arc_numbers(boundary: Boundary, large: Floats, small: Floats) -> Floats:
    """(A, 11): center, normal, xdir, half-axes."""
    normal = cross_rows(boundary.arc_a, boundary.arc_b) / (large * small)[:, None]
    xdir = boundary.arc_a / large[:, None]
    return np.hstack([boundary.arc_center, normal, xdir, large[:, None], small[:, None]])


def _face_numbers(boundary: Boundary) -> Floats:
    """(F, 10): origin, axis, xdir, radius."""
    return np.hstack(
        [
            boundary.face_origin,
            boundary.face_axis,
            boundary.face_xdir,
            boundary.face_radius[:, None],
        ]
    )


@lru_cache(maxsize=256)
def _template(topology: _Topology, first: int, width: int) -> Template:
    """The text of all boundaries of one topology."""
    edges = np.frombuffer(topology.edges, np.int64).reshape(-1, 2).tolist()
    edge_arc = np.frombuffer(topology.edge_arc, np.int64).tolist()
    ellipse = np.frombuffer(topology.ellipse, np.bool_)
    cylinder = np.frombuffer(topology.face_cylinder, np.bool_)
    ids = _Ids(first, width)
    shell_id = ids.take()
    lines: list[str] = []

    def emit(entity: str) -> str:
        taken = ids.take()
        lines.append(f"{taken}={entity};")
        return taken

    def axes(origin: str) -> str:
        z, x = (emit(f"DIRECTION('',{_TRIPLE})") for _ in range(2))
        return emit(f"AXIS2_PLACEMENT_3D('',{origin},{z},{x})")

    points = [emit(f"CARTESIAN_POINT('',{_TRIPLE})") for _ in range(topology.points)]
    directions = [emit(f"DIRECTION('',{_TRIPLE})") for arc in edge_arc if arc < 0]
    arcs: dict[int, str] = {}
    plain = np.array(topology.poles, dtype=np.int64) == 0
    for arc in np.flatnonzero(plain).tolist():
        frame = axes(emit(f"CARTESIAN_POINT('',{_TRIPLE})"))
        radii = (
            f"ELLIPSE('',{frame},{_REAL},{_REAL})"
            if ellipse[arc]
            else (f"CIRCLE('',{frame},{_REAL})")
        )
        arcs[arc] = emit(radii)
    for arc in np.flatnonzero(~plain).tolist():
        count = topology.poles[arc]
        poles = ",".join(emit(f"CARTESIAN_POINT('',{_TRIPLE})") for _ in range(count))
        arcs[arc] = emit(
            f"B_SPLINE_CURVE_WITH_KNOTS('',{count - 1},({poles}),.UNSPECIFIED.,.F.,.F.,"
            f"({count},{count}),(0.,1.),.UNSPECIFIED.)"
        )
    vertices = [emit(f"VERTEX_POINT('',{point})") for point in points]
    edge_curves, straight = [], iter(directions)
    for (start, end), arc in zip(edges, edge_arc, strict=True):
        if arc < 0:
            vector = emit(f"VECTOR('',{next(straight)},1.)")
            curve = emit(f"LINE('',{points[start]},{vector})")
        else:
            curve = arcs[arc]
        edge_curves.append(emit(f"EDGE_CURVE('',{vertices[start]},{vertices[end]},{curve},.T.)"))
    faces = []
    inward = np.frombuffer(topology.face_inward, np.bool_).tolist()
    for face, loops in enumerate(_loops(topology, len(cylinder))):
        bounds = []
        for number, loop in enumerate(loops):
            oriented = [
                emit(
                    f"ORIENTED_EDGE('',*,*,{edge_curves[e if e >= 0 else ~e]},"
                    f"{'.T.' if e >= 0 else '.F.'})"
                )
                for e in loop
            ]
            around = emit(f"EDGE_LOOP('',({','.join(oriented)}))")
            kind = "FACE_BOUND" if number else "FACE_OUTER_BOUND"
            bounds.append(emit(f"{kind}('',{around},.T.)"))
        if cylinder[face]:
            frame = axes(emit(f"CARTESIAN_POINT('',{_TRIPLE})"))
            surface = emit(f"CYLINDRICAL_SURFACE('',{frame},{_REAL})")
        else:
            e = loops[0][0]
            surface = emit(f"PLANE('',{axes(points[edges[e][0] if e >= 0 else edges[~e][1]])})")
        sense = ".F." if inward[face] else ".T."
        faces.append(emit(f"ADVANCED_FACE('',({','.join(bounds)}),{surface},{sense})"))
    lines.append(f"{shell_id}=CLOSED_SHELL('',({','.join(faces)}));")
    arc_numbers = np.ones((len(ellipse), 11), dtype=np.bool_)
    arc_numbers[:, 10] = ellipse
    arc_numbers[~plain] = False
    face_numbers = np.ones((len(cylinder), 10), dtype=np.bool_)
    face_numbers[:, :3] = face_numbers[:, 9:] = cylinder[:, None]
    return Template(
        "\n".join(lines) + "\n", ids.following, arc_numbers.ravel(), face_numbers.ravel()
    )


def _loops(topology: _Topology, faces: int) -> Iterator[list[list[int]]]:
    """Coedges of each loop of each face."""
    face = np.frombuffer(topology.loop_face, np.int64)
    start = np.frombuffer(topology.loop_start, np.int64).tolist()
    coedges = np.frombuffer(topology.coedges, np.int64).tolist()
    for number in range(faces):
        yield [coedges[start[loop] : start[loop + 1]] for loop in np.flatnonzero(face == number)]


class _Ids:
    """Hands out local ids of a fixed width."""

    def __init__(self, first: int, width: int) -> None:
        self.following = first
        self._width = width

    def take(self) -> str:
        self.following += 1
        return f"{LOCAL}{self.following - 1:0{self._width}d}"
