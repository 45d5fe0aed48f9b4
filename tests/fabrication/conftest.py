"""A small roof and a kit made once for all tests of the way from input to files."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from roofs import barrel

from fabrication.gridshell.design import Design, design
from fabrication.job import pool
from fabrication.job.result import JobResult
from fabrication.job.run import make
from fabrication.linkage.kit import Kit, kit


@pytest.fixture(scope="session", autouse=True)
def jobs_in_this_process() -> Iterator[None]:
    """A job that is not told how many processes to use works in this one.

    Tests run beside each other on all cores, and each worker would import the kernel anew. Tests
    of workers say how many they want, or run the command in a process of its own.
    """
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(pool, "process_count", lambda jobs: jobs or 1)
        yield


@pytest.fixture(scope="session")
def small_design() -> Design:
    """A barrel of 12 panels."""
    return design(barrel(), project={"name": "barrel"})


@pytest.fixture(scope="session")
def small_job(small_design: Design, tmp_path_factory: pytest.TempPathFactory) -> JobResult:
    """Its files, made in this process."""
    return make(small_design, tmp_path_factory.mktemp("jobs") / "barrel")


@pytest.fixture(scope="session")
def small_folder(small_job: JobResult) -> Path:
    """Where they are."""
    return small_job.folder


@pytest.fixture(scope="session")
def bennett() -> Kit:
    """The default kit."""
    return kit("bennett")


@pytest.fixture(scope="session")
def kit_job(bennett: Kit, tmp_path_factory: pytest.TempPathFactory) -> JobResult:
    """Its files."""
    return make(bennett, tmp_path_factory.mktemp("kits") / "bennett")
