"""TOML -> Project; every mistake becomes one message with file, line, key, value and limit."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ValidationError

from ddgfab.errors import ProjectError
from ddgfab.nets.registry import ParameterError, find_generator, kinds
from fabrication.project.models import MESH, Net, Project
from fabrication.standards import nearest

KIT = "linkage"
"""The section that makes a project one of a linkage (`fabrication.linkage`), not of a gridshell."""


def load_project(
    path: str | Path, changes: Mapping[str, Mapping[str, Any]] | None = None
) -> Project:
    """The project in a TOML file, validated; `changes` replaces single values, by section.

    Raises
    ------
    ProjectError
        A file that is missing, no TOML, or has an unknown key or a wrong value; names file, line,
        key, value, limit, and the nearest known key.
    """
    file = Path(path)
    values, text = read_toml(file)
    return _project(changed(values, changes), file=file, text=text)


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
        return tomllib.loads(text), text
    except OSError as error:
        raise ProjectError(f"cannot be read: {error.strerror}", file=str(file)) from None
    except UnicodeDecodeError as error:
        raise ProjectError(f"is not UTF-8 text (byte {error.start})", file=str(file)) from None
    except tomllib.TOMLDecodeError as error:
        found = re.search(r"line (\d+)", str(error))
        line = int(found[1]) if found else text.count("\n") + 1
        raise ProjectError(f"is not TOML: {error}", file=str(file), line=line) from None


def project_for_mesh(path: str | Path, sections: Mapping[str, Any] | None = None) -> Project:
    """Project with all defaults for a mesh file; `sections` holds values to change by section.

    Raises
    ------
    ProjectError
        An unknown section, key or value in `sections`.
    """
    return make_project({"net": {"kind": "mesh", "file": str(path)}, **(sections or {})})


def make_project(sections: Mapping[str, Any]) -> Project:
    """Project from a dictionary of sections, as in a file; `net` defaults to the canopy.

    Raises
    ------
    ProjectError
        An unknown section or key, or a wrong value.
    """
    return _project({"net": {"kind": "canopy"}, **sections}, file=None, text="")


def _project(values: Mapping[str, Any], file: Path | None, text: str) -> Project:
    name = None if file is None else str(file)
    if KIT in values:
        line = find_line(text, (KIT,))
        raise ProjectError("[linkage] is for a kit: ddgfab linkage", file=name, line=line)
    sections = sections_in(values, Project, name, text)
    try:
        if "net" not in sections:
            raise ProjectError('a project needs [net] kind = "mesh", file = "..."', file=name)
        if sections["net"].get("kind", MESH) in kinds():
            sections["net"] = _generated(sections["net"], name, text)
            if sections.get("project", {}).get("units", "mm") != "mm":
                raise ProjectError(
                    f"[project] units = {_show(sections['project']['units'])} is for mesh files; "
                    f'a net of kind "{sections["net"]["kind"]}" is made in millimetres',
                    file=name,
                    line=find_line(text, ("project", "units")),
                )
        elif "parameters" in sections["net"]:
            raise ProjectError(
                unknown("[net] parameters", "parameters", {"kind", "file"}),
                file=name,
                line=find_line(text, ("net", "parameters")),
            )
        return Project.model_validate({**sections, "file": file}, strict=None)
    except ValidationError as error:
        raise explain(error, Project, name, text) from None


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


def _generated(net: dict[str, Any], name: str | None, text: str) -> dict[str, Any]:
    """Gathers a generator's parameters, which stand in [net] beside kind, and checks them."""
    given = dict(net.pop("parameters", {}))
    given |= {key: net.pop(key) for key in list(net) if key not in ("kind", "file")}
    try:
        find_generator(net["kind"]).check(given)
    except ParameterError as error:
        line = find_line(text, ("net", error.parameter))
        raise ProjectError(f"[net] {error}", file=name, line=line) from None
    return {**net, "parameters": given} if given else net


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
        return f"{key} = {_show(value)} has too few values"
    wishes = dict.fromkeys(other["msg"].removeprefix("Input should be ") for other in same)
    wish = " or ".join(wishes).replace("a valid ", "a ")
    expected = [str(w) for o in same for w in re.findall(r"'([^']*)'", o["msg"])]
    near = nearest(value, expected) if isinstance(value, str) else []
    hint = f'; did you mean "{near[0]}"?' if near else ""
    place = "".join(f"[{part}]" for part in path[2:] if isinstance(part, int))
    return f"{key}{place} = {_show(value)} must be {wish}{hint}"


def _show(value: Any) -> str:
    text = f'"{value}"' if isinstance(value, str) else repr(value)
    return text if len(text) <= 60 else text[:57] + "..."


def _section_keys(model: type[BaseModel], section: str) -> set[str]:
    own = model.model_fields[section].annotation
    if own is Net:
        return {"kind", "file"}
    assert isinstance(own, type)
    assert issubclass(own, BaseModel)
    return set(own.model_fields)


def unknown(shown: str, word: str, known: set[str]) -> str:
    """What is said of an unknown word: the nearest known one, or all."""
    near = nearest(word, sorted(known), 1)
    hint = f"did you mean {near[0]}?" if near else f"known: {', '.join(sorted(known))}"
    return f"{shown} is unknown; {hint}"
