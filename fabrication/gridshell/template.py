"""A commented project file of a gridshell: [net] has the keys of its kind, and shows the others."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from ddgfab.forms.registry import find_generator, kinds
from ddgfab.surfaces.analytic import SURFACES, surface_parameters
from fabrication.gridshell.net_settings import MESH, SURFACE, NetSettings
from fabrication.gridshell.project import Project
from fabrication.project.template import Setting, Settings, comment, settings_of, template

BEGIN: Final = (
    "A project for `ddgfab make`, with every setting. What is not needed may be deleted: it then "
    'has its default. A line "# key =" is a setting that is not set. Units are in the names: _mm, '
    "_deg (degrees), _percent. Try it: ddgfab make FILE --dry-run"
)


def project_template(project: Project) -> str:
    """The file of a project, with all keys."""
    return template(project, BEGIN, {"net": (list(_own(project.net)), list(_others(project.net)))})


def _own(net: NetSettings) -> Iterator[Setting]:
    """[net]: kind, and the keys that this kind has."""
    known = settings_of(net)
    kind = next(setting for setting in known if setting.key == "kind")
    yield Setting("kind", kind.value, kind.value, kind.text, "")
    if net.kind in (MESH, SURFACE):
        keys = NetSettings.surface_keys() if net.kind == SURFACE else NetSettings.keys()
        named = net.kind == SURFACE and bool(net.surface)
        drop = {"kind", "file" if named else "surface", *(["face"] if named else [])}
        yield from (s for s in known if s.key in keys - drop)
    if net.kind == SURFACE and net.surface:
        for key, default in surface_parameters(net.surface).items():
            yield Setting(key, net.parameters.get(key, default), default, "", "")
    elif net.kind in kinds():
        for about in find_generator(net.kind).parameters:
            value = net.parameters.get(about.name, about.default)
            yield Setting(about.name, value, about.default, about.text, about.limits)


def _others(net: NetSettings) -> Iterator[str]:
    """Other kinds of nets, as comments."""
    yield ""
    yield from comment("Other nets, in place of the keys above:")
    for kind, keys in ((MESH, NetSettings.keys()), (SURFACE, NetSettings.surface_keys())):
        if kind != net.kind:
            yield from ("#", f'# kind = "{kind}"')
            for setting in _defaults(keys - {"kind"}):
                yield from (f"#   {line.removeprefix('# ')}" for line in setting.lines())
    listed = ", ".join(f'"{kind}"' for kind in kinds() if kind != net.kind)
    yield "#"
    yield from comment(f"kind = one of {listed}: with the parameters of `ddgfab net KIND --list`")
    yield from comment(f"surfaces by name: {', '.join(SURFACES)}; see `ddgfab trace --list`")


def _defaults(keys: set[str]) -> Settings:
    """Keys of [net] as they are where nothing is set."""
    return settings_of(NetSettings.model_construct(), tuple(keys))
