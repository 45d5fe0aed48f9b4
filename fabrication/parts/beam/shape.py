"""Beams: a profile between two cuts; the record, and what it is to the rest of the package."""

from __future__ import annotations

import math
from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, Self

import numpy as np

from fabrication.boundary import Boundary, Cut
from fabrication.parts.beam.boundary import beam_geometry
from fabrication.parts.beam.comb import CombEnd
from fabrication.parts.beam.congruence import beam_key, beam_variants, fibre_ends
from fabrication.parts.beam.end_plate import bar_of, plate_details
from fabrication.parts.beam.straps import StrapEnd, strap_holes
from fabrication.parts.beam.stud import stud_details
from fabrication.parts.beam.volume import beam_volume
from fabrication.solids.plate import Blank
from fabrication.solids.sawn import SawnBar
from fabrication.specs import Kind, Profile
from fabrication.standards.profiles import z_range
from fabrication.variants import Variants

if TYPE_CHECKING:
    from fabrication.drawings.views import Drawing

BEAM: Final = Kind(
    role="beam",
    mark="B",
    prefix="BP",
    title="Beams",
    color=(0.33, 0.36, 0.40),
    finish="matte",
    shown=(0.36, 0.42, 0.49),
    form="bar",
    ifc="IfcMember",
)


@dataclass(frozen=True)
class StudEnd:
    """A hole perpendicular to a flat cut, through a plate, and the opening behind the plate [mm].

    z : height at which the axis of the hole meets the cut; the axis lies in the plane y = 0
    diameter : of the hole
    plate : thickness of the plate, or of what a solid bar has before its opening
    length, height, corner : of the opening: along the beam, across it, radius of its corners
    """

    z: float
    diameter: float
    plate: float
    length: float
    height: float
    corner: float


@dataclass(frozen=True)
class SlotEnd:
    """A slot from a flat cut of a flat bar, open at top and bottom, about its middle [mm].

    Its bottom is parallel to the cut, `depth` from it.
    """

    width: float
    depth: float


@dataclass(frozen=True)
class PlateEnd:
    """A plate across a flat cut, whose outer face is the cut; the bar ends at its inner face [mm].

    z : height at which the middle of the plate lies in the cut, y = 0
    width, height, thickness : across the beam, along the cut, and square to it
    holes : (y, w) of the bolt holes from the middle, w upwards along the cut
    diameter : of these holes
    vent : diameter of the hole in the middle, into the cavity of a hollow section; 0 otherwise
    """

    z: float
    width: float
    height: float
    thickness: float
    holes: tuple[tuple[float, float], ...]
    diameter: float
    vent: float = 0.0


@dataclass(frozen=True)
class EndCut:
    """How a beam ends, in the beam's frame; without torsion the node axis lies in its plane y = 0.

    x : where the cut meets the x axis [mm]
    slope, skew : a flat cut is the plane (x + slope z + skew y, y, z), parallel to the node axis;
        without torsion the axis runs along (slope, 0, 1) and skew is 0: a single mitre. A compound
        angle only where an axis leaves the plane y = 0 and is not perpendicular to the beam
    radius : None for a flat cut; else the radius [mm] of the coping cylinder, whose axis lies that
        far (perpendicularly) beyond x; its skew is 0
    stud, slot, plate, comb, straps : a hole for a stud or bolt through the cut, a slot, a plate
        across it, slots across it, or straps that end in it; it is flat, not skew then
    """

    x: float
    slope: float
    radius: float | None = None
    skew: float = 0.0
    stud: StudEnd | None = None
    slot: SlotEnd | None = None
    plate: PlateEnd | None = None
    comb: CombEnd | None = None
    straps: StrapEnd | None = None


@dataclass(frozen=True)
class CrossHole:
    """A round hole through the whole beam along y, centered at (x, z) [mm]."""

    x: float
    z: float
    diameter: float


