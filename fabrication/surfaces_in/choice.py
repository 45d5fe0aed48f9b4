"""Which faces of a file: by number, by name, several, or all."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final, TypeAlias

from ddgfab.errors import InputError, clipped
from ddgfab.suggest import suggestion

FaceChoice: TypeAlias = int | str | Sequence[int | str] | None
"""A number from 0, a name, several of them, "all", or None where the file has one face."""

ALL: Final = "all"
"""All faces of the file."""

_LISTED: Final = 12


def chosen(
    names: Sequence[tuple[str, ...]],
    areas: Sequence[float],
    choice: FaceChoice,
    file: str,
) -> list[int]:
    """Numbers of the faces that are meant, in the order in which they are asked for.

    Parameters
    ----------
    names : of each face: its own, then those of the bodies it belongs to
    areas : of each face [mm2], for messages
    choice : texts that are whole numbers count as numbers, unless a face has that name

    Raises
    ------
    InputError
        None chosen of several, a number beyond the last, an unknown name, a name that several
        faces have, a face chosen twice.
    """
    if choice is None:
        if len(names) > 1:
            raise InputError(
                f"has {len(names)} faces: {_listing(names, areas)}\nchoose one: --face 0, or by "
                "name; several: --face 0 --face 1; all of them: --face all",
                file=file,
            )
        return [0]
    if choice == ALL and not any(ALL in own for own in names):
        return list(range(len(names)))
    wanted = [choice] if isinstance(choice, int | str) else list(choice)
    found: list[int] = []
    for one in wanted:
        number = _number(one, names, areas, file)
        if number in found:
            raise InputError(f"face {clipped(str(one))} is chosen twice", file=file)
        found.append(number)
    if not found:
        raise InputError("no face is chosen: --face 0", file=file)
    return found


def _number(
    wanted: int | str, names: Sequence[tuple[str, ...]], areas: Sequence[float], file: str
) -> int:
    if isinstance(wanted, str):
        with_name = [k for k, own in enumerate(names) if wanted in own]
        nearest = [k for k in with_name if names[k][0] == wanted]
        hits = nearest if len(nearest) == 1 else with_name
        if len(hits) == 1:
            return hits[0]
        if hits:
            few = ", ".join(map(str, hits[:_LISTED])) + (", ..." if len(hits) > _LISTED else "")
            raise InputError(
                f"{len(hits)} faces have the name {clipped(wanted)}: choose by number ({few})",
                file=file,
            )
        if not wanted.removeprefix("-").isdecimal() or len(wanted) > 9:
            known = sorted({name for own in names for name in own})
            more = suggestion(wanted, known) if known else "its faces have no names"
            raise InputError(
                f"has no face {clipped(wanted)}; {more}; by number: {_listing(names, areas)}",
                file=file,
            )
        wanted = int(wanted)
    if not 0 <= wanted < len(names):
        last = "the only face is 0" if len(names) == 1 else f"faces are 0 to {len(names) - 1}"
        raise InputError(f"has no face {wanted}; {last}", file=file)
    return wanted


def patch_name(file: str, number: int, names: tuple[str, ...]) -> str:
    """What messages call a face."""
    own = f" ({clipped(names[0])})" if names and names[0] else ""
    return f"{file} face {number}{own}"


def _listing(names: Sequence[tuple[str, ...]], areas: Sequence[float]) -> str:
    rows = []
    for k, area in enumerate(areas[:_LISTED]):
        name = f"{clipped(names[k][0])}, " if names[k] else ""
        rows.append(f"{k} ({name}{area / 1e6:.3g} m2)")
    return ", ".join(rows) + ("" if len(names) <= _LISTED else ", ...")
