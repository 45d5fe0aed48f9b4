"""How far the edges of a mesh are from principal, and from conjugate, directions of its surface.

Directions are those of a smooth surface fitted to the mesh (or given), at the centers of the inner
quads; the edges of a quad are its two middle lines. Source: do Carmo, Differential Geometry of
Curves and Surfaces, 3.2 to 3.3.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from ddgfab.arguments import checked
from ddgfab.errors import MeshError
from ddgfab.mesh import Floats, Ints, Mesh
from ddgfab.surfaces.fit import fit_mesh
from ddgfab.surfaces.nearest import nearest_points
from ddgfab.surfaces.principal import DETERMINED, forms, principal
from ddgfab.surfaces.spline import SplineSurface

Flags = NDArray[np.bool_]

_FLAT: Final = 0.05
"""Where both edges bend by less than this part of the median curvature, none is conjugate."""


@dataclass(frozen=True, eq=False)
class Alignment:
    """Angles between the edges of quads and directions of the surface.

    Attributes
    ----------
    faces : (n,) ids of the quads: those that do not touch the rim, where there are any
    principal : (n,) angle [rad] from the edges to the principal directions, 0 to pi / 4, the
        greater of both edges
    conjugate : (n,) angle [rad] by which one of the edges must turn to be conjugate to the other,
        0 to pi / 2
    turn : (n,) angle [rad] by which both edges together are turned from the principal
        directions, -pi / 4 to pi / 4
    anisotropy : (n,) difference of the principal curvatures over the sum of their sizes
    half : (n,) half the difference of the principal curvatures
    determined : (n,) whether principal directions mean anything: anisotropy of 0.05 or more
    curved : (n,) whether conjugate directions do: an edge bends
    surface : that the directions are of
    distance : root mean square of the distance of the vertices from it
    """

    faces: Ints
    principal: Floats
    conjugate: Floats
    turn: Floats
    anisotropy: Floats
    half: Floats
    determined: Flags
    curved: Flags
    surface: SplineSurface
    distance: float

    @property
    def principal_deg(self) -> tuple[float, float, float] | None:
        """Median, 95th percentile, greatest; None where no principal direction is determined."""
        return _three(self.principal[self.determined])

    @property
    def conjugate_deg(self) -> tuple[float, float, float] | None:
        """Median, 95th percentile, greatest; None where the surface is plane."""
        return _three(self.conjugate[self.curved])

    @property
    def anisotropy_median(self) -> float:
        """Of the faces."""
        return float(np.median(self.anisotropy))

    def lines(self) -> list[tuple[str, str]]:
        """Titles and texts for people."""
        count = len(self.faces)
        found = self.principal_deg
        if found is None:
            one = (
                f"directions are not determined (anisotropy {self.anisotropy_median:.3f}, below "
                f"{DETERMINED:g}): every orthogonal net is nearly principal"
            )
        else:
            one = _angles(found, int(self.determined.sum()), count)
            one += f"; anisotropy {self.anisotropy_median:.3f}"
        found = self.conjugate_deg
        two = "the surface is plane" if found is None else ""
        two = two if found is None else _angles(found, int(self.curved.sum()), count)
        return [("from principal", one), ("from conjugate", two)]

    def to_dict(self) -> dict[str, Any]:
        """Plain values for JSON; angles [deg] are median, 95th percentile, greatest, or null."""
        return {
            "faces": len(self.faces),
            "principal_deg": _plain(self.principal_deg),
            "conjugate_deg": _plain(self.conjugate_deg),
            "anisotropy_median": self.anisotropy_median,
            "determined_percent": 100 * float(self.determined.mean()),
            "fit_rms": self.distance,
        }


@checked
def alignment(mesh: Mesh, surface: SplineSurface | None = None) -> Alignment:
    """Angles between the edges of the quads of a mesh and principal and conjugate directions.

    Parameters
    ----------
    surface : that the mesh discretises; by default one fitted to its vertices

    Raises
    ------
    MeshError
        No quads; a mesh that no surface can be fitted to (names why).
    DegenerateError
        As `fit_mesh`.
    """
    quads = np.flatnonzero(mesh.face_sizes == 4)
    if not len(quads):
        raise MeshError(
            "the mesh has no quads: directions of edges are those of quads (ddgfab trace makes a "
            "net of quads on a surface)"
        )
    rim = mesh.boundary_vertex[mesh.corners[mesh.face_start[quads, None] + np.arange(4)]]
    inner = quads[~rim.any(axis=1)]
    faces = inner if len(inner) else quads
    if surface is None:
        fitted = fit_mesh(mesh)
        surface, distance = fitted.surface, fitted.rms
    else:
        used = mesh.vertices[mesh.valences > 0]
        distance = float(np.sqrt(np.mean(nearest_points(surface, used).distance ** 2)))
    ring = mesh.vertices[mesh.corners[mesh.face_start[faces, None] + np.arange(4)]]
    jets = surface.jets(nearest_points(surface, ring.mean(axis=1)).uv)
    found, form = principal(jets), forms(jets)
    middles = 0.5 * (ring + np.roll(ring, -1, axis=1))
    edges = middles[:, 1] - middles[:, 3], middles[:, 2] - middles[:, 0]
    across = np.cross(form.normal, jets.u / form.a[:, None])
    first = jets.u / form.a[:, None]
    flat = [
        np.stack([np.einsum("nx,nx->n", e, first), np.einsum("nx,nx->n", e, across)], axis=1)
        for e in edges
    ]
    flat = [e / np.maximum(np.linalg.norm(e, axis=1, keepdims=True), 1e-300) for e in flat]
    axis = 0.5 * np.arctan2(found.deviator[:, 1], found.deviator[:, 0])
    off = [_folded(np.arctan2(e[:, 1], e[:, 0]) - axis) for e in flat]
    turn = 0.25 * np.angle(np.exp(4j * off[0]) + np.exp(4j * off[1]))
    bends = [
        np.stack([form.p * e[:, 0] + form.q * e[:, 1], form.q * e[:, 0] + form.r * e[:, 1]], axis=1)
        for e in flat
    ]
    both = np.abs(np.einsum("nx,nx->n", bends[0], flat[1]))
    bend = np.maximum(*(np.linalg.norm(b, axis=1) for b in bends))
    half = np.hypot(*found.deviator.T)
    size = np.maximum(np.abs(found.larger), np.abs(found.smaller))
    curved = bend > _FLAT * np.median(size)
    return Alignment(
        faces=faces,
        principal=np.maximum(np.abs(off[0]), np.abs(off[1])),
        conjugate=np.arcsin(np.clip(both / np.where(bend > 0, bend, 1.0), 0.0, 1.0)),
        turn=turn,
        anisotropy=found.anisotropy,
        half=half,
        determined=found.anisotropy >= DETERMINED,
        curved=curved & (size > 1e-12 / mesh.diameter),
        surface=surface,
        distance=distance,
    )


def _folded(angle: Floats) -> Floats:
    """Angles less whole quarter turns, -pi / 4 to pi / 4."""
    return np.asarray(angle - np.pi / 2 * np.round(angle / (np.pi / 2)))


def _three(angles: Floats) -> tuple[float, float, float] | None:
    if not len(angles):
        return None
    median, most, greatest = np.degrees(np.percentile(angles, [50, 95, 100])).tolist()
    return float(median), float(most), float(greatest)


def _angles(found: tuple[float, float, float], where: int, count: int) -> str:
    text = f"median {found[0]:.3g}, 95 % below {found[1]:.3g}, greatest {found[2]:.3g} deg"
    return text if where == count else f"{text} (on {where} of {count} faces; undetermined else)"


def _plain(found: tuple[float, ...] | None) -> list[float] | None:
    return None if found is None else [float(f"{value:.12g}") for value in found]
