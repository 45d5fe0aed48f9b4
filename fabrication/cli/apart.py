"""Calls in a process of their own: the CAD kernel may crash on a damaged file."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import suppress
from multiprocessing import get_context
from pathlib import Path
from typing import TYPE_CHECKING, Final, TypeVar

if TYPE_CHECKING:
    from fabrication.formats.report import FileReport

T = TypeVar("T")

CAD_FILES: Final = (".step", ".stp", ".iges", ".igs")
"""Endings of files that the kernel reads."""


class Apart:
    """A process for calls about files, made when it is needed; a context manager."""

    def __init__(self) -> None:
        self._pool: ProcessPoolExecutor | None = None

    def __enter__(self) -> Apart:
        """Nothing yet."""
        return self

    def __exit__(self, *error: object) -> None:
        """End the process."""
        self._end()

    def call(self, path: Path, function: Callable[[Path], T]) -> T:
        """The result of a function of a file; what it raises is raised here.

        Raises
        ------
        InputError
            The process died of it.
        """
        from ddgfab.errors import InputError

        if self._pool is None:
            self._pool = ProcessPoolExecutor(1, mp_context=get_context("spawn"))
        try:
            return self._pool.submit(function, path).result()
        except BrokenProcessPool:
            self._end()
            raise InputError(
                "the CAD kernel crashed while it read this file, which is damaged: export it again",
                file=str(path),
            ) from None

    def _end(self) -> None:
        if self._pool is not None:
            with suppress(BrokenProcessPool):
                self._pool.shutdown(wait=True, cancel_futures=True)
            self._pool = None


def report_of(path: Path, apart: Apart) -> FileReport:
    """What is in a file; the kernel's are read by a process of its own."""
    from fabrication.formats.report import inspect_file

    if path.suffix.lower() in CAD_FILES:
        return apart.call(path, inspect_file)
    return inspect_file(path)


def require_readable(path: Path) -> None:
    """Raise where the kernel cannot read a STEP or IGES file, or crashes of it."""
    if path.suffix.lower() in CAD_FILES and path.is_file():
        with Apart() as apart:
            apart.call(path, _faces)


def _faces(path: Path) -> int:
    from fabrication.surfaces_in.cad import cad_faces

    return len(cad_faces(path))
