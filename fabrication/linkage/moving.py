"""A mechanism that moves, as the page and the animation take it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ddgfab.mesh import Floats
from fabrication.formats.html.page import ContactNote
from fabrication.specs import Color, TriangleMesh


@dataclass(frozen=True, eq=False)
class MovingPiece:
    """A piece that moves: positions of its body and group, its mark."""

    body: int
    group: int
    mark: str = ""


@dataclass(frozen=True)
class Group:
    """Pieces of one part number: the number and the color (sRGB, 0 to 1)."""

    number: str
    color: Color


@dataclass(frozen=True, eq=False)
class MovingScene:
    """A mechanism as the page and the animation show it.

    bodies : meshes [mm], each once
    pieces : what moves
    motions : (T, n, 4, 4) placements of the n pieces in T poses
    driver, values_deg : name of the parameter, and its values (T,)
    design : position of the design pose among the poses
    """

    bodies: Sequence[TriangleMesh]
    groups: Sequence[Group]
    pieces: Sequence[MovingPiece]
    motions: Floats
    driver: str
    values_deg: Floats
    design: int
    touches: Sequence[ContactNote] = ()
