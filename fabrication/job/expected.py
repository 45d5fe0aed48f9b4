"""The files that a job must leave: known before it runs, and compared with what is there."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Final

from ddgfab.errors import OutputError
from fabrication.formats.base import Contents, Format
from fabrication.job.part import PARTS, Shop
from fabrication.job.problems import REJECTED
from fabrication.job.product import Product
from fabrication.job.whole import PREVIEW

SHOWN: Final = 3
"""How many missing files a message names."""


def part_files(product: Product, shop: Shop, failed: frozenset[str] = frozenset()) -> list[str]:
    """Paths below the folder of the files of part numbers.

    Parameters
    ----------
    failed : marks of pieces that failed: their files are in rejected/, alone where no piece is good
    """
    found = []
    for family in product.families:
        bad = [instance.mark in failed for instance in family.instances]
        for _, path in shop.files(family):
            if not all(bad):
                found.append(path.relative_to(shop.folder).as_posix())
            if any(bad):
                rejected = path.relative_to(shop.folder / PARTS).as_posix()
                found.append(f"{REJECTED}/{rejected}")
    return found


def whole_files(
    product: Product, formats: Iterable[Format], without: Iterable[str] = ()
) -> list[str]:
    """Paths below the folder of the files of the whole, and of the product's own.

    Parameters
    ----------
    without : names of formats, the picture, or "extra", that could not be written
    """
    left_out = set(without)
    tables = tuple(product.schedules({family.number: 0.0 for family in product.families}))
    contents = Contents(product.about(), product.families, tables, len(product.plates))
    found = []
    for format in formats:
        if format.name not in left_out:
            found += format.whole_files(contents)
    if PREVIEW not in left_out:
        found.append(PREVIEW)
    return found if "extra" in left_out else [*found, *product.extra_files()]


def require_files(expected: Sequence[str], there: Iterable[str]) -> None:
    """Raise OutputError unless every expected file is there."""
    found = set(there)
    missing = [name for name in dict.fromkeys(expected) if name not in found]
    if missing:
        shown = ", ".join(missing[:SHOWN]) + (", ..." if len(missing) > SHOWN else "")
        raise OutputError(
            f"{len(missing)} of {len(set(expected))} files are not there any more: {shown}\n"
            "Something removed them while the job ran. Nothing was written; run again."
        )
