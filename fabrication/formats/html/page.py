"""What a product tells of itself on its page: title, facts, what a row is about, what moves."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from ddgfab.mesh import Floats
from fabrication.formats.base import Whole
from fabrication.formats.tables import Row
from fabrication.specs import TriangleMesh


def _of_mark(row: Mapping[str, Any]) -> Sequence[str]:
    """The piece that a row names in its column "mark"."""
    return [row["mark"]] if "mark" in row else []


@dataclass(frozen=True, eq=False)
class ContactNote:
    """A contact in a pose: position among the poses, point (3,) [mm], text."""

    pose: int
    at: Floats
    text: str


@dataclass(frozen=True, eq=False)
class Motion:
    """How pieces move, pose by pose.

    Attributes
    ----------
    placements : (T, 4, 4) [mm] by mark; pieces that are not named stand still
    driver, values_deg : name of the parameter, and its values (T,)
    design : position of the design pose among the poses
    touches : contacts at the ends of the range
    """

    placements: Mapping[str, Floats]
    driver: str
    values_deg: Floats
    design: int
    touches: Sequence[ContactNote] = ()


@dataclass(frozen=True)
class Step:
    """Pieces that are put in their places together.

    Attributes
    ----------
    title : what is done
    marks : of the pieces
    group : what the step belongs to; steps of one group stand together on paper, under a picture
    """

    title: str
    marks: tuple[str, ...]
    group: str = ""


def _no_steps(whole: Whole) -> Sequence[Step]:
    """A structure whose order is open."""
    return ()


@dataclass(frozen=True, eq=False)
class Subject:
    """What report.html says beside what every structure has.

    Attributes
    ----------
    title, lead : heading, and a sentence below it
    facts : (name, value)
    notes : remarks, a paragraph each
    marks_of : the marks of the pieces that a row of a schedule is about
    steps : in which order the pieces go together
    motion : of what moves
    meshes : by part number, meshes that are shown instead of those of the parts [mm]
    labelled : roles whose marks stand in the model from the start
    """

    title: str = ""
    lead: str = ""
    facts: Sequence[tuple[str, str]] = ()
    notes: Sequence[str] = ()
    marks_of: Callable[[Row], Sequence[str]] = _of_mark
    steps: Callable[[Whole], Sequence[Step]] = _no_steps
    motion: Motion | None = None
    meshes: Mapping[str, TriangleMesh] = field(default_factory=dict)
    labelled: Sequence[str] = ()
