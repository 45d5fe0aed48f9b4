"""What a traced net is like before anything is optimized: spacing, planarity, umbilics."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from scipy.spatial import cKDTree

from ddgfab.arguments import checked
from ddgfab.measures import planarity_percent
from ddgfab.mesh import Floats
from ddgfab.surfaces.principal import lifted
from ddgfab.trace.certainty import UNCERTAIN_DEG, turn_by_error
from ddgfab.trace.field import PrincipalField, sines
from ddgfab.trace.mesh import TracedMesh
from ddgfab.trace.placing import Network
from ddgfab.trace.twist import TOLD_DEG, edge_twist, line_twist

_DOUBTFUL: Final = 2.0
"""Umbilics nearer to the rim than this [spacings] may be there by noise only."""


@dataclass(frozen=True)
class TraceQuality:
    """Numbers of a traced net. Lengths in the unit of the surface, angles in degrees.

    Attributes
    ----------
    lines : of family 0 and 1
    spacing_percent : 5th, 50th and 95th percentile of the edges over the given spacing of their
        family [%]; those of cells that the rim cuts do not count, where there are others
    planarity_percent : mean and greatest over inner faces
    face_sizes : how many inner, how many rim faces of each number of corners
    uncertain_percent : part of the surface where an error of 1/1000 of the spacing turns lines by
        22.5 deg or more; 0 for conjugate families
    turn_deg : median and 95th percentile of that turn, none for conjugate families
    twist_deg : angle by which the normals of the surface turn about an edge inside, median and
        greatest, and the greatest along a whole line: by as much the axes of beams without torsion
        lean from the normals. None for principal lines, which have none
    least_angle_deg : at which the families meet
    umbilics : place, index, and whether it is doubtful (near the rim)
    spirals : lines that were given up for their length
    """

    vertices: int
    faces: int
    lines: tuple[int, int]
    spacing_percent: tuple[float, float, float]
    planarity_percent: tuple[float, float]
    face_sizes: tuple[dict[int, int], dict[int, int]]
    uncertain_percent: float
    turn_deg: tuple[float, float] | None
    twist_deg: tuple[float, float, float] | None
    least_angle_deg: float
    umbilics: tuple[tuple[tuple[float, float, float], float, bool], ...]
    spirals: int

    def text(self) -> str:
        """The report for people."""
        low, middle, high = self.spacing_percent
        mean, greatest = self.planarity_percent
        inner, rim = (
            ", ".join(f"{count} {size}-gons" for size, count in sizes.items()) or "none"
            for sizes in self.face_sizes
        )
        rows = [
            f"lines         {self.lines[0]} and {self.lines[1]}",
            f"spacing       5 % of the edges below {low:.0f} %, median {middle:.0f} %, "
            f"5 % above {high:.0f} % of the given",
            f"inner faces   {inner}",
            f"rim faces     {rim}",
            f"planarity     mean {mean:.3g} %, greatest {greatest:.3g} % (inner faces)",
            f"families      meet at {self.least_angle_deg:.1f} deg or more",
        ]
        if self.turn_deg is not None:
            rows.append(
                f"certainty     where the surface is out by 1/1000 of the spacing, lines turn by "
                f"{self.turn_deg[0]:.1f} deg (median), 95 % below {self.turn_deg[1]:.1f} deg"
            )
        if self.twist_deg is not None:
            rows.append(
                "twist         normals turn about an edge by {:.2g} deg (median), {:.2g} at most; "
                "along a line by {:.2g} at most".format(*self.twist_deg)
            )
        rows += [f"note          {remark}" for remark in self.remarks()]
        return "\n".join(rows)

    def remarks(self) -> tuple[str, ...]:
        """What a designer must know: uncertain directions, umbilics, spirals; a sentence each."""
        rows = []
        if self.uncertain_percent > 0:
            rows.append(
                f"directions are uncertain on {self.uncertain_percent:.1f} % of the surface: both "
                "curvatures are nearly equal there"
            )
        for (x, y, z), index, doubtful in self.umbilics:
            note = ", near the rim: doubtful" if doubtful else ""
            rows.append(
                f"umbilic at ({x:.6g}, {y:.6g}, {z:.6g}), index {index:+g}: a cell of "
                f"{4 * (1 - index):g} corners{note}"
            )
        if self.twist_deg is not None and self.twist_deg[0] > TOLD_DEG:
            rows.append(
                f"lines are not principal: node axes without torsion lean by about "
                f"{self.twist_deg[0]:.2g} deg an edge, more along lines; ddgfab dilemma on this "
                "net says how far the surface would have to move for principal ones"
            )
        if self.spirals:
            rows.append(f"{self.spirals} spirals were cut at 3 diameters")
        return tuple(rows)

    def to_dict(self) -> dict[str, Any]:
        """Plain values for JSON."""
        return {
            "vertices": self.vertices,
            "faces": self.faces,
            "lines": list(self.lines),
            "spacing_percent": list(self.spacing_percent),
            "planarity_percent": list(self.planarity_percent),
            "inner_face_sizes": {str(k): v for k, v in self.face_sizes[0].items()},
            "rim_face_sizes": {str(k): v for k, v in self.face_sizes[1].items()},
            "uncertain_percent": self.uncertain_percent,
            "turn_deg": None if self.turn_deg is None else list(self.turn_deg),
            "twist_deg": None if self.twist_deg is None else list(self.twist_deg),
            "least_angle_deg": self.least_angle_deg,
            "umbilics": [
                {"place": list(place), "index": index, "doubtful": doubtful}
                for place, index, doubtful in self.umbilics
            ],
            "spirals": self.spirals,
        }


@checked
def quality(network: Network, traced: TracedMesh) -> TraceQuality:
    """Measure a traced net."""
    mesh, samples = traced.mesh, network.samples
    inner = traced.inner_faces
    outer = np.setdiff1d(np.arange(mesh.n_faces), inner)
    given = float(min(network.spacing))
    ratio = 100 * _ratios(network, traced)
    flat = planarity_percent(mesh)[inner] if len(inner) else np.zeros(1)
    turn = np.degrees(turn_by_error(samples.principal, given))[samples.inside]
    principal = isinstance(network.field, PrincipalField)
    median, most = np.percentile(turn, [50, 95]).tolist()
    sine = sines(network.field, samples.jets)[samples.inside]
    places = np.array([umbilic.x for umbilic in network.umbilics]).reshape(-1, 3)
    far = cKDTree(samples.rim(given / 4)).query(places)[0] if len(places) else []
    low, middle, high = np.percentile(ratio, [5, 50, 95]).tolist()
    return TraceQuality(
        vertices=mesh.n_vertices,
        faces=mesh.n_faces,
        lines=(len(network.lines[0]), len(network.lines[1])),
        spacing_percent=(low, middle, high),
        planarity_percent=(float(flat.mean()), float(flat.max())),
        face_sizes=(_sizes(mesh.face_sizes[inner]), _sizes(mesh.face_sizes[outer])),
        uncertain_percent=100 * float((turn > UNCERTAIN_DEG).mean()) if principal else 0.0,
        turn_deg=(median, most) if principal else None,
        twist_deg=None if principal else _twist(network, traced),
        least_angle_deg=float(np.degrees(np.arcsin(np.clip(sine.min(), 0, 1)))),
        umbilics=tuple(
            (umbilic.x, umbilic.index, bool(distance < _DOUBTFUL * given))
            for umbilic, distance in zip(network.umbilics, far, strict=True)
        ),
        spirals=network.spirals,
    )


def _twist(network: Network, traced: TracedMesh) -> tuple[float, float, float]:
    inside = traced.mesh.edges[~traced.mesh.boundary_edge]
    edges = np.degrees(np.abs(edge_twist(network.field.surface, traced.uv, inside)))
    whole = [
        np.degrees(np.ptp(line_twist(network.field, family, line)))
        for family, lines in enumerate(network.lines)
        for line in lines
    ]
    if not len(edges):
        return 0.0, 0.0, float(max(whole))
    return float(np.median(edges)), float(edges.max()), float(max(whole))


def _ratios(network: Network, traced: TracedMesh) -> Floats:
    """Lengths of edges over the spacing of the lines that they lead to."""
    mesh, field = traced.mesh, network.field
    cut = mesh.boundary_vertex[mesh.edges].any(axis=1)
    chosen = np.flatnonzero(~cut) if not cut.all() else np.flatnonzero(~mesh.boundary_edge)
    if not len(chosen):
        return np.full(1, np.nan)
    ends = traced.uv[mesh.edges[chosen]]
    jets = field.surface.jets(ends.mean(axis=1))
    way = lifted(jets, ends[:, 1] - ends[:, 0])
    along = [
        np.abs(np.einsum("nx,nx->n", way, lifted(jets, field.directions(jets, family))))
        for family in (0, 1)
    ]
    across = np.where(along[0] >= along[1], network.spacing[1], network.spacing[0])
    return np.asarray(mesh.edge_lengths[chosen] / across)


def _sizes(values: Any) -> dict[int, int]:
    found, counts = np.unique(values, return_counts=True)
    return dict(zip(found.tolist(), counts.tolist(), strict=True))
