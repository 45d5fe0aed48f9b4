"""Fresh interpreters: modules import alone; schedules and --help never load the CAD kernel."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
HEAVY = "('OCP', 'build123d', 'cadquery', 'vtkmodules', 'pyvista', 'manifold3d', 'xlsxwriter')"
MODULES = sorted(
    ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")
    for package in ("ddgfab", "fabrication")
    for path in (ROOT / package).rglob("*.py")
)


def run(program: str) -> str:
    """Standard output of a program in a fresh interpreter; fails with its error."""
    done = subprocess.run(
        [sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.parametrize(
    "modules",
    [
        pytest.param([m for m in MODULES if m.count(".") < 2], id="rooms"),
        pytest.param(MODULES, id="all", marks=pytest.mark.slow),
    ],
)
def test_every_module_imports_alone_and_light(modules: list[str]) -> None:
    """One process a module would take minutes: each is imported with all of ours forgotten."""
    program = f"""
import importlib, sys
for name in {modules!r}:
    for known in [m for m in sys.modules if m.split('.')[0] in ('ddgfab', 'fabrication')]:
        del sys.modules[known]
    importlib.import_module(name)
    loaded = [m for m in {HEAVY} if m in sys.modules]
    assert not loaded, (name, loaded)
print(len({modules!r}))
"""
    assert int(run(program)) == len(modules) > 20


def test_geometry_works_with_numpy_and_scipy_alone() -> None:
    """Every other third-party module is blocked: all of ddgfab imports, and a net is measured."""
    modules = [m for m in MODULES if m.split(".")[0] == "ddgfab"]
    program = f"""
import importlib, sys

class Blocked:
    def find_spec(self, name, path=None, target=None):
        top = name.split('.')[0]
        own = top.startswith('_sysconfigdata')  # of the interpreter's build, not in its list
        if not own and top not in sys.stdlib_module_names | {{'ddgfab', 'numpy', 'scipy'}}:
            raise ModuleNotFoundError(f'{{name}} is blocked', name=name)

sys.meta_path.insert(0, Blocked())
for name in {modules!r}:
    importlib.import_module(name)
import ddgfab
from ddgfab.forms import generate
report = ddgfab.inspect(generate('canopy'))
try:
    import fabrication
except ModuleNotFoundError:
    print(ddgfab.__version__)
"""
    assert run(program).strip()


def test_no_attribute_of_a_package_hides_a_module() -> None:
    """`import ddgfab.nets.knet as k` gives the module, not a function of its name."""
    program = f"""
import importlib, types
for name in {MODULES!r}:
    importlib.import_module(name)
for name in {MODULES!r}:
    package, _, module = name.rpartition('.')
    if package:
        found = getattr(importlib.import_module(package), module)
        if not isinstance(found, types.ModuleType):
            print(name)
"""
    assert run(program).split() == []


def test_schedules_load_no_cad(tmp_path: Path) -> None:
    program = f"""
import sys
from fabrication import design
roof = design(net={{"kind": "canopy", "panels_along": 6, "panels_across": 4}})
roof.beams.to_csv(r"{tmp_path / "beams.csv"}")
repr(roof), repr(roof.gridshell), repr(roof.support), repr(roof.beams)
loaded = [m for m in ('OCP', 'build123d', 'cadquery') if m in sys.modules]
assert not loaded, loaded
"""
    run(program)
    assert (tmp_path / "beams.csv").read_text("utf-8").startswith("mark,number,status,edge")


@pytest.mark.parametrize("words", [["--help"], ["make", "--help"], ["inspect", "--help"]])
def test_help_is_light(words: list[str]) -> None:
    program = f"""
import sys
from fabrication.cli import app
try:
    app({words!r})
except SystemExit as done:
    assert done.code == 0
loaded = [m for m in ('OCP', 'numpy', 'scipy') if m in sys.modules]
assert not loaded, loaded
"""
    assert "Usage" in run(program)


def test_the_import_direction_check_finds_an_offence(tmp_path: Path) -> None:
    """The checker of .ci must be able to fail."""
    package = tmp_path / "ddgfab"
    package.mkdir()
    (tmp_path / "fabrication").mkdir()
    (tmp_path / ".ci").mkdir()
    (package / "bad.py").write_text("import fabrication.specs\nimport pyvista\n")
    checker = tmp_path / ".ci" / "check_imports.py"
    checker.write_text((ROOT / ".ci" / "check_imports.py").read_text("utf-8"))
    done = subprocess.run([sys.executable, checker], capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert "bad.py:1: ddgfab imports fabrication.specs" in done.stdout
    assert "bad.py:2: pyvista imported at module level" in done.stdout
