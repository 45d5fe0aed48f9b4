"""`ddgfab trace`: a net of curvature lines, or of conjugate lines, on a surface."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fabrication.cli.common import Change, Debug, Json, MeshOutput, Quiet, Units, Verbose, app
from fabrication.cli.terminal import Session, session

if TYPE_CHECKING:
    from ddgfab.trace.patches import Patches


Source = Annotated[
    str | None,
    typer.Argument(help="STEP, IGES or mesh file, or a surface by name; see --list."),
]
Spacing = Annotated[
    float | None, typer.Option(help="Distance of neighboring lines [mm]; default 1500.")
]
Across = Annotated[
    float | None, typer.Option(help="Distance of the lines of the second family [mm].")
]
Face = Annotated[
    list[str] | None,
    typer.Option(help="Which face of the file: number from 0, name, or all. Repeatable."),
]
Along = Annotated[
    str | None,
    typer.Option(help="X,Y,Z: one family lies in planes with this normal, one is conjugate."),
]
Turn = Annotated[
    float | None,
    typer.Option(help="One family is turned from principal by this [deg], one is conjugate."),
]
Curves = Annotated[
    Path | None,
    typer.Option(help="DXF, OBJ or CSV file: one family follows its curves [mm]."),
]
Through = Annotated[
    list[str] | None,
    typer.Option(help="X,Y,Z [mm]: a line of each family runs through it. Repeatable."),
]
MeshScale = Annotated[
    float | None, typer.Option(help="Factor on a mesh's coordinates, before the unit.")
]
Listing = Annotated[bool, typer.Option("--list", help="List the surfaces by name.")]
Picture = Annotated[
    bool, typer.Option(help="Write OUTPUT.png: the net, umbilics, how determined lines are.")
]


@app.command("trace")
def trace_command(
    surface: Source = None,
    output: MeshOutput = Path("net.obj"),
    spacing: Spacing = None,
    across: Across = None,
    face: Face = None,
    along: Along = None,
    turn: Turn = None,
    curves: Curves = None,
    through: Through = None,
    units: Units = None,
    scale: MeshScale = None,
    change: Change = None,
    listing: Listing = False,
    picture: Picture = True,
    as_json: Json = False,
    quiet: Quiet = False,
    verbose: Verbose = False,
    debug: Debug = False,
) -> None:
    """Trace a net of nearly planar quads on a surface: curvature lines, or conjugate lines.

    Writes the mesh [mm], trimmed at the rim of the surface (curved trims as polygons of 96 sides an
    edge; OBJ files have the groups inner, rim and corner), a report (OUTPUT.json: spacing,
    planarity, umbilics, angles of the edges, tags of the vertices) and a picture: umbilics, and how
    far an error of the surface would turn the lines (conjugate lines: at which angle they meet).
    Several faces of a file are kept together where the lines meet at their borders.
    `ddgfab optimize` makes the faces planar.
    Settings are those of [net]: `--set net.spacing_mm=1500`, and the parameters of surfaces by
    name: `ddgfab trace dome --set net.radius_x_mm=30e3`.
    """
    with session(debug, quiet, verbose) as run:
        from ddgfab.errors import InputError
        from ddgfab.io import check_target
        from ddgfab.surfaces.analytic import SURFACES
        from fabrication.cli.changes import put, sections_of
        from fabrication.gridshell.load import make_project
        from fabrication.gridshell.traced import traced_net

        if listing:
            _list_surfaces(run)
            return
        sections = sections_of(change, only=("net", "project"))
        net = sections.setdefault("net", {})
        put(
            sections,
            "net",
            spacing_mm=spacing,
            spacing_across_mm=across,
            face=None if not face else face[0] if len(face) == 1 else face,
            along=None if along is None else _vector(along, "--along"),
            through=None if not through else [_vector(point, "--through") for point in through],
            turn_deg=turn,
            curves=None if curves is None else str(curves),
        )
        if surface is not None:
            net |= _source(surface)
        elif not {"file", "surface"} & net.keys():
            raise InputError(f"which surface? A STEP file or one of {', '.join(SURFACES)}")
        check_target(output)
        put(sections, "project", units=units, scale=scale)
        project = make_project({**sections, "net": {"kind": "surface", **net}})
        _write(run, output, traced_net(project), picture=picture, as_json=as_json)


def _write(run: Session, output: Path, found: Patches, *, picture: bool, as_json: bool) -> None:
    """Write mesh, report and picture; print what was traced."""
    from ddgfab.io import write_mesh
    from ddgfab.io.atomic import atomic_path
    from ddgfab.trace.groups import tag_groups
    from ddgfab.trace.mesh import TAGS

    record, rows = _report(found)
    tags = [TAGS[tag] for tag in found.tag.tolist()]
    write_mesh(output, found.mesh, units="mm", groups=tag_groups(found.mesh, found.tag))
    with atomic_path(output.with_suffix(".json")) as temporary:
        text = json.dumps({**record, "vertex_tags": tags}, indent=1)
        temporary.write_text(text + "\n", encoding="utf-8")
    warning = _draw(output.with_suffix(".png"), found) if picture else ""
    if as_json:
        run.result(json.dumps(record, indent=1))
    else:
        for surface in found.surfaces:
            run.detail(f"surface: {surface!r}")
        run.say("\n".join([*rows, repr(found.mesh)]))
        run.result(f"written to {output} [mm]")
    if warning:
        run.fail(warning)


def _report(found: Patches) -> tuple[dict[str, Any], list[str]]:
    """Quality of the traced nets and directions of their edges, as a record and as lines."""
    from ddgfab.trace.alignment import alignment

    several = len(found.traced) > 1
    records: list[dict[str, Any]] = []
    rows: list[str] = []
    for surface, one in zip(found.surfaces, found.traced, strict=True):
        record: dict[str, Any] = {"surface": surface.name} if several else {}
        record |= one.quality.to_dict()
        rows += [surface.name] if several else []
        rows.append(one.quality.text())
        if (one.mesh.face_sizes == 4).any():  # coarse nets may have no quads
            edges = alignment(one.mesh, surface)
            record["edges"] = edges.to_dict()
            rows += [f"{title:<16}{text}" for title, text in edges.lines()]
        records.append(record)
    rows += [f"note          {joint}" for joint in found.joints]
    if several:
        return {"patches": records, "joints": found.joints}, rows
    return records[0], rows


def _draw(path: Path, found: Patches) -> str:
    """The net, and what its lines depend on; a warning where this machine cannot draw."""
    import numpy as np

    from ddgfab.errors import OutputError
    from ddgfab.surfaces.principal import principal
    from ddgfab.trace import PrincipalField
    from ddgfab.trace.certainty import turn_by_error
    from ddgfab.trace.field import sines
    from fabrication.pictures.fields import FieldPlot, write_panels

    marked = [umbilic for one in found.traced for umbilic in one.network.umbilics]
    places = np.array([umbilic.x for umbilic in marked]).reshape(-1, 3)
    names = tuple(f"umbilic {umbilic.index:+g}" for umbilic in marked)
    values = np.zeros(found.mesh.n_vertices)
    for one, index in zip(found.traced, found.joined.index, strict=True):
        field, keep = one.network.field, index >= 0
        jets = field.surface.jets(one.traced.uv[keep])
        if isinstance(field, PrincipalField):
            angle = turn_by_error(principal(jets), found.spacing)
            title, span = "turn by an error of 1/1000 spacing [deg]", (0.0, 45.0)
        else:
            angle = np.arcsin(np.clip(sines(field, jets), 0.0, 1.0))
            title, span = "angle of the families [deg]", (0.0, 90.0)
        values[index[keep]] = np.degrees(angle)
    rim = np.flatnonzero(found.mesh.boundary_edge)
    panels = [
        FieldPlot(found.mesh, lines=rim, marks=places, captions=names),
        FieldPlot(found.mesh, values, title, span),
    ]
    try:
        write_panels(path, panels)
    except OutputError as error:
        return f"no picture: {error}"
    return ""


def _source(surface: str) -> dict[str, Any]:
    """A file, or a surface by name, as [net] has it."""
    from ddgfab.surfaces.analytic import SURFACES

    is_file = surface not in SURFACES and Path(surface).suffix
    return {"file": surface} if is_file else {"surface": surface}


def _vector(text: str, option: str) -> tuple[float, ...]:
    from ddgfab.errors import InputError, clipped

    try:
        numbers = tuple(float(part) for part in text.split(","))
    except ValueError:
        numbers = ()
    if len(numbers) != 3:
        raise InputError(f"{option} {clipped(text)}: expected three numbers, for instance 0,1,0")
    return numbers


def _list_surfaces(run: Session) -> None:
    from ddgfab.surfaces.analytic import SURFACES, surface_parameters

    for name, function in SURFACES.items():
        summary = (function.__doc__ or "").strip().split("\n")[0]
        run.result(f"{name}: {summary}")
        for key, default in surface_parameters(name).items():
            run.result(f"  {key} = {default:g}")
