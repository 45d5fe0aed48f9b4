"""The job: a design becomes solids, checks and files in one complete output folder."""

from __future__ import annotations

import shutil
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import Future, as_completed
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Final

from ddgfab.errors import OutputError
from ddgfab.optimize.report import comparison
from fabrication.checks.assembly import check_assembly
from fabrication.formats.xlsx import write_xlsx
from fabrication.gridshell.design import Design
from fabrication.gridshell.schedules import schedules
from fabrication.job.folder import OutputFolder, safe_name
from fabrication.job.manifest import (
    MANIFEST,
    build_manifest,
    file_records,
    write_manifest,
)
from fabrication.job.part import (
    PartJob,
    PartResult,
    VerifyTask,
    assemble,
    draw,
    make_parts,
    verify_parts,
)
from fabrication.job.pool import Workers, worker_pool
from fabrication.job.problems import problems_of
from fabrication.pictures.change import write_change
from fabrication.progress import Progress
from fabrication.records import CHORD_MM, clearances, part_records, part_settings
from fabrication.specs import Check, Family
from fabrication.standards import mass_kg

REJECTED: Final = "rejected"
"""Folder, inside the output folder, of the parts that failed a check or a limit."""

BATCH: Final = 24
"""Part numbers that a process takes at a time."""

SAMPLE: Final = 10
"""`verify = "sample"` reads back one part number in so many."""


@dataclass(frozen=True, eq=False, repr=False)
class JobResult:
    """A finished job.

    Attributes
    ----------
    folder : where everything is
    manifest : what manifest.json says
    problems : what failed a check or a limit, a line each
    warnings : what could not be done but is no fault of the structure
    """

    folder: Path
    manifest: dict[str, Any]
    problems: tuple[str, ...]
    warnings: tuple[str, ...]

    @property
    def exit_code(self) -> int:
        """0 when every check passed, else 1."""
        return 1 if self.problems else 0

    def __repr__(self) -> str:
        parts = len(self.manifest["parts"])
        state = f"{len(self.problems)} problems" if self.problems else "every check passed"
        return f"JobResult({parts} parts in {self.folder}, {state})"


