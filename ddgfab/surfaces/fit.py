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
from scipy.sparse import coo_array, csr_array, diags_array

from ddgfab.arguments import checked
from ddgfab.errors import DegenerateError, MeshError
from ddgfab.measures import not_a_disk
from ddgfab.mesh import Floats, Mesh
from ddgfab.surfaces.spline import SplineSurface
from ddgfab.symmetric import factored

_DEGREE: Final = 5
_LEAST, _MOST, _FEWER = 12, 22, 0.7
"""Control points a side: fewer than vertices a side, by this factor; at least, at most."""
_WEIGHTS: Final = 10.0 ** np.arange(-9, 5)
_WORSE: Final = 1.08
"""A smoother surface may have this part of the least residual."""
_SHRINK: Final = 0.985
"""The trim is the rim of the mesh, smaller by this: directions are worst at the rim."""
_FAR: Final = 0.01
"""A residual (root mean square) beyond this part of the size is not a fit."""
_FOLDED: Final = 1e-3
"""Part of the area that may face down in plan: slivers turned over by noise, no folds."""
_NEAREST: Final = 1e-9
"""Residuals below this part of the size count as none."""
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
    parameters : (V, 2) of the vertices
    warning : what to know of these parameters; empty where they are plan coordinates
    """

    surface: SplineSurface
    residual: Floats
    smoothness: float
    parameters: Floats
    warning: str = ""

    @property
    def rms(self) -> float:
        """Root mean square of the residual: the noise of the mesh, as the fit sees it."""
        return float(np.sqrt(np.mean(self.residual**2)))


@checked
def fit_mesh(mesh: Mesh, *, smooth: float = _NEAREST, name: str = "mesh") -> FittedSurface:
    """A smooth surface near the vertices of a mesh with one rim.

    Parameters are plan coordinates in the least-squares plane. Where faces stand upright or upside
    down there, the rim is laid round a rectangle (four corners) or a circle and the mesh spread
    inside, with a warning: directions near the rim are less certain then.

    Parameters
    ----------
    smooth : residual (root mean square), as a part of the size, that a smoother surface may have:
        meshes that are drawn and not measured have waves that no designer meant

    Raises
    ------
    MeshError
        Several pieces, several rims or none, fewer vertices than an even fit needs.
    DegenerateError
        A residual above 1 % of the size.
    """
    if reason := not_a_disk(mesh):
        raise MeshError(f"{name}: {reason}")
    used = np.flatnonzero(mesh.valences > 0)
    points = mesh.vertices[used]
    if len(points) < 2 * _DEGREE**2:
        raise MeshError(f"{name}: {len(points)} vertices; {2 * _DEGREE**2} are needed for a fit")
    center, size = points.mean(axis=0), mesh.diameter
    plan, warning = _plan(mesh, points, center, name)
    low, high = plan[used].min(axis=0), plan[used].max(axis=0)
    margin = _MARGIN * float(np.linalg.norm(high - low))
    count = int(np.clip(_FEWER * np.sqrt(len(points)), _LEAST, _MOST))
    knots = [_knots(low[k] - margin, high[k] + margin, count) for k in (0, 1)]
    rows = _rows(plan[used], knots)
    control, smoothness = _smoothest(rows, (points - center) / size, smooth)
    control = center + size * control.reshape(count, count, 3)
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
    found = FittedSurface(surface, residual, smoothness, plan, warning)
    if found.rms > _FAR * size:
        worst = int(residual.argmax())
        raise DegenerateError(
            f"{name}: a smooth surface stays {found.rms:.4g} away on average (limit "
            f"{_FAR * size:.4g}), most at vertex {worst} ({residual[worst]:.4g}): it has creases, "
            "or is too rough"
        )
    return found


def _plan(mesh: Mesh, points: Floats, center: Floats, name: str) -> tuple[Floats, str]:
    """(V, 2) parameters of the vertices, and what to know of them."""
    up = mesh.vector_areas.sum(axis=0)
    axes = np.linalg.svd(points - center, full_matrices=False)[2]
    if axes[2] @ up < 0:
        axes[2] *= -1
    axes[1] = np.cross(axes[2], axes[0])
    facing = mesh.vector_areas @ axes[2]
    down = np.flatnonzero(facing <= 0)
    if -facing[down].sum() <= _FOLDED * np.abs(facing).sum():
        return np.asarray((mesh.vertices - center) @ axes[:2].T), ""
    plan, shape = _spread(mesh)
    return plan, (
        f"{name}: {len(down)} faces stand upright or upside down in plan (face {down[0]}), so the "
        f"mesh was spread over a {shape}: directions near the rim are uncertain"
    )


def _spread(mesh: Mesh) -> tuple[Floats, str]:
    """(V, 2) the mesh spread over a rectangle or a circle, its rim by arc length; which of both.

    Every other vertex lies in the weighted mean of its neighbors, nearer ones weigh more: faces do
    not fold. Rows and columns of quads count as they are.
    Source: Tutte 1963, How to draw a graph; Floater 1997, Parametrization.
    """
    rim = mesh.boundary_loops[0]
    x = mesh.vertices[rim]
    lengths = np.linalg.norm(np.roll(x, -1, axis=0) - x, axis=1)
    corners = np.flatnonzero(mesh.valences[rim] == 2)
    inner = ~mesh.boundary_vertex & (mesh.valences > 0)
    grid = len(corners) == 4 and (mesh.face_sizes == 4).all() and (mesh.valences[inner] == 4).all()
    near = np.ones(mesh.n_edges)
    if grid:
        lengths = np.full(len(rim), float(lengths.mean()))
    else:
        near = 1.0 / np.maximum(mesh.edge_lengths, 1e-9 * mesh.diameter)
    if len(corners) == 4:
        rim, lengths = np.roll(rim, -corners[0]), np.roll(lengths, -corners[0])
        bounds = [*(corners - corners[0]).tolist(), len(rim)]
        sides = np.add.reduceat(lengths, bounds[:-1])
        wide, high = sides[0] + sides[2], sides[1] + sides[3]
        box = np.array([[0, 0], [wide, 0], [wide, high], [0, high], [0, 0]]) / 2
        placed = []
        for k in range(4):
            part = lengths[bounds[k] : bounds[k + 1]]
            t = np.concatenate([[0], np.cumsum(part[:-1])]) / part.sum()
            placed.append(box[k] + t[:, None] * (box[k + 1] - box[k]))
        fixed, shape = np.concatenate(placed), "rectangle"
    else:
        angle = 2 * np.pi * np.concatenate([[0], np.cumsum(lengths[:-1])]) / lengths.sum()
        fixed = lengths.sum() / (2 * np.pi) * np.stack([np.cos(angle), np.sin(angle)], axis=1)
        shape = "circle"
    plan = np.zeros((mesh.n_vertices, 2))
    plan[rim] = fixed
    ends = mesh.edges
    links = csr_array(
        coo_array(
            (np.tile(near, 2), (np.concatenate(ends.T), np.concatenate(ends.T[::-1]))),
            shape=(mesh.n_vertices, mesh.n_vertices),
        )
    )
    free = np.flatnonzero(inner)
    if len(free):
        rows = links[free]
        matrix = diags_array(rows.sum(axis=1)) - rows[:, free]
        plan[free] = factored(matrix).solve(rows @ plan)
    return plan, shape


def _knots(low: float, high: float, count: int) -> Floats:
    inner = np.linspace(low, high, count - _DEGREE + 1)
    return np.concatenate([np.full(_DEGREE, low), inner, np.full(_DEGREE, high)])


def _rows(plan: Floats, knots: list[Floats]) -> csr_array:
    """(n, coefficients^2) values of all products of basis functions at points of the plan."""
    one, two = (BSpline.design_matrix(plan[:, k], knots[k], _DEGREE).toarray() for k in (0, 1))
    return csr_array((one[:, :, None] * two[:, None, :]).reshape(len(plan), -1))


def _smoothest(rows: csr_array, values: Floats, smooth: float) -> tuple[Floats, float]:
    """Coefficients (m, 3) of the smoothest surface that is hardly worse than the nearest one."""
    normal, right = (rows.T @ rows).toarray(), rows.T @ values
    eye = np.eye(round(np.sqrt(len(normal))))
    third = np.diff(eye, 3, axis=0)
    bend = third.T @ third
    penalty = np.kron(bend, eye) + np.kron(eye, bend)
    tiny = 1e-13 * np.trace(normal) / len(normal) * np.eye(len(normal))
    found = []
    for weight in _WEIGHTS.tolist():
        control = cho_solve(cho_factor(normal + weight * penalty + tiny), right)
        found.append((weight, control, float(np.sqrt(np.mean((rows @ control - values) ** 2)))))
    limit = max(_WORSE * min(rms for _, _, rms in found), smooth)
    weight, control, _ = [entry for entry in found if entry[2] <= limit][-1]
    return control, weight
