"""Tests for mutants: which tests run a line, and one run of chosen tests in a forked process.

The map of lines to tests comes from one run under coverage, which names the test, or the fixture
of a module or session, that runs each line. A process that has the libraries loaded is forked for
every run, so a run costs the time of its tests and not that of the imports.
"""

from __future__ import annotations

import ast
import functools
import importlib
import json
import os
import pkgutil
import resource
import signal
import sys
import time
from collections import defaultdict
from collections.abc import Generator, Iterable, Sequence
from pathlib import Path
from typing import Any

import coverage
import pytest

HEAVY = (
    "numpy",
    "scipy.optimize",
    "scipy.sparse.linalg",
    "scipy.spatial",
    "hypothesis",
    "OCP.BRep",
)
"""Libraries that are loaded once."""
FIXTURE = "fixture:"


def cpu() -> float:
    """Seconds of processor time of this process and of its children that have ended."""
    return sum(os.times()[:4])


class Recorder:
    """Plugin of pytest: names the running test for coverage, and notes its result and seconds."""

    def __init__(self, measured: coverage.Coverage | None) -> None:
        self.measured = measured
        self.context = ""
        self.seconds: dict[str, float] = {}
        self.failed: set[str] = set()
        self.fixtures: dict[str, list[str]] = {}

    def switch(self, context: str) -> None:
        self.context = context
        if self.measured is not None:
            self.measured.switch_context(context)

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: Any) -> Generator[None, Any, Any]:
        self.fixtures[item.nodeid] = list(getattr(item, "fixturenames", ()))
        self.switch(item.nodeid)
        begin = cpu()
        done = yield
        self.seconds[item.nodeid] = cpu() - begin
        self.switch("")
        return done

    @pytest.hookimpl(wrapper=True)
    def pytest_fixture_setup(self, fixturedef: Any) -> Generator[None, Any, Any]:
        before = self.context
        if fixturedef.scope != "function":
            self.switch(FIXTURE + fixturedef.argname)
        try:
            return (yield)
        finally:
            self.switch(before)

    def pytest_runtest_logreport(self, report: Any) -> None:
        if report.failed:
            self.failed.add(report.nodeid)


def measure(clone: Path, arguments: Sequence[str], target: Path) -> None:
    """Write the map of lines to tests of one run of pytest as JSON.

    Parameters
    ----------
    clone : Path
        Folder of the project.
    arguments : Sequence[str]
        Arguments of pytest.
    target : Path
        File for `seconds` of every test that passes and `lines`: module, line, tests.
    """
    measured = coverage.Coverage(
        data_file=None,
        source=[str(clone / "ddgfab"), str(clone / "fabrication")],
        config_file=False,
    )
    recorder = Recorder(measured)
    measured.start()
    pytest.main(["-q", "-p", "no:cacheprovider", *arguments], plugins=[recorder])
    measured.stop()
    users: dict[str, list[str]] = defaultdict(list)
    for test, names in recorder.fixtures.items():
        for name in names:
            users[FIXTURE + name].append(test)
    data = measured.get_data()
    lines: dict[str, dict[int, list[str]]] = {}
    for file in data.measured_files():
        of_file = lines[str(Path(file).relative_to(clone))] = {}
        for line, contexts in data.contexts_by_lineno(file).items():
            tests = {t for c in contexts if c for t in users.get(c, [c])}
            of_file[line] = sorted(tests - recorder.failed)
    seconds = {t: s for t, s in recorder.seconds.items() if t not in recorder.failed}
    target.write_text(json.dumps({"seconds": seconds, "lines": lines}))


def preload(clone: Path) -> None:
    """Import libraries and all modules of the project, for the processes that are forked."""
    for name in HEAVY:
        importlib.import_module(name)
    for package in ("ddgfab", "fabrication"):
        for found in pkgutil.walk_packages([str(clone / package)], package + "."):
            if not found.name.endswith(("__main__", ".start")):
                importlib.import_module(found.name)


@functools.cache
def users(clone: Path) -> dict[str, set[str]]:
    """Names of the modules that import a module or a name of it."""
    found: dict[str, set[str]] = defaultdict(set)
    for package in ("ddgfab", "fabrication"):
        for file in (clone / package).rglob("*.py"):
            name = dotted(str(file.relative_to(clone)))
            for node in ast.walk(ast.parse(file.read_text())):
                if isinstance(node, ast.Import):
                    used = [alias.name for alias in node.names]
                elif isinstance(node, ast.ImportFrom) and node.module:
                    used = [node.module, *(f"{node.module}.{alias.name}" for alias in node.names)]
                else:
                    continue
                for one in used:
                    found[one].add(name)
    return found


