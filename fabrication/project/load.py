"""TOML -> sections; every mistake becomes one message with file, line, key, value and limit."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, Final

from pydantic import BaseModel, ValidationError

from ddgfab.errors import ProjectError, clipped
from ddgfab.suggest import nearest, suggestion
from fabrication.project.sections import Section
from fabrication.project.toml import toml_text

LARGEST_INTEGER: Final = 2**63
"""TOML's integers have 64 bits."""


def changed(
    values: Mapping[str, Any], changes: Mapping[str, Mapping[str, Any]] | None
) -> dict[str, Any]:
    """Sections with single values replaced; what is no section stays, for validation to find."""
    out = dict(values)
    for section, keys in (changes or {}).items():
        own = out.get(section, {})
        out[section] = {**own, **keys} if isinstance(own, Mapping) else own
    return out


def read_toml(file: Path) -> tuple[dict[str, Any], str]:
    """The values of a TOML file, and its text.

    Raises
    ------
    ProjectError
        Missing, not UTF-8, or no TOML; names file and line.
    """
    try:
        text = file.read_bytes().decode("utf-8-sig").replace("\r\n", "\n")
        return parse_toml(text), text
    except OSError as error:
        raise ProjectError(f"cannot be read: {error.strerror}", file=str(file)) from None
    except ProjectError as error:
        raise ProjectError(str(error), file=str(file)) from None
    except UnicodeDecodeError as error:
        raise ProjectError(f"is not UTF-8 text (byte {error.start})", file=str(file)) from None
    except tomllib.TOMLDecodeError as error:
        found = re.search(r"line (\d+)", str(error))
        line = int(found[1]) if found else text.count("\n") + 1
        raise ProjectError(f"is not TOML: {error}", file=str(file), line=line) from None


def parse_toml(text: str) -> dict[str, Any]:
    """The values of TOML.

    Raises
    ------
    tomllib.TOMLDecodeError
        Text that is no TOML.
    ProjectError
        Lists in lists without end, or a number of more digits than any computer number has.
    """
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


def sections_in(
    values: Mapping[str, Any], model: type[BaseModel], name: str | None, text: str
) -> dict[str, dict[str, Any]]:
    """The sections of a file, each one that the model knows.

    Raises
    ------
    ProjectError
        An unknown section, or a value where a section must be.
    """
    known = set(model.model_fields) - {"file"}
    for section, content in values.items():
        at = find_line(text, (section,))
        if section not in known:
            raise ProjectError(unknown(f"[{section}]", section, known), file=name, line=at)
        if not isinstance(content, Mapping):
            raise ProjectError(f"{section} must be a section [{section}]", file=name, line=at)
    return {key: dict(content) for key, content in values.items()}


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


def explain(
    error: ValidationError, model: type[BaseModel], name: str | None, text: str
) -> ProjectError:
    """One message for the first mistakes of a model's validation (at most three lines)."""
    lines: list[str] = []
    first: int | None = None
    seen: set[tuple[str | int, ...]] = set()
    problems = error.errors(include_url=False)
    for problem in problems:
        path = tuple(problem["loc"])
        if path[:2] in seen:
            continue  # further alternatives of the same key
        seen.add(path[:2])
        key = f"[{path[0]}]" + (f" {path[1]}" if len(path) > 1 else "")
        line = find_line(text, path[:2])
        first = first or line
        if problem["type"] == "extra_forbidden":
            message = unknown(key, str(path[1]), _section_keys(model, str(path[0])))
        else:
            message = _value_problem(
                key, path, problem, [p for p in problems if p["loc"][:2] == path[:2]]
            )
        lines.append(message if not lines or line is None else f"line {line}: {message}")
    if len(lines) > 3:
        lines = [*lines[:2], f"... and {len(lines) - 2} more"]
    return ProjectError("\n".join(lines), file=name, line=first)


def _value_problem(key: str, path: tuple[str | int, ...], problem: Any, same: list[Any]) -> str:
    if problem["type"] == "value_error":
        return f"{key}: {problem['ctx']['error']}"
    value = problem["input"]
    if problem["type"] == "missing":
        return f"{key} = {show(value)} has too few values"
    allowed = dict.fromkeys(other["msg"].removeprefix("Input should be ") for other in same)
    limit = " or ".join(allowed).replace("a valid ", "a ").replace("dictionary", "table")
    literals = [str(name) for other in same for name in re.findall(r"'([^']*)'", other["msg"])]
    meant = isinstance(value, str) and nearest(value, literals)
    hint = f"; {suggestion(value, literals)}" if meant else ""
    place = "".join(f"[{part}]" for part in path[2:] if isinstance(part, int))
    return f"{key}{place} = {show(value)} must be {limit}{hint}"


def show(value: Any) -> str:
    """A value as it stands in a file, cut to 60 characters."""
    return clipped(toml_text(value))


def _section_keys(model: type[BaseModel], section: str) -> set[str]:
    own = model.model_fields[section].annotation
    assert isinstance(own, type)
    assert issubclass(own, Section)
    return own.keys()


def unknown(shown: str, name: str, known: set[str]) -> str:
    """The message for an unknown name, shown as it stands in the file: the nearest, or all."""
    return f"{clipped(shown)} is unknown; {suggestion(name, sorted(known))}"
