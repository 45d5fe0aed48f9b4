"""Mutation tests: change one place at a time and see whether a test fails.

    python benchmarks/mutation.py --rooms motion parts --sample 40

Needs an environment with the project, cosmic-ray 8.7 and coverage. Works on a clone in a temporary
folder, which holds the last commit. The mutants of a room are drawn with a fixed seed from the
operators of cosmic-ray. Each runs against the tests that run its line, the fastest first. Prints
the rate and every survivor, and writes all to `--results`; `--resume` goes on with a run that was
cut, or with a greater sample; `--only` runs the survivors of a result again.
"""

from __future__ import annotations

import argparse
import ast
import json
import os
import random
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import mutation_tests
from cosmic_ray.ast import ast_nodes, get_ast
from cosmic_ray.mutating import mutate_code
from cosmic_ray.plugins import get_operator, operator_names

ROOT = Path(__file__).resolve().parents[1]

ROOMS = {
    "motion": (["fabrication/motion"], ["test_motion_*", "test_linkage_poses"]),
    "job": (
        ["fabrication/job"],
        [
            *("test_new_kind", "test_new_format"),
            *(
                f"test_job_{name}"
                for name in ("folder", "limits", "lock", "names", "others", "place", "problems")
            ),
            *("test_job_run", "test_job_sources"),
        ],
    ),
    "support": (["ddgfab/support"], ["test_support_*"]),
    "detailing": (
        ["fabrication/gridshell/detailing"],
        [
            *("test_connections*", "test_new_node"),
            *(
                f"test_gridshell_{name}"
                for name in ("beams", "nodes", "node_heights", "panels", "axes", "rules", "frames")
            ),
        ],
    ),
    "parts": (
        ["fabrication/parts"],
        [
            *("test_parts_*", "test_families*", "test_solids_properties"),
            *("test_linkage_links", "test_linkage_labels"),
        ],
    ),
    "checks": (["fabrication/checks"], ["test_checks_*"]),
    "linkages": (["ddgfab/linkages"], ["test_linkages_*"]),
    "families": (
        ["fabrication/families.py", "fabrication/variants.py"],
        ["test_families*", "test_parts_pin"],
    ),
}
"""Modules and test files of every room."""

LEFT_OUT = re.compile(
    r"core/(AddNot|RemoveDecorator"
    r"|ReplaceBinaryOperator_(Add|Sub|Mul|Div|FloorDiv|Mod|Pow)_(Bit\w+|LShift|RShift))"
)
"""Kinds of mutants that are not drawn: nearly all of them end in an exception in every test."""

TEXT = (ast.JoinedStr, ast.Raise, ast.Import, ast.ImportFrom)
"""Places that are not changed: texts, messages of errors, imports; and annotations."""


class Mutant(NamedTuple):
    """One change: module, operator of cosmic-ray and its occurrence, and first and last line."""

    module: str
    operator: str
    occurrence: int
    first: int
    last: int


def texts(tree: ast.AST) -> Iterator[ast.AST]:
    """Nodes of text, messages, imports and annotations in a module."""
    for node in ast.walk(tree):
        if isinstance(node, TEXT):
            yield node
        for name in ("annotation", "returns"):
            if (note := getattr(node, name, None)) is not None:
                yield note


def spans(source: str) -> list[tuple[tuple[int, int], tuple[int, int]]]:
    """Begin and end (line, column in bytes) of the places that are not changed."""
    return [
        ((n.lineno, n.col_offset), (n.end_lineno, n.end_col_offset))  # type: ignore[attr-defined]
        for n in texts(ast.parse(source))
    ]


def mutants(clone: Path, module: str) -> Iterator[Mutant]:
    """All mutants of a module, in a fixed order."""
    source = (clone / module).read_text()
    left_out = spans(source)
    nodes = list(ast_nodes(get_ast(source)))
    for name in sorted(operator_names()):
        kind = get_operator(name)
        if LEFT_OUT.match(name) or kind.arguments():
            continue
        operator = kind()
        places = (place for node in nodes for place in operator.mutation_positions(node))
        for occurrence, (begin, end) in enumerate(places):
            if not any(first <= tuple(begin) and tuple(end) <= last for first, last in left_out):
                yield Mutant(module, name, occurrence, begin[0], end[0])


def draw(clone: Path, modules: list[str], sample: int) -> tuple[list[Mutant], int]:
    """`sample` mutants of some modules by a fixed seed, and the number of all."""
    files = sorted(
        str(file.relative_to(clone))
        for m in modules
        for file in ([clone / m] if m.endswith(".py") else (clone / m).rglob("*.py"))
    )
    every = [mutant for file in files for mutant in mutants(clone, file)]
    order = random.Random(0).sample(every, min(2 * sample, len(every)))
    return sorted([m for m in order if compiles(clone, m)][:sample]), len(every)


def mutated(clone: Path, mutant: Mutant) -> str:
    """The text of the module with its change."""
    source = (clone / mutant.module).read_text()
    after = mutate_code(source, get_operator(mutant.operator)(), mutant.occurrence)
    assert after is not None
    return str(after)


def compiles(clone: Path, mutant: Mutant) -> bool:
    """Whether a change leaves Python; a star before arguments is no product."""
    try:
        compile(mutated(clone, mutant), mutant.module, "exec")
    except SyntaxError:
        return False
    return True


