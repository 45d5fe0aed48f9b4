"""The tree of errors: each says what failed, where, by how much, and what to do."""

from __future__ import annotations

import re
from typing import Final

MOST_SHOWN: Final = 60
"""So many characters of a value are shown in a message."""

_LONGEST: Final = re.compile(r"\S{400,}")
"""Text without a space that is longer than any path a message may have to name in full."""


def printable(text: str) -> str:
    r"""Text for a terminal: control and direction characters as escapes, line breaks as they are.

    What comes from files, names and arguments must neither steer the terminal nor change the order
    in which a line is read; a run of 400 characters and more without a space is cut.

    >>> print(printable("roof\x1b[31m.obj"))
    roof\x1b[31m.obj
    """
    clear = "".join(c if c.isprintable() or c == "\n" else _escaped(c) for c in text)
    return _LONGEST.sub(lambda found: found[0][:MOST_SHOWN] + "...", clear)


def clipped(value: object, most: int = MOST_SHOWN) -> str:
    r"""A value for a message: on one line, printable, cut after `most` characters.

    >>> print(clipped("a\nb", 2))
    a\n...
    """
    text = str(value)
    shown = "".join(c if c.isprintable() else _escaped(c) for c in text[:most])
    return shown + "..." if len(text) > most else shown


def _escaped(character: str) -> str:
    return character.encode("unicode_escape").decode("ascii")


class DdgError(Exception):
    """Base of every error that a user can cause or has to know of.

    The message is one to three lines: what failed and where, the value and the limit, what to do.
    Characters that a terminal would obey are written as escapes; see `printable`.
    """

    def __init__(self, message: str = "") -> None:
        super().__init__(printable(message))


class InputError(DdgError, ValueError):
    """A file or array that cannot be used; names the file and line where there is one."""

    def __init__(self, message: str, *, file: str | None = None, line: int | None = None) -> None:
        name = None if file is None else clipped(file, 400)
        where = "" if name is None else f"{name}: " if line is None else f"{name}:{line}: "
        super().__init__(where + message)
        self.file = file
        self.line = line


class ArgumentError(InputError, TypeError):
    """An argument of the wrong type; names the function, the argument and what is needed."""


class MeshError(InputError):
    """A mesh that is not an oriented manifold surface, or that the task cannot use."""


class DegenerateError(DdgError, ValueError):
    """A geometric construction without a solution; names the element and the quantity.

    Attributes
    ----------
    cell : indices of the cell of a net, or None for other elements
    """

    def __init__(self, message: str, *, cell: tuple[int, ...] | None = None) -> None:
        super().__init__(message)
        self.cell = cell


class SupportError(DdgError):
    """No usable torsion-free support structure; says why and what is possible instead."""


class ProjectError(InputError):
    """A project file with an unknown key, a wrong value or a missing file."""


class DetailError(DdgError):
    """A part that cannot be made: does not fit, too short, too narrow. Names the parts."""


class KernelError(DdgError):
    """The CAD kernel is missing, of the wrong build, or refused a part."""


class OutputError(DdgError):
    """The output folder or a file in it cannot be written; nothing was left half written."""


class OptimizeError(DdgError):
    """An optimisation that missed its goals; says which, where, and what pulls against them.

    Attributes
    ----------
    solution : what a solver reached, or None
    result : what a recipe reached (`ddgfab.optimize.OptimizeResult`), or None; never silently taken
    """

    def __init__(
        self, message: str, *, solution: object | None = None, result: object | None = None
    ) -> None:
        super().__init__(message)
        self.solution = solution
        self.result = result