def make(
    design: Design,
    folder: str | Path | None = None,
    *,
    jobs: int = 1,
    pool: Workers | None = None,
    progress: Progress | None = None,
) -> JobResult:
    """Solids, checks and files of a design; the folder appears complete or not at all.

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
    name = safe_name(design.project.name)
    target = Path(folder) if folder is not None else Path("outputs") / name
    tell = progress or (lambda step, done, of: None)
    with staged(target, jobs, pool) as (staging, workers):
        return _Job(design, staging, target, workers, tell).run()


@contextmanager
def staged(target: Path, jobs: int, pool: Workers | None) -> Iterator[tuple[Path, Workers]]:
    """A folder to fill and the workers of a job: its own ones where no pool is given.

    The folder takes the target's place when the block ends well, and goes when it does not.
    """
    with ExitStack() as stack:
        workers = stack.enter_context(worker_pool(jobs)) if pool is None else pool
        staging = stack.enter_context(OutputFolder(target))
        try:
            yield staging, workers
        except BaseException:
            workers.stop()  # before the staging folder goes, into which they write
            raise


class _Job:
    """One run: the state that its steps share."""

    def __init__(
        self, design: Design, staging: Path, target: Path, pool: Workers, tell: Progress
    ) -> None:
        self.design, self.staging, self.target = design, staging, target
        self.pool, self.tell = pool, tell
        self.formats = frozenset(design.project.output.formats)
        self.seconds: dict[str, float] = dict(design.seconds)
        self.warnings: list[str] = []
        self.settings = part_settings(design, staging, self.formats)

    def run(self) -> JobResult:
        """All steps; the manifest comes last.

        The pool draws and reads part files back while this process looks at clearances. Pictures
        and assembly are made of what passed so far and, should later checks find more, again.
        """
        with self._timed("parts"):
            parts = self._make()
        failed = _failed(self._checks_by_mark(parts, {}))
        models, drawn = self._draw(parts, failed), failed
        tasks = self._verify_tasks(parts)
        reading = [self.pool.submit(verify_parts, task) for task in tasks[: len(tasks) // 3]]
        with self._timed("clearances"):
            self.tell("clearances", 0, 0)
            pieces = check_assembly(
                self._within_limits(),
                {part.number: part.mesh for part in parts},
                clearances(self.design),
                tolerance=2 * CHORD_MM,
            )
        failed = _failed(self._checks_by_mark(parts, pieces))
        assembly, assembled = self._assemble(parts, failed), failed
        reading += [self.pool.submit(verify_parts, task) for task in tasks[len(tasks) // 3 :]]
        with self._timed("schedules"):
            self._write_schedules(parts)
            self._write_change()
        with self._timed("waiting for the other processes"):
            found = self._collect(reading)
            extra = self._collect_assembly(assembly)
        parts = [replace(p, checks=(*p.checks, *found.get(p.number, ()))) for p in parts]
        checks = self._checks_by_mark(parts, pieces)
        failed = _failed(checks)
        if failed != assembled:
            extra = self._collect_assembly(self._assemble(parts, failed))
        warnings = self._collect_models(models)
        if failed != drawn:
            warnings = self._collect_models(self._draw(parts, failed))
        self.warnings += warnings
        self._reject(parts, failed)
        return self._finish(parts, checks, extra)

    def _within_limits(self) -> list[Family]:
        """Families of pieces that passed their limits; what is rejected anyway clashes with none.

        All pieces of a family pass, or none.
        """
        good = {
            piece.mark
            for piece in self.design.gridshell.pieces
            if all(check.passed for check in piece.checks)
        }
        return [f for f in self.design.families if f.instances[0].mark in good]

    # --- parts -------------------------------------------------------------------------------
    def _make(self) -> list[PartResult]:
        """All part numbers, in the pool."""
        jobs = [PartJob(f.number, f.kind, f.shape) for f in self.design.families]
        for kind in ("step", "stl", "3mf"):
            if kind in self.formats:
                (self.staging / "parts" / kind).mkdir(parents=True)
        batches = [jobs[i : i + BATCH] for i in range(0, len(jobs), BATCH)]
        futures = [self.pool.submit(make_parts, batch, self.settings) for batch in batches]
        parts: list[PartResult] = []
        for future in futures:
            parts += future.result()
            self.tell("parts", len(parts), len(jobs))
        for part in parts:
            for name, seconds in part.seconds.items():
                self._add(f"part {name}", seconds)
        return parts

    def _verify_tasks(self, parts: Sequence[PartResult]) -> list[list[VerifyTask]]:
        """Batches of part numbers to be read back, as the project asks."""
        every = {"all": 1, "sample": SAMPLE, "none": 0}[self.design.project.checks.verify]
        if not every:
            return []
        tasks = [(p.number, p.properties.volume, p.mesh, p.files) for p in parts[::every]]
        return [tasks[i : i + BATCH] for i in range(0, len(tasks), BATCH)]

    def _collect(self, reading: Sequence[Future[Any]]) -> dict[str, list[Check]]:
        """Wait for files read back: checks by part number."""
        found: dict[str, list[Check]] = {}
        for done, future in enumerate(as_completed(reading), 1):
            checked, seconds = future.result()
            found.update(checked)
            self._add("read back (all processes)", seconds)
            self.tell("read back", done, len(reading))
        return found

    def _checks_by_mark(
        self, parts: Sequence[PartResult], pieces: dict[str, list[Check]]
    ) -> dict[str, list[Check]]:
        """Every piece's checks: its limits, its part number's, its clearances."""
        of_number = {part.number: part.checks for part in parts}
        checks = {piece.mark: list(piece.checks) for piece in self.design.gridshell.pieces}
        for family in self.design.families:
            for instance in family.instances:
                own = checks[instance.mark]
                own += of_number[family.number]
                own += pieces.get(instance.mark, ())
        return checks

    def _reject(self, parts: Sequence[PartResult], failed: set[str]) -> None:
        """Files of numbers with a failing piece go to rejected/, alone where no piece is good."""
        files = {part.number: part.files for part in parts}
        for family in self.design.families:
            bad = [i.mark in failed for i in family.instances]
            if not any(bad):
                continue
            for path in files[family.number].values():
                target = self.staging / REJECTED / path.relative_to(self.staging / "parts")
                target.parent.mkdir(parents=True, exist_ok=True)
                if all(bad):
                    path.rename(target)
                else:
                    shutil.copy2(path, target)

    # --- the whole ---------------------------------------------------------------------------
    def _assemble(self, parts: Sequence[PartResult], failed: set[str]) -> Future[Any] | None:
        """Start writing assembly.step of the pieces that passed, and reading it back."""
        instances = [
            (family.number, instance.mark, instance.placement)
            for family in self.design.families
            for instance in family.instances
            if instance.mark not in failed
        ]
        path = self.staging / "assembly.step"
        if "step" not in self.formats or not instances:
            path.unlink(missing_ok=True)
            return None
        used = {number for number, _, _ in instances}
        return self.pool.submit(
            assemble,
            path,
            self.design.project.name,
            [(part.job, part.properties) for part in parts if part.number in used],
            instances,
            self.settings,
            self.design.project.checks.verify != "none",
        )

    def _collect_assembly(self, writing: Future[Any] | None) -> list[Check]:
        """Wait for assembly.step; the checks of the whole."""
        if writing is None:
            return []
        self.tell("assembly.step", 0, 0)
        checks, seconds = writing.result()
        for step, time_s in seconds.items():
            self._add(step, time_s)
        return list(checks)

    def _write_schedules(self, parts: Sequence[PartResult]) -> None:
        """CSV and XLSX, with the masses of the parts as made."""
        density = {role: material.density for role, material in self.settings.materials.items()}
        masses = {p.number: mass_kg(p.properties.volume, density[p.job.kind.role]) for p in parts}
        tables = schedules(self.design.gridshell, self.design.families, masses)
        folder = self.staging / "schedules"
        if "csv" in self.formats:
            folder.mkdir()
            for name, table in tables.items():
                table.to_csv(folder / f"{name}.csv")
        if "xlsx" in self.formats:
            folder.mkdir(exist_ok=True)
            rows = {name: table.rows for name, table in tables.items()}
            write_xlsx(folder / "schedule.xlsx", rows)

    def _write_change(self) -> None:
        """A picture of what [optimize] did to the net."""
        moved = self.design.optimized
        if moved is None:
            return
        try:
            write_change(self.staging / "optimized.png", moved.change)
        except OutputError as error:
            self.warnings.append(f"no optimized.png: {error}")

    def _draw(self, parts: Sequence[PartResult], failed: set[str]) -> Future[Any]:
        """Start model.glb and preview.png."""
        meshes = {part.number: part.mesh for part in parts}
        glb = "glb" in self.formats
        return self.pool.submit(draw, self.staging, self.design.families, meshes, failed, glb)

    def _collect_models(self, drawing: Future[Any]) -> list[str]:
        """Wait for model and picture; what could not be drawn."""
        self.tell("model and preview", 0, 0)
        warnings, seconds = drawing.result()
        self._add("model and preview", seconds)
        return list(warnings)

    # --- the end -----------------------------------------------------------------------------
    def _finish(
        self,
        parts: Sequence[PartResult],
        checks: dict[str, list[Check]],
        extra: Sequence[Check],
    ) -> JobResult:
        """Write the manifest and gather the problems."""
        self.tell("manifest", 0, 0)
        design = self.design
        roles = {piece.mark: piece.kind.role for piece in design.gridshell.pieces}
        problems = problems_of(
            roles, ((mark, check) for mark, list_ in checks.items() for check in list_)
        )
        manifest = build_manifest(
            project=design.project.name,
            input={
                "file": design.source.file,
                "sha256": design.source.sha256,
                "vertices": design.mesh.n_vertices,
                "faces": design.mesh.n_faces,
            },
            settings=design.project.settings,
            net=design.measures.to_dict(),
            support=design.support.to_dict(),
            parts=part_records(design, parts, checks, self.settings),
            files=file_records(self.staging),
            timings_s=self.seconds,
            extra_checks=extra,
        )
        if design.optimized is not None:
            manifest["optimize"] = comparison(design.optimized)
        manifest["problems"] = [problem.to_dict() for problem in problems]
        manifest["notes"] = [*design.source.notes, *design.gridshell.problems, *self.warnings]
        write_manifest(self.staging / MANIFEST, manifest)
        lines = [str(problem) for problem in problems]
        lines += [f"assembly.step: {c.name} {c.value}" for c in extra if not c.passed]
        return JobResult(self.target, manifest, tuple(lines), tuple(self.warnings))

    @contextmanager
    def _timed(self, step: str) -> Iterator[None]:
        begin = time.perf_counter()
        yield
        self._add(step, time.perf_counter() - begin)

    def _add(self, step: str, seconds: float) -> None:
        self.seconds[step] = self.seconds.get(step, 0.0) + seconds


def _failed(checks: dict[str, list[Check]]) -> set[str]:
    """Marks of the pieces that failed a check."""
    return {mark for mark, list_ in checks.items() if not all(c.passed for c in list_)}
