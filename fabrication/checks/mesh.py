"""Checks of a part's mesh: manifold, watertight, outward, one body, genus, volume, no crossings.

manifold3d's status alone accepts meshes that are inside out, overlapping shells and bodies that
cross themselves: so orientation, components and volume are checked beside it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from ddgfab.mesh import Floats
from fabrication.checks.crossing import crossings
from fabrication.specs import Check, TriangleMesh

VOLUME_ROUNDING: Final = 1e-9
"""Relative slack of a mesh's volume for rounding, beside what the chord tolerance gives."""


@dataclass(frozen=True)
class MeshReport:
    """A triangle mesh in numbers: edges without exactly one opposite, bodies, genus, volume, area.

    Volume [mm3] is signed: negative when the mesh is inside out. genus is summed over the
    components, from the Euler characteristic; it means something for watertight meshes only.
    """

    triangles: int
    open_edges: int
    components: int
    genus: int
    volume: float
    area: float

    @property
    def watertight(self) -> bool:
        """Whether every edge has exactly one opposite half-edge."""
        return self.triangles > 0 and self.open_edges == 0


def measure_mesh(mesh: TriangleMesh) -> MeshReport:
    """Count and integrate a mesh with numpy alone (no manifold3d)."""
    tri = mesh.triangles
    n = len(mesh.vertices)
    start, end = tri.ravel(), np.roll(tri, -1, axis=1).ravel()
    key, opposite = np.sort(start * n + end), np.sort(end * n + start)
    if len(key) and np.array_equal(key, opposite) and (key[1:] != key[:-1]).all():
        open_edges = 0
    else:
        here, count = np.unique(key, return_counts=True)
        back, count_back = np.unique(opposite, return_counts=True)
        paired = np.isin(here, back[count_back == 1]) & (count == 1)
        open_edges = int(len(key) - paired.sum())
    used = np.unique(tri)
    components, genus = 0, 0
    if len(tri):
        graph = coo_array((np.ones(len(start)), (start, end)), shape=(n, n))
        labels = connected_components(graph, directed=False)[1]
        components = len(np.unique(labels[used]))
        euler = len(used) - len(np.unique(np.minimum(start, end) * n + np.maximum(start, end)))
        genus = components - (euler + len(tri)) // 2
    return MeshReport(len(tri), open_edges, components, genus, *_integrals(mesh))


def check_mesh(
    mesh: TriangleMesh,
    *,
    volume: float,
    area: float,
    chord: float,
    genus: int = 0,
    self_crossing: bool = True,
) -> list[Check]:
    """The checks of one part's mesh.

    Parameters
    ----------
    volume, area : of the exact part [mm3, mm2]
    chord : greatest distance [mm] of the mesh from the exact surface; bounds the volume's error by
        area * chord
    genus : expected number of through holes and handles
    self_crossing : also look for triangles that go through each other

    Returns
    -------
    Checks "mesh manifold" (manifold3d's status), "mesh watertight", "mesh components",
    "mesh outward" (volume > 0), "mesh genus", "mesh volume" (deviation [mm3] against its bound),
    "mesh crossings" (pairs of triangles that go through each other).
    """
    report = measure_mesh(mesh)
    bound = area * chord + VOLUME_ROUNDING * abs(volume)
    status = to_manifold(mesh).status().name
    deviation = abs(report.volume - volume)
    checks = [
        Check("mesh manifold", status == "NoError", status, "NoError"),
        Check("mesh watertight", report.watertight, float(report.open_edges), 0.0),
        Check("mesh components", report.components == 1, float(report.components), 1.0),
        Check("mesh outward", report.volume > 0, report.volume, 0.0),
        Check("mesh genus", report.genus == genus, float(report.genus), float(genus)),
        Check("mesh volume", deviation <= bound, deviation, bound),
    ]
    if self_crossing:
        found = float(len(crossings(mesh)))
        checks.append(Check("mesh crossings", found == 0, found, 0.0))
    return checks


def to_manifold(mesh: TriangleMesh) -> Any:
    """The mesh as a manifold3d body in double precision; its status says whether it is one."""
    import manifold3d

    return manifold3d.Manifold(
        manifold3d.Mesh64(
            np.ascontiguousarray(mesh.vertices, dtype=np.float64),
            np.ascontiguousarray(mesh.triangles, dtype=np.uint64),
        )
    )


def _integrals(mesh: TriangleMesh) -> tuple[float, float]:
    """Signed volume (divergence theorem about the first vertex) and area."""
    if not len(mesh.triangles):
        return 0.0, 0.0
    corners: Floats = mesh.vertices[mesh.triangles] - mesh.vertices[mesh.triangles[0, 0]]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    volume = float(np.einsum("ij,ij->", corners[:, 0], cross)) / 6.0
    return volume, float(np.linalg.norm(cross, axis=1).sum()) / 2.0
