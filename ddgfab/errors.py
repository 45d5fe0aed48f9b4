"""The tree of errors: each says what failed, where, by how much, and what to do."""

from __future__ import annotations


def printable(text: str) -> str:
    """Text without control characters: what a file holds must not steer the terminal."""
    return "".join(c if c.isprintable() or c == "\n" else "?" for c in text)


class DdgError(Exception):
    """Base of every error that a user can cause or must hear about.

    The message is one to three lines: what failed and where, the value and the limit, what to do.
    Characters that a terminal would obey are replaced.
    """

    def __init__(self, message: str = "") -> None:
        super().__init__(printable(message))


class InputError(DdgError, ValueError):
    """A file or array that cannot be used; names the file and line where there is one."""

    def __init__(self, message: str, *, file: str | None = None, line: int | None = None) -> None:
        where = "" if file is None else f"{file}: " if line is None else f"{file}:{line}: "
        super().__init__(where + message)
        self.file = file
        self.line = line


class ArgumentError(InputError, TypeError):
    """An argument of the wrong type; names the function, the argument and what is needed."""


class MeshError(InputError):
    """A mesh that is no oriented manifold surface, or that the task cannot use."""


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
