"""`ddgfab inspect` and `ddgfab check`: what a mesh is, and whether files are sound."""

from __future__ import annotations

import json
import shlex
import time
from pathlib import Path
from typing import Annotated

import typer

from fabrication.cli.common import (
    Change,
    Debug,
    Flip,
    Quads,
    Quiet,
    Reading,
    Scale,
    Units,
    Up,
    Verbose,
    Weld,
    app,
)
from fabrication.cli.terminal import DONE, FAILED, session


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
    change: Change = None,
    quiet: Quiet = False,
    verbose: Verbose = False,
    debug: Debug = False,
) -> None:
    """What kind of net a mesh is, and how far from planar, circular, conical, torsion-free.

    Of quads it says how far their edges are from principal and from conjugate directions, what
    planar faces will cost, and which command to try: optimize, optimize --retrace, or dilemma.
    """
    with session(debug, quiet, verbose) as run:
        from ddgfab.io import unlikely_size
        from ddgfab.measures import inspect
        from ddgfab.redesign.advice import advise
        from ddgfab.support import SupportStructure
        from ddgfab.transforms.curvature_range import curvature_range
        from fabrication.cli.changes import sections_of
        from fabrication.cli.settings import reading_with
        from fabrication.gridshell.foresight import foreseen_record, foreseen_text

        sections = sections_of(change, only=("project", "net"))
        reading = reading_with(Reading(units, scale, up, flip, quads, weld), sections)
        read = reading.read(mesh)
        report = inspect(read.mesh)
        curved = None if quiet else curvature_range(read.mesh)
        given = None
        if read.axes is not None:
            given = SupportStructure.of(read.mesh, read.axes, "given")
        notes = list(read.notes)
        if unlikely := unlikely_size(report.edge_length[1]):
            key, value = reading.likely(read, report.edge_length[1])
            shown = value if isinstance(value, str) else f"{value:g}"
            notes.append(f"{unlikely}: is the file in another unit? (--{key} {shown})")
        if as_json:
            record = {
                "file": read.file,
                "sha256": read.sha256,
                "units": read.units,
                "origin_mm": read.origin.tolist(),
                "notes": notes,
                "axes": None if given is None else given.to_dict(),
                "curvatures": None if curved is None else curved.to_dict(),
                "planar_forecast": foreseen_record(read.mesh),
            }
            advice = advise(read.mesh)
            record["directions"] = None if advice is None else advice.to_dict()
            run.result(json.dumps({**record, **report.to_dict()}, indent=1))
            return
        run.detail(f"{read.file}: sha256 {read.sha256}")
        run.detail(f"unit in the file: {read.units or 'not stated'}; {read.mesh!r}")
        for note in notes:
            run.say(f"note: {note}")
        if quiet:
            run.result(f"{read.file}: {report.kind}")
            return
        advice = advise(read.mesh)
        name = shlex.join([str(mesh), *reading.arguments()])
        rows = [] if curved is None else curved.lines()
        rows += [] if advice is None else advice.lines(name)
        text = [report.text(), *(f"{title:<22}{value}" for title, value in rows)]
        run.result("\n".join(filter(None, [*text, foreseen_text(read.mesh)])))
        if given is not None:
            run.say(
                f"node axes in the file: torsion max {given.torsion_deg_max:.1e} deg, lean max "
                f"{given.lean_deg_max:.2f}, mean {given.lean_deg_mean:.2f} deg; make takes them"
            )


@app.command("check")
def check_command(
    files: Annotated[
        list[Path], typer.Argument(help="Files as ddgfab makes them: STEP, STL, 3MF, GLB, CSV.")
    ],
    quiet: Quiet = False,
    verbose: Verbose = False,
    debug: Debug = False,
) -> None:
    """Check files: solids closed and valid, with their volume; tables complete."""
    failed = 0
    with session(debug, quiet, verbose) as run:
        from fabrication.formats.report import inspect_file

        for file in files:
            begin = time.perf_counter()
            report = inspect_file(file)
            if report.passed:
                run.say(report.text())
            else:
                run.result(report.text())
            run.detail(f"  read and checked in {time.perf_counter() - begin:.1f} s")
            failed += not report.passed
        if len(files) > 1 or quiet:
            state = f"{failed} failed" if failed else "every check passed"
            run.result(f"{len(files)} file{'s' if len(files) > 1 else ''}: {state}")
    raise typer.Exit(FAILED if failed else DONE)
