"""Arguments of public functions against their annotations, with errors that name the argument.

Without this a mesh where points are expected, or one number where a list is, ends as an error of
numpy or of Python deep inside, which does not say which argument of which function it was.
"""

from __future__ import annotations

import functools
import inspect
import numbers
import operator
import types
import typing
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, Final, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ddgfab.errors import ArgumentError
from ddgfab.instead import instead

F = TypeVar("F", bound=Callable[..., Any])
Check = Callable[[Any], bool]

_ARRAY_PARTS: Final = frozenset(typing.get_args(ArrayLike))
_NUMERIC: Final = "biuf"
"""Kinds of numpy's types that are real numbers or flags."""

COMPLEX: Final = "complex"
"""Mark of an annotation: complex numbers are welcome."""

Complexes = typing.Annotated[ArrayLike, COMPLEX]
"""Annotation of arrays that may be complex; of other arrays the imaginary part would be lost."""


def checked(function: F) -> F:
    """The function with its arguments tested against their annotations before it runs.

    Raises (the function that comes back)
    ------
    ArgumentError
        An argument of another type; names the function, the argument, what came and what is needed.
    """
    signature = inspect.signature(function)
    names = tuple(signature.parameters)

    @functools.cache
    def tests() -> dict[str, tuple[Check, Any]]:
        hints = typing.get_type_hints(function, include_extras=True)
        return {name: (_check(hints[name]), hints[name]) for name in names if name in hints}

    @functools.wraps(function)
    def wrapper(*args: Any, **kwargs: Any) -> Any:
        found = tests()
        for name, value in (*zip(names, args, strict=False), *kwargs.items()):
            if name in found and not found[name][0](value):
                raise ArgumentError(_message(function, name, value, found[name][1]))
        return function(*args, **kwargs)

    return typing.cast(F, wrapper)


# --- shapes --------------------------------------------------------------------------------------
def together(**arrays: ArrayLike) -> list[NDArray[np.float64]]:
    """Arrays of floats of one shape, from arrays whose shapes go together.

    Raises
    ------
    ArgumentError
        Shapes that do not go together; names the arguments with their shapes.
    """
    given = [np.asarray(value, dtype=np.float64) for value in arrays.values()]
    try:
        return list(np.broadcast_arrays(*given))
    except ValueError:
        shapes = ", ".join(
            f"{name} {array.shape}" for name, array in zip(arrays, given, strict=True)
        )
        raise ArgumentError(f"shapes do not go together: {shapes}") from None


def finite_together(**arrays: ArrayLike) -> list[NDArray[np.float64]]:
    """`together` for finite numbers.

    Raises
    ------
    ArgumentError
        Shapes that do not go together, or an entry that is not finite; names the argument.
    """
    for name, value in arrays.items():
        _refuse_endless(np.asarray(value, dtype=np.float64), name)
    return together(**arrays)


def complex_together(**arrays: ArrayLike) -> list[NDArray[Any]]:
    """`finite_together` that keeps complex numbers."""
    for name, value in arrays.items():
        _refuse_endless(np.asarray(value), name)
    together(**{name: np.zeros(np.shape(value)) for name, value in arrays.items()})
    return list(np.broadcast_arrays(*(np.asarray(value) * 1.0 for value in arrays.values())))


def _refuse_endless(array: NDArray[Any], name: str) -> None:
    if not np.isfinite(array).all():
        index = tuple(np.argwhere(~np.isfinite(array))[0].tolist())
        entry = "".join(f"[{i}]" for i in index)
        raise ArgumentError(f"{name}{entry} is {array[index]:g}; a finite number is needed")


def vectors(**arrays: ArrayLike) -> list[NDArray[np.float64]]:
    """Arrays (..., 3) of finite floats, of one shape, from points or vectors that go together.

    Raises
    ------
    ArgumentError
        Other than three coordinates, shapes that do not go together, or an entry that is not
        finite; names the argument.
    """
    for name, value in arrays.items():
        shape = np.shape(value)
        if shape[-1:] != (3,):
            raise ArgumentError(f"{name} has shape {shape}; (..., 3) is needed")
    return finite_together(**arrays)


def of_shape(value: ArrayLike, shape: tuple[int | None, ...], name: str) -> NDArray[np.float64]:
    """An array of floats of a shape, in which None stands for any length, `...` not at all.

    Raises
    ------
    ArgumentError
        Another shape; names the argument.
    """
    array = np.asarray(value, dtype=np.float64)
    wrong = array.ndim != len(shape) or any(
        want is not None and have != want for have, want in zip(array.shape, shape, strict=False)
    )
    if wrong:
        words = ", ".join("any" if want is None else str(want) for want in shape)
        end = ",)" if len(shape) == 1 else ")"
        raise ArgumentError(f"{name} has shape {array.shape}; ({words}{end} is needed")
    return array


# --- tests ---------------------------------------------------------------------------------------
def is_numeric(value: Any, kinds: str = _NUMERIC) -> bool:
    """Whether numpy makes an array of real numbers or flags of it: a number, an array, lists."""
    if isinstance(value, np.ndarray):
        return value.dtype.kind in kinds
    if isinstance(value, (str, bytes, Mapping)) or value is None:
        return False
    if not (isinstance(value, (numbers.Number, Sequence)) or hasattr(value, "__array__")):
        return False
    try:
        return np.asarray(value).dtype.kind in kinds
    except (TypeError, ValueError):  # rows of different lengths, objects without numbers
        return False


