"""`ddgfab init`: a commented project file, with every setting."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from fabrication.cli.common import Change, Debug, Quiet, Verbose, app
from fabrication.cli.terminal import session

if TYPE_CHECKING:
    from fabrication.cli.changes import Sections
    from fabrication.gridshell.project import Project
    from fabrication.linkage.project import KitProject


@app.command("init")
def init_command(
    source: Annotated[
        str | None,
        typer.Argument(
            help="Kind of net or of linkage, mesh, surface (STEP, IGES) or project; none: the "
            "built-in example."
        ),
    ] = None,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="File; default <project>.toml.")
    ] = None,
    linkage: Annotated[
        bool,
        typer.Option(
            "--linkage", help="Of a linkage: SOURCE is bennett, cube, knet, crab or a mesh."
        ),
    ] = False,
    force: Annotated[bool, typer.Option("--force", help="Replace a file.")] = False,
    change: Change = None,
    quiet: Quiet = False,
    verbose: Verbose = False,
    debug: Debug = False,
) -> None:
    """Write a project file with every setting, its meaning, unit, values and default.

    What it makes is what would be made without it: `ddgfab init` and `ddgfab make`, `ddgfab init
    roof.obj` and `ddgfab make roof.obj`, `ddgfab init --linkage cube` and `ddgfab linkage cube`.
    """
    with session(debug, quiet, verbose) as run:
        from ddgfab.errors import InputError, OutputError
        from ddgfab.io.atomic import atomic_write
        from fabrication.cli.changes import sections_of
        from fabrication.job.names import safe_name

        sections = sections_of(change)
        if not linkage and source is not None:
            linkage = _is_linkage(source)
        made = _kit(source, sections) if linkage else _gridshell(source, sections)
        target = output or Path(f"{safe_name(made.name)}.toml")
        if target.suffix.lower() != ".toml":
            raise InputError(f"{target}: a project file ends in .toml")
        if target.exists() and not force:
            raise OutputError(f"{target}: exists already; --force replaces it, -o names another")
        text = _text(made, target)
        with atomic_write(target) as stream:
            stream.write(text.encode("utf-8"))
        command = "linkage" if linkage else "make"
        run.result(f"written to {target}")
        run.say(f"next: ddgfab {command} {target} --dry-run")


def _is_linkage(source: str) -> bool:
    """Whether a project file, or a kind that is not a kind of net too, is of a linkage."""
    from ddgfab.forms.registry import kinds
    from fabrication.gridshell.load import KIT
    from fabrication.linkage.project import kit_kinds
    from fabrication.project.read import read_toml

    if Path(source).suffix.lower() == ".toml":
        return KIT in read_toml(Path(source))[0]
    return source in kit_kinds() and source not in kinds()


def _gridshell(source: str | None, sections: Sections) -> Project:
    """The project of `ddgfab make` with this source."""
    from ddgfab.io.load import suffix_of, unknown_format
    from fabrication.gridshell.design import find_project
    from fabrication.surfaces_in.find import CAD_SUFFIXES, MESH_SUFFIXES

    known = (".toml", *CAD_SUFFIXES, *MESH_SUFFIXES, ".json")
    path = None if source is None else Path(source)
    if path is not None and path.suffix and suffix_of(path) not in known:
        raise unknown_format(path, known)
    return find_project(source, sections)


def _kit(source: str | None, sections: Sections) -> KitProject:
    """The project of `ddgfab linkage` with this source."""
    from fabrication.linkage.kit import find_kit_project

    return find_kit_project(source, sections)


def _text(made: Project | KitProject, target: Path) -> str:
    """The file of a project: with its name, and files named from where it will lie."""
    from ddgfab.forms.registry import find_generator, kinds
    from fabrication.gridshell.net_settings import NetSettings
    from fabrication.gridshell.project import Project
    from fabrication.gridshell.template import project_template
    from fabrication.linkage.template import kit_template

    base = Path() if made.file is None else made.file.parent

    def moved(path: Path | str) -> Path:
        return Path(os.path.relpath(base / path, target.parent))

    section = made.net if isinstance(made, Project) else made.linkage
    if isinstance(section, NetSettings) and section.kind in kinds():
        files = find_generator(section.kind).files(section.parameters)
        named = {name: moved(section.parameters[name]).as_posix() for name in files}
        section = section.model_copy(update={"parameters": {**section.parameters, **named}})
    elif (path := getattr(section, "file", None)) is not None:
        section = section.model_copy(update={"file": moved(path)})
    general = made.project.model_copy(update={"name": made.name})
    if isinstance(made, Project):
        return project_template(made.model_copy(update={"project": general, "net": section}))
    return kit_template(made.model_copy(update={"project": general, "linkage": section}))
