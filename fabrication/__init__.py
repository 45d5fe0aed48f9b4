"""fabrication: from a discrete surface or a linkage to parts, checks and files.

`design`, `kit` and what they give are imported when first used, so that the command line starts at
once.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from fabrication.gridshell.design import Design, design
    from fabrication.job.result import JobResult
    from fabrication.job.run import make
    from fabrication.linkage.kit import Kit, kit

__all__ = ["Design", "JobResult", "Kit", "design", "kit", "make"]

_HOMES = {
    "Design": "fabrication.gridshell.design",
    "design": "fabrication.gridshell.design",
    "JobResult": "fabrication.job.run",
    "make": "fabrication.job.run",
    "Kit": "fabrication.linkage.kit",
    "kit": "fabrication.linkage.kit",
}


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'fabrication' has no attribute '{name}'")
    from importlib import import_module

    return getattr(import_module(_HOMES[name]), name)
