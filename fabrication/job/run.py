"""The job: a product becomes parts, checks and files in one complete output folder."""

from __future__ import annotations

from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import Any

from ddgfab.errors import InputError, OutputError
from fabrication.formats import registry
from fabrication.job.folder import OutputFolder
from fabrication.job.limits import check_limits
from fabrication.job.names import folder_for
from fabrication.job.part import Shop
from fabrication.job.pool import Workers, worker_pool
from fabrication.job.product import HasProduct, Product
from fabrication.job.result import JobResult
from fabrication.job.steps import Steps
from fabrication.progress import Progress, silent


def _product(design: Any) -> Product:
    """What a design or a kit makes.

    Raises
    ------
    InputError
        Something else; names what makes a design of it.
    """
    made = getattr(design, "product", None)
    product = made() if callable(made) and not isinstance(design, type) else None
    if not isinstance(product, Product):
        raise InputError(
            f"make: design is of type {type(design).__name__}; a Design, a Kit or a Product is "
            "needed: make(design(source)), where source is a project or mesh file, a Mesh or "
            "(vertices, faces); make(kit(source)) for a linkage"
        )
    return product


def make(
    design: HasProduct | Product,
    folder: str | Path | None = None,
    *,
    jobs: int = 1,
    pool: Workers | None = None,
    progress: Progress | None = None,
    anyway: bool = False,
    force: bool = False,
) -> JobResult:
    """Parts, checks and files of a design; the folder appears complete or not at all.

    Parameters
    ----------
    design : what `design` or `kit` gave, or a product
    folder : default outputs/<project name>
    jobs : processes; 1 works in this one. More need a ``if __name__ == "__main__"`` guard in the
        caller, as always with multiprocessing
    pool : what `worker_pool` gave, to be used instead of `jobs`
    progress : called as (step, done, of)
    anyway : go on where pieces are beyond limits of the project; they are made, and rejected
    force : replace the result of another project

    Raises
    ------
    LimitError
        Pieces are beyond limits that are known before parts are made; names what helps.
    OutputError
        The folder cannot be written or is not ours to replace, holds another project's result, or
        another job is writing it; nothing is changed then.
    DdgError
        A part cannot be made, or a package is missing that a format needs.
    """
    product = design if isinstance(design, Product) else _product(design)
    if not anyway:
        check_limits(product)
    target = target_of(product, folder)
    formats = tuple(product.format(name) for name in product.output.formats)
    verified = product.verify != "none"
    registry.missing(formats, checked=verified)
    kernel = registry.needs_kernel(product.output.formats, checked=verified)
    with ExitStack() as stack:
        workers = pool or stack.enter_context(worker_pool(jobs, kernel=kernel))
        place = OutputFolder(target, project=product.name, sources=product.sources, force=force)
        staging = stack.enter_context(place)
        own = tuple(format for format in formats if format.parts)
        shop = Shop(staging, own, product.about(), product.chord)
        job = Steps(product, formats, shop, target, workers, progress or silent)
        try:
            result = job.run()
        except BaseException:
            workers.stop()  # before the staging folder goes, into which they write
            raise
    return replace(result, kept=tuple(place.notes))


def target_of(product: Product, folder: str | Path | None = None) -> Path:
    """The folder of a product's files: the one given, or outputs/<project name>."""
    return target_for(product.name, folder)


def target_for(project: str, folder: str | Path | None = None) -> Path:
    """The same by the project's name."""
    if folder is None:
        return folder_for(Path("outputs"), project)
    if str(folder) == "":
        raise OutputError("the folder has no name; name one, or leave it out")
    return Path(folder)
