"""ddgfab: discrete parametric surfaces and their torsion-free structures; numpy and scipy only."""

from __future__ import annotations

from importlib.metadata import PackageNotFoundError, version

from ddgfab.errors import DdgError
from ddgfab.io import read_mesh, write_obj
from ddgfab.measures import inspect
from ddgfab.mesh import Mesh
from ddgfab.net import Net
from ddgfab.support import SupportStructure, support_structure

__all__ = [
    "DdgError",
    "Mesh",
    "Net",
    "SupportStructure",
    "__version__",
    "inspect",
    "read_mesh",
    "support_structure",
    "write_obj",
]

try:
    __version__ = version("ddgfab")
except PackageNotFoundError:  # a source tree that is not installed
    __version__ = "0+source"
