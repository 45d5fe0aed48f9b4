"""Build-ups of panes such as "8/16Ar/6.6", from the outside inwards: thickness and mass."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cache
from typing import Final

from ddgfab.errors import ProjectError, clipped
from fabrication.standards.data import density, table

FORM: Final = (
    'from the outside inwards "8/16Ar/6.6.2": plies in mm, laminated ones with dots between (a '
    "third number or a later one is the films between two plies), cavities in mm with Air, Ar or Kr"
)
MOST_PANES: Final = 4
LONGEST: Final = 60
"""Characters of a build-up."""

M_PER_MM: Final = 1e-3


@dataclass(frozen=True)
class Sheet:
    """One pane of a build-up: a ply, or plies with PVB between.

    plies : thicknesses [mm], outermost first
    films : PVB films of 0.38 mm between two plies
    """

    plies: tuple[float, ...]
    films: int = 0

    @property
    def interlayers(self) -> float:
        """Thickness of all PVB [mm]."""
        return (len(self.plies) - 1) * self.films * float(table("glass")["film"]["thickness"])


@dataclass(frozen=True)
class Cavity:
    """What lies between two panes: a spacer's width [mm], and a gas."""

    width: float
    gas: str


@dataclass(frozen=True)
class BuildUp:
    """A pane as it is ordered: panes from the outside inwards, and the cavities between them."""

    text: str
    panes: tuple[Sheet, ...]
    cavities: tuple[Cavity, ...]

    @property
    def thickness(self) -> float:
        """Of all of it [mm]."""
        glass = sum(sum(pane.plies) + pane.interlayers for pane in self.panes)
        return round(glass + sum(cavity.width for cavity in self.cavities), 6)

    @property
    def mass(self) -> float:
        """Mass [kg/m2] of glass, films and gas; spacers and edge seals are not in it."""
        data = table("glass")
        glass = density("glass") * sum(sum(pane.plies) for pane in self.panes)
        film = float(data["film"]["density"]) * sum(pane.interlayers for pane in self.panes)
        gas = sum(float(data["gas"][cavity.gas]) * cavity.width for cavity in self.cavities)
        return M_PER_MM * (glass + film + gas)

    @property
    def density(self) -> float:
        """Mean density [kg/m3]: mass over thickness."""
        return self.mass / (M_PER_MM * self.thickness)


@cache
def build_up(text: str) -> BuildUp:
    """The build-up of a text.

    Raises
    ------
    ProjectError
        Not such a text, a ply that is not float glass, a cavity or a number of films out of range;
        names the element, its place, and what is allowed.
    """
    if len(text) > LONGEST:
        raise ProjectError(f"build_up of {len(text)} characters; at most {LONGEST}: {FORM}")
    elements = text.split("/")
    if len(elements) % 2 == 0 or len(elements) > 2 * MOST_PANES - 1:
        raise ProjectError(
            f'build_up = "{clipped(text)}" has {len(elements)} elements; panes and cavities take '
            f"turns, 1 to {MOST_PANES} panes: {FORM}"
        )
    panes, cavities = [], []
    for place, element in enumerate(elements, 1):
        where = f'build_up = "{clipped(text)}": element {place}, "{clipped(element)}"'
        if place % 2:
            panes.append(_pane(element, where))
        else:
            cavities.append(_cavity(element, where))
    return BuildUp(text, tuple(panes), tuple(cavities))


def _pane(element: str, where: str) -> Sheet:
    """A pane: one ply, or plies and the films between them."""
    if not re.fullmatch(r"[0-9]{1,3}(\.[0-9]{1,3}){0,4}", element):
        raise ProjectError(f"{where}, is not a pane: {FORM}")
    numbers = [int(number) for number in element.split(".")]
    film = table("glass")["film"]
    films = int(film["usual"]) if len(numbers) > 1 else 0
    if len(numbers) > 2:
        films = numbers.pop()
        if not 1 <= films <= film["most"]:
            more = ".".join(map(str, [*numbers, films]))
            raise ProjectError(
                f"{where}: {films} is not a number of films (1 to {film['most']}); three plies are "
                f'written with their films, "{more}.{film["usual"]}"'
            )
    known = table("glass")["ply"]["thickness"]
    for number in numbers:
        if number not in known:
            raise ProjectError(
                f"{where}: there is no float glass of {number} mm; "
                f"{', '.join(map(str, known))} (EN 572-2)"
            )
    return Sheet(tuple(float(number) for number in numbers), films)


def _cavity(element: str, where: str) -> Cavity:
    """A cavity: its width, and the gas, air where none is named."""
    found = re.fullmatch(r"([0-9]{1,3})([A-Za-z]*)", element)
    gases = [name for name in table("glass")["gas"] if name != "source"]
    if found is None:
        raise ProjectError(f"{where}, is not a cavity: {FORM}")
    names = {name.lower(): name for name in gases}
    gas = names.get(found[2].lower() or "air")
    if gas is None:
        raise ProjectError(f'{where}: there is no gas "{clipped(found[2])}"; {", ".join(gases)}')
    width, limits = float(found[1]), table("glass")["cavity"]
    if not limits["least"] <= width <= limits["most"]:
        raise ProjectError(
            f"{where}: a cavity is {limits['least']} to {limits['most']} mm wide (EN 1279-1)"
        )
    return Cavity(width, gas)
