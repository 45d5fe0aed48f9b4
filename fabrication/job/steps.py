"""The steps of a job: parts, checks, files of the whole, schedules, manifest."""

from __future__ import annotations

import shutil
import time
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import Future, as_completed
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any, Final, TypeVar

from fabrication.formats.base import Format, Material, Part, Whole
from fabrication.job.expected import part_files, require_files, whole_files
from fabrication.job.manifest import (
    MANIFEST,
    RUN,
    build_manifest,
    file_records,
    part_records,
    write_manifest,
    write_run,
)
from fabrication.job.part import PARTS, Made, Shop, make_parts, read_back
from fabrication.job.pool import WorkerLostError, Workers
from fabrication.job.problems import REJECTED, FailedCheck, lines_of, problems_of, rejections
from fabrication.job.product import Product
from fabrication.job.result import JobResult
from fabrication.job.whole import PREVIEW, draw, write_whole
from fabrication.progress import Progress
from fabrication.specs import Check, Family

BATCH: Final = 24
"""Most part numbers that a process takes at a time."""

SHARES: Final = 16
"""Small jobs are dealt out in so many batches."""

SAMPLE: Final = 10
"""`verify = "sample"` reads back one part number in so many."""

_T = TypeVar("_T")


class Steps:
    """One run: the state that its steps share."""

    def __init__(
        self,
        product: Product,
        formats: Sequence[Format],
        shop: Shop,
        target: Path,
        pool: Workers,
        progress: Progress,
    ) -> None:
        self.product, self.shop, self.target = product, shop, target
        self.formats = [format for format in formats if format.writes_whole()]
        self.libraries = [name for format in formats for name in format.libraries]
        self.pool, self.progress = pool, progress
        self.sources = product.sources.record(target)
        self.seconds: dict[str, float] = dict(product.seconds)
        self.warnings: list[str] = []
        self.unwritten: set[str] = set()
        self.parts: dict[str, Part] = {}
        self.of_number: dict[str, list[Check]] = {}
        self.of_mark: dict[str, list[Check]] = {}

    def run(self) -> JobResult:
        """All steps; the manifest comes last.

        The pool reads part files back while this process looks at clearances. The files of the
        whole are written of what passed so far and, should reading back find more, again.
        """
        with self._timed("parts"):
            self._make()
        tasks = _batches(self._sample())
        reading = self._read_back(tasks, 0, len(tasks) // 3)
        with self._timed("clearances"):
            self.progress("clearances", 0, 0)
            meshes = {number: part.mesh for number, part in self.parts.items()}
            self.of_mark = self.product.clearances(meshes)
        failed = self._failed()
        whole = self._whole(failed)
        writing = self._write(whole)
        reading |= self._read_back(tasks, len(tasks) // 3, len(tasks))
        with self._timed("files of the product"):
            extra = self.product.checks()
            missed = self.product.write_extra(self.shop.folder)
            self.warnings += missed
            self.unwritten |= {"extra"} if missed else set()
        with self._timed("waiting for the other processes"):
            self._collect(reading)
            found, warnings = self._collect_whole(writing)
        if self._failed() != failed:
            failed = self._failed()
            whole = self._whole(failed)
            found, warnings = self._collect_whole(self._write(whole))
        self.warnings += warnings
        self._reject(failed)
        return self._finish(whole, [*extra, *found])

    # --- parts -------------------------------------------------------------------------------
    def _make(self) -> None:
        """All part numbers, in the pool."""
        families = self.product.families
        orders = [(family, self.product.material(family)) for family in families]
        for folder in {path.parent for f in families for _, path in self.shop.files(f)}:
            folder.mkdir(parents=True, exist_ok=True)
        self.progress("parts", 0, len(orders))
        futures, begun = [], 0
        for batch in _batches(orders):
            futures.append(self.pool.submit(make_parts, batch, self.shop))
            begun += len(batch)
            if self.pool.at_once:
                self.progress("parts", begun, len(orders))
        for batch, future in zip(_batches(orders), futures, strict=True):
            for one in self._made(batch, future):
                self.parts[one.part.number] = one.part
                self.of_number[one.part.number] = list(one.checks)
                self._add(one.seconds)
            self.progress("parts", len(self.parts), len(orders))

    def _made(
        self, batch: Sequence[tuple[Family, Material]], future: Future[list[Made]]
    ) -> Iterator[Made]:
        """A batch's parts; where a process was lost, they are made one by one."""
        try:
            yield from future.result()
        except WorkerLostError:
            for order in batch:
                try:
                    yield from self.pool.submit(make_parts, [order], self.shop).result()
                except WorkerLostError:
                    raise WorkerLostError(order[0].number) from None

    def _sample(self) -> list[Part]:
        """The parts whose files are read back."""
        every = {"all": 1, "sample": SAMPLE, "none": 0}[self.product.verify]
        return list(self.parts.values())[::every] if every else []

    def _read_back(
        self, tasks: Sequence[Sequence[Part]], first: int, last: int
    ) -> dict[Future[Any], Sequence[Part]]:
        """Start reading files back; the parts of each call."""
        reading = {}
        for done, task in enumerate(tasks[first:last], first):
            if self.pool.at_once:
                self.progress("read back", done, len(tasks))
            reading[self.pool.submit(read_back, task, self.shop)] = task
        return reading

    def _collect(self, reading: Mapping[Future[Any], Sequence[Part]]) -> None:
        """Wait for part files read back. A part that no process survives fails its check."""
        for done, future in enumerate(as_completed(reading), 1):
            try:
                self._take(future.result())
            except WorkerLostError:
                for part in reading[future]:
                    try:
                        self._take(self.pool.submit(read_back, [part], self.shop).result())
                    except WorkerLostError as lost:
                        self.of_number[part.number].append(Check("file readable", False, lost.why))
            self.progress("read back", done, len(reading))

    def _take(self, result: tuple[dict[str, list[Check]], float]) -> None:
        """Checks of part files read back."""
        found, seconds = result
        for number, checks in found.items():
            self.of_number[number] += checks
        self._add({"read back (all processes)": seconds})

    def _checks(self) -> dict[str, list[Check]]:
        """Every piece's checks: its limits, its part number's, its clearances."""
        checks = {piece.mark: list(piece.checks) for piece in self.product.pieces}
        for family in self.product.families:
            for instance in family.instances:
                checks[instance.mark] += self.of_number[family.number]
                checks[instance.mark] += self.of_mark.get(instance.mark, ())
        return checks

    def _failed(self) -> frozenset[str]:
        """Marks of the pieces that failed a check so far."""
        checks = self._checks().items()
        return frozenset(m for m, own in checks if not all(check.passed for check in own))

    def _reject(self, failed: frozenset[str]) -> None:
        """Files of numbers with a failing piece go to rejected/, alone where no piece is good."""
        for family in self.product.families:
            bad = [instance.mark in failed for instance in family.instances]
            if not any(bad):
                continue
            for _, path in self.shop.files(family):
                target = self.shop.folder / REJECTED / path.relative_to(self.shop.folder / PARTS)
                target.parent.mkdir(parents=True, exist_ok=True)
                if all(bad):
                    path.rename(target)
                else:
                    shutil.copy2(path, target)

    # --- the whole ---------------------------------------------------------------------------
    def _whole(self, failed: frozenset[str]) -> Whole:
        """The structure as made, with its schedules."""
        product = self.product
        with self._timed("schedules"):
            made = product.schedules({number: p.mass for number, p in self.parts.items()})
            tables = {n: t.with_status(failed, product.marks_of) for n, t in made.items()}
        return Whole(
            about=self.shop.about,
            parts=self.parts,
            families=product.placed,
            shown=product.shown,
            failed=failed,
            tables={name: table.rows for name, table in tables.items()},
            legends={name: table.legend for name, table in tables.items()},
            plates=product.plates,
            mates=product.mates,
            colors=product.colors,
        )

    def _write(self, whole: Whole) -> dict[str, Future[Any]]:
        """Start writing the files of the whole, but for reports, and the preview; by name."""
        verify = self.product.verify != "none"
        if self.pool.at_once:
            self.progress("files of the whole", 0, 0)
        return {
            **{
                format.name: self.pool.submit(write_whole, format, self.shop.folder, whole, verify)
                for format in self.formats
                if not format.report
            },
            PREVIEW: self.pool.submit(draw, self.shop.folder, whole),
        }

    def _collect_whole(self, writing: Mapping[str, Future[Any]]) -> tuple[list[Check], list[str]]:
        """Wait for the files of the whole: their checks, and what could not be written."""
        checks: list[Check] = []
        warnings: list[str] = []
        for done, (name, future) in enumerate(writing.items()):
            self.progress("files of the whole", done, len(writing))
            try:
                missed, found, seconds = future.result()
            except WorkerLostError as lost:
                if name != PREVIEW:
                    raise WorkerLostError(f"{name} of the whole") from None
                missed, found, seconds = [f"no {name}: {lost.why}"], [], {}
            warnings += missed
            self.unwritten |= {name} if missed else set()
            checks += found
            self._add(seconds)
        self.progress("files of the whole", len(writing), len(writing))
        return checks, warnings

    # --- the end -----------------------------------------------------------------------------
    def _finish(self, whole: Whole, extra: list[Check]) -> JobResult:
        """Gather the problems, write reports and manifest."""
        checks = self._checks()
        roles = {piece.mark: piece.kind.role for piece in self.product.pieces}
        problems = problems_of(roles, ((mark, c) for mark, own in checks.items() for c in own))
        lines = [str(problem) for problem in problems] + lines_of(extra)
        for format in self.formats:
            if format.report:
                complete = replace(whole, problems=tuple(lines), checks=checks)
                verify = self.product.verify != "none"
                missed, found, seconds = write_whole(format, self.shop.folder, complete, verify)
                self.warnings += missed
                self.unwritten |= {format.name} if missed else set()
                self._add(seconds)
                extra += found
                lines += lines_of(found)
        self.progress("manifest", 0, 0)
        self.warnings += self.product.sources.changes(self.sources)
        manifest = self._manifest(whole.failed, checks, extra, problems)
        write_run(self.shop.folder / RUN, self.sources, self.seconds)
        write_manifest(self.shop.folder / MANIFEST, manifest)
        return JobResult(self.target, manifest, tuple(lines), tuple(self.warnings), self.seconds)

    def _manifest(
        self,
        failed: frozenset[str],
        checks: dict[str, list[Check]],
        extra: Sequence[Check],
        problems: Sequence[FailedCheck],
    ) -> dict[str, Any]:
        """What manifest.json says."""
        product = self.product
        files = file_records(self.shop.folder)
        require_files(
            [
                *part_files(product, self.shop, failed),
                *whole_files(product, self.formats, self.unwritten),
            ],
            (record["path"] for record in files),
        )
        manifest = build_manifest(
            project=product.name,
            facts=product.facts(),
            parts=part_records(product.families, self.parts, checks),
            files=files,
            extra_checks=extra,
            libraries=(*product.libraries, *self.libraries),
        )
        manifest["problems"] = [problem.to_dict() for problem in problems]
        manifest["rejected"] = sorted(failed)
        manifest["notes"] = [*rejections(sorted(failed)), *product.notes, *self.warnings]
        return manifest

    @contextmanager
    def _timed(self, step: str) -> Iterator[None]:
        begin = time.perf_counter()
        yield
        self._add({step: time.perf_counter() - begin})

    def _add(self, seconds: dict[str, float]) -> None:
        for step, value in seconds.items():
            self.seconds[step] = self.seconds.get(step, 0.0) + value


def _batches(items: Sequence[_T]) -> list[list[_T]]:
    """The items in batches for one process each."""
    size = max(1, min(BATCH, -(-len(items) // SHARES)))
    return [list(items[i : i + size]) for i in range(0, len(items), size)]
