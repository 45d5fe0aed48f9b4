"""SupportStructure: a node axis at every vertex, with the certificate of its torsion and lean."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.arguments import checked
from ddgfab.errors import DegenerateError, SupportError
from ddgfab.measures import lean, torsion
from ddgfab.mesh import Floats, Ints, Mesh, unit
from ddgfab.support.edge import beam_heights
from ddgfab.tolerances import TORSION_EXACT_DEG


@dataclass(frozen=True, eq=False, repr=False)
class SupportStructure:
    """Node axes of a mesh, and the planes of its edges.

    Make one with `SupportStructure.of` (or `ddgfab.support.support_structure`).

    Attributes
    ----------
    mesh : the mesh whose vertices carry the axes
    axes : (V, 3) unit node axes a(v), on the side of the vertex normals
    kind : how it was made: "offset", "normal", "axis", "edge", "optimize", "central", ..., "given"
    status : "exact" (a closed construction), "converged", or "stopped" (a solver that gave up)
    history_deg : greatest torsion after each step of the construction; the last is the result's
    """

    mesh: Mesh
    axes: Floats
    kind: str
    status: str
    history_deg: tuple[float, ...]

    @staticmethod
    @checked
    def of(
        mesh: Mesh,
        axes: ArrayLike,
        kind: str = "given",
        *,
        status: str = "exact",
        history_deg: tuple[float, ...] = (),
    ) -> SupportStructure:
        """Structure of (V, 3) axes of any length other than zero.

        Raises
        ------
        SupportError
            Wrong shape, or an axis of a vertex in use that is zero or not finite.
        """
        given = np.array(axes, dtype=np.float64)
        if given.shape != mesh.vertices.shape:
            raise SupportError(f"axes have shape {given.shape}; expected {mesh.vertices.shape}")
        length = np.linalg.norm(given, axis=1)
        bad = np.flatnonzero(~np.isfinite(length) | ((length == 0) & (mesh.valences > 0)))
        if len(bad):
            raise SupportError(f"the node axis of vertex {bad[0]} is {given[bad[0]].tolist()}")
        normalized = unit(given)
        normalized.setflags(write=False)
        if not history_deg:
            history_deg = (float(np.degrees(torsion(mesh, normalized).max())),)
        return SupportStructure(mesh, normalized, kind, status, history_deg)

    @cached_property
    def torsion(self) -> Floats:
        """(E,) torsion of each edge [rad]: the angle between span(e, a_i) and span(e, a_j)."""
        return torsion(self.mesh, self.axes)

    @cached_property
    def lean(self) -> Floats:
        """(V,) lean of each vertex [rad]: the angle between node axis and vertex normal."""
        return lean(self.mesh, self.axes)

    @property
    def torsion_deg_max(self) -> float:
        """Greatest torsion of an edge [deg]."""
        return float(np.degrees(self.torsion.max()))

    @property
    def torsion_deg_mean(self) -> float:
        """Mean torsion of the edges [deg]."""
        return float(np.degrees(self.torsion.mean()))

    @property
    def lean_deg_max(self) -> float:
        """Greatest lean of a vertex [deg]."""
        return float(np.degrees(self.lean.max()))

    @property
    def lean_deg_mean(self) -> float:
        """Mean lean of the vertices that faces use [deg]."""
        return float(np.degrees(self.lean[self.mesh.valences > 0].mean()))

    def worst_edges(self, count: int = 5) -> Ints:
        """Ids of the edges of greatest torsion, worst first."""
        return np.argsort(-self.torsion, kind="stable")[:count]

    def worst_vertices(self, count: int = 5) -> Ints:
        """Ids of the vertices of greatest lean, worst first."""
        return np.argsort(-self.lean, kind="stable")[:count]

    def leaning(self, limit_deg: float) -> Ints:
        """Ids of the vertices whose axis leans by more than a limit [deg], worst first."""
        order = np.argsort(-self.lean, kind="stable")
        return order[np.degrees(self.lean[order]) > limit_deg]

    @property
    def torsion_free(self) -> bool:
        """Whether no edge exceeds `TORSION_EXACT_DEG`."""
        return self.torsion_deg_max <= TORSION_EXACT_DEG

    @cached_property
    def beam_height_spread(self) -> float | None:
        """Greatest less least height of beams whose lower edges meet on the axes, over the mean.

        Zero on an edge offset: beams of one height everywhere. None with torsion, where the lower
        edges do not meet, and where an axis runs along an edge. See
        `ddgfab.support.edge.beam_heights`.
        """
        if not self.torsion_free:
            return None
        try:
            return float(np.ptp(beam_heights(self.mesh, self.axes)))
        except DegenerateError:
            return None

    @cached_property
    def edge_planes(self) -> Floats:
        """(E, 3) unit normals n(e) of the planes pi(e) through the edges and their axes.

        n(e) = (a_i + a_j) x e made unit, with e running from `mesh.edges` column 0 to column 1:
        it points across the beam into the left face of the edge, ``edge_faces[:, 0]``.
        """
        start, end = self.mesh.edges.T
        return unit(np.cross(self.axes[start] + self.axes[end], unit(self.mesh.edge_vectors)))

    def __repr__(self) -> str:
        return (
            f"SupportStructure({self.kind}, {self.mesh.n_vertices} axes, "
            f"torsion max {self.torsion_deg_max:.1e} deg, "
            f"lean max {self.lean_deg_max:.1f} mean {self.lean_deg_mean:.1f} deg)"
        )

    def to_dict(self) -> dict[str, Any]:
        """The certificate as plain data, as the manifest keeps it (angles in degrees)."""
        edges, vertices = self.worst_edges(), self.worst_vertices()
        return {
            "kind": self.kind,
            "status": self.status,
            "steps": len(self.history_deg),
            "torsion_free": self.torsion_free,
            "torsion_deg_max": self.torsion_deg_max,
            "torsion_deg_mean": self.torsion_deg_mean,
            "torsion_worst_edges": _table("edge", edges, self.torsion),
            "beam_height_spread": self.beam_height_spread,
            "lean_deg_max": self.lean_deg_max,
            "lean_deg_mean": self.lean_deg_mean,
            "lean_worst_vertices": _table("vertex", vertices, self.lean),
        }


def _table(name: str, ids: Ints, angles: Floats) -> list[dict[str, float]]:
    return [{name: int(i), "deg": float(np.degrees(angles[i]))} for i in ids]
