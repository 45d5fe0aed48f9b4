"""The job: a kit becomes parts, plates, schedules and a moving report in one complete folder."""

from __future__ import annotations

import hashlib
import time
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import Future, as_completed
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any, Final

import numpy as np

from fabrication.formats.glb import write_glb
from fabrication.formats.step import Header, Material
from fabrication.formats.threemf import check_threemf
from fabrication.formats.xlsx import write_xlsx
from fabrication.job.folder import safe_name
from fabrication.job.manifest import (
    MANIFEST,
    build_manifest,
    file_records,
    part_record,
    write_manifest,
)
from fabrication.job.part import (
    PartJob,
    PartResult,
    PartSettings,
    assemble,
    make_parts,
    verify_parts,
)
from fabrication.job.pool import Workers
from fabrication.job.problems import problems_of
from fabrication.linkage.kit import Kit
from fabrication.linkage.page import MovingScene, write_page
from fabrication.linkage.pieces import ORDER
from fabrication.linkage.poses import check_poses
from fabrication.linkage.printing import PRINTED_CHORD_MM, write_plates
from fabrication.linkage.scene import lying_broad, moving_scene, report_page, write_pictures
from fabrication.linkage.schedules import kit_schedules
from fabrication.motion.free_range import poses_to_confirm
from fabrication.parts.pin import PIN
from fabrication.pipeline import JobResult, staged
from fabrication.progress import Progress
from fabrication.specs import Check, Role, TriangleMesh
from fabrication.standards import mass_kg
from fabrication.table import Table

BATCH: Final = 8
"""Part numbers that a process takes at a time."""

FOLDERS: Final = {"step": "step", "stl": "stl", "3mf": "3mf"}
"""Folders of the part files, by format."""


def make_kit(
    kit: Kit,
    folder: str | Path | None = None,
    *,
    jobs: int = 1,
    pool: Workers | None = None,
    progress: Progress | None = None,
) -> JobResult:
    """All files of a kit, checked; the folder appears complete or not at all.

    Parameters
    ----------
    folder : default outputs/<project name>
    jobs : processes; 1 works in this one. More need a ``if __name__ == "__main__"`` guard in the
        caller, as always with multiprocessing
    pool : what `worker_pool` gave, to be used instead of `jobs`
    progress : called as (step, done, of)

    Raises
    ------
    OutputError
        The folder cannot be written or is not ours to replace; nothing is changed then.
    DdgError
        A part cannot be made.
    """
    target = Path(folder) if folder is not None else Path("outputs") / safe_name(kit.name)
    tell = progress or (lambda step, done, of: None)
    with staged(target, jobs, pool) as (staging, workers):
        return _KitJob(kit, staging, target, workers, tell).run()


