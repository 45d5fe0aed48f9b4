"""What a job would make: parts, files and limits, without making any."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from fabrication.formats import registry
from fabrication.job.expected import part_files, whole_files
from fabrication.job.folder import OutputFolder
from fabrication.job.limits import check_limits, problems_known
from fabrication.job.part import Shop
from fabrication.job.product import Product
from fabrication.job.run import target_of


@dataclass(frozen=True)
class Plan:
    """What a job would make.

    Attributes
    ----------
    folder : where the files would be
    kinds : (group, how many pieces of how many part numbers) of each kind of part
    pieces, numbers : how many parts, of how many part numbers
    files : paths below the folder; the manifest comes besides
    replaces : whether an output folder is there already
    problems : limits that pieces are beyond, a line each
    """

    folder: Path
    kinds: tuple[tuple[str, str], ...]
    pieces: int
    numbers: int
    files: tuple[str, ...]
    replaces: bool
    problems: tuple[str, ...]

    def folders(self) -> Iterator[tuple[str, tuple[str, ...]]]:
        """Names of the files by their folder; those in none first, under "."."""
        by_folder: dict[str, list[str]] = {}
        for path in map(Path, self.files):
            by_folder.setdefault(path.parent.as_posix(), []).append(path.name)
        for folder in sorted(by_folder):
            yield folder, tuple(by_folder[folder])


def plan_job(
    product: Product,
    folder: str | Path | None = None,
    *,
    anyway: bool = False,
    force: bool = False,
) -> Plan:
    """The plan of a product; nothing is written, and no CAD kernel is loaded.

    Parameters
    ----------
    folder : default outputs/<project name>
    anyway : pieces beyond limits are named in the plan, instead of an error
    force : whether the result of another project would be replaced

    Raises
    ------
    LimitError, OutputError, InputError
        As `fabrication.job.run.make` before it makes a part.
    """
    if not anyway:
        check_limits(product)
    target = target_of(product, folder)
    formats = tuple(product.format(name) for name in product.output.formats)
    registry.missing(formats, checked=product.verify != "none")
    place = OutputFolder(target, project=product.name, sources=product.sources, force=force)
    place.check()
    own = tuple(format for format in formats if format.parts)
    shop = Shop(place.target, own, product.about(), product.chord)
    files = [*part_files(product, shop), *whole_files(product, formats)]
    pieces = Counter(family.kind.title for family in product.families for _ in family.instances)
    numbers = Counter(family.kind.title for family in product.families)
    return Plan(
        folder=target,
        kinds=tuple(
            (group, f"{count} of {numbers[group]} part number{'s' if numbers[group] != 1 else ''}")
            for group, count in pieces.items()
        ),
        pieces=pieces.total(),
        numbers=len(product.families),
        files=tuple(dict.fromkeys(files)),
        replaces=place.target.exists(),
        problems=tuple(str(problem) for problem in problems_known(product)),
    )
