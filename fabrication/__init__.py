"""fabrication: from a discrete surface to parts, checks and files.

`design` and what it gives are imported when first used, so that the command line starts at once.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from fabrication.designs import Design, design
    from fabrication.pipeline import JobResult, make

__all__ = ["Design", "JobResult", "design", "make"]

_HOMES = {
    "Design": "fabrication.designs",
    "design": "fabrication.designs",
    "JobResult": "fabrication.pipeline",
    "make": "fabrication.pipeline",
}


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'fabrication' has no attribute '{name}'")
    from importlib import import_module

    return getattr(import_module(_HOMES[name]), name)
