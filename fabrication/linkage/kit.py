"""Kit: a linkage as numbers, its parts and its certified motion; made by `kit`."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from contextlib import nullcontext
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.errors import InputError
from ddgfab.io.regular import unchanged
from ddgfab.linkages import Mechanism
from ddgfab.mesh import Floats
from fabrication.linkage.links import Linkage
from fabrication.linkage.lists import kit_lists
from fabrication.linkage.plates import Plate, Printed
from fabrication.linkage.printing import PRINTED_CHORD_MM, laid_out
from fabrication.linkage.project import KitProject, kit_kinds, load_kit_project, make_kit_project
from fabrication.linkage.schedules import kit_schedules, marks_of
from fabrication.linkage.widen import MovingLinkage, moved, widened
from fabrication.motion.free_range import FreeMotion
from fabrication.parts.pin import PIN
from fabrication.progress import Progress, silent
from fabrication.solids import mesh_of
from fabrication.specs import Family, Instance, Role, rejected
from fabrication.standards import density, mass_kg
from fabrication.table import Table

if TYPE_CHECKING:
    from fabrication.linkage.product import KitProduct

SHOWN: Final = 2
"""Pairs of parts that are named at either end of the free range; the manifest names all."""

MESHES: Final = (".obj", ".off", ".ply")


@dataclass(frozen=True, eq=False, repr=False)
class Kit:
    """A linkage in parts, and how far it moves.

    Attributes
    ----------
    mechanism : hinges and bars, and their kinematics
    moved : the linkage in parts with its certified free motion, and what was tried to widen it
    printed, plates : what is printed, and what stands where on the print plates
    digest : sha256 of the mesh of a K-net, or of the project file, that it was made from
    """

    project: KitProject
    mechanism: Mechanism
    moved: MovingLinkage
    printed: Sequence[Printed]
    plates: tuple[Plate, ...]
    seconds: Mapping[str, float]
    digest: str | None = None

    @property
    def name(self) -> str:
        """The project's name."""
        return self.project.name

    def __repr__(self) -> str:
        low, high = np.degrees([self.motion.low, self.motion.high])
        return (
            f"Kit({self.name}: {self.mechanism.n_bars} bars on {self.mechanism.n_hinges} hinges, "
            f"{len(self.linkage.families)} part numbers, free {low:.1f} to {high:.1f} deg)"
        )

    @property
    def linkage(self) -> Linkage:
        """Pieces, part numbers, levels along the hinges."""
        return self.moved.linkage

    @property
    def motion(self) -> FreeMotion:
        """The certified free range of the driving angle, and what ends it."""
        return self.moved.motion

    @property
    def notes(self) -> list[str]:
        """Remarks for who prints and assembles the kit, and what was tried to widen its range."""
        return [*self.linkage.notes, *self.moved.tried]

    @property
    def families(self) -> tuple[Family, ...]:
        """Part numbers with their instances in the design pose."""
        return self.linkage.families

    @cached_property
    def schedules(self) -> dict[str, Table]:
        """The schedules "bom", "links", "hinges", "assembly", ...; masses of solid parts.

        Their status is that of the limits; solids and clearances are checked by the job.
        """
        from fabrication.solids import volume_of

        masses = {
            f.number: mass_kg(volume_of(f.shape), self.density(f.role)) for f in self.families
        }
        beyond, tables = rejected(self.linkage.pieces), self.tables(masses)
        return {name: table.with_status(beyond, marks_of) for name, table in tables.items()}

    def tables(self, masses: Mapping[str, float]) -> dict[str, Table]:
        """All schedules without a status; masses [kg] by part number."""
        return {
            **kit_schedules(self.linkage, masses),
            **kit_lists(self.linkage, masses, self.project),
        }

    def density(self, role: Role) -> float:
        """Density [kg/m3] of what parts of a role are made of."""
        metal = role == PIN.role and self.linkage.settings.pin == "metal"
        return density("steel") if metal else self.linkage.settings.printer.density

    def summary(self) -> str:
        """The linkage in a sentence."""
        mechanism = self.mechanism
        freedom = f"{mechanism.mobility} degree{'s' if mechanism.mobility > 1 else ''} of freedom"
        return (
            f"{mechanism.n_bars} bars on {mechanism.n_hinges} hinges, "
            f"{len(mechanism.cells)} isogram{'s' if len(mechanism.cells) > 1 else ''}, {freedom}"
        )

    def motion_facts(self) -> list[tuple[str, str]]:
        """The motion as names and values: driving angle, free range, contacts, certificate."""
        mechanism, motion = self.mechanism, self.motion
        low, high, design = np.degrees([motion.low, motion.high, mechanism.design])
        facts = [
            ("driving angle", mechanism.driver),
            ("free range", f"{low:.2f} to {high:.2f} deg, that is {high - low:.2f} deg"),
            ("design pose", f"{design:.2f} deg"),
        ]
        for end, contacts in (("ends below", motion.below), ("ends above", motion.above)):
            facts += [(end, contact.text()) for contact in contacts[:SHOWN]]
            if len(contacts) > SHOWN:
                facts.append((end, f"and {len(contacts) - SHOWN} more pairs"))
        facts += [("tightest within", contact.text()) for contact in motion.tightest[:1]]
        facts += [("certificate", motion.certificate), ("path", mechanism.path)]
        facts += [("folded at", f"{np.degrees(t):.2f} deg: {what}") for t, what in self._dead]
        return facts

    @property
    def _dead(self) -> list[tuple[float, str]]:
        """The dead points next to the free range on either side."""
        known = sorted(self.mechanism.dead_points)
        below = [point for point in known if point[0] <= self.mechanism.design]
        above = [point for point in known if point[0] > self.mechanism.design]
        return below[-1:] + above[:1]

    def facts(self) -> dict[str, Any]:
        """Mechanism and motion as plain values, for the manifest."""
        mechanism, motion = self.mechanism, self.motion

        def degrees(value: float) -> float:
            return round(float(np.degrees(value)), 6)

        return {
            "kind": mechanism.kind,
            "bars": mechanism.n_bars,
            "hinges": mechanism.n_hinges,
            "isograms": len(mechanism.cells),
            "mobility": mechanism.mobility,
            "driver": mechanism.driver,
            "path": mechanism.path,
            "design_deg": degrees(mechanism.design),
            "limits_deg": [degrees(limit) for limit in mechanism.limits],
            "dead_points_deg": [degrees(t) for t, _ in mechanism.dead_points],
            "free_deg": [degrees(motion.low), degrees(motion.high)],
            "certified": motion.proven,
            "certificate": motion.certificate,
            "contacts": [contact.to_dict() for contact in motion.contacts],
            "tightest": [contact.to_dict() for contact in motion.tightest],
        }

    def angles(self, count: int) -> Floats:
        """(count,) driving angles [rad] through the free range, ends included."""
        return np.linspace(self.motion.low, self.motion.high, count)

    def motions(self, angles: ArrayLike) -> dict[str, Floats]:
        """Placements (T, 4, 4) by mark of the pieces that move, at (T,) driving angles [rad].

        They are those of the part number's shape, as in the families' instances.

        Raises
        ------
        InputError
            A driving angle outside the mechanism's limits.
        """
        poses = self.mechanism.poses(angles)
        placed = [self.linkage.placements_at(poses[k]) for k in range(len(poses.points))]
        turns = {
            instance.mark: (piece.placement, instance.placement)
            for piece, instance in zip(self.linkage.pieces, self._instances, strict=True)
        }
        return {
            mark: np.stack([at[mark] for at in placed]) @ np.linalg.inv(own) @ shared
            for mark, (own, shared) in turns.items()
            if mark in placed[0]
        }

    @cached_property
    def _instances(self) -> tuple[Instance, ...]:
        """The instance of each piece: where the shape of its part number goes."""
        by_mark = {i.mark: i for family in self.families for i in family.instances}
        return tuple(by_mark[piece.mark] for piece in self.linkage.pieces)

    def placed(self, angle: float | None = None) -> tuple[Family, ...]:
        """Part numbers of what moves, with their instances at a driving angle [rad].

        By default those of the design pose; the coupon and its pin are left out.
        """
        at = self.mechanism.design if angle is None else float(angle)
        motions = self.motions(np.array([at]))
        placed = []
        for family in self.families:
            own = [i for i in family.instances if i.mark in motions]
            if own:
                moved = tuple(Instance(i.mark, motions[i.mark][0]) for i in own)
                placed.append(replace(family, instances=moved))
        return tuple(placed)

    def product(self) -> KitProduct:
        """What the job makes of it; see `fabrication.job`."""
        from fabrication.linkage.product import KitProduct

        return KitProduct(self)

    def to_build123d(self, angle: float | None = None) -> Any:
        """A labelled `build123d.Compound` at a driving angle [rad], by default the design's.

        Its children are Links, Pins, Caps, Spacers with a labelled, colored solid a piece.
        """
        from fabrication.handover import to_build123d

        return to_build123d(self.name, self.placed(angle))

    def to_cadquery(self, angle: float | None = None) -> Any:
        """A `cadquery.Assembly` at a driving angle [rad]: a named, colored solid a piece."""
        from fabrication.handover import to_cadquery

        return to_cadquery(self.name, self.placed(angle))

    def _repr_png_(self) -> bytes:
        from fabrication.linkage.scene import colors_of, lying_broad
        from fabrication.pictures.preview import preview_png

        shown = lying_broad(self)
        return preview_png(shown, colors_of(shown))


