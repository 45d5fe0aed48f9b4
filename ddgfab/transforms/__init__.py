"""Transformations that keep classes of nets."""

from __future__ import annotations

from ddgfab.transforms.baecklund_transform import (
    baecklund,
    baecklund_from,
    baecklund_lattice,
    bianchi,
)
from ddgfab.transforms.christoffel import christoffel_dual
from ddgfab.transforms.darboux_transform import darboux, darboux_common, darboux_dual
from ddgfab.transforms.gauss import gauss_image, mesh_curvatures
from ddgfab.transforms.moebius import Moebius, invert, invert_normals
from ddgfab.transforms.parallel import (
    combescure,
    nearest_parallel,
    parallel_along,
    parallel_dimension,
    parallel_space,
)
from ddgfab.transforms.ribaucour_transform import ribaucour

__all__ = [
    "Moebius",
    "baecklund",
    "baecklund_from",
    "baecklund_lattice",
    "bianchi",
    "christoffel_dual",
    "combescure",
    "darboux",
    "darboux_common",
    "darboux_dual",
    "gauss_image",
    "invert",
    "invert_normals",
    "mesh_curvatures",
    "nearest_parallel",
    "parallel_along",
    "parallel_dimension",
    "parallel_space",
    "ribaucour",
]
