"""Every setting and every option, taken from the program itself, with values worth trying.

Nothing is listed by hand: a new command, option, setting, kind of net or of linkage is in it by
itself. Values come from the types: names, both sides of every limit, lists of every length.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any

import typer
from pydantic import BaseModel

from ddgfab.forms.registry import find_generator, kinds
from ddgfab.surfaces.analytic import SURFACES, surface_parameters
from fabrication.cli import app
from fabrication.cli.settings import _Settings as DilemmaProject
from fabrication.formats.registry import find, names
from fabrication.gridshell.load import RULED
from fabrication.gridshell.project import Project
from fabrication.linkage.project import KITS

ABSURD: tuple[Any, ...] = (
    *("", "x", "\x1b[31m", "\u202e", "x" * 500, "a\x00b", "/dev/zero", "../roof.obj", "1e3", "nan"),
    *(0, -1, 1, 2**31, 2**63 - 1, 0.1, -0.0, 1e-9, 1e-300, 1e9, 1.1e9, 1e300),
    *(float("nan"), float("inf"), True, [], [1], [1, 2, 3], [[]], [["a"]], {}, {"a": 1}),
)
"""Values of every type, for any setting."""


@dataclass(frozen=True)
class Setting:
    """A setting, and values of its own type.

    product : "gridshell", a kind of linkage, or "dilemma"
    with_ : what else has to be set, so that it is known: the kind of net
    """

    product: str
    section: str
    key: str
    values: tuple[Any, ...]
    with_: tuple[tuple[str, str, str], ...] = ()

    def __str__(self) -> str:
        kind = "".join(f" ({value})" for _, _, value in self.with_)
        return f"{self.product} {self.section}.{self.key}{kind}"


@cache
def settings() -> tuple[Setting, ...]:
    """Every setting of every product."""
    models = {"gridshell": Project, "dilemma": DilemmaProject, **KITS}
    found = [s for product, model in models.items() for s in _of_model(product, model)]
    for kind in kinds():
        for parameter in find_generator(kind).parameters:
            low, high = parameter.low, parameter.high
            values = (parameter.default, low, high, low - 1, high + 1, *parameter.choices)
            found.append(Setting("gridshell", "net", parameter.name, values, (_kind(kind),)))
    for surface in SURFACES:
        given = (_kind("surface"), ("net", "surface", surface))
        for name, default in surface_parameters(surface).items():
            values = (default, -default, 0.5 * default, 2 * default, 1e-3 * default)
            found.append(Setting("gridshell", "net", name, values, given))
    for format in (find(name) for name in names()):
        for option, choices in format.options.items():
            key = f"options.{format.name}.{option}"
            found.append(Setting("gridshell", "output", key, (*choices, "none")))
    for section, (rule, _, _) in RULED.items():
        schema = rule.model_json_schema()
        places = values_of(schema["properties"]["where"], schema)
        for key in set(rule.keys()) - {"where"}:
            own = values_of(schema["properties"][key], schema)
            rules = tuple([{"where": at, key: value}] for at in places for value in own)
            found.append(Setting("gridshell", section, "rules", rules))
    return tuple(found)


def _kind(kind: str) -> tuple[str, str, str]:
    return ("net", "kind", kind)


def _of_model(product: str, model: type[BaseModel]) -> Iterator[Setting]:
    schema = model.model_json_schema()
    for section, field in model.model_fields.items():
        inner = field.annotation
        if not (isinstance(inner, type) and issubclass(inner, BaseModel)):
            continue
        named: Mapping[str, Any] = getattr(inner, "choices", dict)()
        for key, own in inner.model_json_schema()["properties"].items():
            values = [*values_of(own, {**schema, **inner.model_json_schema()}), *named.get(key, ())]
            yield Setting(product, section, key, tuple(values))


def values_of(schema: Mapping[str, Any], root: Mapping[str, Any]) -> list[Any]:
    """Values of a JSON schema: its names, and numbers at, within and beyond its limits."""
    if "$ref" in schema:
        return values_of(root["$defs"][schema["$ref"].rpartition("/")[2]], root)
    found: list[Any] = [schema["default"]] if schema.get("default") is not None else []
    for option in schema.get("anyOf", ()):
        found += values_of(option, root)
    if "const" in schema:
        found.append(schema["const"])
    found += schema.get("enum", ())
    kind = schema.get("type")
    if kind == "boolean":
        found += [True, False]
    elif kind in ("number", "integer"):
        found += _numbers(schema, 1 if kind == "integer" else 0.5)
    elif kind == "string" and "enum" not in schema:
        found += ["", "roof", "boundary", "group:one", "FL 60x8", "RHS 80x40x4", "M12", "roof.obj"]
    elif kind == "array":
        found += _lists(schema, root)
    elif kind == "object":
        found += [{}, {"a": 1}, {"step": {"schema": "AP242"}}]
    return found


def _numbers(schema: Mapping[str, Any], step: float) -> list[float]:
    ends = [
        schema.get(key) for key in ("minimum", "exclusiveMinimum", "maximum", "exclusiveMaximum")
    ]
    near = [end + d for end in ends if end is not None for d in (-step, 0, step, 20 * step)]
    return [*near, *(round(x / step) * step for x in (1, 3, 12, 45, 200, 1500))]


def _lists(schema: Mapping[str, Any], root: Mapping[str, Any]) -> list[Any]:
    if "prefixItems" in schema:
        columns = [values_of(item, root) for item in schema["prefixItems"]]
        count = max(len(column) for column in columns)
        rows: list[Any] = [[c[k % len(c)] for c in columns] for k in range(count)]
        return [*rows, rows[0][:-1], [*rows[0], 1]]
    items = values_of(schema.get("items", {}), root)
    return [[], *([item] for item in items), items[:2], items[:4] * 2]


# --- the command line ---------------------------------------------------------------------------
@dataclass(frozen=True)
class Option:
    """An option or an argument of a command.

    name : as it is typed; empty for an argument
    words : of its help, which names the values that it takes
    """

    name: str
    takes_value: bool
    numeric: bool
    words: tuple[str, ...]


@cache
def commands() -> dict[str, tuple[Option, ...]]:
    """Options and arguments of every command; `--debug` shows tracebacks and is left out."""
    group: Any = typer.main.get_command(app)
    return {
        name: tuple(o for p in command.params for o in _options(p) if o.name != "--debug")
        for name, command in group.commands.items()
    }


def _options(parameter: Any) -> Iterator[Option]:
    text = getattr(parameter, "help", "") or ""
    words = tuple(w for w in re.split(r"[\s,;:()]+", text) if w and len(w) < 20)
    kind = parameter.type_descriptor.annotation
    numeric = "int" in str(kind) or "float" in str(kind)
    if parameter.param_type_name == "argument":
        yield Option("", True, numeric, words)
        return
    flag = bool(getattr(parameter, "is_flag", False))
    for name in (*parameter.opts, *parameter.secondary_opts):
        yield Option(name, not flag, numeric, words)
