"""`ddgfab net`: write any net of the library as a mesh file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from fabrication.cli.common import Debug, app, errors, values_of

if TYPE_CHECKING:
    from ddgfab.mesh import Mesh


@app.command("net")
def net_command(
    kind: Annotated[str | None, typer.Argument(help="Kind of net; see --list.")] = None,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="OBJ, OFF or PLY; default KIND.obj.")
    ] = None,
    change: Annotated[
        list[str] | None, typer.Option("--set", help="A parameter: panels_along=20, ...")
    ] = None,
    listing: Annotated[
        bool, typer.Option("--list", help="List all kinds, or the parameters of KIND.")
    ] = False,
    offset: Annotated[
        float | None,
        typer.Option(help="Write the net parallel to it at this distance [mm] instead."),
    ] = None,
    circles: Annotated[
        Path | None,
        typer.Option(
            help="Also write incircles and vertex spheres (koebe, minimal): CSV, OBJ or STEP."
        ),
    ] = None,
    debug: Debug = False,
) -> None:
    """Write an exact net (planar, circular, conical, ...) as a mesh file."""
    with errors(debug):
        from ddgfab.errors import InputError
        from ddgfab.forms.registry import find_generator, generate, kinds
        from ddgfab.io import write_mesh

        if listing:
            _list_nets(kinds() if kind is None else (kind,))
            return
        if kind is None:
            raise InputError(f"which kind of net? One of {', '.join(kinds())}; see --list")
        parameters = values_of(change or [])
        mesh = generate(kind, parameters)
        summary = find_generator(kind).summary
        if offset is not None:
            from ddgfab.offsets import exact_offset

            mesh, report = exact_offset(mesh, offset)
            summary = str(report)
        counts = "" if circles is None else _write_circles(circles, mesh)
        target = output or Path(f"{kind}.obj")
        write_mesh(target, mesh, units="mm")
        typer.echo(f"{summary}\n{mesh!r}\nwritten to {target} [mm]{counts}")


def _write_circles(path: Path, mesh: Mesh) -> str:
    """Write the circles and spheres of an s-isothermic net; returns how many, as text."""
    from ddgfab.io.circles import write_circles
    from ddgfab.nets.sisothermic import SIsothermic

    curves = SIsothermic.of(mesh).curves()
    if path.suffix.lower() in (".step", ".stp"):
        from fabrication.formats.step.circles import write_step_circles

        write_step_circles(path, curves)
    else:
        write_circles(path, curves)
    counts = ", ".join(f"{len(given)} {kind}s" for kind, given in curves.items())
    return f"\n{counts} written to {path} [mm]"


def _list_nets(names: tuple[str, ...]) -> None:
    """Kinds of net with their parameters, defaults, limits and meaning."""
    from ddgfab.forms.registry import find_generator

    for name in names:
        entry = find_generator(name)
        typer.echo(f"{name}: {entry.summary}")
        for known in entry.parameters:
            limits = f" [{known.limits}]" if known.limits else ""
            typer.echo(f"  {known.name} = {known.default_text}  {known.text}{limits}")
