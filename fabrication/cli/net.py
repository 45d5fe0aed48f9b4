"""`ddgfab net`: write any net of the library as a mesh file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final

import typer

from fabrication.cli.common import Change, Debug, Quiet, Verbose, app
from fabrication.cli.terminal import Session, session

if TYPE_CHECKING:
    from ddgfab.mesh import Mesh

FARTHEST_MM: Final = 1e6
"""No parallel net is farther away [mm]."""


@app.command("net")
def net_command(
    kind: Annotated[str | None, typer.Argument(help="Kind of net; see --list.")] = None,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="OBJ, OFF or PLY; default KIND.obj.")
    ] = None,
    change: Change = None,
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
    quiet: Quiet = False,
    verbose: Verbose = False,
    debug: Debug = False,
) -> None:
    """Write an exact net (planar, circular, conical, ...) as a mesh file.

    Parameters are settings of [net]: `ddgfab net canal --set net.panels_along=24`.
    """
    with session(debug, quiet, verbose) as run:
        from ddgfab.errors import InputError
        from ddgfab.forms.registry import find_generator, generate, kinds
        from ddgfab.io import check_target, write_mesh
        from fabrication.cli.changes import sections_of
        from fabrication.gridshell.load import make_project

        if listing:
            _list_nets(run, kinds() if kind is None else (kind,))
            return
        given = sections_of(change, only=("net",)).get("net", {})
        if kind is not None and given.setdefault("kind", kind) != kind:
            raise InputError(f"KIND is {kind} and net.kind is {given['kind']}: give one of them")
        if given.get("kind") is None:
            raise InputError(f"which kind of net? One of {', '.join(kinds())}; see --list")
        entry = find_generator(str(given["kind"]))
        target = output or Path(f"{entry.kind}.obj")
        check_target(target)
        net = make_project({"net": given}).net
        mesh, summary = generate(net.kind, net.parameters), entry.summary
        if offset is not None:
            if not abs(offset) <= FARTHEST_MM:
                raise InputError(f"--offset {offset:g}: at most {FARTHEST_MM:g} mm to either side")
            from ddgfab.offsets import exact_offset

            mesh, report = exact_offset(mesh, offset)
            summary = str(report)
        counts = "" if circles is None else _write_circles(circles, mesh)
        write_mesh(target, mesh, units="mm")
        for name, value in net.parameters.items():
            run.detail(f"{name} = {value}")
        run.say(f"{summary}\n{mesh!r}")
        run.result(f"written to {target} [mm]{counts}")


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


def _list_nets(run: Session, names: tuple[str, ...]) -> None:
    """Kinds of net with their parameters, defaults, limits and meaning."""
    from ddgfab.forms.registry import find_generator

    for name in names:
        entry = find_generator(name)
        run.result(f"{name}: {entry.summary}")
        for known in entry.parameters:
            limits = f" [{known.limits}]" if known.limits else ""
            run.result(f"  {known.name} = {known.default_text}  {known.text}{limits}")
