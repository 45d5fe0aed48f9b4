"""The registry: every kind of net that `[net] kind = ...` and `ddgfab net KIND` can make."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

# Imported for their entries in GENERATORS, in the order of the list that people see.
from ddgfab.arguments import checked
from ddgfab.forms import (  # noqa: F401
    canal,
    conical,
    cyclide,
    knet_roofs,
    knet_towers,
    koebe,
    minimal,
    monge_surface,
    moulding,
    rotational,
    station_canopy,
    translation,
)
from ddgfab.forms.generators import GENERATORS, Generator, ParameterError
from ddgfab.mesh import Mesh
from ddgfab.suggest import suggestion

__all__ = ["Generator", "ParameterError", "find_generator", "generate", "kinds"]


@checked
def kinds() -> tuple[str, ...]:
    """Names of all kinds, sorted."""
    return tuple(sorted(GENERATORS))


@checked
def find_generator(kind: str) -> Generator:
    """The generator of a kind.

    Raises
    ------
    ParameterError
        An unknown kind; names the nearest.
    """
    if kind not in GENERATORS:
        raise ParameterError(f'kind "{kind}" is unknown; {suggestion(kind, kinds())}', "kind")
    return GENERATORS[kind]


@checked
def generate(
    kind: str, parameters: Mapping[str, Any] | None = None, folder: Path | None = None
) -> Mesh:
    """Mesh [mm] of a kind of net with its parameters, the others at their defaults.

    Parameters
    ----------
    folder : where the files that parameters name lie; by default the current folder

    Raises
    ------
    ParameterError
        An unknown kind or parameter (names the nearest), a wrong type, a value beyond its limits.
    DegenerateError
        Values that are each within limits but make a degenerate net together; names the cell.
    MeshError
        A file that cannot be used.

    Examples
    --------
    >>> generate("conical", {"panels_along": 6, "panels_across": 4}).n_faces
    24
    """
    entry = find_generator(kind)
    given = dict(parameters or {})
    entry.check(given)
    for name in entry.files(given):
        given[name] = str((folder or Path()) / given[name])
    return entry.function(**given)
