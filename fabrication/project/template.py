"""A commented project file with every setting, made from the models that check it."""

from __future__ import annotations

import inspect
import re
import textwrap
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from types import NoneType, UnionType
from typing import Annotated, Any, Final, Literal, TypeAlias, Union, get_args, get_origin

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from fabrication.project.sections import LARGEST, Section
from fabrication.project.toml import toml_key, toml_text

WIDTH: Final = 96
"""Longest line of a comment."""

UNITS: Final = {"_mm": "mm", "_deg": "deg", "_percent": "%", "_edges": "mean edges"}
"""Units by the ending of a key."""


@dataclass(frozen=True)
class Setting:
    """A key of a section.

    Attributes
    ----------
    value : what it is set to; None: it is not set, and stands in a comment
    default : shown where the value is another one
    text : what it means
    allowed : its unit and values
    """

    key: str
    value: Any
    default: Any
    text: str
    allowed: str

    def lines(self) -> Iterator[str]:
        """The comment, and the line itself."""
        rest = f" [{self.allowed}]" if self.allowed else ""
        if self.value != self.default:
            shown = "not set" if self.default is None else toml_text(self.default)
            rest += f" (default: {shown})"
        yield from comment(f"{self.text}{rest}".strip())
        if self.value is None:
            yield f"# {toml_key(self.key)} ="
        else:
            yield f"{toml_key(self.key)} = {toml_text(self.value)}"


Settings: TypeAlias = "list[Setting]"


def comment(text: str) -> list[str]:
    """Text as comment lines."""
    return [f"# {line}" for line in textwrap.wrap(text, WIDTH, break_on_hyphens=False)]


def template(
    project: BaseModel,
    begin: str,
    own: Mapping[str, tuple[Settings, list[str]]] | None = None,
) -> str:
    """The project file of a project, with every key of every section.

    Parameters
    ----------
    begin : comment at the top
    own : settings of sections that are not like their model, and lines that follow them
    """
    lines = comment(begin)
    for name in type(project).model_fields:
        if name == "file":
            continue
        section = getattr(project, name)
        settings, rest = (own or {}).get(name) or (settings_of(section), [])
        lines += ["", *comment(_heading(name, section)), f"[{name}]"]
        for setting in settings:
            lines += setting.lines()
        lines += rest
    return "\n".join(lines) + "\n"


def settings_of(section: BaseModel, names: tuple[str, ...] | None = None) -> Settings:
    """The settings of a section, or some of them, as they are."""
    texts = meanings(type(section))
    choices = section.choices() if isinstance(section, Section) else {}
    found: Settings = []
    for name, field in type(section).model_fields.items():
        if names is not None and name not in names:
            continue
        text = texts.get(name, "")
        named = [f'"{choice}"' for choice in choices.get(name, ())]
        found.append(
            Setting(
                name,
                getattr(section, name),
                field.get_default(call_default_factory=True),
                text,
                _missing_in(text, " or ".join(named)) if named else allowed_of(name, field, text),
            )
        )
    return found


def meanings(model: type[BaseModel]) -> dict[str, str]:
    """What the keys of a section mean: `Attributes` of its docstring and those it derives from.

    Keys that share an entry take one of its parts between semicolons each, or all of it.
    """
    found: dict[str, str] = {}
    for base in model.__mro__:
        text = inspect.getdoc(base) if "__doc__" in vars(base) and base.__doc__ else ""
        _, attributes, rows = (text or "").partition("Attributes\n----------\n")
        for entry in re.split(r"\n(?=\S)", rows) if attributes else ():
            names, colon, meaning = entry.partition(" : ")
            keys = [name.strip() for name in names.split(",")] if colon else []
            whole = " ".join(meaning.split())
            parts = whole.split("; ")
            for place, key in enumerate(keys):
                found.setdefault(key, parts[place] if len(parts) == len(keys) else whole)
    return found


def _heading(name: str, section: BaseModel) -> str:
    """The first paragraph of a section's docstring."""
    first = (inspect.getdoc(type(section)) or "").partition("\n\n")[0]
    text = re.sub(rf'^\[{name}\]( kind = "\w+")?[:,.]?\s*', "", " ".join(first.split()))
    return text[:1].upper() + text[1:]


def allowed_of(name: str, field: FieldInfo, text: str = "") -> str:
    """Unit and values of a key, as far as its text does not say them."""
    unit = next((unit for ending, unit in UNITS.items() if name.endswith(ending)), "")
    kinds = " or ".join(dict.fromkeys(_kinds(field.annotation, field.metadata)))
    return ", ".join(filter(None, [unit, _missing_in(text, kinds)]))


def _missing_in(text: str, kinds: str) -> str:
    """The kinds of values, or nothing where the text names all of them."""
    quoted = re.findall(r'"[^"]*"', kinds)
    only = not re.sub(r'"[^"]*"|\bor\b|\s', "", kinds)
    return "" if only and all(name in text for name in quoted) else kinds


def _kinds(annotation: Any, metadata: list[Any]) -> Iterator[str]:
    """What a value may be, an entry each."""
    origin, parts = get_origin(annotation), get_args(annotation)
    if origin is Annotated:
        inner = [
            part
            for given in parts[1:]
            for part in (given.metadata if isinstance(given, FieldInfo) else [given])
        ]
        yield from _kinds(parts[0], [*metadata, *inner])
    elif origin in (Union, UnionType):
        for part in parts:
            yield from _kinds(part, metadata)
    elif origin is Literal:
        yield from (f'"{part}"' for part in parts)
    elif origin is tuple:
        many = "" if Ellipsis in parts else f" of {len(parts)}"
        items = " or ".join(dict.fromkeys(_kinds(parts[0], [])))
        yield f"list{many}: {items}" if items else f"list{many}"
    elif annotation is bool:
        yield "true or false"
    elif annotation in (int, float):
        yield _number("whole number" if annotation is int else "number", metadata)
    elif annotation is not NoneType:
        name = getattr(annotation, "__name__", "")
        yield {"str": "text", "Path": "path", "list": "list", "dict": "table"}.get(name, "value")


def _number(kind: str, metadata: list[Any]) -> str:
    """A number with its limits."""
    limits = {
        name: getattr(part, name)
        for part in metadata
        for name in ("gt", "ge", "lt", "le")
        if getattr(part, name, None) not in (None, LARGEST, -LARGEST)
    }
    if limits.keys() == {"ge", "le"}:
        return f"{kind} from {limits['ge']:g} to {limits['le']:g}"
    if limits.keys() == {"gt", "lt"}:
        return f"{kind} between {limits['gt']:g} and {limits['lt']:g}"
    texts = {"gt": "more than", "ge": "at least", "lt": "less than", "le": "at most"}
    shown = " and ".join(f"{texts[name]} {value:g}" for name, value in limits.items())
    return f"{kind} {shown}".strip()
