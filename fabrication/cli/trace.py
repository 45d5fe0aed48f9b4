"""`ddgfab trace`: a net of curvature lines, or of conjugate lines, on a surface."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Annotated

import typer

from fabrication.cli.common import Debug, app, errors, values_of


@app.command("trace")
def trace_command(
    surface: Annotated[
        str | None,
        typer.Argument(help="STEP, IGES or mesh file, or a surface by name; see --list."),
    ] = None,
    output: Annotated[
        Path, typer.Option("-o", "--output", help="OBJ, OFF or PLY to write.")
    ] = Path("net.obj"),
    spacing: Annotated[float, typer.Option(help="Distance of neighboring lines [mm].")] = 1500.0,
    across: Annotated[
        float | None, typer.Option(help="Distance of the lines of the second family [mm].")
    ] = None,
    face: Annotated[int | None, typer.Option(help="Which face of the file, from 0.")] = None,
    along: Annotated[
        str | None,
        typer.Option(help="X,Y,Z: one family lies in planes with this normal, one is conjugate."),
    ] = None,
    turn: Annotated[
        float | None,
        typer.Option(help="One family is turned from principal by this [deg], one is conjugate."),
    ] = None,
    change: Annotated[
        list[str] | None, typer.Option("--set", help="A parameter of a surface by name: rise_mm=4")
    ] = None,
    listing: Annotated[bool, typer.Option("--list", help="List the surfaces by name.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Machine-readable report.")] = False,
    debug: Debug = False,
) -> None:
    """Trace a net of nearly planar quads on a surface: curvature lines, or conjugate lines.

    Writes the mesh [mm], trimmed at the rim of the surface (curved trims as polygons of 96 sides an
    edge), and reports spacing, planarity and umbilics. `ddgfab optimize` makes its faces planar.
    """
    with errors(debug):
        from ddgfab.errors import InputError
        from ddgfab.io import check_target, write_mesh
        from ddgfab.surfaces.analytic import SURFACES
        from ddgfab.trace import trace
        from fabrication.surfaces_in.find import find_surface

        if listing:
            _list_surfaces()
            return
        if surface is None:
            raise InputError(f"which surface? A STEP file or one of {', '.join(SURFACES)}")
        check_target(output)
        parameters = values_of(change or [])
        found = trace(
            find_surface(surface, parameters, face),
            (spacing, spacing if across is None else across),
            along=None if along is None else _vector(along),
            turn=None if turn is None else math.radians(turn),
        )
        write_mesh(output, found.mesh, units="mm")
        if as_json:
            typer.echo(json.dumps(found.quality.to_dict(), indent=1))
        else:
            typer.echo(f"{found.quality.text()}\n{found.mesh!r}\nwritten to {output} [mm]")


def _vector(text: str) -> tuple[float, ...]:
    from ddgfab.errors import InputError

    try:
        numbers = tuple(float(part) for part in text.split(","))
    except ValueError:
        numbers = ()
    if len(numbers) != 3:
        raise InputError(f"--along {text}: expected three numbers, for instance 0,1,0")
    return numbers


def _list_surfaces() -> None:
    import inspect

    from ddgfab.surfaces.analytic import SURFACES

    for name, function in SURFACES.items():
        summary = (function.__doc__ or "").strip().split("\n")[0]
        typer.echo(f"{name}: {summary}")
        for key, parameter in inspect.signature(function).parameters.items():
            typer.echo(f"  {key} = {parameter.default:g}")
