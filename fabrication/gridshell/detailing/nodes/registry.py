"""Which kinds of nodes there are: a line each. A kind's module is imported when it is used."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from fabrication.gridshell.detailing.nodes.base import NodeSize

_HERE = "fabrication.gridshell.detailing.nodes"

MODULES: Final = {
    "cylinder": (f"{_HERE}.round", "Cylinder"),
    "tube": (f"{_HERE}.round", "Tube"),
    "star": (f"{_HERE}.star", "Star"),
    "plates": (f"{_HERE}.plates", "Plates"),
}
"""Module and class of each kind, by its name in [node] kind."""

_REGISTERED: dict[str, type[NodeSize]] = {}


def names() -> tuple[str, ...]:
    """Names of all kinds of nodes."""
    return tuple(dict.fromkeys([*MODULES, *_REGISTERED]))


def register(name: str, kind: type[NodeSize]) -> None:
    """Add a kind under its name, or put it in the place of the one that has this name."""
    _REGISTERED[name] = kind


def unregister(name: str) -> None:
    """Take back what `register` did."""
    _REGISTERED.pop(name, None)


def find(name: str) -> type[NodeSize]:
    """The kind of a name, one of `names()`."""
    if name in _REGISTERED:
        return _REGISTERED[name]
    module, attribute = MODULES[name]
    kind: type[NodeSize] = getattr(import_module(module), attribute)
    return kind


def kinds_of(key: str) -> tuple[str, ...]:
    """Names of the kinds that have a key of [node] for themselves; none: all kinds have it."""
    return tuple(name for name in names() if key in find(name).keys)
