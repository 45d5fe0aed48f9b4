"""What a design should keep, as one energy: near its surface, small and smooth movements.

Not "straight polylines": far from conjugate nets, planar faces with polylines as smooth as before
exist on flattened surfaces only. What is kept smooth here is the movement.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final, Literal, TypeAlias, get_args

import numpy as np

from ddgfab.errors import InputError
from ddgfab.mesh import Floats, Ints, Mesh
from ddgfab.optimize.rim import rim_corners
from ddgfab.optimize.surface import RimCurve, SmoothSurface
from ddgfab.optimize.terms.base import LinearTerm, VectorTerm
from ddgfab.optimize.terms.cover import Covered, covered
from ddgfab.optimize.terms.edges import Lengths, edge_stretch
from ddgfab.optimize.terms.nearness import NearRim, NearSurface
from ddgfab.optimize.terms.shape import closeness, edge_differences, fair_movement, fair_rim

Keep: TypeAlias = Literal["close", "balanced", "fair"]
"""What a design keeps rather: its surface, or the smoothness of its faces."""

EnergyTerm: TypeAlias = VectorTerm | LinearTerm | Lengths | NearSurface | Covered | NearRim
"""A term of the energy."""

KEEP: Final[dict[Keep, float]] = {"close": 0.2, "balanced": 0.33, "fair": 0.5}
"""Wavelength from which movements along the normal cost distance rather than bending, as part of
the width of the mesh (the square root of its area)."""

_NEAR, _COVER, _SLIDE, _STRAIN, _RIM, _CORNER = 1.0, 1.0, 0.002, 0.02, 3.0, 5.0
"""Distances count from the mesh to the surface and back: with the vertices alone, a mesh would
slide off a flank and cut it off. Sliding and shear are cheap: where edges do not follow conjugate
directions they have to turn in the surface, and what may not slide leaves the surface or creases.
"""
FREE_CORNER: Final = 2.0
"""Weight of corners of the boundary for goals whose directions the surface alone decides: a net of
curvature lines cannot run from corner to corner."""
_STRETCH: Final = 1.0
"""Edges whose lengths change by more than `EASY_STRETCH`; below it a change is nearly free. With a
third of it some panes still become twice as long; three times as much crumples more."""
EASY_STRETCH: Final = 1.3
"""Factor up to which edges may become longer or shorter where vertices slide."""
_GLIDE: Final = 1e4
_ALONG: Final = 0.4
"""Smoothness of the sliding at "balanced"; it grows with the square of the knob."""
_EVEN_RIM: Final = 3.0
"""How many times smoother than inside the boundary moves across itself: without it rims become
ragged, and some fold back on themselves, at hardly any gain in distance. Twenty times cost coarse
meshes a tenth of their distance."""
_FAIR_RANGE: Final = 0.3, 10.0
"""Range of the weight of smoothness; the lower end sinks where the surface is to be kept closer
than "close". Below 0.3 nets of few faces crease rather than bend; above 10 fine nets stall."""


def keep_number(keep: Keep | float) -> float:
    """The number of a name.

    Raises
    ------
    InputError
        An unknown name, a number that is not positive.
    """
    if isinstance(keep, str):
        if keep not in KEEP:
            raise InputError(f'keep = "{keep}"; one of {", ".join(get_args(Keep))}, or a number')
        return KEEP[keep]
    if not (np.isfinite(keep) and keep > 0):
        raise InputError(f"keep = {keep:g}: more than zero is needed, for instance 0.33")
    return float(keep)


@dataclass(frozen=True)
class Weights:
    """Weights of the energy, for a mesh whose mean edge is one."""

    near: float = _NEAR
    cover: float = _COVER
    slide: float = _SLIDE
    strain: float = _STRAIN
    fair: float = 1.0
    along: float = _ALONG
    stretch: float = _STRETCH
    rim: float = _RIM
    even_rim: float = _EVEN_RIM
    corner: float = _CORNER

    @staticmethod
    def of(mesh: Mesh, keep: Keep | float = "balanced", *, glide: bool = False) -> Weights:
        """The weights for a mesh.

        The weight of smoothness is such that waves shorter than `keep` times the width of the mesh
        cost bending and longer ones distance, whatever the size of the faces. Of a mesh in pieces
        the largest piece counts.
        """
        width = float(np.sqrt(np.bincount(mesh.components, mesh.face_areas).max()))
        knob = keep_number(keep)
        least, most = _FAIR_RANGE
        least *= min(1.0, knob / KEEP["close"]) ** 4
        fair = float(np.clip((knob * width / (2 * np.pi)) ** 4, least, most))
        return Weights(
            strain=_STRAIN * max(1.0, float(np.sqrt(fair))),
            fair=fair,
            along=_ALONG * (knob / KEEP["balanced"]) ** 2,
            rim=_GLIDE if glide else _RIM,
            even_rim=_EVEN_RIM * fair,
        )

    def coarser(self, scale: float) -> Weights:
        """The same energy, but for a factor, on a mesh of `scale` times as long edges.

        It has fewer vertices, and the same movement is shorter in its mean edges and bends more
        from edge to edge. Weights of its own would aim at another surface than the fine mesh does.
        """
        square = scale**2
        return replace(
            self,
            strain=self.strain / square,
            fair=max(self.fair / square**2, min(self.fair, _FAIR_RANGE[0])),
            along=self.along / square**2,
            stretch=self.stretch / square,
            rim=self.rim if self.rim >= _GLIDE else self.rim / scale,
            even_rim=self.even_rim / (scale * square**2),
            corner=self.corner / square,
        )


def energy(
    mesh: Mesh,
    weights: Weights,
    surface: Mesh | None = None,
    features: Ints | None = None,
    rim: Mesh | None = None,
) -> tuple[EnergyTerm, ...]:
    """Terms of the energy of a mesh whose mean edge is one.

    Parameters
    ----------
    surface : to stay near to; that of the mesh itself by default
    features : ids of edges across which the movement need not be smooth
    rim : whose boundary that of the mesh stays near to; that of the mesh itself by default, which
        is laid on the surface unless the boundary glides
    """
    used = np.flatnonzero(mesh.valences > 0)
    smooth = SmoothSurface(mesh if surface is None else surface)
    outer = np.flatnonzero(mesh.boundary_vertex)
    terms: list[EnergyTerm] = [
        NearSurface(
            surface=smooth,
            vertices=used,
            weight=weights.near,
        ),
        covered(mesh, surface, weight=weights.cover),
        closeness(mesh, weight=weights.slide),
        _strain(mesh, weights.strain),
        edge_stretch(mesh, EASY_STRETCH, weight=weights.stretch),
        *fair_movement(mesh, weights.fair, weights.along, features=features),
    ]
    if len(outer):
        laid = mesh
        if surface is not None and weights.rim < _GLIDE:
            foot, normal = smooth.closest(mesh.vertices)
            height = np.einsum("vx,vx->v", foot - mesh.vertices, normal)
            laid = mesh.with_vertices(mesh.vertices + height[:, None] * normal)
        curve = RimCurve(laid if rim is None else rim)
        terms.append(NearRim(curve=curve, vertices=outer, weight=weights.rim))
        terms.append(fair_rim(mesh, weights.even_rim, features=features))
        held = np.zeros(mesh.n_vertices)
        held[rim_corners(mesh)] = 1.0
        if held.any():
            terms.append(closeness(mesh, laid.vertices, held, weight=weights.corner))
    return tuple(terms)


def _strain(mesh: Mesh, weight: float) -> VectorTerm:
    """Changes of edge vectors over the length of the edge: keeps small edges from collapsing."""
    lengths: Floats = mesh.edge_lengths
    matrix = edge_differences(mesh)
    matrix.data /= np.repeat(np.maximum(lengths, np.finfo(float).tiny), 2)
    return VectorTerm(
        name="strain", scalar=matrix, target=np.asarray(matrix @ mesh.vertices), weight=weight
    )