def changed(before: str, after: str) -> list[str]:
    """Lines that differ, as - and +."""
    old, new = before.splitlines(), after.splitlines()
    if len(old) != len(new):
        return [f"- {len(old)} lines", f"+ {len(new)} lines"]
    different = [(a, b) for a, b in zip(old, new, strict=True) if a != b]
    return [line for a, b in different for line in (f"- {a.strip()}", f"+ {b.strip()}")]


def run(clone: Path, mutant: Mutant, found: dict[str, Any], tick: int) -> dict[str, Any]:
    """Run the tests of one mutant; what came of it."""
    file = clone / mutant.module
    source = file.read_text()
    stamp = file.stat().st_mtime
    after = mutated(clone, mutant)
    outcome, tests, begin = "survived", 0, time.monotonic()
    try:
        file.write_text(after)
        os.utime(file, (stamp + 10 + tick, stamp + 10 + tick))  # no compiled file may match it
        output, stale = clone.parent / "output", mutation_tests.importers(clone, mutant.module)
        rows = range(mutant.first, mutant.last + 1)
        for part in mutation_tests.stages(found, mutant.module, rows):
            usual = sum(found["seconds"][t] for t in part)
            tests += len(part)
            came = mutation_tests.forked(clone, part, output, 15 + 5 * usual, stale)
            if came != "passed":
                outcome = "timeout" if came == "timeout" else "killed"
                break
        if not tests:
            outcome = "no test"
    finally:
        file.write_text(source)
        os.utime(file, (stamp, stamp))
    return {
        **mutant._asdict(),
        "outcome": outcome,
        "tests": tests,
        "seconds": round(time.monotonic() - begin, 1),
        "change": changed(source, after),
    }


def control(clone: Path, module: str, found: dict[str, Any]) -> bool:
    """Whether the fastest tests of a module pass without a change, imported again as for one."""
    tests = mutation_tests.stages(found, module, range(0), most=2)[:1]
    stale, output = mutation_tests.importers(clone, module), clone.parent / "output"
    return not tests or mutation_tests.forked(clone, tests[0], output, 300, stale) == "passed"


def main() -> None:
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("--rooms", nargs="*", default=list(ROOMS), choices=list(ROOMS))
    arguments.add_argument("--sample", type=int, default=50)
    arguments.add_argument("--results", type=Path, default=Path("mutation-results"))
    arguments.add_argument("--slow", action="store_true", help="use tests marked slow too")
    arguments.add_argument("--resume", action="store_true", help="go on with a run that was cut")
    arguments.add_argument("--only", type=Path, help="run the survivors of this result again")
    given = arguments.parse_args()
    given.results.mkdir(parents=True, exist_ok=True)
    clone = Path(tempfile.mkdtemp(prefix="mutation-")) / "clone"
    subprocess.run(["git", "clone", "-q", str(ROOT), str(clone)], check=True)
    os.environ["PYTHONPATH"] = str(clone)  # before an installed copy
    sys.path.insert(0, str(clone))
    mutation_tests.preload(clone)
    for room in given.rooms:
        modules, patterns = ROOMS[room]
        chosen = sorted(
            str(p.relative_to(clone)) for t in patterns for p in clone.glob(f"tests/*/{t}.py")
        )
        map_file = given.results.resolve() / f"{room}.map.json"
        script = str(Path(mutation_tests.__file__).resolve())
        marks = [] if given.slow else ["-m", "not slow"]
        log = (given.results / f"{room}.log").open("w")
        if not (given.resume and map_file.exists()):
            subprocess.run(
                [sys.executable, script, str(clone), str(map_file), *chosen, *marks],
                cwd=clone,
                check=True,
                stdout=log,
                stderr=log,
            )
        found = json.loads(map_file.read_text())
        sys.dont_write_bytecode = True
        os.environ["PYTHONDONTWRITEBYTECODE"] = "1"
        drawn, count = draw(clone, modules, given.sample)
        if given.only:
            alive = [
                r
                for r in json.loads(given.only.read_text())
                if r["outcome"] not in ("killed", "timeout")
            ]
            drawn = [Mutant(*(r[k] for k in Mutant._fields)) for r in alive]
        for module in sorted({mutant.module for mutant in drawn}):
            if not control(clone, module, found):
                sys.exit(f"{module}: a test fails without a change; see {clone.parent / 'output'}")
        result = given.results / f"{room}.json"
        rows = json.loads(result.read_text()) if given.resume and result.exists() else []
        known = {Mutant(*(row[k] for k in Mutant._fields)) for row in rows}
        for tick, mutant in enumerate(drawn):
            if mutant in known:
                continue
            rows.append(run(clone, mutant, found, tick))
            row = rows[-1]
            result.write_text(json.dumps(rows, indent=1))
            if row["outcome"] in ("survived", "no test"):
                print(f"{row['outcome']}: {mutant.module}:{mutant.first} {mutant.operator}")
                print("\n".join(f"    {line}" for line in row["change"]), flush=True)
        killed = sum(r["outcome"] in ("killed", "timeout") for r in rows)
        print(f"{room}: {killed} of {len(rows)} killed ({count} mutants in all)", flush=True)


if __name__ == "__main__":
    main()