class _KitJob:
    """One run: the state that its steps share."""

    def __init__(
        self, kit: Kit, staging: Path, target: Path, pool: Workers, tell: Progress
    ) -> None:
        self.kit, self.staging, self.target = kit, staging, target
        self.pool, self.tell = pool, tell
        self.formats = frozenset(kit.project.output.formats)
        self.seconds: dict[str, float] = dict(kit.seconds)
        self.settings = part_settings(kit, staging)

    def run(self) -> JobResult:
        """All steps; the manifest comes last."""
        with self._timed("parts"):
            parts = self._make()
        meshes = {part.number: part.mesh for part in parts}
        tasks = [[(p.number, p.properties.volume, p.mesh, p.files)] for p in parts]
        reading = [self.pool.submit(verify_parts, task) for task in tasks]
        assembly = self._assemble(parts)
        with self._timed("plates"):
            extra = [*motion_checks(self.kit), *self._plates()]
        with self._timed("poses"):
            self.tell("poses", 0, 0)
            angles = poses_to_confirm(self.kit.motion, between=1)
            poses = check_poses(self.kit, meshes, angles)
            clear = all(check.passed for checks in poses.values() for check in checks)
            extra.append(Check("poses in which the meshes are clear", clear, float(len(angles))))
        with self._timed("waiting for the other processes"):
            found = self._collect(reading)
            extra += self._collect_assembly(assembly)
        parts = [replace(p, checks=(*p.checks, *found.get(p.number, ()))) for p in parts]
        checks = self._checks_by_mark(parts, poses)
        failed = {mark for mark, list_ in checks.items() if not all(c.passed for c in list_)}
        scene = moving_scene(self.kit)
        pictures = self._draw(scene, meshes, failed)
        tables = kit_schedules(self.kit.linkage, self._masses(parts))
        with self._timed("schedules"):
            self._write_schedules(tables)
        roles: dict[str, Role] = {piece.mark: piece.kind.role for piece in self.kit.linkage.pieces}
        problems = problems_of(
            roles, ((mark, check) for mark, list_ in checks.items() for check in list_)
        )
        lines = [str(problem) for problem in problems]
        lines += [f"{check.name}: {check.value}" for check in extra if not check.passed]
        if "html" in self.formats:
            with self._timed("report"):
                self.tell("report.html", 0, 0)
                page = report_page(self.kit, tables, lines)
                write_page(self.staging / "report.html", page, scene)
        warnings, seconds = pictures.result()
        self.seconds["pictures"] = seconds
        manifest = self._manifest(parts, checks, extra, warnings)
        manifest["problems"] = [problem.to_dict() for problem in problems]
        write_manifest(self.staging / MANIFEST, manifest)
        return JobResult(self.target, manifest, tuple(lines), tuple(warnings))

    def _draw(
        self, scene: MovingScene, meshes: Mapping[str, TriangleMesh], failed: set[str]
    ) -> Future[Any]:
        """Start the pictures, and write the model: what failed is red."""
        families = lying_broad(self.kit)
        if "glb" in self.formats:
            write_glb(self.staging / "model.glb", families, meshes, failed)
        gif = scene if "gif" in self.formats else None
        return self.pool.submit(write_pictures, self.staging, families, meshes, failed, gif)

    def _make(self) -> list[PartResult]:
        """All part numbers, in the pool."""
        jobs = [PartJob(f.number, f.kind, f.shape) for f in self.kit.families]
        for kind, name in FOLDERS.items():
            if kind in self.formats:
                (self.staging / "parts" / name).mkdir(parents=True)
        batches = [jobs[i : i + BATCH] for i in range(0, len(jobs), BATCH)]
        futures = [self.pool.submit(make_parts, batch, self.settings) for batch in batches]
        parts: list[PartResult] = []
        for future in futures:
            parts += future.result()
            self.tell("parts", len(parts), len(jobs))
        return parts

    def _plates(self) -> list[Check]:
        """Print plates, written and read back."""
        if "3mf" not in self.formats:
            return []
        folder, kit = self.staging / "plates", self.kit
        written = write_plates(folder, kit.families, kit.printed, kit.plates)
        return [
            replace(check, name=f"{path.stem} {check.name}")
            for path, expected in written.items()
            for check in check_threemf(path, expected)
        ]

    def _assemble(self, parts: Sequence[PartResult]) -> Future[Any] | None:
        """Start writing assembly.step of what moves, and reading it back."""
        if "step" not in self.formats:
            return None
        instances = [
            (family.number, instance.mark, instance.placement)
            for family in self.kit.placed()
            for instance in family.instances
        ]
        used = {number for number, _, _ in instances}
        return self.pool.submit(
            assemble,
            self.staging / "assembly.step",
            self.kit.name,
            [(part.job, part.properties) for part in parts if part.number in used],
            instances,
            self.settings,
            True,
        )

    def _collect_assembly(self, writing: Future[Any] | None) -> list[Check]:
        """Wait for assembly.step; the checks of the whole."""
        if writing is None:
            return []
        self.tell("assembly.step", 0, 0)
        checks, seconds = writing.result()
        self.seconds.update(seconds)
        return list(checks)

    def _collect(self, reading: Sequence[Future[Any]]) -> dict[str, list[Check]]:
        """Wait for files read back: checks by part number."""
        found: dict[str, list[Check]] = {}
        for done, future in enumerate(as_completed(reading), 1):
            found.update(future.result()[0])
            self.tell("read back", done, len(reading))
        return found

    def _checks_by_mark(
        self, parts: Sequence[PartResult], poses: dict[str, list[Check]]
    ) -> dict[str, list[Check]]:
        """Every piece's checks: its limits, its part number's, its clearances."""
        of_number = {part.number: part.checks for part in parts}
        checks = {piece.mark: list(piece.checks) for piece in self.kit.linkage.pieces}
        for family in self.kit.families:
            for instance in family.instances:
                checks[instance.mark] += of_number[family.number]
                checks[instance.mark] += poses.get(instance.mark, ())
        return checks

    def _masses(self, parts: Sequence[PartResult]) -> dict[str, float]:
        return {
            p.number: mass_kg(p.properties.volume, self.kit.density(p.job.kind.role)) for p in parts
        }

    def _write_schedules(self, tables: Mapping[str, Table]) -> None:
        """CSV a table, and one workbook."""
        folder = self.staging / "schedules"
        if self.formats & {"csv", "xlsx"}:
            folder.mkdir()
        if "csv" in self.formats:
            for name, table in tables.items():
                table.to_csv(folder / f"{name}.csv")
        if "xlsx" in self.formats:
            rows = {name: table.rows for name, table in tables.items()}
            write_xlsx(folder / "schedule.xlsx", rows)

    def _manifest(
        self,
        parts: Sequence[PartResult],
        checks: dict[str, list[Check]],
        extra: Sequence[Check],
        warnings: Sequence[str],
    ) -> dict[str, Any]:
        """What manifest.json says."""
        self.tell("manifest", 0, 0)
        kit = self.kit
        manifest = build_manifest(
            project=kit.name,
            input=_input(kit),
            settings=kit.project.settings,
            net=kit.facts(),
            support={},
            parts=self._part_records(parts, checks),
            files=file_records(self.staging),
            timings_s=self.seconds,
            extra_checks=extra,
        )
        manifest["notes"] = [*kit.notes, *warnings]
        return manifest

    def _part_records(
        self, parts: Sequence[PartResult], checks: dict[str, list[Check]]
    ) -> list[dict[str, Any]]:
        """The manifest's parts, by mark."""
        masses = self._masses(parts)
        results = {part.number: part for part in parts}
        records = []
        for family in self.kit.families:
            part = results[family.number]
            for instance in family.instances:
                placed = _placed(part.mesh, instance.placement)
                records.append(
                    part_record(
                        mark=instance.mark,
                        number=family.number,
                        role=family.role,
                        placement=instance.placement,
                        volume_mm3=part.properties.volume,
                        mass_kg=masses[family.number],
                        bbox_mm=placed,
                        checks=checks[instance.mark],
                    )
                )
        return sorted(records, key=lambda record: str(record["mark"]))

    @contextmanager
    def _timed(self, step: str) -> Iterator[None]:
        begin = time.perf_counter()
        yield
        self.seconds[step] = self.seconds.get(step, 0.0) + time.perf_counter() - begin


