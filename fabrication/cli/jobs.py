"""A job on the command line, whatever its product: carried out or only planned, and its report."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Final, TypeVar

from fabrication.cli.terminal import DONE, FAILED, Session

if TYPE_CHECKING:
    from pydantic import BaseModel

    from fabrication.job.plan import Plan
    from fabrication.job.product import HasProduct, Product
    from fabrication.job.result import JobResult

SHOWN: Final = 3
"""How many files the last lines name."""

MANY: Final = 6
"""Of more files in a folder a plan names the first and the last."""

D = TypeVar("D", bound="HasProduct")


@dataclass(frozen=True)
class JobOptions:
    """How a job is run: where to, past limits or not, for real or not, over other projects."""

    output: str | None
    anyway: bool
    dry_run: bool
    force: bool = False


def run_job(
    run: Session,
    project: BaseModel,
    design: Callable[[], D],
    about: Callable[[D], Iterator[str]],
    options: JobOptions,
) -> int:
    """Design and make, or only plan; prints the report and returns the exit code."""
    from fabrication.formats.registry import needs_kernel
    from fabrication.job.folder import OutputFolder
    from fabrication.job.plan import plan_job
    from fabrication.job.pool import process_count, worker_pool
    from fabrication.job.run import make, target_for

    begin = time.perf_counter()
    for name, value in changed_settings(project):
        run.detail(f"setting {name} = {value}")
    output: Any = getattr(project, "output")  # noqa: B009 - every project has these two
    checks: Any = getattr(project, "checks")  # noqa: B009
    own: str = getattr(project, "name")  # noqa: B009
    sources: Any = getattr(project, "sources")  # noqa: B009
    place = OutputFolder(
        target_for(own, options.output), project=own, sources=sources, force=options.force
    )
    if options.dry_run:
        place.check()
        made = design()
        product = made.product()
        plan = plan_job(product, options.output, anyway=options.anyway, force=options.force)
        for line in about(made):
            run.say(line)
        _report_plan(run, plan, product.notes)
        return FAILED if plan.problems else DONE
    place.prepare()
    run.detail(f"processes: {process_count(output.jobs)}")
    kernel = needs_kernel(output.formats, checked=checks.verify != "none")
    with worker_pool(output.jobs, kernel=kernel) as pool:
        made = design()
        result = make(
            made,
            options.output,
            pool=pool,
            progress=run.progress,
            anyway=options.anyway,
            force=options.force,
        )
        run.outcome = f"the files are complete in {result.folder}"
    for line in about(made):
        run.say(line)
    result = replace(result, kept=(*place.notes, *result.kept))
    _report(run, made.product(), result, time.perf_counter() - begin)
    return result.exit_code


def changed_settings(project: BaseModel) -> Iterator[tuple[str, str]]:
    """Settings that are not as they are by default, as section.key and TOML."""
    from fabrication.project.toml import toml_text

    for section, values in project.model_dump(mode="json", exclude_defaults=True).items():
        if isinstance(values, Mapping):
            for key, value in values.items():
                yield f"{section}.{key}", toml_text(value)


def _count(number: int, name: str) -> str:
    return f"{number} {name}{'' if number == 1 else 's'}"


def _report(run: Session, product: Product, result: JobResult, seconds: float) -> None:
    """What a job made, how long it took, and which files to open."""
    manifest = result.manifest
    for step, taken in sorted(result.seconds.items(), key=lambda item: -item[1]):
        run.detail(f"time {step}: {taken:.2f} s")
    numbers = len({part["number"] for part in manifest["parts"]})
    checks = manifest["checks"]
    run.say(
        f"{_count(len(manifest['parts']), 'part')} of {_count(numbers, 'part number')}; "
        f"{checks['passed']} checks passed, {checks['failed']} failed; {seconds:.1f} s"
    )
    for note in manifest["notes"]:
        run.say(f"note: {note}")
    for kept in result.kept:
        run.say(f"note: {kept}")
    for problem in result.problems:
        run.fail(f"FAILED {problem}")
    files = [record["path"] for record in manifest["files"]]
    run.result(f"{_count(len(files), 'file')} in {result.folder}")
    for name in to_open(product, files):
        run.say(f"  open {result.folder / name}")


def to_open(product: Product, files: list[str]) -> list[str]:
    """The files that show most: those that the product names first, of those that are there."""
    wanted = [name for name in product.shown_first if name in files]
    return wanted[:SHOWN]


def _report_plan(run: Session, plan: Plan, notes: Sequence[str]) -> None:
    """What a job would make."""
    run.say(f"{_count(plan.pieces, 'part')} of {_count(plan.numbers, 'part number')}")
    for note in notes:
        run.say(f"note: {note}")
    for problem in plan.problems:
        run.fail(f"FAILED {problem}")
    for kind, count in plan.kinds:
        run.say(f"  {kind}: {count}")
    for folder, names in plan.folders():
        shown = ", ".join(names) if len(names) <= MANY else f"{names[0]} to {names[-1]}"
        run.say(f"  {folder}/: {_count(len(names), 'file')}: {shown}")
    replaced = ", in place of what is there" if plan.replaces else ""
    run.result(
        f"dry run: {_count(len(plan.files), 'file')} would be written to {plan.folder}{replaced}; "
        "nothing was written"
    )