def _check(hint: Any) -> Check:
    """The test that belongs to an annotation; what is not known passes."""
    origin, parts = typing.get_origin(hint), typing.get_args(hint)
    if origin in (typing.Union, types.UnionType):
        tests: list[Check] = [is_numeric] if set(parts) >= _ARRAY_PARTS else []
        tests += [_check(part) for part in parts if not (tests and part in _ARRAY_PARTS)]
        return lambda value: any(test(value) for test in tests)
    if origin is typing.Annotated:
        if COMPLEX in parts:
            return lambda value: is_numeric(value, _NUMERIC + "c")
        return _check(parts[0])
    if origin is np.ndarray:
        return is_numeric
    if origin is typing.Literal:
        return lambda value: isinstance(value, str)
    if origin in (Sequence, tuple) or hint is tuple:
        return _listed(origin, parts)
    if origin is Mapping:
        return lambda value: isinstance(value, Mapping)
    if origin is Callable or hint is Callable:
        return callable
    if hint in _SIMPLE:
        return _SIMPLE[hint]
    if getattr(hint, "_is_protocol", False):
        members = {name for base in hint.__mro__[:-1] for name in vars(base) if name[:1] != "_"}
        members |= {name for name in typing.get_type_hints(hint) if name[:1] != "_"}
        members |= {"__call__"} & set(vars(hint))
        return lambda value: all(hasattr(value, name) for name in members)
    return (lambda value: isinstance(value, hint)) if isinstance(hint, type) else _anything


def _listed(origin: Any, parts: tuple[Any, ...]) -> Check:
    """A list, tuple or array of things that pass; of the length that a tuple's annotation says."""
    fixed = [_check(part) for part in parts] if origin is tuple and Ellipsis not in parts else []
    item = _check(parts[0]) if parts else _anything
    if parts and typing.get_origin(parts[0]) is np.ndarray:
        item = _rows

    def test(value: Any) -> bool:
        if fixed:
            if not isinstance(value, (list, tuple, np.ndarray)) or _scalar(value):
                return False
            return len(value) == len(fixed) and all(map(_passes, fixed, value))
        if isinstance(value, np.ndarray):
            return value.ndim > 0 and value.dtype.kind in _NUMERIC and all(map(item, value[:1]))
        return isinstance(value, (list, tuple, range)) and all(item(part) for part in value)

    return test


def _rows(value: Any) -> bool:
    return is_numeric(value) and np.ndim(value) > 0


def _passes(test: Check, value: Any) -> bool:
    return test(value)


def _scalar(value: Any) -> bool:
    return isinstance(value, np.ndarray) and value.ndim == 0


def _real(value: Any) -> bool:
    if isinstance(value, np.ndarray):
        return value.ndim == 0 and value.dtype.kind in "biuf"
    return isinstance(value, numbers.Real)


def _whole(value: Any) -> bool:
    # A whole float passes; one that is not finite is refused by its function, with the limit.
    try:
        operator.index(value)
    except TypeError:
        return _real(value) and (not np.isfinite(value) or float(value).is_integer())
    return True


def _anything(value: Any) -> bool:
    return True


_SIMPLE: Final[dict[Any, Check]] = {
    Any: _anything,
    object: _anything,
    float: _real,
    int: _whole,
    complex: lambda value: _real(value) or isinstance(value, numbers.Complex),
    bool: lambda value: isinstance(value, (bool, np.bool_)),
    str: lambda value: isinstance(value, str),
    Path: lambda value: isinstance(value, Path),
    type(None): lambda value: value is None,
}


# --- messages ------------------------------------------------------------------------------------
def _message(function: Callable[..., Any], name: str, value: Any, hint: Any) -> str:
    wanted = _wanted(hint)
    kind = "array" if _array_like(hint) else wanted.rpartition(" ")[2]
    advice = instead(value, kind)
    return (
        f"{function.__qualname__}: {name} is {_given(value)}; {wanted} is needed"
        f"{f' ({advice})' if advice else ''}"
    )


def _given(value: Any) -> str:
    if isinstance(value, np.ndarray):
        return f"an array of shape {value.shape} and type {value.dtype}"
    text = repr(value)
    if value is None or isinstance(value, (str, numbers.Number)):
        return text if len(text) <= 40 else f"{text[:37]}..."
    return f"of type {type(value).__name__}"


def _array_like(hint: Any) -> bool:
    parts = typing.get_args(hint)
    union = typing.get_origin(hint) in (typing.Union, types.UnionType)
    return typing.get_origin(hint) is np.ndarray or (
        union and (set(parts) >= _ARRAY_PARTS or any(_array_like(part) for part in parts))
    )


def _wanted(hint: Any) -> str:
    """An annotation as text."""
    origin, parts = typing.get_origin(hint), typing.get_args(hint)
    if origin in (typing.Union, types.UnionType):
        names = ["an array of numbers"] if set(parts) >= _ARRAY_PARTS else []
        names += [_wanted(part) for part in parts if not (names and part in _ARRAY_PARTS)]
        return " or ".join(dict.fromkeys(names))
    if origin is typing.Annotated:
        return _wanted(parts[0])
    if origin is np.ndarray:
        return "an array of numbers"
    if origin is typing.Literal:
        return "one of " + ", ".join(f'"{part}"' for part in parts)
    if origin is tuple and parts and Ellipsis not in parts:
        return "(" + ", ".join(map(_wanted, parts)) + ")"
    if origin in (Sequence, tuple):
        return f"a list, each: {_wanted(parts[0])}" if parts else "a list"
    if origin is Mapping:
        return "a dictionary"
    if origin is Callable:
        return "a function"
    return _WORDS.get(hint, f"a {getattr(hint, '__name__', hint)}")


_WORDS: Final[dict[Any, str]] = {
    float: "a number",
    int: "an integer",
    complex: "a number",
    bool: "True or False",
    str: "a string",
    Path: "a path",
    type(None): "None",
}
