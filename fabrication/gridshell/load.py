"""The project of a gridshell from a TOML file, a mesh file or a dictionary, validated."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

from pydantic import ValidationError

from ddgfab.errors import ProjectError
from ddgfab.forms.registry import ParameterError, find_generator, kinds
from ddgfab.surfaces.analytic import SURFACES, surface_parameters
from fabrication.gridshell.project import MESH, SURFACE, NetSettings, Project
from fabrication.project.load import (
    changed,
    explain,
    find_line,
    read_toml,
    sections_in,
    show,
    unknown,
)
from fabrication.surfaces_in.find import CAD_SUFFIXES

KIT = "linkage"
"""The section that makes a project one of a linkage (`fabrication.linkage`), not of a gridshell."""


TRACED_GOAL: Final[dict[str, Any]] = {"goal": "planar", "flat_percent": 0.0}
"""[optimize] of a project that traces its net on a surface, where it has none: the net is planar
to third order, made exactly planar it has axes without torsion."""


def load_project(
    path: str | Path, changes: Mapping[str, Mapping[str, Any]] | None = None
) -> Project:
    """The project in a TOML file, validated; `changes` replaces single values, by section.

    Raises
    ------
    ProjectError
        A file that is missing, no TOML, or has an unknown key or a wrong value; names file, line,
        key, value, limit, and the nearest known key.
    """
    file = Path(path)
    values, text = read_toml(file)
    return _project(changed(values, changes), file=file, text=text)


def project_for_mesh(path: str | Path, sections: Mapping[str, Any] | None = None) -> Project:
    """Project with all defaults for a mesh or surface file; `sections` changes values.

    Raises
    ------
    ProjectError
        An unknown section, key or value in `sections`.
    """
    kind = SURFACE if Path(path).suffix.lower() in CAD_SUFFIXES else MESH
    changes = dict(sections or {})
    net = {"kind": kind, "file": str(path), **changes.pop("net", {})}
    return make_project({"net": net, **changes})


def make_project(sections: Mapping[str, Any]) -> Project:
    """Project from a dictionary of sections, as in a file; `net` defaults to the canopy.

    Raises
    ------
    ProjectError
        An unknown section or key, or a wrong value.
    """
    return _project({"net": {"kind": "canopy"}, **sections}, file=None, text="")


def _project(values: Mapping[str, Any], file: Path | None, text: str) -> Project:
    name = None if file is None else str(file)
    if KIT in values:
        line = find_line(text, (KIT,))
        raise ProjectError("[linkage] is for a kit: ddgfab linkage", file=name, line=line)
    sections = sections_in(values, Project, name, text)
    try:
        if "net" not in sections:
            raise ProjectError('a project needs [net] kind = "mesh", file = "..."', file=name)
        if sections["net"].get("kind", MESH) in kinds():
            sections["net"] = _generated(sections["net"], name, text)
            if sections.get("project", {}).get("units", "mm") != "mm":
                raise ProjectError(
                    f"[project] units = {show(sections['project']['units'])} is for mesh files; "
                    f'a net of kind "{sections["net"]["kind"]}" is made in millimetres',
                    file=name,
                    line=find_line(text, ("project", "units")),
                )
        elif sections["net"].get("kind") == SURFACE:
            sections["net"] = _traced(sections["net"], name, text)
            sections.setdefault("optimize", dict(TRACED_GOAL))
        elif "parameters" in sections["net"]:
            raise ProjectError(
                unknown("[net] parameters", "parameters", NetSettings.keys()),
                file=name,
                line=find_line(text, ("net", "parameters")),
            )
        return Project.model_validate({**sections, "file": file}, strict=None)
    except ValidationError as error:
        raise explain(error, Project, name, text) from None


def _traced(net: dict[str, Any], name: str | None, text: str) -> dict[str, Any]:
    """Gathers a surface's own parameters, which stand in [net] beside kind."""
    own, given = NetSettings.surface_keys(), _own_parameters(net, name, text)
    given |= {key: net.pop(key) for key in list(net) if key not in own}
    surface = net.get("surface")
    known = surface_parameters(surface) if surface in SURFACES else {}
    for key in given:
        if key not in known and (surface in SURFACES or not surface):
            raise ProjectError(
                unknown(f"[net] {key}", key, own | set(known)),
                file=name,
                line=find_line(text, ("net", key)),
            )
    return {**net, "parameters": given} if given else net


def _own_parameters(net: dict[str, Any], name: str | None, text: str) -> dict[str, Any]:
    """`parameters` of a [net] made in Python or taken from a manifest; files have none."""
    given = net.pop("parameters", {})
    if not isinstance(given, Mapping):
        raise ProjectError(
            "[net] parameters is unknown; parameters stand in [net] beside kind",
            file=name,
            line=find_line(text, ("net", "parameters")),
        )
    return dict(given)


def _generated(net: dict[str, Any], name: str | None, text: str) -> dict[str, Any]:
    """Gathers a generator's parameters, which stand in [net] beside kind, and checks them."""
    given = _own_parameters(net, name, text)
    given |= {key: net.pop(key) for key in list(net) if key not in ("kind", "file")}
    try:
        find_generator(net["kind"]).check(given)
    except ParameterError as error:
        line = find_line(text, ("net", error.parameter))
        raise ProjectError(f"[net] {error}", file=name, line=line) from None
    return {**net, "parameters": given} if given else net