def _input(kit: Kit) -> dict[str, str | None]:
    """The file that the linkage came from: the mesh of a K-net, or the project."""
    path = kit.project.source
    if path is None:
        return {"file": None, "sha256": None}
    return {"file": str(path), "sha256": hashlib.sha256(path.read_bytes()).hexdigest()}


def motion_checks(kit: Kit) -> list[Check]:
    """That the linkage moves at all, and that its range is proven."""
    moved = float(np.degrees(kit.motion.high - kit.motion.low))
    return [
        Check("free range [deg]", moved > 0, moved, 0.0),
        Check("free range is proven", kit.motion.proven, kit.motion.certificate),
    ]


def part_settings(kit: Kit, folder: Path) -> PartSettings:
    """What all parts of a kit share; files go below `folder`."""
    output, formats = kit.project.output, kit.project.output.formats
    settings = kit.linkage.settings
    printed = Material(settings.printer.material, settings.printer.density)
    metal = Material("Steel", kit.density(PIN.role))
    roles = [kind.role for kind in ORDER]
    return PartSettings(
        folder=folder,
        step="step" in formats,
        stl="stl" in formats,
        chord=PRINTED_CHORD_MM,
        schema=output.step_schema,
        header=Header(output.author, output.organization, kit.name),
        materials={
            **dict.fromkeys(roles, printed),
            PIN.role: metal if settings.pin == "metal" else printed,
        },
        threemf="3mf" in formats,
    )


def _placed(mesh: TriangleMesh, placement: Any) -> Any:
    """(2, 3) bounding box [mm] of a placed mesh."""
    points = mesh.vertices @ placement[:3, :3].T + placement[:3, 3]
    return np.stack([points.min(axis=0), points.max(axis=0)])
