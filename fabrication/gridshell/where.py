"""Places in a structure, as [[beam]] and [[node]] name them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Final, TypeAlias

from pydantic import AfterValidator, Field

from ddgfab.errors import clipped
from ddgfab.suggest import suggestion
from fabrication.project.sections import Section

GROUP: Final = "group:"
"""Begins the name of a place that a group of the mesh file makes."""

BOUNDARY: Final = "boundary"

SUPPORTS: Final = "supports"
"""The nodes that [ground] names, and the beams that end at them."""


def known_place(*names: str) -> AfterValidator:
    """Names of places, or groups."""

    def check(value: str) -> str:
        if value in names or (value.startswith(GROUP) and value != GROUP):
            return value
        shown = ", ".join(f'"{name}"' for name in (*names, "group:NAME"))
        raise ValueError(
            f'"{clipped(value)}" is no place: {shown} or a list of numbers; '
            f"{suggestion(value, [*names, GROUP])}"
        )

    return AfterValidator(check)


Ids: TypeAlias = Annotated[tuple[int, ...], Field(strict=False)]
Edges: TypeAlias = Annotated[str, known_place(BOUNDARY, SUPPORTS)] | Ids
Vertices: TypeAlias = Annotated[str, known_place(BOUNDARY, SUPPORTS)] | Ids


def shown(where: str | tuple[int, ...]) -> str:
    """A place as it stands in the file."""
    return f'"{clipped(where)}"' if isinstance(where, str) else clipped(list(where))


def group_of(where: str | tuple[int, ...]) -> str | None:
    """The group that a place names, or None."""
    named = isinstance(where, str) and where.startswith(GROUP)
    return str(where)[len(GROUP) :] if named else None


class Rule(Section):
    """A table with `where`: settings of one place."""

    def own(self) -> Mapping[str, Any]:
        """What it changes."""
        return self.model_dump(exclude={"where"}, exclude_unset=True)
