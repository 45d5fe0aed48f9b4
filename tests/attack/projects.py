"""Projects of gridshells and linkages with changed keys, values and texts: settings or a message.

    python tests/attack/projects.py --count 100000

What is read is asked for its settings and written as a template again; of some the design is made,
on a net of four faces, or the mechanism of a linkage.
"""

from __future__ import annotations

import random
import sys
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

HERE = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(HERE), str(HERE / "tests" / "attack"), str(HERE / "tests" / "fabrication")]

from damage import damaged  # noqa: E402
from mutations import changed_text  # noqa: E402
from roofs import barrel  # noqa: E402
from watch import Watch, run  # noqa: E402

from ddgfab.forms.registry import kinds  # noqa: E402
from ddgfab.io import write_obj  # noqa: E402
from fabrication import design  # noqa: E402
from fabrication.cli.changes import sections_of  # noqa: E402
from fabrication.gridshell.load import load_project, make_project  # noqa: E402
from fabrication.gridshell.project import Project  # noqa: E402
from fabrication.gridshell.template import project_template  # noqa: E402
from fabrication.linkage.project import (  # noqa: E402
    KitProject,
    kit_kinds,
    load_kit_project,
    make_kit_project,
)
from fabrication.linkage.template import kit_template  # noqa: E402

DESIGNED = 50
"""One in so many seeds becomes a design, or a mechanism, where it is read."""

NUMBERS = [0, 1, -1, 2, 3, 5, 7, 90, 180, 360, 1000, 256, 2**31, 2**63 - 1, 0.1, 1e-9, 1e-300, 1e9]
NUMBERS += [1e16, 1e300, -0.0, float("nan"), float("inf"), 12.5, 0.2, 45.0, 1500.0]
TEXTS = ["", "none", "auto", "glass", "cylinder", "tube", "flat", "cope", "FL 60x8", "SHS 60x4"]
TEXTS += ["RHS 1e9x60x5", "FL 0x0", "T 60x60x7", "M12", "M99", "../roof.obj", "/dev/zero", "a\x00b"]
TEXTS += ["mesh", "surface", "canopy", "conical", "planar", "torsion-free", "families", "x" * 500]
TEXTS += ["\u202e", "CON", "C:\\temp\\roof.obj", "step", "stl", "AP242", "all", "sample", "warn"]
LISTS: list[Any] = [[], [1], [1, 2], [1.0, 2.0], [1, 2, 3], [[0, 0], [1, 0], [0, 1]], ["stl"], [[]]]
LISTS += [
    [[0, 0], [60, 0], [60, 8], [0, 8]],
    [0] * 300,
    [{"a": 1}],
    {"a": 1},
    {"step": {"schema": 5}},
]
LISTS += [[[-30, -4], [30, -4], [30, 4], [-30, 4]], [[0, 0], [1e9, 0], [0, 1e-9]], [-1, 0, 1e300]]
TEXTS += ["stud", "bolted_tongue", "welded", "star", "bolt", "8/16Ar/6.6.2", "6.6.2", "8/16", "//"]
TEXTS += [
    "8/16Ar/6.6.2/16Kr/8",
    "0/16Ar/8",
    "8/1e9Ar/8",
    "boundary",
    "polished",
    "M1e9",
    "2026-02-30",
]
LISTS += [
    [{"where": "boundary", "profile": "RHS 120x60x5"}],
    [{"where": [0, 1, 10**9], "profile": "FL 60x8"}],
    [{"where": [], "profile": []}, {"profile": 5}, {}],
]
VALUES: list[Any] = [*NUMBERS, *NUMBERS, *TEXTS, *LISTS, True, False]


ROOF = '[net]\nkind = "mesh"\nfile = "roof.obj"\n'
STUDS = (
    '[connection]\nkind = "stud"\nbolt = "M12"\nplate_mm = 20\nfasteners = true\nthread_mm = 18\n'
)
TONGUES = (
    '[connection]\nkind = "bolted_tongue"\nbolt = "M12"\nplate_mm = 10\n[node]\nkind = "star"\n'
)
RULES = '[[beam]]\nprofile = "FL 60x8"\n[[beam]]\nwhere = "boundary"\nprofile = "RHS 60x40x3"\n'
RULES += "[[beam]]\nwhere = [0, 3]\nprofile = [[-30, -4], [30, -4], [30, 4], [-30, 4]]\n"
ORDER = '[panel]\nbuild_up = "8/16Ar/6.6.2"\nedge_work = "ground"\nstep_mm = 20\n'
ORDER += (
    '[rates]\nkg = 4.5\nm2 = 210\nhole = 3\ncurrency = "CHF"\n[stock]\nlength_mm = [6000, 12000]\n'
)
ORDER += 'kerf_mm = 3\n[project]\ndate = "2026-03-01"\ntitle = "Roof"\n'


