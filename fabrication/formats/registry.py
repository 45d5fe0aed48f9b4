"""Which formats there are: one line each. Light: everything else is imported when it is used."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from importlib import import_module
from importlib.util import find_spec
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from fabrication.formats.base import Format

MODULES: Final = {
    "step": "fabrication.formats.step.format",
    "stl": "fabrication.formats.stl",
    "3mf": "fabrication.formats.threemf",
    "glb": "fabrication.formats.glb",
    "ifc": "fabrication.formats.ifc",
    "3dm": "fabrication.formats.rhino",
    "dxf": "fabrication.formats.dxf",
    "nc1": "fabrication.formats.nc1",
    "sheets": "fabrication.formats.sheets",
    "csv": "fabrication.formats.csv",
    "xlsx": "fabrication.formats.xlsx",
    "html": "fabrication.formats.html",
}
"""Modules whose FORMAT is a format, by its name, in the order in which files are written."""

_REGISTERED: dict[str, Format] = {}


def names() -> tuple[str, ...]:
    """Names of all formats that every product can be written in."""
    return tuple(dict.fromkeys([*MODULES, *_REGISTERED]))


def defaults(*, printed: bool) -> tuple[str, ...]:
    """Names of the formats that a product is written in where its project names none.

    Parameters
    ----------
    printed : whether the product is made by printers
    """
    wanted = ("always", "printed") if printed else ("always",)
    return tuple(name for name in names() if find(name).by_default in wanted)


def register(format: Format) -> None:
    """Add a format under its name, or put it in the place of the one that has this name."""
    _REGISTERED[format.name] = format


def unregister(name: str) -> None:
    """Take back what `register` did."""
    _REGISTERED.pop(name, None)


def find(name: str) -> Format:
    """The format of a name.

    Raises
    ------
    InputError
        There is none; names the nearest one.
    """
    if name in _REGISTERED:
        return _REGISTERED[name]
    check_names([name], names())
    found: Format = import_module(MODULES[name]).FORMAT
    return found


def check_names(given: Iterable[str], known: Iterable[str]) -> None:
    """Raise InputError for the first name that is not known, with the nearest one."""
    from ddgfab.errors import InputError
    from ddgfab.suggest import suggestion

    known = tuple(known)
    for name in given:
        if name not in known:
            raise InputError(f'format "{name}" is unknown; {suggestion(name, known)}')


def check_options(options: Mapping[str, Mapping[str, str]]) -> None:
    """Raise InputError for the first option, or value of one, that its format does not have."""
    from ddgfab.errors import InputError
    from ddgfab.suggest import suggestion

    check_names(options, names())
    for name, chosen in options.items():
        known = find(name).options
        for option, value in chosen.items():
            if not known:
                raise InputError(f'format "{name}" has no options')
            if option not in known:
                raise InputError(
                    f'format "{name}" has no option "{option}"; {suggestion(option, known)}'
                )
            if value not in known[option]:
                raise InputError(
                    f'{name}.{option} = "{value}" must be {" or ".join(known[option])}'
                )


def missing(formats: Iterable[Format], *, checked: bool) -> None:
    """Raise where a package is not installed that a format needs to be written, or checked.

    Raises
    ------
    InputError
        Names the format, the package and how to install it.
    """
    from ddgfab.errors import InputError

    for format in formats:
        needs: Mapping[str, str] = format.needs
        if checked:
            needs = {**needs, **format.needs_to_check}
        for module, install in needs.items():
            if find_spec(module) is None:
                why = "" if module in format.needs else " to be read back"
                raise InputError(
                    f'format "{format.name}" needs {module}{why}, which is not installed: '
                    f"pip install {install}\n"
                    "Or leave the format out (--formats)."
                )


def needs_kernel(formats: Iterable[str], *, checked: bool) -> bool:
    """Whether the checks of some format load the CAD kernel.

    Names of formats that only one product has are passed over.
    """
    known = names()
    return checked and any("OCP" in find(n).needs_to_check for n in formats if n in known)
