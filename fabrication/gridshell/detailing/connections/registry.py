"""Which kinds of connections there are: a line each. A kind's module is imported when used."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from fabrication.gridshell.detailing.connections.base import Connection

_HERE = "fabrication.gridshell.detailing.connections"

MODULES: Final = {
    "welded": (f"{_HERE}.welded", "Welded"),
    "stud": (f"{_HERE}.stud", "Stud"),
    "end_plate": (f"{_HERE}.end_plate", "EndPlate"),
    "slotted": (f"{_HERE}.slotted", "Slotted"),
    "bolted_tongue": (f"{_HERE}.tongue", "BoltedTongue"),
}
"""Module and class of each kind, by its name in [connection] kind."""


def names() -> tuple[str, ...]:
    """Names of all kinds of connections."""
    return tuple(MODULES)


def find(name: str) -> type[Connection]:
    """The kind of a name, one of `names()`."""
    module, attribute = MODULES[name]
    kind: type[Connection] = getattr(import_module(module), attribute)
    return kind


def kinds_of(key: str) -> tuple[str, ...]:
    """Names of the kinds that have a key of [connection] for themselves; none: all have it."""
    return tuple(name for name in names() if key in find(name).keys)
