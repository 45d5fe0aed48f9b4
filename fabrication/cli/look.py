"""`ddgfab inspect` and `ddgfab check`: what a mesh is, and whether files are sound."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from fabrication.cli.common import (
    DONE,
    FAILED,
    Debug,
    Flip,
    Quads,
    Reading,
    Scale,
    Units,
    Up,
    Weld,
    app,
    errors,
)


@app.command("inspect")
def inspect_command(
    mesh: Annotated[Path, typer.Argument(help="OBJ, OFF, PLY, STL or COMPAS JSON.")],
    as_json: Annotated[bool, typer.Option("--json", help="Machine-readable.")] = False,
    units: Units = None,
    scale: Scale = 1.0,
    up: Up = "z",
    flip: Flip = False,
    quads: Quads = False,
    weld: Weld = None,
    debug: Debug = False,
) -> None:
    """What kind of net a mesh is, and how far from planar, circular, conical, torsion-free."""
    with errors(debug):
        from ddgfab.io import unlikely_size
        from ddgfab.measures import inspect

        read = Reading(units, scale, up, flip, quads, weld).read(mesh)
        report = inspect(read.mesh)
        notes = list(read.notes)
        if unlikely := unlikely_size(report.edge_length[1]):
            notes.append(f"{unlikely}: is the file in another unit? (--units m, --scale 0.001)")
        if as_json:
            record = {
                "file": read.file,
                "sha256": read.sha256,
                "units": read.units,
                "origin_mm": read.origin.tolist(),
                "notes": notes,
            }
            typer.echo(json.dumps({**record, **report.to_dict()}, indent=1))
            return
        for note in notes:
            typer.echo(f"note: {note}")
        typer.echo(report.text())


@app.command("check")
def check_command(
    files: Annotated[list[Path], typer.Argument(help="STEP, STL or 3MF files.")],
    debug: Debug = False,
) -> None:
    """Check whether each file is closed and valid, and print its volume."""
    failed = False
    with errors(debug):
        from fabrication.formats.report import inspect_file

        for file in files:
            report = inspect_file(file)
            typer.echo(report.text())
            failed |= not report.passed
    raise typer.Exit(FAILED if failed else DONE)
