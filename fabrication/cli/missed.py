"""Where `ddgfab optimize` misses its goal: the best mesh reached, and the command to try next."""

from __future__ import annotations

import math
import shlex
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from fabrication.cli.common import Reading
from fabrication.cli.terminal import Session

if TYPE_CHECKING:
    from ddgfab.errors import DdgError, OptimizeError
    from ddgfab.mesh import Floats, Mesh
    from fabrication.progress import Progress

PLANAR: Final = "planar"
"""The goal by default."""


def stem(source: Path) -> str:
    """The name of a mesh file without its endings."""
    return Path(source.name.removesuffix(".gz")).stem or "mesh"


def write_missed(
    run: Session, error: OptimizeError, command: Command, target: Path, origin: Floats
) -> None:
    """Print what failed and what to try, and write the best mesh reached beside the target."""
    from ddgfab.io import write_mesh
    from ddgfab.optimize import OptimizeResult
    from ddgfab.optimize.directions import TRACE, TRACE_REASON

    advice: tuple[tuple[str, object], ...] = getattr(error.result, "advice", ())
    traced_again = bool(advice) and advice[0][0] == TRACE and command.anew
    lines = [
        line
        for line in str(error).splitlines()
        if not (traced_again and line.startswith(TRACE_REASON))
    ]
    run.fail("FAILED " + "\n".join(lines))
    if not isinstance(error.result, OptimizeResult):  # refused before solving
        run.fail(f"{target} was not written")
        if command.settings.get("boundary", "free") != "free":
            run.fail(f"next: {command.text({'boundary': 'free'})}")
        return
    best = target.with_name(f"{target.stem}.missed.obj")
    mesh = error.result.mesh
    write_mesh(best, mesh.with_vertices(mesh.vertices + origin), units="mm")
    run.fail(f"the best mesh reached: {best} [mm]; {target} was not written")
    if not advice:
        if command.anew:
            net = command.traced(float(f"{error.result.change.edge:.3g}"))
            run.fail(f"trace nets of other spacings and look at them: {net}")
        return
    changed = dict(_setting(*one) for one in advice if one[0] != TRACE)
    by_net = command.traced(advice[0][1]) if advice[0][0] == TRACE else ""
    if by_net and not (traced_again and changed):
        run.fail(f"next: {by_net}")
        return
    if by_net:
        run.fail(f"accept the traced net, or trace one and look at it: {by_net}")
    run.fail(f"next: {command.text(changed)}")


_KEYS: Final = {
    "flat": "flat_percent",
    "distance_limit": "distance_limit_edges",
    "max_pane": "max_pane_mm",
    "max_movement": "max_movement_mm",
    "max_lean": "max_lean_deg",
    "zigzag_limit": "zigzag_limit_deg",
    "rise_limit": "rise_limit_percent",
    "stretch_limit": "stretch_limit_percent",
}
"""Keys of [optimize] for options of `ddgfab.optimize.optimize` with other names."""


def _setting(name: str, value: object) -> tuple[str, object]:
    """Key and value in [optimize] for an option of `ddgfab.optimize.optimize`."""
    key = _KEYS.get(name, name)
    if isinstance(value, float) and key.endswith(("_deg", "_percent")) and key != "flat_percent":
        value = float(f"{math.degrees(value) if key.endswith('_deg') else 100 * value:.4g}")
    return key, value


def untraceable(error: DdgError, mesh: Mesh, command: Command, progress: Progress) -> DdgError:
    """The error of a mesh that cannot be traced anew, with the command that keeps its own edges.

    It accepts what a run on them is like: other edges are not to be had.
    """
    from ddgfab.errors import OptimizeError
    from ddgfab.optimize import OptimizeResult
    from ddgfab.optimize.directions import TRACE, accepted
    from fabrication.gridshell.load import make_project
    from fabrication.gridshell.optimized import limits_of, optimized_mesh

    changed: dict[str, object] = {}
    settings = make_project({"optimize": command.settings}).optimize
    try:
        optimized_mesh(mesh, settings, progress)
    except OptimizeError as missed:
        advice = getattr(missed.result, "advice", ())
        if isinstance(missed.result, OptimizeResult) and advice and advice[0][0] == "keep":
            # what "keep" leads to next is the net that cannot be traced
            advice = accepted(missed.result, limits_of(settings)) or advice
        changed = dict(_setting(*one) for one in advice if one[0] != TRACE)
        if not changed:
            return type(error)(f"{error}\non its own edges the mesh is missed as well: {missed}")
    return type(error)(f"{error}\nor keep its own edges\nnext: {command.text(changed)}")


_OPTIONS: Final = {
    "goal": "--goal",
    "boundary": "--boundary",
    "flat_percent": "--flat",
    "keep": "--keep",
    "max_movement_mm": "--max-movement",
    "feature_angle_deg": "--features",
    "equal_edges": "--equal-edges",
    "equal_panels": "--equal-panels",
}
"""Options of the command for keys of [optimize]; the others are given by --set."""


class Command:
    """The command as given, to be printed again with other settings."""

    def __init__(
        self,
        source: Path,
        output: Path | None,
        reading: Reading,
        settings: dict[str, Any],
        *,
        anew: bool,
        surface: Path | None = None,
    ) -> None:
        self.begin = ["ddgfab", "optimize", str(source)]
        if output is not None:
            self.begin += ["-o", str(output)]
        self.source, self.reading = source, reading
        self.placed = Reading(reading.units, reading.scale).arguments()
        self.begin += reading.arguments()
        self.anew, self.surface = anew, surface
        self.settings = settings

    def traced(self, spacing: object) -> str:
        """The command that traces another net: of the same spacing, then one to be looked at."""
        if not self.anew and "fix" not in self.settings:
            dropped = ("keep", "diagonals")
            settings = {key: value for key, value in self.settings.items() if key not in dropped}
            again = Command(self.source, None, Reading(), settings, anew=True)
            again.begin = self.begin
            return again.text({})
        net = f"{stem(self.source)}-net.obj"
        words = ["ddgfab", "trace", str(self.source), "-o", net, "--spacing", f"{spacing:g}"]
        return shlex.join(words + self.placed)

    def text(self, changed: dict[str, Any]) -> str:
        """It with these settings changed."""
        from fabrication.project.toml import argument_text

        arguments = [*self.begin, *(["--retrace"] if self.anew else [])]
        if self.surface is not None:
            arguments += ["--surface", str(self.surface)]
        for key, value in {**self.settings, **changed}.items():
            if key == "goal" and value == PLANAR:
                continue
            if key == "diagonals" and value is True:
                arguments.append("--diagonals")
            elif key in _OPTIONS:
                arguments += [_OPTIONS[key], argument_text(value)]
            elif key == "fix" and not isinstance(value, str):
                arguments += ["--fix", ",".join(map(str, value))]
            else:
                arguments += ["--set", f"optimize.{key}={argument_text(value)}"]
        return shlex.join(arguments)
