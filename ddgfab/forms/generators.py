"""Generators: functions from a few numbers that a designer understands to a mesh in millimetres.

A generator is a function whose parameters are annotated with `About`; `generator(kind)` reads
names, types, defaults and limits from its signature, so they stand in one place, checks what is
given against them, and lists the function under its kind.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import wraps
from math import inf, isfinite
from numbers import Integral, Real
from typing import Any, Literal, ParamSpec, get_args, get_type_hints

from ddgfab.errors import InputError
from ddgfab.mesh import Mesh
from ddgfab.suggest import suggestion

P = ParamSpec("P")


@dataclass(frozen=True)
class About:
    """What a parameter means, and the limits within which it does (both included).

    A text is one of `choices`, or with `file` the name of a file, empty for none.
    """

    text: str
    low: float = -inf
    high: float = inf
    choices: tuple[str, ...] = ()
    file: bool = False


@dataclass(frozen=True)
class Parameter:
    """A parameter of a generator: its type, default, meaning and limits.

    A whole number, a number, or a text: one of `choices`, the name of a `file`, or any. A length
    ends in _mm, an angle in _deg; others have no unit.
    """

    name: str
    type: type[int] | type[float] | type[str]
    default: Any
    text: str
    low: float
    high: float
    choices: tuple[str, ...] = ()
    file: bool = False

    @property
    def default_text(self) -> str:
        """The default as people read it."""
        return f'"{self.default}"' if self.type is str else f"{self.default:g}"

    @property
    def limits(self) -> str:
        """The limits as text, empty when there are none."""
        if self.choices:
            return ", ".join(self.choices)
        if isfinite(self.low) and isfinite(self.high):
            return f"{self.low:g} to {self.high:g}"
        if isfinite(self.low):
            return f"{self.low:g} or more"
        return f"{self.high:g} or less" if isfinite(self.high) else ""


class ParameterError(InputError):
    """A parameter of a generator that is unknown, of the wrong type or beyond its limits."""

    def __init__(self, message: str, parameter: str) -> None:
        super().__init__(message)
        self.parameter = parameter


@dataclass(frozen=True, repr=False)
class Generator:
    """A kind of net: its summary, its parameters and the function that makes it.

    support : kind of the node axes of such nets where a project leaves them to us: "auto", or
        "normals" for K-nets, which have no torsion-free ones, or "edge" for beams of one height
    """

    kind: str
    summary: str
    parameters: tuple[Parameter, ...]
    function: Callable[..., Mesh]
    support: Literal["auto", "normals", "edge"] = "auto"

    def check(self, values: Mapping[str, Any]) -> None:
        """Raise `ParameterError` for the first value that the kind does not take."""
        known = {parameter.name: parameter for parameter in self.parameters}
        for name, value in values.items():
            if name not in known:
                raise ParameterError(f"{name} is unknown; {suggestion(name, known)}", name)
            _check(known[name], value)

    def files(self, values: Mapping[str, Any]) -> tuple[str, ...]:
        """Names of the parameters by which values name a file."""
        return tuple(p.name for p in self.parameters if p.file and values.get(p.name))

    def __repr__(self) -> str:
        return f"Generator({self.kind}: {', '.join(p.name for p in self.parameters)})"


GENERATORS: dict[str, Generator] = {}
"""Every kind, as the modules that make them are imported; `ddgfab.forms.registry` imports all."""


def _check(parameter: Parameter, value: Any) -> None:
    name = parameter.name
    if parameter.type is str:
        _check_text(parameter, value)
        return
    number = isinstance(value, Real) and not isinstance(value, bool) and isfinite(value)
    if not number or (parameter.type is int and not isinstance(value, Integral)):
        needed = "a whole number" if parameter.type is int else "a number"
        raise ParameterError(f"{name} = {value!r} must be {needed}", name)
    if not parameter.low <= value <= parameter.high:
        raise ParameterError(
            f"{name} = {value:g} is beyond its limits: {parameter.limits} ({parameter.text})", name
        )


def _check_text(parameter: Parameter, value: Any) -> None:
    name = parameter.name
    if not isinstance(value, str):
        raise ParameterError(f"{name} = {value!r} must be a text in quotes", name)
    if parameter.choices and value not in parameter.choices:
        hint = suggestion(value, parameter.choices)
        raise ParameterError(f'{name} = "{value}" is unknown; {hint}', name)


def _parameters(function: Callable[..., Mesh]) -> tuple[Parameter, ...]:
    hints = get_type_hints(function, include_extras=True)
    found = []
    for name, given in inspect.signature(function).parameters.items():
        kind, about = get_args(hints[name])
        limits = about.low, about.high, about.choices, about.file
        found.append(Parameter(name, kind, given.default, about.text, *limits))
    return tuple(found)


def generator(
    kind: str, support: Literal["auto", "normals", "edge"] = "auto"
) -> Callable[[Callable[P, Mesh]], Callable[P, Mesh]]:
    """List a function under a kind, and check its arguments at every call.

    The first line of the docstring is the summary.
    """

    def register(function: Callable[P, Mesh]) -> Callable[P, Mesh]:
        signature = inspect.signature(function)
        summary = (function.__doc__ or "").strip().split("\n")[0]

        @wraps(function)
        def checked(*args: P.args, **kwargs: P.kwargs) -> Mesh:
            entry.check(signature.bind(*args, **kwargs).arguments)
            return function(*args, **kwargs)

        entry = Generator(kind, summary, _parameters(function), checked, support)
        GENERATORS[kind] = entry
        return checked

    return register
