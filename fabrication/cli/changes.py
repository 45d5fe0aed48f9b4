"""Settings given on the command line: `--set section.key=value`, the same for every command."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from typing import Any, Final

from ddgfab.errors import ProjectError, clipped
from ddgfab.suggest import nearest
from fabrication.project.read import merged, parse_toml

DEEPEST: Final = 4
"""No setting lies in more tables than this, within its section."""

Sections = dict[str, dict[str, Any]]
"""Settings by section and key."""


def sections_of(changes: Sequence[str] | None, only: Sequence[str] = ()) -> Sections:
    """`section.key=value` as sections; the value is TOML, or text without quotes.

    Parameters
    ----------
    only : the sections that the command has settings of, the most likely first; by default a
        project's sections, which are checked with the project

    Raises
    ------
    ProjectError
        Another form, or another section than those of `only`.
    """
    sections: Sections = {}
    for change in changes or ():
        name, equals, value = change.partition("=")
        section, dot, key = (part.strip() for part in name.partition("."))
        if not (equals and dot and section and key):
            example = f"{only[0]}.{_bare(change)}" if only else "panel.gap_mm=15"
            raise ProjectError(
                f"--set {clipped(change)}: expected section.key=value, such as {example}"
            )
        if key.count(".") > DEEPEST or not all(part.strip() for part in key.split(".")):
            raise ProjectError(f"--set {clipped(change)}: {clipped(key)} is not a key")
        if only and section not in only:
            meant = [name for name in nearest(section, only) if name[0] == section[0]]
            takes = " or ".join(f"{name}.key=value" for name in only)
            hint = f"did you mean {meant[0]}.{clipped(key)}?" if meant else f"it takes {takes}"
            raise ProjectError(
                f"--set {clipped(change)}: this command has no section {clipped(section)}; {hint}"
            )
        inner = value_of(value, f"--set {clipped(name)}")
        for table in reversed(key.split(".")):  # output.options.step.schema=AP242
            inner = {table: inner}
        sections[section] = merged(sections.get(section, {}), inner)
    return sections


def _bare(change: str) -> str:
    """What stands for `key=value` in the example: the change itself where it has no section."""
    key, equals, _ = change.partition("=")
    return clipped(change) if equals and key.strip().isidentifier() else "key=value"


def value_of(text: str, where: str = "value") -> Any:
    """A TOML value, or text without quotes.

    Raises
    ------
    ProjectError
        A value that no computer number can be, or lists in lists without end; names `where`.
    """
    try:
        values = parse_toml(f"value = {text}")
    except tomllib.TOMLDecodeError:
        return text.strip()
    except ProjectError as error:
        raise ProjectError(f"{where}: {str(error).removeprefix('value = ')}") from None
    return values["value"] if set(values) == {"value"} else text.strip()


def put(sections: Sections, section: str, **values: Any) -> None:
    """Put the values of options that are given (not None) into a section, before `--set`'s."""
    given = {name: value for name, value in values.items() if value is not None}
    if given:
        sections.setdefault(section, {}).update(given)


def comma_list(text: str | None) -> list[str] | None:
    """Items between commas, in lower case; None stays None."""
    if text is None:
        return None
    return [item.strip().lower() for item in text.split(",") if item.strip()]
