"""Hexagon bolts, nuts, washers and studs by size, and the distances that they need."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache
from typing import Any, Final, Literal, TypeAlias

from ddgfab.errors import ProjectError
from fabrication.standards.data import table

BoltSize: TypeAlias = Literal["M6", "M8", "M10", "M12", "M14", "M16", "M18", "M20", "M22", "M24"]
"""Sizes of the data file."""

BoltClass: TypeAlias = Literal["5.6", "8.8", "10.9", "A2-70", "A4-70", "A4-80"]
"""Property classes of the data file."""

BoltSeries: TypeAlias = Literal["full", "shank"]
"""Bolts threaded up to the head (ISO 4017), or with a shank (ISO 4014)."""

_CORNERS: Final = 2.0 / math.sqrt(3.0)


@dataclass(frozen=True)
class Timber:
    """Distances and sizes [mm] of bolts in timber, loaded along the grain.

    spacing, end, edge : least distance of two bolts along the grain, to a loaded end, to the side
    hole : greatest diameter of the hole
    washer : least width and thickness of washers
    """

    spacing: float
    end: float
    edge: float
    hole: float
    washer: tuple[float, float]


@dataclass(frozen=True)
class Fastener:
    """The dimensions [mm] of bolt, nut, washer and holes of one size.

    Attributes
    ----------
    size : such as "M12"
    diameter, pitch : of the thread
    drill : of the hole that is tapped
    hole : clearance hole, medium series
    flats : width across flats of head and nut
    head, nut : their heights
    washer : inside and outside diameter, thickness
    wide : of an extra large washer, for timber
    full, shank : shortest and longest bolt threaded up to the head, and with a shank
    """

    size: str
    diameter: float
    pitch: float
    drill: float
    hole: float
    flats: float
    head: float
    nut: float
    washer: tuple[float, float, float]
    wide: tuple[float, float, float]
    full: tuple[float, float]
    shank: tuple[float, float]

    @property
    def corners(self) -> float:
        """Width across corners of head and nut."""
        return _CORNERS * self.flats

    @property
    def edge(self) -> float:
        """Least distance from the hole's center to an edge (EN 1993-1-8, table 3.3)."""
        return float(table("fasteners")["distances"]["edge"]) * self.hole

    @property
    def end(self) -> float:
        """Least distance from the hole's center to the end of the part (the same table)."""
        return float(table("fasteners")["distances"]["end"]) * self.hole

    @property
    def spacing(self) -> float:
        """Least distance of two holes in the direction of the load (the same table)."""
        return float(table("fasteners")["distances"]["spacing"]) * self.hole

    @property
    def spacing_across(self) -> float:
        """Least distance of two holes across the direction of the load (the same table)."""
        return float(table("fasteners")["distances"]["spacing_across"]) * self.hole

    @property
    def in_timber(self) -> Timber:
        """What a bolt in timber needs (EN 1995-1-1, table 8.4 and 10.4.3)."""
        rule, d = table("fasteners")["timber"], self.diameter
        return Timber(
            rule["spacing"] * d,
            max(rule["end"] * d, rule["least_end_mm"]),
            rule["edge"] * d,
            d + rule["hole_mm"],
            (rule["washer"] * d, rule["washer_thickness"] * d),
        )

    @property
    def least_thread(self) -> float:
        """Least length of thread in engagement."""
        return float(table("fasteners")["thread"]["least"]) * self.diameter

    @property
    def usual_thread(self) -> float:
        """Length of thread in engagement where there is room for it."""
        return float(table("fasteners")["thread"]["usual"]) * self.diameter

    @property
    def runout(self) -> float:
        """Depth at the bottom of a blind hole that has no complete thread."""
        return float(table("fasteners")["thread"]["runout"]) * self.pitch

    @property
    def wrench(self) -> float:
        """Room that the head of a spanner needs across the bolt."""
        return float(table("fasteners")["wrench"]["head"]) * self.flats


@cache
def fastener(size: str) -> Fastener:
    """The dimensions of a size such as "M12".

    Raises
    ------
    ProjectError
        An unknown size; the known ones are listed.
    """
    sizes: dict[str, dict[str, Any]] = table("fasteners")["sizes"]
    if size not in sizes:
        raise ProjectError(f'there is no bolt "{size}"; known: {", ".join(sizes)}')
    row = sizes[size]
    return Fastener(
        size,
        row["diameter"],
        row["pitch"],
        row["drill"],
        row["hole"],
        row["s"],
        row["k"],
        row["m"],
        _three(row["washer"]),
        _three(row["wide"]),
        (float(row["full"][0]), float(row["full"][1])),
        (float(row["shank"][0]), float(row["shank"][1])),
    )


def _three(values: list[float]) -> tuple[float, float, float]:
    inside, outside, thickness = values
    return float(inside), float(outside), float(thickness)


def fasteners() -> tuple[Fastener, ...]:
    """All sizes, the smallest first."""
    return tuple(fastener(size) for size in table("fasteners")["sizes"])


def wrench_swing() -> float:
    """Angle [rad] by which a spanner must be free to turn."""
    return math.radians(float(table("fasteners")["wrench"]["swing_deg"]))


def bolt_length(bolt: Fastener, series: BoltSeries, least: float, most: float) -> float | None:
    """The longest bolt [mm] of a series between two lengths; None where there is none."""
    short, long = bolt.full if series == "full" else bolt.shank
    fits = [
        float(length)
        for length in table("fasteners")["series"]
        if max(short, least) <= length <= min(long, most)
    ]
    return max(fits, default=None)


def shortest_bolt(bolt: Fastener, least: float) -> tuple[float, bool] | None:
    """The shortest bolt [mm] of at least a length, with a shank where there is one; or None.

    Returns
    -------
    Its length, and whether it has a shank (ISO 4014) or is threaded up to the head (ISO 4017).
    """
    for length in table("fasteners")["series"]:
        if length < least:
            continue
        for shank, (short, long) in ((True, bolt.shank), (False, bolt.full)):
            if short <= length <= long:
                return float(length), shank
    return None


def stud_length(least: float) -> float | None:
    """The shortest stud [mm] (DIN 976-1) of at least a length; None where there is none."""
    fits = [float(length) for length in table("fasteners")["series"] if length >= least]
    return min(fits, default=None)


@dataclass(frozen=True)
class PropertyClass:
    """What goes together by the property class of a bolt or stud, as it is ordered.

    bolt, nut : classes
    washer, wide : hardness of plain and of extra large washers, or their steel
    """

    bolt: str
    nut: str
    washer: str
    wide: str


def property_class(name: str) -> PropertyClass:
    """The classes of nut and washers that go with a class of bolts, one of the data file."""
    row = table("fasteners")["classes"][name]
    return PropertyClass(name, row["nut"], row["washer"], row["wide"])


def steel_density() -> float:
    """Density of fasteners [kg/m3]."""
    return float(table("fasteners")["density"])
