"""What the commands share: the program, its options, and how mesh files are read."""

from __future__ import annotations

from dataclasses import dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fabrication.cli.terminal import Program
from fabrication.formats.registry import names

if TYPE_CHECKING:
    from ddgfab.io import ReadResult

app = typer.Typer(
    cls=Program,
    help="Discrete surfaces into things that can be built: torsion-free gridshells as checked "
    "STEP, STL and schedules.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode="markdown",  # in "rich", units in brackets would be markup
)

Anyway = Annotated[
    bool,
    typer.Option(
        "--anyway", help="Go on where parts are beyond limits: they are made, and rejected."
    ),
]
Force = Annotated[
    bool, typer.Option("--force", help="Replace the result of another project in the folder.")
]
Output = Annotated[
    str | None, typer.Option("-o", "--output", help="Folder; default outputs/<project>.")
]
Change = Annotated[
    list[str] | None,
    typer.Option(
        "--set", help="Change a setting: section.key=value, such as panel.gap_mm=15. Repeatable."
    ),
]
Quiet = Annotated[
    bool, typer.Option("-q", "--quiet", help="Print errors and the result only, no progress.")
]
Verbose = Annotated[
    bool, typer.Option("-v", "--verbose", help="Print more: settings, times of the steps, files.")
]
Debug = Annotated[bool, typer.Option("--debug", help="Show tracebacks.")]
Formats = Annotated[
    str | None, typer.Option(help=f"Files to write, with commas between: {', '.join(names())}.")
]
Jobs = Annotated[int | None, typer.Option(min=0, help="Processes; 0: one a core.")]
DryRun = Annotated[
    bool,
    typer.Option(
        "--dry-run", help="Say what would be made and whether it keeps its limits; write nothing."
    ),
]

Units = Annotated[
    str | None,
    typer.Option(
        help="Unit of the mesh file: mm, cm, m, in or ft; default: what it states in a comment "
        '("# units: m"), else mm.'
    ),
]
Scale = Annotated[float, typer.Option(help="Factor on the coordinates, before the unit.")]
Up = Annotated[str, typer.Option(help="Axis of the file that is up: z, y, x, -z, -y or -x.")]
Flip = Annotated[bool, typer.Option("--flip", help="Turn the faces over.")]
Quads = Annotated[bool, typer.Option("--quads", help="Merge pairs of triangles into quads.")]
Weld = Annotated[
    float | None,
    typer.Option(
        help="Vertices nearer than this [mm] are one; default: what the digits of the file leave."
    ),
]
MeshOutput = Annotated[Path, typer.Option("-o", "--output", help="OBJ, OFF or PLY to write.")]
Json = Annotated[bool, typer.Option("--json", help="Machine-readable report.")]


@dataclass(frozen=True)
class Reading:
    """How a command reads mesh files: its options."""

    units: str | None = None
    scale: float = 1.0
    up: str = "z"
    flip: bool = False
    quads: bool = False
    weld: float | None = None

    def read(self, path: Path) -> ReadResult:
        """The mesh of a file [mm]."""
        from ddgfab.io import STATED
        from fabrication.meshes_in import read_mesh

        return read_mesh(
            path,
            self.scale,
            units=self.units or STATED,
            merge=self.weld,
            up=self.up,
            flip=self.flip,
            quads=self.quads,
        )

    def likely(self, read: ReadResult, median_mm: float) -> tuple[str, str | float]:
        """The option that makes an unlikely size of a mesh a likely one, and its value."""
        from ddgfab.io import likely_setting, to_millimetres

        factor = to_millimetres(self.units, self.scale, read.units, read.file)
        return likely_setting(median_mm, factor, self.scale, read.units)

    def given(self) -> dict[str, Any]:
        """The options that are not as they are by default."""
        values = {field.name: getattr(self, field.name) for field in fields(self)}
        return {f.name: values[f.name] for f in fields(self) if values[f.name] != f.default}

    def arguments(self) -> list[str]:
        """The options that are not as they are by default, for commands to try next."""
        found = []
        for name, value in self.given().items():
            found.append(f"--{name}")
            if value is not True:
                found.append(f"{value:g}" if isinstance(value, float) else str(value))
        return found