def bare(text: str) -> str:
    """A template without its comments, which take most of the time of reading."""
    return "\n".join(row for row in text.split("\n") if row and not row.startswith("#")) + "\n"


@cache
def sound_texts() -> tuple[tuple[str, str], ...]:
    """(kind, text) of project files: nets and connections of every kind, all keys, and linkages."""
    found = [("gridshell", ROOF)] * 5
    found += [("gridshell", ROOF + more) for more in (STUDS, TONGUES, RULES, ORDER)] * 3
    found += [("gridshell", ROOF + RULES + ORDER)] * 2
    mesh: dict[str, Any] = {"kind": "mesh", "file": "roof.obj"}
    surface = {"kind": "surface", "surface": "dome"}
    for net in (mesh, mesh, surface, *({"kind": k} for k in kinds())):
        found.append(("gridshell", bare(project_template(make_project({"net": net})))))
    for kind in kit_kinds():
        text = kit_template(make_kit_project({"linkage": {"kind": kind}}))
        found += [("kit", text), ("kit", bare(text))]
    return (*found, ("gridshell", project_template(make_project({"net": mesh}))))


@cache
def keys(kind: str) -> tuple[tuple[str, str], ...]:
    """(section, key) that projects have, and some that they have not."""
    found = [("net", name) for name in ("panels_along", "radius_mm", "cells", "nothing")]
    model = Project if kind == "gridshell" else KitProject
    for section, field in model.model_fields.items():
        own = getattr(field.annotation, "model_fields", {})
        found += [(section, name) for name in own]
    found += [("linkage", name) for name in ("kind", "a_mm", "alpha_deg", "cells", "twists_deg")]
    return (*found, ("nothing", "x"), ("output", "options.step.schema"), ("net", "parameters"))


def shown(value: Any, rng: random.Random) -> str:
    """A value as it may stand behind --set."""
    if isinstance(value, str) and rng.random() < 0.7:
        return value
    text = str(value).replace("True", "true").replace("False", "false").replace("'", '"')
    return text.replace("{", "{ ").replace(": ", " = ")


def attack(watch: Watch, seed: int, folder: Path) -> None:
    """One project: a text that is changed, or settings as on the command line."""
    rng = random.Random(seed)
    kind, text = rng.choice(sound_texts())
    path = folder / "project.toml"
    if not (folder / "roof.obj").exists():
        write_obj(folder / "roof.obj", barrel(2, 2))
    words: list[str] = []
    which = rng.random()
    if which < 0.45:
        data = changed_text(text, rng).encode("utf-8", "surrogatepass")
    elif which < 0.55:
        data = damaged(text.encode(), seed)
    else:
        data = text.encode()
        for _ in range(rng.choice((1, 1, 2, 4))):
            section, key = rng.choice(keys(kind))
            words.append(f"{section}.{key}={shown(rng.choice(VALUES), rng)}")
    path.write_bytes(data)

    def read() -> Any:
        project = (load_project if kind == "gridshell" else load_kit_project)(
            path, sections_of(words)
        )
        assert isinstance(project.settings, dict)
        assert project.name
        return project

    project = watch.call(seed, read)
    if project is None or seed % DESIGNED:
        return
    if isinstance(project, KitProject):
        watch.call(f"{seed} (template)", lambda: kit_template(project))
        watch.call(f"{seed} (mechanism)", project.mechanism)
        return
    watch.call(f"{seed} (template)", lambda: project_template(project))
    if project.net.kind == "mesh" and project.optimize.goal == "none":
        watch.call(f"{seed} (design)", lambda: design(path, **sections_of(words)).schedules)


if __name__ == "__main__":
    with TemporaryDirectory(dir="/dev/shm" if Path("/dev/shm").is_dir() else None) as place:
        sys.exit(run(attack, __doc__, 100_000, Path(place)))
