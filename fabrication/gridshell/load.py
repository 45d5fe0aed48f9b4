"""The project of a gridshell from a TOML file, a mesh file or a dictionary, validated."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

from pydantic import ValidationError

from ddgfab.forms.registry import ParameterError, find_generator, kinds
from ddgfab.surfaces.analytic import SURFACES, surface_parameters
from fabrication.gridshell.net_settings import MESH, SURFACE, NetSettings
from fabrication.gridshell.part_settings import BeamRule
from fabrication.gridshell.project import Project
from fabrication.project.load import explain, sections_in, show, unknown
from fabrication.project.read import Changes, Origin, changed, read_toml
from fabrication.surfaces_in.find import CAD_SUFFIXES

KIT = "linkage"
"""The section that makes a project one of a linkage (`fabrication.linkage`), not of a gridshell."""


TRACED_GOAL: Final[dict[str, Any]] = {"goal": "planar", "flat_percent": 0.0}
"""[optimize] of a project that traces its net on a surface, where it has none: the net is planar
to third order, made exactly planar it has axes without torsion."""


def load_project(path: str | Path, changes: Changes | None = None) -> Project:
    """The project in a TOML file, validated; `changes` replaces single values, by section.

    Raises
    ------
    ProjectError
        A file that is missing, no TOML, or has an unknown key or a wrong value; names file, line,
        key, value, limit, and the nearest known key.
    """
    values, text = read_toml(Path(path))
    values = _with_rules(values, Origin(str(path), text))
    keys = frozenset((section, key) for section, own in (changes or {}).items() for key in own)
    return _project(changed(values, changes), Path(path), Origin(str(path), text, keys))


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
    return _project({"net": {"kind": "canopy"}, **sections}, None, Origin())


def _project(values: Mapping[str, Any], file: Path | None, origin: Origin) -> Project:
    if KIT in values:
        raise origin.error("[linkage] is for a kit: ddgfab linkage", KIT)
    sections = sections_in(_with_rules(values, origin), Project, origin)
    for section in ("beam", "node"):
        if "bolt" in sections.get(section, {}):
            raise origin.error(
                f"[{section}] bolt is no setting: beam and node are joined by one rule, "
                '[connection] kind = "stud" with bolt = "M12", or kind = "welded" without holes',
                section,
                "bolt",
            )
    if "net" not in sections:
        raise origin.error('a project needs [net] kind = "mesh", file = "..."')
    try:
        if sections["net"].get("kind", MESH) in kinds():
            sections["net"] = _generated(sections["net"], origin)
            if sections.get("project", {}).get("units", "mm") != "mm":
                raise origin.error(
                    f"[project] units = {show(sections['project']['units'])} is for mesh files; "
                    f'a net of kind "{sections["net"]["kind"]}" is made in millimetres',
                    "project",
                    "units",
                )
        elif sections["net"].get("kind") == SURFACE:
            sections["net"] = _traced(sections["net"], origin)
            sections.setdefault("optimize", dict(TRACED_GOAL))
        elif "parameters" in sections["net"]:
            raise origin.error(
                unknown("[net] parameters", "parameters", NetSettings.keys()), "net", "parameters"
            )
        return Project.model_validate({**sections, "file": file}, strict=None)
    except ValidationError as error:
        raise explain(error, Project, origin) from None


def _with_rules(values: Mapping[str, Any], origin: Origin) -> dict[str, Any]:
    """[[beam]] tables as one section: that without `where`, and the others as its rules."""
    tables = values.get("beam")
    if not isinstance(tables, list) or not all(isinstance(t, Mapping) for t in tables):
        return dict(values)
    plain = [table for table in tables if "where" not in table]
    if len(plain) > 1:
        raise origin.error(
            f"{len(plain)} [[beam]] tables have no where: one is for all beams, the others need "
            'where = "boundary" or edge numbers',
            "beam",
        )
    own = dict(plain[0]) if plain else {}
    if "rules" in own:
        raise origin.error("[[beam]] rules: give each rule a [[beam]] table of its own", "beam")
    rules = [dict(table) for table in tables if "where" in table]
    known = BeamRule.keys()
    for number, rule in enumerate(rules, 1):
        for key in rule:
            if key not in known:
                raise origin.error(
                    f"[[beam]] rule {number}: {unknown(key, key, known)}; tables with where change "
                    "the profile",
                    "beam",
                )
        if missing := sorted(known - set(rule)):
            raise origin.error(f"[[beam]] rule {number} needs {missing[0]}", "beam")
    return {**values, "beam": {**own, "rules": rules}}


def _traced(net: dict[str, Any], origin: Origin) -> dict[str, Any]:
    """Gathers a surface's own parameters, which stand in [net] beside kind."""
    own, given = NetSettings.surface_keys(), _own_parameters(net, origin)
    given |= {key: net.pop(key) for key in list(net) if key not in own}
    surface = net.get("surface", "")
    named = isinstance(surface, str) and surface in SURFACES
    known = surface_parameters(surface) if named else {}
    for key in given:
        if key not in known and (named or not surface):
            raise origin.error(unknown(f"[net] {key}", key, own | set(known)), "net", key)
    return {**net, "parameters": given} if given else net


def _own_parameters(net: dict[str, Any], origin: Origin) -> dict[str, Any]:
    """`parameters` of a [net] made in Python or taken from a manifest; files have none."""
    given = net.pop("parameters", {})
    if not isinstance(given, Mapping):
        raise origin.error(
            "[net] parameters is unknown; parameters stand in [net] beside kind",
            "net",
            "parameters",
        )
    return dict(given)


def _generated(net: dict[str, Any], origin: Origin) -> dict[str, Any]:
    """Gathers a generator's parameters, which stand in [net] beside kind, and checks them."""
    given = _own_parameters(net, origin)
    given |= {key: net.pop(key) for key in list(net) if key not in ("kind", "file")}
    try:
        find_generator(net["kind"]).check(given)
    except ParameterError as error:
        raise origin.error(f"[net] {error}", "net", error.parameter) from None
    return {**net, "parameters": given} if given else net
