"""The project of a gridshell from a TOML file, a mesh file or a dictionary, validated."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

from pydantic import ValidationError

from ddgfab.forms.registry import ParameterError, find_generator, kinds
from ddgfab.surfaces.analytic import SURFACES, surface_parameters
from fabrication.gridshell.kind_settings import KindSection, NodeRule
from fabrication.gridshell.net_settings import MESH, SURFACE, NetSettings
from fabrication.gridshell.part_settings import BeamRule, ConnectionSettings, NodeSettings
from fabrication.gridshell.project import Project
from fabrication.project.load import explain, sections_in, show, unknown
from fabrication.project.read import Changes, Origin, changed, read_toml
from fabrication.project.sections import Section
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
                f"[{section}] bolt is not a setting: beams and nodes are joined by "
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


RULED: Final[dict[str, tuple[type[Section], str, str]]] = {
    "beam": (BeamRule, "profile", "the profile"),
    "node": (NodeRule, "", "what sizes nodes"),
    "connection": (NodeRule, "", "how beams are joined there"),
}
"""Sections that may stand several times, with rules for places: what a rule is, the key that it
must have, and what it changes."""


KINDS: Final[dict[str, type[KindSection]]] = {
    "node": NodeSettings,
    "connection": ConnectionSettings,
}
"""Those whose rules may have any key that is ruled."""


def _with_rules(values: Mapping[str, Any], origin: Origin) -> dict[str, Any]:
    """Tables of `RULED` sections as one section each: that without `where`, the others as rules.

    Raises
    ------
    ProjectError
        Several tables without where, unknown or missing keys.
    """
    out = dict(values)
    for section in RULED:
        tables = values.get(section)
        if isinstance(tables, list) and all(isinstance(t, Mapping) for t in tables):
            out[section] = _ruled(section, tables, origin)
    return out


def _ruled(section: str, tables: list[Mapping[str, Any]], origin: Origin) -> dict[str, Any]:
    """One section of its [[...]] tables."""
    model, needed, what = RULED[section]
    plain = [table for table in tables if "where" not in table]
    if len(plain) > 1:
        raise origin.error(
            f"{len(plain)} [[{section}]] tables have no where: one is for all {section}s, the "
            'others need where = "boundary", "group:NAME" or numbers',
            section,
        )
    own = dict(plain[0]) if plain else {}
    if "rules" in own:
        raise origin.error(
            f"[[{section}]] rules: give each rule a [[{section}]] table of its own", section
        )
    rules = [dict(table) for table in tables if "where" in table]
    known = model.keys() | (KINDS[section].ruled() if section in KINDS else set())
    for number, rule in enumerate(rules, 1):
        for key in rule:
            if key not in known:
                raise origin.error(
                    f"[[{section}]] rule {number}: {unknown(key, key, known)}; tables with where "
                    f"change {what}",
                    section,
                )
        if needed and needed not in rule:
            raise origin.error(f"[[{section}]] rule {number} needs {needed}", section)
        if len(rule) == 1:
            raise origin.error(f"[[{section}]] rule {number} changes nothing but where", section)
    return {**own, "rules": rules}


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