@dataclass(frozen=True, eq=False)
class BeamShape:
    """A profile swept along x between two cuts. Frame: x start to end, y across, z up in pi(e)."""

    profile: Profile
    start: EndCut
    end: EndCut
    holes: tuple[CrossHole, ...] = ()

    @property
    def is_skew(self) -> bool:
        """Whether a cut is a compound angle; both ends are flat then."""
        return self.start.skew != 0.0 or self.end.skew != 0.0

    def key(self) -> Hashable:
        """Profile, kinds of cuts and holes."""
        return beam_key(self)

    @classmethod
    def variants(cls, shapes: Sequence[Self]) -> Variants:
        """As they are, and turned end for end where nothing distinguishes the ends."""
        return beam_variants(shapes)

    def geometry(self) -> Boundary | Cut:
        """Exact but for coped ends on a profile with round corners, which are cut."""
        return beam_geometry(self)

    def second_volume(self) -> float:
        """Length integrated over the profile, less the holes in its walls."""
        return beam_volume(self)

    def dimensions(self) -> dict[str, Any]:
        """Profile, bar to saw over all, and the cuts.

        A mitre [deg] between cut and square cut is positive where the beam is longer at the top, a
        skew [deg], seen from above, where it is longer on its left; skews of skew beams only.
        """
        start, end = fibre_ends(bar_of(self))
        found = {
            "profile": self.profile.name,
            "length_cut_mm": float(end.max() - start.min()),
            "mitre_start_deg": float(np.degrees(-np.arctan(self.start.slope))),
            "mitre_end_deg": float(np.degrees(np.arctan(self.end.slope))),
        }
        if self.is_skew:
            found["skew_start_deg"] = float(np.degrees(-np.arctan(self.start.skew)))
            found["skew_end_deg"] = float(np.degrees(np.arctan(self.end.skew)))
        return found

    def sawn(self) -> SawnBar | None:
        """The bar between plates, where its ends are flat and nothing is cut into them."""
        bar = bar_of(self)
        for cut in (bar.start, bar.end):
            if cut.radius is not None or cut.stud or cut.slot or cut.comb:
                return None
        if bar.is_skew:
            return None
        return SawnBar(
            bar.profile,
            (bar.start.x, bar.start.slope),
            (bar.end.x, bar.end.slope),
            tuple((hole.x, hole.z, hole.diameter) for hole in bar.holes),
            beam_volume(bar),
        )

    def details(self) -> dict[str, Any]:
        """From cut to cut at the top and the bottom of the profile; holes through the ends."""
        low, high = z_range(self.profile)
        slope = self.end.slope - self.start.slope
        found: dict[str, Any] = {
            f"length_{name}_mm": self.end.x - self.start.x + z * slope
            for name, z in (("top", high), ("bottom", low))
        }
        for name, cut, outward in (("start", self.start, -1.0), ("end", self.end, 1.0)):
            if cut.stud is not None:
                found |= stud_details(cut, outward, self.profile.loops, name)
            if cut.plate is not None:
                found |= plate_details(cut.plate, low, name)
            if cut.comb is not None:
                found |= cut.comb.details(cut.comb.z - low, name)
            if cut.straps is not None:
                found |= cut.straps.details(cut, strap_holes(self, cut, outward), name)
        return found

    def blanks(self) -> list[Blank]:
        """Plates across its ends, those inside hollow ends that studs go through, and straps."""
        found = []
        for cut in (self.start, self.end):
            if (straps := cut.straps) is not None:
                small, large = sorted((straps.height, straps.reach + straps.lap))
                found += [Blank("strap", straps.thickness, small, large)] * 2
            if cut.plate is not None:
                small, large = sorted((cut.plate.width, cut.plate.height))
                found.append(Blank("end plate", cut.plate.thickness, small, large))
            elif cut.stud is not None and len(self.profile.loops) > 1:
                wide, high = np.ptp(self.profile.loops[1].points, axis=0).tolist()
                small, large = sorted((wide, high * math.hypot(1.0, cut.slope)))
                found.append(Blank("plate inside an end", cut.stud.plate, small, large))
        return found

    def drawing(self, about: Mapping[str, Any]) -> Drawing:
        """What its sheet shows."""
        from fabrication.parts.beam.drawing import beam_drawing

        return beam_drawing(self)

    def stock(self) -> tuple[str, float]:
        """Name of the bar that it is sawn from, and the length to saw [mm]."""
        about = self.dimensions()
        return str(about["profile"]), float(about["length_cut_mm"])
