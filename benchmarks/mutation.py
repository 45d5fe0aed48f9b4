"""Mutation tests by cosmic-ray: change one place at a time and see whether a test fails.

    python benchmarks/mutation.py COSMIC_RAY --rooms motion parts --sample 40

COSMIC_RAY is the program of an environment of its own; the tests run in this one. Works on a clone
in a temporary folder. The mutants of a room are drawn with a fixed seed; each runs against the
tests of the room, first the fast ones, then those marked slow. Prints the rate and every survivor.
"""

from __future__ import annotations

import argparse
import os
import random
import shlex
import sqlite3
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]

ROOMS = {
    "linkages": (
        ["ddgfab/linkages"],
        ["ddgfab/test_linkages_*.py", "fabrication/test_motion_free_range.py"],
    ),
    "motion": (
        ["fabrication/motion"],
        ["fabrication/test_motion_*.py", "fabrication/test_linkage_poses.py"],
    ),
    "job": (["fabrication/job"], ["fabrication/test_job_*.py", "fabrication/test_new_*.py"]),
    "support": (["ddgfab/support"], ["ddgfab/test_support_*.py"]),
    "detailing": (
        ["fabrication/gridshell/detailing"],
        [f"fabrication/test_gridshell_{what}.py" for what in ("beams", "nodes", "panels", "design")]
        + ["fabrication/test_gridshell_schedules.py"],
    ),
    "parts": (
        ["fabrication/parts"],
        ["fabrication/test_parts_*.py", "fabrication/test_families.py"],
    ),
    "families": (
        ["fabrication/families.py", "fabrication/variants.py"],
        [
            "fabrication/test_families.py",
            "fabrication/test_new_kind.py",
            "fabrication/test_parts_pin.py",
        ],
    ),
    "checks": (["fabrication/checks"], ["fabrication/test_checks_*.py"]),
}
"""Modules and tests of every room."""

LEFT_OUT = (
    "core/ReplaceBinaryOperator_BitOr_",  # `A | None` in annotations, which nothing evaluates
    "core/AddNot",
    "core/RemoveDecorator",
)
"""Kinds of mutants that are not drawn; the last two always stop the import or every test."""

CONFIG = """[cosmic-ray]
module-path = {modules}
timeout = 300.0
excluded-modules = []
test-command = {command}
[cosmic-ray.distributor]
name = "local"
"""


def text(values: object) -> str:
    """A value as TOML."""
    return repr(values).replace("'", '"')


def drawn(session: Path, sample: int) -> int:
    """Leave `sample` mutants in a session; number of all."""
    with sqlite3.connect(session) as data:
        rows = data.execute("select job_id, operator_name from mutation_specs order by job_id")
        all_jobs = sorted(job for job, kind in rows if not kind.startswith(LEFT_OUT))
        kept = set(random.Random(0).sample(all_jobs, min(sample, len(all_jobs))))
        for table in ("mutation_specs", "work_items"):
            for (job,) in data.execute(f"select job_id from {table}").fetchall():
                if job not in kept:
                    data.execute(f"delete from {table} where job_id = ?", (job,))
    return len(all_jobs)


def main() -> None:
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("cosmic_ray", type=Path)
    arguments.add_argument("--rooms", nargs="*", default=list(ROOMS), choices=list(ROOMS))
    arguments.add_argument("--sample", type=int, default=40)
    given = arguments.parse_args()
    folder = Path(tempfile.mkdtemp(prefix="mutation-"))
    clone = folder / "clone"
    subprocess.run(["git", "clone", "-q", str(ROOT), str(clone)], check=True)
    environment = os.environ | {"PYTHONPATH": str(clone)}  # before an installed copy
    for room in given.rooms:
        modules, patterns = ROOMS[room]
        tests = sorted(
            str(p.relative_to(clone)) for t in patterns for p in clone.glob(f"tests/{t}")
        )
        pytest = f"{sys.executable} -m pytest -q -x -p no:cacheprovider {shlex.join(tests)}"
        script, config, session = (folder / f"{room}.{kind}" for kind in ("sh", "toml", "sqlite"))
        # Exit code 5 of pytest: no test is marked slow.
        script.write_text(f"{pytest} -m 'not slow' || exit 1\n{pytest} -m slow\ntest $? -ne 1\n")
        config.write_text(CONFIG.format(modules=text(modules), command=text(f"sh {script}")))

        def run(*words: str) -> str:
            done = subprocess.run(
                [str(given.cosmic_ray), *words],
                cwd=clone,
                env=environment,
                capture_output=True,
                text=True,
            )
            if done.returncode:
                sys.exit(f"{shlex.join(words)}:\n{done.stdout}{done.stderr}")
            return done.stdout

        run("init", str(config), str(session))
        count = drawn(session, given.sample)
        run("exec", str(config), str(session))
        with sqlite3.connect(session) as data:
            rows = data.execute(
                "select module_path, operator_name, start_pos_row, test_outcome, diff from "
                "mutation_specs join work_results using (job_id) "
                "order by module_path, start_pos_row"
            ).fetchall()
        alive = [row for row in rows if "SURVIVED" in str(row[3]).upper()]
        killed = len(rows) - len(alive)
        print(f"{room}: {killed} of {len(rows)} killed ({count} mutants in all)", flush=True)
        for module, kind, line, _, diff in alive:
            print(f"  {module}:{line} {kind}")
            for changed in str(diff).splitlines():
                if changed[:1] in "+-" and changed[:3] not in ("+++", "---"):
                    print(f"    {changed}")


if __name__ == "__main__":
    main()