def kit(
    source: str | Path | None = None, *, progress: Progress | None = None, **settings: Any
) -> Kit:
    """A kit of parts from a kind of linkage or a project file; loads no CAD kernel.

    Parameters
    ----------
    source : "bennett" (the default), "cube", "knet", "crab", a project file (TOML), or a mesh file
        (OBJ, OFF, PLY) of a K-net
    progress : called as (step, done, of)
    settings : parameters of [linkage], such as ``a_mm=80``, and sections that differ from the
        project's or the defaults, such as ``parts={"pin": "printed"}``

    Raises
    ------
    DdgError
        The project, the linkage or a part is invalid; names the value and its limit.

    Examples
    --------
    >>> kit("bennett", a_mm=100, alpha_deg=40, beta_deg=70).mechanism.mobility
    1
    """
    if source is not None and not isinstance(source, (str, Path)):
        raise InputError(
            f"kit: source is of type {type(source).__name__}; a kind of linkage "
            f"({', '.join(kit_kinds())}), a project file or the mesh file of a K-net is needed "
            "(write_mesh(path, mesh) writes one)"
        )
    return detail_kit(find_kit_project(source, settings), progress)


def find_kit_project(source: str | Path | None, settings: Mapping[str, Any]) -> KitProject:
    """The project of a kind, project or mesh file, with parameters and sections changed."""
    # A mapping is a section, though maybe an unknown one, but for a surface's own parameters.
    sections = {
        name: dict(value)
        for name, value in settings.items()
        if isinstance(value, Mapping) and name != "parameters"
    }
    parameters = {name: value for name, value in settings.items() if name not in sections}
    linkage = {**sections.get("linkage", {}), **parameters}
    if source is not None and Path(source).suffix.lower() == ".toml":
        return load_kit_project(source, {**sections, **({"linkage": linkage} if linkage else {})})
    if source is not None and Path(source).suffix.lower() in MESHES:
        linkage = {"file": str(source), **linkage}
        name = sections.get("project", {}).get("name", Path(source).stem)
        sections["project"] = {**sections.get("project", {}), "name": name}
        source = "knet"
    kind = "bennett" if source is None else str(source)
    if kind not in kit_kinds():
        raise InputError(
            f'"{kind}" is neither a kind of linkage ({", ".join(kit_kinds())}) nor a project '
            f"(.toml) or a mesh ({', '.join(MESHES)})"
        )
    return make_kit_project({**sections, "linkage": {"kind": kind, **linkage}})


def detail_kit(project: KitProject, progress: Progress | None = None) -> Kit:
    """The kit of a validated project."""
    report = progress or silent
    seconds: dict[str, float] = {}

    def lap(step: str, begin: float) -> None:
        seconds[step] = time.perf_counter() - begin

    report("mechanism", 0, 0)
    begin = time.perf_counter()
    with nullcontext() if project.source is None else unchanged(project.source) as digest:
        mechanism = project.mechanism()
    lap("mechanism", begin)
    report("parts and free motion", 0, 0)
    begin = time.perf_counter()
    find = widened if project.motion.maximize_range else moved
    found = find(mechanism, project.part_settings())
    lap("parts and free motion", begin)
    report("print plates", 0, 0)
    begin = time.perf_counter()
    families = found.linkage.families
    meshes = {f.number: mesh_of(f.shape, PRINTED_CHORD_MM) for f in families}
    apart = frozenset(piece.mark for piece in found.linkage.loose)
    printed, filled = laid_out(
        families, meshes, found.linkage.settings, project.printer.bed(), apart
    )
    lap("print plates", begin)
    return Kit(project, mechanism, found, printed, filled, seconds, digest)
