"""Parallel meshes at a constant distance: of vertices, of faces or of edges; and which one it is.

v' = v + d s_v, where s is a parallel mesh whose vertices lie on the unit sphere (circular nets),
whose faces touch it (conical nets) or whose edges touch it (Koebe nets).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.arguments import checked
from ddgfab.errors import DegenerateError, MeshError
from ddgfab.measures.edge_offset import koebe_field
from ddgfab.mesh import Floats, Mesh, unit
from ddgfab.support.exact import cone_field, reflected_axes

OFFSET_RELATIVE: Final = 1e-9
"""Distances count as constant, and edges as parallel, below this spread relative to their size.

Every function takes another as `tolerance`: coordinates of six digits leave some 1e-6.
"""

Element = Literal["vertex", "edge", "face"]
_PLURAL: Final[dict[Element, str]] = {"vertex": "vertices", "edge": "edges", "face": "faces"}


@dataclass(frozen=True)
class OffsetReport:
    """Distances between a mesh and one parallel to it, by element; spread = greatest - least.

    Attributes
    ----------
    distance : mean distance of vertices, of edges, of faces (signed along the normal)
    spread : how much each varies
    parallel : greatest sine of the angle between corresponding edges
    scale : greatest distance of vertices, against which spreads are judged
    tolerance : spread, over the scale, below which distances count as constant, and sine below
        which edges count as parallel
    """

    distance: dict[Element, float]
    spread: dict[Element, float]
    parallel: float
    scale: float
    tolerance: float = OFFSET_RELATIVE

    @property
    def constant(self) -> tuple[Element, ...]:
        """The elements at a constant distance, within the tolerance."""
        return tuple(k for k, v in self.spread.items() if v <= self.tolerance * self.scale)

    @property
    def is_parallel(self) -> bool:
        """Whether all edges are parallel, within the tolerance."""
        return self.parallel <= self.tolerance

    def __str__(self) -> str:
        kind = " and ".join(self.constant) or "no"
        words = ", ".join(f"{k} {self.distance[k]:.6g} +- {v:.1e}" for k, v in self.spread.items())
        parallel = "parallel" if self.is_parallel else f"edges turned by {self.parallel:.1e} rad"
        return f"{kind} offset: distance of {words}; {parallel}"


@checked
def classify_offset(
    mesh: Mesh, other: Mesh | ArrayLike, tolerance: float = OFFSET_RELATIVE
) -> OffsetReport:
    """Which distances between a mesh and another with the same faces are constant.

    Constant distance of vertices: (v' - v) / d lies on the unit sphere and planar faces are
    circular; of faces: it is tangent to it and the net conical; of edges: its edges touch it, a
    Koebe net.

    Parameters
    ----------
    other : the parallel mesh, or its (V, 3) vertices
    tolerance : of the report, see `OffsetReport`

    Raises
    ------
    MeshError
        Another number of vertices.

    Examples
    --------
    >>> from ddgfab.forms.registry import generate
    >>> mesh = generate("conical")
    >>> classify_offset(mesh, face_offset(mesh, 100.0)).constant
    ('face',)

    Source: Pottmann, Liu, Wallner, Bobenko, Wang 2007, section 3; mathematics.md 10.7.
    """
    moved = other.vertices if isinstance(other, Mesh) else np.asarray(other, dtype=np.float64)
    if moved.shape != mesh.vertices.shape:
        raise MeshError(f"vertices have shape {moved.shape}; expected {mesh.vertices.shape}")
    used = mesh.valences > 0
    shift = moved - mesh.vertices
    start, end = mesh.edges.T
    along = unit(mesh.edge_vectors)
    middle = 0.5 * (shift[start] + shift[end])
    edge = np.linalg.norm(np.cross(middle, along), axis=1)
    turned = np.linalg.norm(np.cross(moved[end] - moved[start], along), axis=1)
    length = np.linalg.norm(moved[end] - moved[start], axis=1)
    vertex = np.linalg.norm(shift[used], axis=1)
    height = np.einsum("cx,cx->c", shift[mesh.corners], mesh.face_normals[mesh.corner_face])
    values: dict[Element, Floats] = {"vertex": vertex, "edge": edge, "face": height}
    # An edge may shrink to a point: then it is judged against the mesh's own.
    sine = turned / np.maximum(length, mesh.edge_lengths)
    return OffsetReport(
        {name: float(v.mean()) for name, v in values.items()},
        {name: float(np.ptp(v)) for name, v in values.items()},
        float(sine.max()),
        float(vertex.max()),
        tolerance,
    )


@checked
def vertex_offset(mesh: Mesh, distance: float, tolerance: float = OFFSET_RELATIVE) -> Mesh:
    """Parallel mesh of a circular net at a constant distance of vertices, to the outside.

    Parameters
    ----------
    tolerance : how far edges may turn [rad], and the distance vary in parts of it; meshes from
        files with few digits need more than the default (about 1e-5 for six digits)

    Raises
    ------
    DegenerateError
        The mesh is not circular (or a hole in it turns normals round): names the worst edge.

    Source: mathematics.md 2.7, 10.6.
    """
    axes = reflected_axes(mesh)
    _refuse(mesh, axes, "vertex", "circular", tolerance)
    return mesh.with_vertices(mesh.vertices + distance * axes)


@checked
def face_offset(mesh: Mesh, distance: float, tolerance: float = OFFSET_RELATIVE) -> Mesh:
    """Parallel mesh of a conical net at a constant distance of faces, to the outside.

    Boundary vertices have freedom left: theirs are nearest to the surface normals.

    Parameters
    ----------
    tolerance : how far edges may turn [rad], and the distance vary in parts of it; meshes from
        files with few digits need more than the default (about 1e-5 for six digits)

    Raises
    ------
    DegenerateError
        The mesh is not conical: names the worst edge.

    Source: v' = v + d axis / <axis, N>; Liu, Pottmann, Wallner, Yang, Wang 2006; mathematics.md
    10.6.
    """
    field = cone_field(mesh)
    _refuse(mesh, field, "face", "conical", tolerance)
    return mesh.with_vertices(mesh.vertices + distance * field)


@checked
def edge_offset(mesh: Mesh, distance: float, tolerance: float = OFFSET_RELATIVE) -> Mesh:
    """Parallel mesh at a constant distance of edges, to the outside, of a mesh like a Koebe net.

    Beams on it have one height, and their upper edges meet at the nodes.

    Parameters
    ----------
    tolerance : how far edges may turn [rad], and the distance vary in parts of it; meshes from
        files with few digits need more than the default (about 1e-5 for six digits)

    Raises
    ------
    DegenerateError
        The mesh is not parallel to a Koebe net (names the worst edge), or a vertex has too few
        edges to tell.

    Source: v' = v + d k_v; mathematics.md 10.6.
    """
    field = koebe_field(mesh, tolerance)
    return mesh.with_vertices(mesh.vertices + distance * field)


@checked
def exact_offset(
    mesh: Mesh, distance: float, tolerance: float = OFFSET_RELATIVE
) -> tuple[Mesh, OffsetReport]:
    """The parallel mesh at a constant distance that the net allows: vertices, faces or edges first.

    Parameters
    ----------
    tolerance : how far edges may turn [rad], and the distance vary in parts of it; meshes from
        files with few digits need more than the default (about 1e-5 for six digits)

    Raises
    ------
    DegenerateError
        The net is neither circular nor conical nor parallel to a Koebe net; says why for each.
    """
    reasons = []
    for offset in (vertex_offset, face_offset, edge_offset):
        try:
            moved = offset(mesh, distance, tolerance)
        except DegenerateError as error:
            reasons.append(str(error).split("\n")[0])
        else:
            return moved, classify_offset(mesh, moved, tolerance)
    raise DegenerateError("no offset at a constant distance:\n" + "; ".join(reasons))


def _refuse(mesh: Mesh, field: Floats, element: Element, kind: str, tolerance: float) -> None:
    """Raise `DegenerateError` unless v + d s_v is parallel with a constant distance of elements."""
    size = float(np.median(mesh.edge_lengths))
    report = classify_offset(mesh, mesh.vertices + size * field, tolerance)
    if report.is_parallel and element in report.constant:
        return
    start, end = mesh.edges.T
    turned = np.linalg.norm(np.cross(field[end] - field[start], unit(mesh.edge_vectors)), axis=1)
    worst = int((turned * size / mesh.edge_lengths).argmax())
    raise DegenerateError(
        f"the mesh is not {kind}: offset by one edge length its edges turn by up to "
        f"{np.degrees(report.parallel):.2g} deg (edge {worst}) and the distance of its "
        f"{_PLURAL[element]} varies by {report.spread[element] / report.scale:.1e} (limit "
        f"{tolerance:g})"
    )
