"""Transformations that keep classes of nets."""

from __future__ import annotations

from ddgfab.transforms.moebius import Moebius, invert, invert_normals
from ddgfab.transforms.parallel import (
    combescure,
    nearest_parallel,
    parallel_dimension,
    parallel_space,
)

__all__ = [
    "Moebius",
    "combescure",
    "invert",
    "invert_normals",
    "nearest_parallel",
    "parallel_dimension",
    "parallel_space",
]
