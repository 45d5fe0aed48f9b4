"""Settings of commands that make no job: [dilemma], and those of [project] and [net] for meshes."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, Final

from pydantic import ValidationError

from ddgfab.errors import ProjectError, clipped
from ddgfab.suggest import suggestion
from fabrication.cli.changes import Sections
from fabrication.cli.common import Reading
from fabrication.gridshell.load import make_project
from fabrication.project.load import explain
from fabrication.project.read import Origin
from fabrication.project.sections import Finite, Section

READING: Final = {
    "project.units": "units",
    "project.scale": "scale",
    "net.up": "up",
    "net.flip": "flip",
    "net.quads": "quads",
    "net.weld_mm": "weld",
}
"""Fields of `Reading` by the settings of a project that mean the same."""


def reading_with(reading: Reading, sections: Sections) -> Reading:
    """How meshes are read, by options and by settings; an option that is given has precedence.

    Raises
    ------
    ProjectError
        A setting that does not concern the reading of meshes, or a wrong value.
    """
    given = {name: dict(sections.get(name, {})) for name in ("project", "net")}
    names = [f"{section}.{key}" for section, keys in given.items() for key in keys]
    for name in names:
        if name not in READING:
            raise ProjectError(
                f"--set {clipped(name)}: this command reads a mesh, and has no such setting; "
                f"{suggestion(name, READING)}"
            )
    if not names:
        return reading
    project = make_project({**given, "net": {"kind": "mesh", "file": "mesh", **given["net"]}})
    changed: dict[str, Any] = {}
    for name in names:
        section, key = name.split(".")
        if READING[name] not in reading.given():
            changed[READING[name]] = getattr(getattr(project, section), key)
    return replace(reading, **changed)


class DilemmaSettings(Section):
    """[dilemma].

    Attributes
    ----------
    goal : what the edges are to be, "principal" or "planar"
    keep : part of the difference of the curvatures to keep, 0 to 1
    nearest : the nearest surface, whatever is left
    plan : move heights only
    surface : that the net is drawn on: a file or a name
    """

    goal: str = "principal"
    keep: Finite | None = None
    nearest: bool = False
    plan: bool = False
    surface: str | None = None


class _Settings(Section):
    dilemma: DilemmaSettings = DilemmaSettings()


def dilemma_settings(sections: Sections) -> DilemmaSettings:
    """[dilemma], validated.

    Raises
    ------
    ProjectError
        An unknown key, or a wrong value.
    """
    try:
        return _Settings.model_validate({"dilemma": sections.get("dilemma", {})}).dilemma
    except ValidationError as error:
        raise explain(error, _Settings, Origin()) from None
