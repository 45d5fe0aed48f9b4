"""How curved a mesh is: range of its mean and Gauss curvature, for reports."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from ddgfab.arguments import checked
from ddgfab.curvature import cotangent_mean_curvature
from ddgfab.curvature.cotangent import angle_defects, mixed_vertex_areas, triangulate
from ddgfab.errors import DdgError
from ddgfab.mesh import Floats, Mesh
from ddgfab.transforms.gauss import GaussKind, mesh_curvatures

KINDS: Final[tuple[GaussKind, ...]] = ("vertex", "face", "edge")
"""Gauss images that are exact, in the order in which they are tried."""

DIGITS_TOLERANCE: Final = 1e-4
"""Tolerance of Gauss images, for files of six digits."""

MOST_FACES: Final = 20_000
"""Larger meshes are measured by cotangents; a Gauss image of one takes long."""

NAMES: Final = {"vertex": "circular", "face": "conical", "edge": "Koebe"}


@dataclass(frozen=True)
class CurvatureRange:
    """Least, mean and greatest curvature; a sphere with faces that look outward has H = -1 / R.

    Attributes
    ----------
    mean : of H, by the unit of length
    gauss : of K, by its square
    way : how they were found
    """

    mean: tuple[float, float, float]
    gauss: tuple[float, float, float]
    way: str

    def lines(self) -> list[tuple[str, str]]:
        """Title and text of each curvature, for a mesh in millimetres, by metres."""
        rows = []
        for title, values, power in (("mean curvature H", self.mean, 1),
                                     ("Gauss curvature K", self.gauss, 2)):  # fmt: skip
            low, middle, high = (1000.0**power * value for value in values)
            symbol = "1/m" if power == 1 else "1/m2"
            text = f"{low:.3g} to {high:.3g}, mean {middle:.3g} {symbol}; {self.way}"
            rows.append((title, text))
        return rows

    def to_dict(self) -> dict[str, object]:
        """Plain numbers for JSON: least, mean, greatest of each, per mm where the mesh is in mm."""
        return {"mean": list(self.mean), "gauss": list(self.gauss), "way": self.way}


@checked
def curvature_range(mesh: Mesh) -> CurvatureRange | None:
    """Range of mean and Gauss curvature, by the mesh's own Gauss image or else by cotangents.

    Circular, conical and Koebe nets: Steiner's formula at each face. Other meshes: the cotangent
    formula and angle defects of the mesh cut into triangles, at inner vertices. Means are weighted
    by area. None for a mesh that has neither a Gauss image nor an inner vertex.

    Source: Bobenko, Pottmann, Wallner 2010; Meyer, Desbrun, Schroeder, Barr 2003; mathematics.md
    8.2, 8.4.
    """
    kinds = KINDS if mesh.n_faces <= MOST_FACES and (mesh.face_sizes > 3).any() else ()
    for kind in kinds:
        try:
            found = mesh_curvatures(mesh, kind, DIGITS_TOLERANCE)
        except DdgError:
            continue
        way = f"by the Gauss image of a {NAMES[kind]} net, at faces"
        return _range(found.mean, found.gauss, mesh.face_areas, way)
    cut = triangulate(mesh)
    inner = ~cut.boundary_vertex & (cut.valences > 0)
    if not inner.any():
        return None
    area = mixed_vertex_areas(cut)[inner]
    mean = cotangent_mean_curvature(cut)[inner]
    gauss = angle_defects(cut)[inner] / area
    return _range(mean, gauss, area, "by cotangents, at inner vertices")


def _range(mean: Floats, gauss: Floats, weights: Floats, way: str) -> CurvatureRange | None:
    """The range of finite values."""
    if not (np.isfinite(mean).all() and np.isfinite(gauss).all()):
        return None
    least = [
        (float(v.min()), float(np.average(v, weights=weights)), float(v.max()))
        for v in (mean, gauss)
    ]
    return CurvatureRange(least[0], least[1], way)
