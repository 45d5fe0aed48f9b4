"""Which ddgfab wrote a file."""

from __future__ import annotations

from functools import cache
from importlib.metadata import PackageNotFoundError, version


@cache  # looking it up takes as long as writing a part
def package_version() -> str:
    """The installed version, or "0+source" when run from a source tree that is not installed."""
    try:
        return version("ddgfab")
    except PackageNotFoundError:
        return "0+source"


def originating_system() -> str:
    """What files name as their originating system."""
    return f"ddgfab {package_version()}"
