"""No job loads the CAD kernel that reads nothing back; proven in fresh interpreters."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

PROGRAM = """
import sys
from pathlib import Path
from fabrication import design, kit, make
from fabrication.cli.terminal import DONE

folder = Path({folder!r})
if {product!r} == "gridshell":
    formats = ["step", "stl", "3mf", "glb", "csv", "xlsx"]
    net = {{"kind": "canopy", "parameters": {{"panels_along": 4, "panels_across": 4}}}}
    made = design(EXAMPLE, net=net, output={{"formats": formats}}, checks={{"verify": "none"}})
else:
    made = kit("bennett", checks={{"verify": "none"}})
result = make(made, folder)
assert result.exit_code == DONE, result.problems
loaded = sorted(name for name in sys.modules if name.split(".")[0] in ("OCP", "build123d"))
assert not loaded, loaded[:5]
"""


@pytest.mark.slow
@pytest.mark.parametrize("product", ["gridshell", "linkage"])
def test_without_reading_back_no_kernel_is_loaded(product: str, tmp_path: Path) -> None:
    folder = tmp_path / "job"
    program = PROGRAM.format(folder=str(folder), product=product).replace("EXAMPLE", "None")
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, timeout=120
    )
    assert done.returncode == 0, done.stderr
    found = {path.suffix for path in folder.rglob("*.*")}
    assert {".step", ".stl", ".3mf", ".glb", ".csv", ".xlsx", ".png", ".json"} <= found
    assert (folder / "assembly.step").stat().st_size > 10_000


@pytest.mark.slow
def test_processes_load_the_kernel_only_where_asked() -> None:
    program = """
import sys
from fabrication.job.pool import worker_pool

def loaded(name):
    import sys
    return name in sys.modules

if __name__ == "__main__":
    import operator
    for kernel in (False, True):
        with worker_pool(2, kernel=kernel) as pool:
            found = pool.submit(eval, "'OCP' in __import__('sys').modules").result()
        assert found == kernel, (found, kernel)
"""
    subprocess.run([sys.executable, "-c", program], check=True, timeout=120)


@pytest.mark.slow
def test_workers_are_stopped_while_they_send_large_results() -> None:
    """What a worker has written half is waited for by nobody."""
    program = """
import time
from fabrication.job.pool import worker_pool

if __name__ == "__main__":
    with worker_pool(2, kernel=False) as pool:
        pool.submit(abs, 1).result()
        for _ in range(40):
            pool.submit(bytes, 30_000_000)
        time.sleep(0.4)
        pool.stop()
"""
    for _ in range(3):
        subprocess.run([sys.executable, "-c", program], check=True, timeout=30)