def importers(clone: Path, module: str) -> set[str]:
    """Names of a module, given by its path, and of all that import it, over others too."""
    found, ahead = set[str](), [dotted(module)]
    while ahead:
        name = ahead.pop()
        if name not in found:
            found.add(name)
            ahead += users(clone).get(name, ())
    return found


def dotted(path: str) -> str:
    """Name of the module of a file."""
    return path.removesuffix(".py").replace("/", ".").removesuffix(".__init__")


def unload(names: Iterable[str]) -> None:
    """Forget imported modules, here and in their packages."""
    for name in names:
        module = sys.modules.pop(name, None)
        above, _, last = name.rpartition(".")
        package = sys.modules.get(above)
        if module is not None and getattr(package, last, None) is module:
            delattr(package, last)


def rebind(names: Iterable[str]) -> None:
    """Import packages again that were forgotten, and give them the modules that were not."""
    packages = set(names)
    for name, module in list(sys.modules.items()):
        above, _, last = name.rpartition(".")
        if above in packages:
            setattr(importlib.import_module(above), last, module)


def forked(
    clone: Path, tests: Iterable[str], output: Path, limit: float, stale: Iterable[str] = ()
) -> str:
    """Run tests in a process of their own.

    Parameters
    ----------
    clone : Path
        Folder of the project.
    tests : Iterable[str]
        Tests in their order.
    output : Path
        File for what pytest writes.
    limit : float
        Most processor time [s]; 20 times as much on the clock, as other programs may run.
    stale : Iterable[str]
        Modules to import again.

    Returns
    -------
    str
        `passed`, `failed` or `timeout`.
    """
    child = os.fork()
    if not child:
        os.setsid()
        resource.setrlimit(resource.RLIMIT_CPU, (int(limit) + 1, int(limit) + 5))
        file = os.open(output, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
        os.dup2(file, 1)
        os.dup2(file, 2)
        os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
        os.chdir(clone)
        unload(stale)
        code = 3
        try:
            rebind(stale)
            code = int(pytest.main(["-q", "-x", "-p", "no:cacheprovider", *tests]))
        finally:
            sys.stdout.flush()
            os._exit(code)
    end = time.monotonic() + 20 * limit
    while time.monotonic() < end:
        done, status = os.waitpid(child, os.WNOHANG)
        if done:
            end_group(child)
            if os.WIFSIGNALED(status) and os.WTERMSIG(status) in (signal.SIGXCPU, signal.SIGKILL):
                return "timeout"
            return "failed" if status else "passed"
        time.sleep(0.05)
    end_group(child)
    os.waitpid(child, 0)
    return "timeout"


def end_group(child: int) -> None:
    """End a process and all that it has started."""
    try:
        os.killpg(child, signal.SIGKILL)
    except ProcessLookupError:
        return


def stages(
    found: dict[str, Any], module: str, rows: range, most: int = 8, budget: float = 15.0
) -> list[list[str]]:
    """Tests of a place in two parts: the fastest that run it, then the others.

    Parameters
    ----------
    found : dict
        Map by `measure`.
    module : str
        Path of the module in the project.
    rows : range
        Lines of the place. Lines that only the import runs take all tests of the module.
    most : int
        Length of the first part.
    budget : float
        Most processor time [s] of the second part.

    Returns
    -------
    list of list of str
        Parts, in the order in which to run them; empty if no test runs the module.
    """
    lines = found["lines"].get(module, {})
    tests = {t for row in rows for t in lines.get(str(row), [])}
    if not tests:
        tests = {t for names in lines.values() for t in names}
    seconds = found["seconds"]
    in_order = sorted(tests & seconds.keys(), key=lambda t: (seconds[t], t))
    first = in_order[:most]
    rest: list[str] = []
    for test in in_order[most:]:
        if sum(seconds[t] for t in rest) + seconds[test] <= budget:
            rest.append(test)
    return [part for part in (first, rest) if part]


if __name__ == "__main__":
    measure(Path(sys.argv[1]), sys.argv[3:], Path(sys.argv[2]))
