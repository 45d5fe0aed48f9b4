"""Project files: TOML with changes, and where each setting stands, for messages."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, TypeAlias

from ddgfab.errors import ProjectError, clipped
from ddgfab.io.regular import read_regular
from fabrication.project.hints import advice_for, place_of, unclosed

LARGEST_INTEGER: Final = 2**63
"""TOML's integers have 64 bits."""

LIMIT_BYTES: Final = 256 * 1024
"""Larger project files are refused."""

KEY_PARTS: Final = 20
"""Keys a.b.c of more parts are refused: parsing takes the cube of their number."""

_QUOTED: Final = re.compile(r"""\"[^"\n]*\"|'[^'\n]*'""")
_LONG_KEY: Final = re.compile(rf"(?<![\w-])(?:[\w-]+[ \t]*\.[ \t]*){{{KEY_PARTS}}}")

Changes: TypeAlias = Mapping[str, Mapping[str, Any]]
"""Single values that replace those of a file, by section and key."""


@dataclass(frozen=True)
class Origin:
    """Where settings come from: a file with its text, or none; and the keys changed since."""

    file: str | None = None
    text: str = ""
    changed: frozenset[tuple[str, ...]] = frozenset()

    def line(self, *path: str | int) -> int | None:
        """Line (from 1) of a section or of a key in it; None where the file does not have it."""
        if not path or path[:2] in self.changed:
            return None
        return find_line(self.text, path)

    def error(self, message: str, *path: str | int) -> ProjectError:
        """An error about a section, or a key in it; names the file only if it stands there."""
        line = self.line(*path)
        sections = {section for section, _ in self.changed}
        whole = len(path) == 1 or line is None
        if path[:2] in self.changed or (whole and bool(path) and path[0] in sections):
            return ProjectError(message)  # of the change, or of it with what the file has
        return ProjectError(message, file=self.file, line=line)


def read_changed(path: str | Path, changes: Changes | None) -> tuple[dict[str, Any], Origin]:
    """The values of a TOML file with changes, and where they come from.

    Raises
    ------
    ProjectError
        As `read_toml`.
    """
    values, text = read_toml(Path(path))
    keys = frozenset((section, key) for section, own in (changes or {}).items() for key in own)
    return changed(values, changes), Origin(str(path), text, keys)


def changed(values: Mapping[str, Any], changes: Changes | None) -> dict[str, Any]:
    """Sections with single values replaced; what is no section stays, for validation to find."""
    out = dict(values)
    for section, keys in (changes or {}).items():
        own = out.get(section, {})
        out[section] = merged(own, keys) if isinstance(own, Mapping) else own
    return out


def merged(values: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """A table with values replaced; tables in it are merged too."""
    out = dict(values)
    for key, value in changes.items():
        own = out.get(key)
        if isinstance(own, Mapping) and isinstance(value, Mapping):
            value = merged(own, value)
        out[key] = value
    return out


def read_toml(file: Path) -> tuple[dict[str, Any], str]:
    """The values of a TOML file, and its text.

    Raises
    ------
    ProjectError
        Missing, no regular file, above `LIMIT_BYTES`, not UTF-8, or no TOML; names file, line and
        column, and how the line is written.
    """
    name = str(file)
    data = read_regular(
        file,
        LIMIT_BYTES,
        ProjectError,
        what="a project file (TOML)",
        advice="a project is a few lines of TOML; is this one?",
    )
    try:
        text = data.decode("utf-8-sig").replace("\r\n", "\n")
        return parse_toml(text), text
    except ProjectError as error:
        raise ProjectError(str(error), file=name) from None
    except UnicodeDecodeError as error:
        raise ProjectError(f"is not UTF-8 text (byte {error.start})", file=name) from None
    except tomllib.TOMLDecodeError as error:
        line, column = place_of(error, text)
        lines = text.split("\n")
        if line > 1 and not advice_for(lines[line - 1]) and unclosed(lines[line - 2]):
            line, column = line - 1, len(lines[line - 2]) + 1  # a text that the line end closed
        advice = advice_for(lines[line - 1])
        reason = re.sub(r"\s*\(at [^)]*\)$", "", str(error))
        at = "" if column is None else f" (column {column})"
        message = f"is not TOML: {reason}{at}"
        message += "".join(f"\n{clipped(part, 200)}" for part in advice.splitlines())
        raise ProjectError(message, file=name, line=line) from None


def parse_toml(text: str) -> dict[str, Any]:
    """The values of TOML.

    Raises
    ------
    tomllib.TOMLDecodeError
        Text that is not TOML.
    ProjectError
        Lists in lists without end, a number of more digits than any computer number has, or a key
        of more than `KEY_PARTS` parts.
    """
    bare = _QUOTED.sub("q", text)
    if _LONG_KEY.search(bare):
        raise ProjectError(f"a key of more than {KEY_PARTS} parts with dots between them")
    try:
        values = tomllib.loads(text)
    except tomllib.TOMLDecodeError:
        raise
    except RecursionError:
        raise ProjectError("lists or tables in one another, too deep to be settings") from None
    except ValueError:  # Python refuses integers of more than 4,300 digits
        longest = max(re.findall(r"\d+", text), key=len)
        raise ProjectError(f"{clipped(longest)} has {len(longest)} digits: too many") from None
    for path, value in _numbers(values):
        if not -LARGEST_INTEGER <= value < LARGEST_INTEGER:
            raise ProjectError(f"{path} = {clipped(value)} does not fit into 64 bits")
    return values


def _numbers(values: Any, path: str = "") -> Iterator[tuple[str, int]]:
    """Every integer below a value, with its keys."""
    if isinstance(values, Mapping):
        for key, value in values.items():
            yield from _numbers(value, f"{path}.{key}" if path else str(key))
    elif isinstance(values, list):
        for value in values:
            yield from _numbers(value, path)
    elif isinstance(values, int):
        yield path, values


def find_line(text: str, path: tuple[str | int, ...]) -> int | None:
    """Line (from 1) of a section or of a key in it, or None when the text does not show it."""
    section = ""
    place: int | None = None
    for number, line in enumerate(text.split("\n"), 1):
        header = re.match(r"\s*\[\s*([\w.-]+)\s*\]", line)
        if header:
            section = header[1]
            if section == path[0]:
                place = number
            elif section == ".".join(map(str, path[:2])):
                return number
        elif section == path[0] and len(path) > 1:
            if re.match(rf"\s*[\"']?{re.escape(str(path[1]))}[\"']?\s*=", line):
                return number
        elif not section and re.match(rf"\s*{re.escape(str(path[0]))}\s*[=.]", line):
            return number
    return place
