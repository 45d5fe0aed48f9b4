"""`inspect`: a mesh in one record of plain numbers, as text and as a dictionary."""

from __future__ import annotations

from dataclasses import asdict, dataclass

import numpy as np
from numpy.typing import NDArray

from ddgfab.arguments import checked
from ddgfab.measures.edges import dihedral_angles, torsion
from ddgfab.measures.faces import (
    chebyshev_defect,
    circular_defect,
    interior_angles,
    planarity,
    planarity_percent,
)
from ddgfab.measures.kinds import kind_names, kind_words
from ddgfab.measures.vertices import conical_defect, star_defect
from ddgfab.mesh import Floats, Ints, Mesh

Flags = NDArray[np.bool_]

_DIGITS = 12
"""Digits of the numbers in a report: below what differs between linear algebra libraries."""


@dataclass(frozen=True)
class Measure:
    """Greatest and mean value of a measure, and its worst elements as (id, value), worst first."""

    of: str
    unit: str
    greatest: float
    mean: float
    worst: tuple[tuple[int, float], ...]


@dataclass(frozen=True)
class Report:
    """What a mesh is. Lengths in `unit`, angles in degrees (this is for people to read).

    Attributes
    ----------
    kind : one line of text; kinds : all names that apply (see `kinds.kind_names`)
    face_sizes : how many faces of each number of corners
    valences_inner, valences_boundary : how many vertices of each number of edges
    boundary_loops : number of edges of each boundary loop
    edge_length : least, median, greatest
    corner_angle_deg : least, greatest interior angle
    measures : by name: planarity, planarity_percent, circular_deg, conical_deg,
        normal_torsion_deg, star_deg, sides_percent, dihedral_deg
    """

    kind: str
    kinds: tuple[str, ...]
    unit: str
    vertices: int
    edges: int
    faces: int
    components: int
    face_sizes: dict[int, int]
    valences_inner: dict[int, int]
    valences_boundary: dict[int, int]
    boundary_loops: tuple[int, ...]
    edge_length: tuple[float, float, float]
    corner_angle_deg: tuple[float, float]
    area: float
    measures: dict[str, Measure]

    def __repr__(self) -> str:
        return f"Report({self.kind}; {self.vertices} vertices, {self.faces} faces)"

    def to_dict(self) -> dict[str, object]:
        """Plain numbers, strings, lists and dictionaries with string keys, ready for JSON."""
        return {key: _plain(value) for key, value in asdict(self).items()}

    def lines(self) -> list[str]:
        """The report for people."""
        low, median, high = self.edge_length
        loops = ", ".join(map(str, self.boundary_loops))
        rows = [
            ("kind", self.kind),
            ("size", f"{self.vertices} vertices, {self.edges} edges, {self.faces} faces"),
            ("faces", _histogram(self.face_sizes, "-gon")),
            ("valences inside", _histogram(self.valences_inner, "-valent") or "none"),
            ("valences at boundary", _histogram(self.valences_boundary, "-valent") or "none"),
            ("components", str(self.components)),
            ("boundary loops", f"{len(self.boundary_loops)} (of {loops} edges)" if loops else "0"),
            (
                "edge lengths",
                f"{low:.6g} to {high:.6g} {self.unit}, median {median:.6g} {self.unit}",
            ),
            (
                "corner angles",
                f"{self.corner_angle_deg[0]:.2f} to {self.corner_angle_deg[1]:.2f} deg",
            ),
        ]
        for name, measure in self.measures.items():
            worst = ", ".join(f"{i} ({value:.3g})" for i, value in measure.worst)
            text = f"max {measure.greatest:.3g}, mean {measure.mean:.3g} {measure.unit}"
            rows.append((_TITLES[name], text + (f"; worst {measure.of} {worst}" if worst else "")))
        width = max(len(title) for title, _ in rows)
        return [f"{title:<{width}}  {text}" for title, text in rows]

    def text(self) -> str:
        """The lines as one string."""
        return "\n".join(self.lines())


