"""Sections of a project; every mistake is one message with file, line, key, value and limit."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import Any, get_args, get_origin

from pydantic import BaseModel, ValidationError

from ddgfab.errors import ProjectError, clipped
from ddgfab.suggest import nearest, suggestion
from fabrication.project.hints import WINDOWS
from fabrication.project.read import Origin
from fabrication.project.sections import Section
from fabrication.project.toml import toml_text


def sections_in(
    values: Mapping[str, Any], model: type[BaseModel], origin: Origin
) -> dict[str, dict[str, Any]]:
    """The sections of a file, each one that the model knows.

    Raises
    ------
    ProjectError
        An unknown section, or a value where a section must be.
    """
    known = set(model.model_fields) - {"file"}
    for section, content in values.items():
        if section not in known:
            raise origin.error(unknown(f"[{section}]", section, known), section)
        if not isinstance(content, Mapping):
            raise origin.error(f"{section} must be a section [{section}]", section)
        for key, value in content.items():
            for text in _texts(value):
                if bad := re.search(r"[\x00-\x1f\x7f-\x9f]", text):
                    raise origin.error(
                        f"[{section}] {clipped(key)} = {show(text)} has the control character "
                        f"{clipped(bad[0])}{_escaped(bad[0])}",
                        section,
                        key,
                    )
    return {key: dict(content) for key, content in values.items()}


def _escaped(character: str) -> str:
    """Advice where a backslash of a path may have made a control character."""
    return f"\n{WINDOWS}" if character in "\b\t\n\f\r" else ""


def _texts(value: object) -> Iterator[str]:
    """Every text in a value, those in lists too."""
    if isinstance(value, str):
        yield value
    elif isinstance(value, list):
        for item in value:
            yield from _texts(item)


def explain(error: ValidationError, model: type[BaseModel], origin: Origin) -> ProjectError:
    """One message for the first mistakes of a model's validation (at most three lines)."""
    found: list[tuple[tuple[str | int, ...], str]] = []
    seen: set[tuple[str | int, ...]] = set()
    problems = error.errors(include_url=False)
    for problem in problems:
        path = tuple(problem["loc"])
        if path[:2] in seen:
            continue  # further alternatives of the same key
        seen.add(path[:2])
        key = f"[{path[0]}]" + (f" {path[1]}" if len(path) > 1 else "")
        if problem["type"] == "extra_forbidden":
            message = unknown(key, str(path[1]), _section_keys(model, str(path[0])))
        else:
            same = [other for other in problems if other["loc"][:2] == path[:2]]
            message = _value_problem(model, key, path, problem, same)
        found.append((path[:2], message))
    found.sort(key=lambda item: origin.line(*item[0]) is None)  # what stands in the file first
    first, lines = found[0][0], [found[0][1]]
    for path, message in found[1:]:
        line = origin.line(*path)
        lines.append(message if line is None else f"line {line}: {message}")
    if len(lines) > 3:
        lines = [*lines[:2], f"... and {len(lines) - 2} more"]
    return origin.error("\n".join(lines), *first)


def _value_problem(
    model: type[BaseModel], key: str, path: tuple[str | int, ...], problem: Any, same: list[Any]
) -> str:
    if problem["type"] == "value_error":
        return f"{key}: {problem['ctx']['error']}"
    value = problem["input"]
    if problem["type"] == "missing":
        return f"{key} = {show(value)} has too few values; {_form(model, path, value)} is needed"
    limit = " or ".join(dict.fromkeys(_wanted(model, other) for other in same))
    literals = [str(name) for other in same for name in re.findall(r"'([^']*)'", other["msg"])]
    meant = isinstance(value, str) and nearest(value, literals)
    hint = f"; {suggestion(value, literals)}" if meant else ""
    place = "".join(f".{part}" for part in _table_keys(model, path))
    place += "".join(f"[{part}]" for part in path[2:] if isinstance(part, int))
    return f"{key}{place} = {show(value)} must be {limit}{hint}"


def _table_keys(model: type[BaseModel], path: tuple[str | int, ...]) -> list[str]:
    """The keys of tables in a section that a path of pydantic goes through."""
    section: Any = model.model_fields[str(path[0])].annotation
    inner = section.model_fields[str(path[1])].annotation if len(path) > 2 else None
    keys = []
    for part in path[2:]:
        if get_origin(inner) is not dict:
            break
        keys.append(clipped(part))
        inner = get_args(inner)[1]
    return keys


def _wanted(model: type[BaseModel], problem: Any) -> str:
    """What a value must be, as people say it."""
    kind = problem["type"]
    if kind in ("tuple_type", "list_type"):
        return _form(model, problem["loc"], problem["input"])
    if kind == "too_long":
        most = problem["ctx"]["max_length"]
        return f"a list of {most} values"
    texts = {
        "dict_type": "a table such as { key = ... }",
        "bool_type": "true or false",
        "string_type": 'text such as "abc"',
        "path_type": 'a path such as "roof.obj"',
    }
    text: str = problem["msg"].removeprefix("Input should be ").replace("a valid ", "a ")
    text = text.replace("a integer", "an integer")
    return texts.get(kind, text.replace("'", '"'))


def _form(model: type[BaseModel], path: tuple[str | int, ...], value: object) -> str:
    """A list as it is written: of the numbers that were given, or the default."""
    numbers = re.findall(r"\d+(?:\.\d+)?", value) if isinstance(value, str) else []
    default = None
    section = model.model_fields[str(path[0])].annotation
    if not numbers and isinstance(section, type) and issubclass(section, Section):
        default = section.model_fields[str(path[1])].get_default(call_default_factory=True)
    example = default if isinstance(default, tuple) and default else [1, 2]
    shown = f"[{', '.join(numbers[:4])}]" if numbers else toml_text(example)
    return f"a list such as {shown}"


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
