"""Smooth surfaces that the nets discretise: oracles of the tests and sources of nets."""

from __future__ import annotations

from ddgfab.surfaces.ellipsoid import (
    ellipsoid_curvatures,
    ellipsoid_normals,
    ellipsoid_patch,
    ellipsoid_umbilics,
)
from ddgfab.surfaces.isothermic import smooth_dual, smooth_isothermic_residuals
from ddgfab.surfaces.k_closed import (
    breather_lines,
    dini_lines,
    kuen_lines,
    pseudosphere_lines,
    rotational_lines,
)
from ddgfab.surfaces.k_surfaces import (
    KSurface,
    amsler,
    amsler_angle,
    breather,
    dini,
    kuen,
    pseudosphere,
    surface_of,
)
from ddgfab.surfaces.minimal import (
    Weierstrass,
    smooth_catenoid,
    smooth_enneper,
    smooth_scherk_tower,
    smooth_schwarz_p,
)
from ddgfab.surfaces.ribaucour import ChebyshevSurface, smooth_ribaucour
from ddgfab.surfaces.sequences import KSequence, baecklund_sequence, smooth_darboux
from ddgfab.surfaces.sine_gordon import (
    baecklund_angle,
    breather_angle,
    permute,
    sine_gordon_defect,
    soliton,
    solitons,
)

__all__ = [
    "ChebyshevSurface",
    "KSequence",
    "KSurface",
    "Weierstrass",
    "amsler",
    "amsler_angle",
    "baecklund_angle",
    "baecklund_sequence",
    "breather",
    "breather_angle",
    "breather_lines",
    "dini",
    "dini_lines",
    "ellipsoid_curvatures",
    "ellipsoid_normals",
    "ellipsoid_patch",
    "ellipsoid_umbilics",
    "kuen",
    "kuen_lines",
    "permute",
    "pseudosphere",
    "pseudosphere_lines",
    "rotational_lines",
    "sine_gordon_defect",
    "smooth_catenoid",
    "smooth_darboux",
    "smooth_dual",
    "smooth_enneper",
    "smooth_isothermic_residuals",
    "smooth_ribaucour",
    "smooth_scherk_tower",
    "smooth_schwarz_p",
    "soliton",
    "solitons",
    "surface_of",
]
