"""Every setting with every value of its type and many of others: settings, or a message.

    python tests/attack/sweep.py              # all of them; what is accepted is designed too

A seed is a setting (`known.settings`), so that a new one is covered by itself.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

HERE = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(HERE), str(HERE / "tests" / "attack"), str(HERE / "tests" / "fabrication")]

from known import ABSURD, Setting, settings  # noqa: E402
from roofs import barrel  # noqa: E402
from watch import Watch, run  # noqa: E402

from ddgfab.io import write_obj  # noqa: E402
from fabrication.cli.changes import sections_of  # noqa: E402
from fabrication.cli.settings import dilemma_settings  # noqa: E402
from fabrication.gridshell.design import Design, design_net  # noqa: E402
from fabrication.gridshell.load import make_project  # noqa: E402
from fabrication.gridshell.net_input import load_net  # noqa: E402
from fabrication.gridshell.optimized import optimized_mesh  # noqa: E402
from fabrication.gridshell.project import Project  # noqa: E402
from fabrication.gridshell.template import project_template  # noqa: E402
from fabrication.linkage.project import KitProject, make_kit_project  # noqa: E402
from fabrication.linkage.template import kit_template  # noqa: E402

SECONDS = 30.0
"""What a setting asks for may be large: a net of a million vertices, panes of a millimetre."""


def projects(setting: Setting, values: tuple[Any, ...], mesh: Path) -> Iterator[tuple[str, Any]]:
    """(value as text, what reads the project) of a setting with each of some values."""
    for value in values:
        sections: dict[str, dict[str, Any]] = {}
        for section, key, kind in setting.with_:
            sections.setdefault(section, {})[key] = kind
        if setting.product == "gridshell" and not setting.with_:
            sections["net"] = {"kind": "mesh", "file": str(mesh)}
        if setting.section == "optimize" and setting.key != "goal":
            sections["optimize"] = {"goal": "families" if "f" in setting.key[:3] else "planar"}
        own: Any = value
        for key in reversed(setting.key.split(".")):
            own = {key: own}
        name = next(iter(own))
        sections.setdefault(setting.section, {})[name] = own[name]
        yield f"{value!r:.60}", _reader(setting, sections)


def _reader(setting: Setting, sections: dict[str, dict[str, Any]]) -> Callable[[], Any]:
    if setting.product == "dilemma":
        return lambda: dilemma_settings(sections)
    if setting.product == "gridshell":
        return lambda: make_project(sections)
    linkage = {"kind": setting.product, **sections.get("linkage", {})}
    return lambda: make_kit_project({**sections, "linkage": linkage})


@cache
def start() -> Any:
    """A mesh of four faces, whose designs take a tenth of a second."""
    return barrel(2, 2)


def use(project: Any) -> Any:
    """What a project is for, without its parts: template, net, design, mechanism."""
    if isinstance(project, KitProject):
        kit_template(project)
        return project.mechanism()
    if not isinstance(project, Project):
        return project
    project_template(project)
    net = load_net(project)
    if net.mesh.n_faces > 400:
        return net
    if project.optimize.goal != "none":
        return optimized_mesh(net.mesh, project.optimize)
    made: Design = design_net(project, net)
    made.product().notes  # noqa: B018 - what a plan says
    return made.schedules


def attack(watch: Watch, seed: int, folder: Path, *, absurd: int = 1, deep: bool = True) -> None:
    """One setting with all its values and one in `absurd` of those of other types."""
    setting = settings()[seed % len(settings())]
    mesh = folder / "roof.obj"
    if not mesh.exists():
        write_obj(mesh, start())
    values = (*setting.values, *ABSURD[seed % absurd :: absurd])
    for text, read in projects(setting, values, mesh):
        project = watch.call(f"{setting} = {text}", read)
        if project is not None and deep:
            watch.call(f"{setting} = {text} (used)", lambda made=project: use(made), SECONDS)


def typed(watch: Watch, seed: int) -> None:
    """The same values as text behind --set."""
    setting = settings()[seed % len(settings())]
    for value in (*setting.values, *ABSURD):
        change = f"{setting.section}.{setting.key}={value}"
        watch.call(change[:80], lambda word=change: sections_of([word]))


if __name__ == "__main__":
    with TemporaryDirectory() as place:
        sys.exit(run(attack, __doc__, len(settings()), Path(place)))
