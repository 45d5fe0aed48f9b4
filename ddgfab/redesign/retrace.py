"""A net traced anew on the surface that a mesh stands for, where its edges run the wrong way."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from ddgfab.arguments import checked
from ddgfab.errors import DegenerateError, InputError, MeshError
from ddgfab.mesh import Mesh
from ddgfab.optimize.surface import SmoothSurface
from ddgfab.surfaces.fit import FittedSurface, fit_mesh
from ddgfab.surfaces.nearest import nearest_points
from ddgfab.surfaces.principal import DETERMINED
from ddgfab.trace import Traced, trace
from ddgfab.trace.reference import reference_mesh
from ddgfab.trace.samples import Samples

_SMOOTH: Final = (1e-9, 1e-4, 3e-4, 1e-3, 3e-3)
"""Residuals, as parts of the size, that a smoother surface may have: the first that makes a net."""

_WEAK: Final = 0.5
"""Greatest part of the surface on which principal directions may mean nothing."""


@dataclass(frozen=True, eq=False)
class Retraced:
    """A surface fitted to a mesh and a net of curvature lines on it.

    Attributes
    ----------
    traced : the net, with its quality
    reference : the surface as a fine mesh over the net (see `reference_mesh`)
    spacing : of the lines: the median edge of the mesh
    """

    fitted: FittedSurface
    traced: Traced
    reference: Mesh
    spacing: float

    @property
    def mesh(self) -> Mesh:
        """The net."""
        return self.traced.mesh

    def notes(self, unit: str = "mm") -> tuple[str, ...]:
        """What was done, a line each."""
        fitted, quality = self.fitted, self.traced.quality
        return (
            f"retraced on a smooth surface {fitted.rms:.3g} {unit} from the mesh (root mean "
            f"square), spacing {self.spacing:.4g} {unit}: {quality.lines[0]} and "
            f"{quality.lines[1]} lines, {quality.faces} faces",
            *((fitted.warning,) if fitted.warning else ()),
            *quality.remarks(),
        )

    def distance_note(self, mesh: Mesh, result: Mesh, unit: str = "mm") -> str:
        """How far the vertices of a result lie from the surface, and it from the first mesh."""
        far = nearest_points(self.fitted.surface, result.vertices[result.valences > 0]).distance
        back = SmoothSurface(mesh).distance(result.vertices[result.valences > 0])
        return (
            f"vertices lie {far.mean():.2g} {unit} from the smooth surface on average, at most "
            f"{far.max():.3g}; from the first mesh {back.mean():.2g}, at most {back.max():.3g} "
            f"{unit}"
        )


@checked
def retrace(mesh: Mesh, spacing: float | None = None, *, name: str = "mesh") -> Retraced:
    """A net of curvature lines on the surface of a mesh, at the spacing of the mesh.

    Parameters
    ----------
    spacing : distance of neighboring lines; by default the median edge

    Raises
    ------
    MeshError, DegenerateError
        No surface fits the mesh (see `fit_mesh`), or none of the smoother ones makes a net.
    InputError
        A spacing that does not suit the surface.
    """
    asked = float(np.median(mesh.edge_lengths)) if spacing is None else float(spacing)
    last: Exception | None = None
    for smooth in _SMOOTH:
        fitted = fit_mesh(mesh, smooth=smooth, name=name)
        _check_determined(fitted)
        try:
            found = trace(fitted.surface, asked)
        except InputError as error:
            if not isinstance(error, MeshError):
                raise
            last = error
        except DegenerateError as error:
            last = error
        else:
            return Retraced(fitted, found, reference_mesh(fitted.surface, found.traced), asked)
    raise DegenerateError(
        f"{name}: no net of curvature lines at spacing {asked:.4g}: {last}"
    ) from None


def _check_determined(fitted: FittedSurface) -> None:
    """Raise where principal directions are those of noise."""
    samples = Samples.of(fitted.surface)
    weak = samples.principal.anisotropy[samples.inside] < DETERMINED
    if weak.mean() > _WEAK:
        raise DegenerateError(
            f"{fitted.surface.name}: directions are not determined on {100 * weak.mean():.0f} % of "
            f"the surface (anisotropy below {DETERMINED:g}; limit {100 * _WEAK:g} %): every "
            "orthogonal net is nearly principal\nthe mesh can stay as it is: ddgfab optimize, or "
            "give directions: ddgfab trace --along X,Y,Z"
        )
