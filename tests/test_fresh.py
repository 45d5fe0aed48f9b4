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


def test_every_module_imports_light() -> None:
    program = f"""
import importlib, sys
for name in {MODULES!r}:
    importlib.import_module(name)
    loaded = [m for m in {HEAVY} if m in sys.modules]
    assert not loaded, (name, loaded)
print(len({MODULES!r}))
"""
    assert int(run(program)) == len(MODULES) > 400


@pytest.mark.slow
def test_every_module_imports_alone() -> None:
    """No modules import each other in a circle, and every package can be imported first.

    So can every module then: Python imports its packages before it, and what these have not
    imported cannot lead back to it. Others are forgotten; a process each would take minutes.
    """
    checker = ROOT / ".ci" / "check_imports.py"
    done = subprocess.run([sys.executable, checker], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout
    packages = [name for name in MODULES if (ROOT.joinpath(*name.split("."))).is_dir()]
    program = f"""
import importlib, sys
for name in {packages!r}:
    for known in [m for m in sys.modules if m.split('.')[0] in ('ddgfab', 'fabrication')]:
        del sys.modules[known]
    importlib.import_module(name)
print(len({packages!r}))
"""
    assert int(run(program)) == len(packages) > 30


def test_the_import_check_finds_a_circle(tmp_path: Path) -> None:
    package = tmp_path / "fabrication"
    package.mkdir()
    (tmp_path / "ddgfab").mkdir()
    (tmp_path / ".ci").mkdir()
    (package / "a.py").write_text("from fabrication.b import x\n")
    (package / "b.py").write_text("from fabrication.a import y\n")
    checker = tmp_path / ".ci" / "check_imports.py"
    checker.write_text((ROOT / ".ci" / "check_imports.py").read_text("utf-8"))
    done = subprocess.run([sys.executable, checker], capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert "in a circle: fabrication.a, fabrication.b" in done.stdout


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