_TITLES = {
    "planarity": "planarity",
    "planarity_percent": "planarity, relative",
    "circular_deg": "circular defect",
    "conical_deg": "conical defect",
    "normal_torsion_deg": "torsion of normals",
    "star_deg": "star planarity",
    "sides_percent": "opposite sides",
    "dihedral_deg": "dihedral angles",
}


@checked
def inspect(mesh: Mesh, *, unit: str = "mm", worst: int = 5) -> Report:
    """Measure a mesh and say which kind of net it is.

    Parameters
    ----------
    unit : the unit of the vertices, for the text
    worst : how many of the worst elements each measure names

    Means are over the elements for which a measure is defined: faces with four corners or more
    for planarity and circularity, quads for opposite sides, inner vertices of valence 4 or more
    for the conical defect, vertices of valence 3 or more for stars, inner edges for dihedrals.

    Examples
    --------
    >>> from ddgfab.forms.registry import generate
    >>> inspect(generate("rotational")).kind.split(" (")[0]
    'conical and circular net'
    """
    inner = ~mesh.boundary_vertex & (mesh.valences > 0)
    many = mesh.face_sizes > 3
    tables: dict[str, tuple[str, str, Floats, Flags]] = {}

    def add(name: str, of: str, symbol: str, values: Floats, where: Flags) -> None:
        tables[name] = (of, symbol, values, where)

    add("planarity", "faces", unit, planarity(mesh), many)
    add("planarity_percent", "faces", "%", planarity_percent(mesh), many)
    add("circular_deg", "faces", "deg", np.degrees(circular_defect(mesh)), many)
    add(
        "conical_deg",
        "vertices",
        "deg",
        np.degrees(conical_defect(mesh)),
        inner & (mesh.valences > 3),
    )
    twist = np.degrees(torsion(mesh, mesh.vertex_normals))
    add("normal_torsion_deg", "edges", "deg", twist, np.ones(mesh.n_edges, dtype=bool))
    add("star_deg", "vertices", "deg", np.degrees(star_defect(mesh)), mesh.valences > 2)
    add("sides_percent", "faces", "%", chebyshev_defect(mesh), mesh.face_sizes == 4)
    add(
        "dihedral_deg",
        "edges",
        "deg",
        np.degrees(np.abs(dihedral_angles(mesh))),
        ~mesh.boundary_edge,
    )
    names = kind_names(mesh)
    angles = np.degrees(interior_angles(mesh))
    lengths = mesh.edge_lengths
    return Report(
        kind=kind_words(mesh, names),
        kinds=names,
        unit=unit,
        vertices=mesh.n_vertices,
        edges=mesh.n_edges,
        faces=mesh.n_faces,
        components=int(mesh.components.max()) + 1,
        face_sizes=_counts(mesh.face_sizes),
        valences_inner=_counts(mesh.valences[inner]),
        valences_boundary=_counts(mesh.valences[mesh.boundary_vertex]),
        boundary_loops=tuple(len(loop) for loop in mesh.boundary_loops),
        edge_length=(float(lengths.min()), float(np.median(lengths)), float(lengths.max())),
        corner_angle_deg=(float(angles.min()), float(angles.max())),
        area=float(mesh.face_areas.sum()),
        measures={name: _measure(*row, worst) for name, row in tables.items()},
    )


def _measure(of: str, unit: str, values: Floats, where: Flags, worst: int) -> Measure:
    ids = np.flatnonzero(where)
    if not len(ids):
        return Measure(of, unit, 0.0, 0.0, ())
    chosen = values[ids]
    order = np.argsort(-chosen, kind="stable")[:worst]
    ranked = tuple((int(ids[i]), float(chosen[i])) for i in order)
    return Measure(of, unit, float(chosen.max()), float(chosen.mean()), ranked)


def _counts(values: Ints) -> dict[int, int]:
    found, counts = np.unique(values, return_counts=True)
    return dict(zip(found.tolist(), counts.tolist(), strict=True))


def _histogram(counts: dict[int, int], noun: str) -> str:
    return ", ".join(f"{number} {key}{noun}" for key, number in counts.items())


def _plain(value: object) -> object:
    if isinstance(value, dict):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    return float(f"{value:.{_DIGITS}g}") if isinstance(value, float) else value
