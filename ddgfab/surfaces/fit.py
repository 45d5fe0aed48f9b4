"""A mesh as a smooth surface: a quintic tensor spline fitted over its plan.

The weight of smoothness is chosen by the data: the largest that costs 8 % of the residual. Source:
Eilers, Marx 1996, Flexible smoothing with B-splines and penalties; docs/surfaces.md.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from scipy.interpolate import BSpline
from scipy.linalg import cho_factor, cho_solve
from scipy.sparse import csr_array

from ddgfab.arguments import checked
from ddgfab.errors import DegenerateError, MeshError
from ddgfab.mesh import Floats, Mesh
from ddgfab.surfaces.spline import SplineSurface

_DEGREE: Final = 5
_COEFFICIENTS: Final = 22
"""Control points a side."""
_WEIGHTS: Final = 10.0 ** np.arange(-9, 3)
_WORSE: Final = 1.08
"""A smoother surface may have this part of the least residual."""
_SHRINK: Final = 0.985
"""The trim is the rim of the mesh, smaller by this: directions are worst at the rim."""
_FAR: Final = 0.01
"""A residual (root mean square) beyond this part of the size is no fit."""
_FOLDED: Final = 1e-3
"""Part of the area that may face down in plan: slivers turned over by noise, no folds."""
_MARGIN: Final = 0.005
"""The rectangle of parameters reaches beyond the plan by this part of its size."""


@dataclass(frozen=True, eq=False)
class FittedSurface:
    """A surface fitted to a mesh.

    Attributes
    ----------
    surface : over the plan of the mesh, trimmed by its rim
    residual : (V,) distance of each vertex from the surface at its own parameters
    smoothness : weight of the smoothness that was chosen
    """

    surface: SplineSurface
    residual: Floats
    smoothness: float

    @property
    def rms(self) -> float:
        """Root mean square of the residual: the noise of the mesh, as the fit sees it."""
        return float(np.sqrt(np.mean(self.residual**2)))


@checked
def fit_mesh(mesh: Mesh, *, name: str = "mesh") -> FittedSurface:
    """A smooth surface near the vertices of a mesh with one rim.

    Parameters are plan coordinates in the least-squares plane.

    Raises
    ------
    MeshError
        Several pieces, several rims or none, fewer vertices than an even fit needs.
    DegenerateError
        Faces that lie upside down in plan, or a residual above 1 % of the size.
    """
    if int(mesh.components.max()) > 0:
        raise MeshError(f"{name}: {int(mesh.components.max()) + 1} pieces; one is needed")
    euler = int((mesh.valences > 0).sum()) - mesh.n_edges + mesh.n_faces
    if len(mesh.boundary_loops) != 1 or euler != 1:
        raise MeshError(
            f"{name}: {len(mesh.boundary_loops)} rims, Euler characteristic {euler}; a disk with "
            "one rim is needed: cut it open, or fill its holes"
        )
    used = np.flatnonzero(mesh.valences > 0)
    points = mesh.vertices[used]
    if len(points) < 2 * _DEGREE**2:
        raise MeshError(f"{name}: {len(points)} vertices; {2 * _DEGREE**2} are needed for a fit")
    center = points.mean(axis=0)
    up = mesh.vector_areas.sum(axis=0)
    axes = np.linalg.svd(points - center, full_matrices=False)[2]
    if axes[2] @ up < 0:
        axes[2] *= -1
    axes[1] = np.cross(axes[2], axes[0])
    size = mesh.diameter
    plan = (mesh.vertices - center) @ axes[:2].T
    facing = mesh.vector_areas @ axes[2]
    down = np.flatnonzero(facing <= 0)
    if -facing[down].sum() > _FOLDED * np.abs(facing).sum():
        raise DegenerateError(
            f"{name}: {len(down)} faces stand upright or upside down in plan (face {down[0]}); the "
            "surface cannot be fitted over its plan\ncut it into flatter pieces"
        )
    low, high = plan[used].min(axis=0) - _MARGIN * size, plan[used].max(axis=0) + _MARGIN * size
    knots = [_knots(low[k], high[k]) for k in (0, 1)]
    rows = _rows(plan[used], knots)
    control, smoothness = _smoothest(rows, (points - center) / size)
    control = center + size * control.reshape(_COEFFICIENTS, _COEFFICIENTS, 3)
    rim = plan[mesh.boundary_loops[0]]
    middle = rim.mean(axis=0)
    surface = SplineSurface(
        control,
        knots,
        (_DEGREE, _DEGREE),
        None,
        [middle + _SHRINK * (rim - middle)],
        name=name,
    )
    residual = np.zeros(mesh.n_vertices)
    residual[used] = np.linalg.norm(surface.points(plan[used]) - points, axis=1)
    found = FittedSurface(surface, residual, smoothness)
    if found.rms > _FAR * size:
        worst = int(residual.argmax())
        raise DegenerateError(
            f"{name}: a smooth surface stays {found.rms:.4g} away on average (limit "
            f"{_FAR * size:.4g}), most at vertex {worst} ({residual[worst]:.4g}): it has creases, "
            "or is too rough"
        )
    return found


def _knots(low: float, high: float) -> Floats:
    inner = np.linspace(low, high, _COEFFICIENTS - _DEGREE + 1)
    return np.concatenate([np.full(_DEGREE, low), inner, np.full(_DEGREE, high)])


def _rows(plan: Floats, knots: list[Floats]) -> csr_array:
    """(n, coefficients^2) values of all products of basis functions at points of the plan."""
    one, two = (BSpline.design_matrix(plan[:, k], knots[k], _DEGREE).toarray() for k in (0, 1))
    return csr_array((one[:, :, None] * two[:, None, :]).reshape(len(plan), -1))


def _smoothest(rows: csr_array, values: Floats) -> tuple[Floats, float]:
    """Coefficients (m, 3) of the smoothest surface that is hardly worse than the nearest one."""
    normal, right = (rows.T @ rows).toarray(), rows.T @ values
    third = np.diff(np.eye(_COEFFICIENTS), 3, axis=0)
    bend = third.T @ third
    eye = np.eye(_COEFFICIENTS)
    penalty = np.kron(bend, eye) + np.kron(eye, bend)
    tiny = 1e-13 * np.trace(normal) / len(normal) * np.eye(len(normal))
    found = []
    for weight in _WEIGHTS.tolist():
        control = cho_solve(cho_factor(normal + weight * penalty + tiny), right)
        found.append((weight, control, float(np.sqrt(np.mean((rows @ control - values) ** 2)))))
    limit = max(_WORSE * min(rms for _, _, rms in found), 1e-9)
    weight, control, _ = [entry for entry in found if entry[2] <= limit][-1]
    return control, weight
