"""Where `ddgfab optimize` misses its goal: the best mesh reached, and the command to try next."""

from __future__ import annotations

import math
import shlex
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from fabrication.cli.common import Reading
from fabrication.cli.terminal import Session

if TYPE_CHECKING:
    from ddgfab.errors import OptimizeError
    from ddgfab.mesh import Floats

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
    from ddgfab.optimize.directions import TRACE

    run.fail(f"FAILED {error}")
    if not isinstance(error.result, OptimizeResult):  # refused before solving
        run.fail(f"{target} was not written")
        return
    best = target.with_name(f"{target.stem}.missed.obj")
    mesh = error.result.mesh
    write_mesh(best, mesh.with_vertices(mesh.vertices + origin), units="mm")
    run.fail(f"the best mesh reached: {best} [mm]; {target} was not written")
    if error.result.advice:
        name, value = error.result.advice[0]
        if name == TRACE:
            run.fail(f"next: {command.traced(value)}")
            return
        changed = dict(_setting(name, value) for name, value in error.result.advice)
        run.fail(f"next: {command.text(changed)}")


_KEYS: Final = {
    "flat": "flat_percent",
    "distance_limit": "distance_limit_edges",
    "max_pane": "max_pane_mm",
    "max_movement": "max_movement_mm",
}
"""Keys of [optimize] for options of `ddgfab.optimize.optimize` with other names."""


def _setting(name: str, value: object) -> tuple[str, object]:
    """Key and value in [optimize] for an option of `ddgfab.optimize.optimize`."""
    if name == "max_lean" and isinstance(value, float):
        return "max_lean_deg", float(f"{math.degrees(value):.4g}")
    return _KEYS.get(name, name), value


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
    ) -> None:
        self.begin = ["ddgfab", "optimize", str(source)]
        if output is not None:
            self.begin += ["-o", str(output)]
        self.source = source
        self.placed = Reading(reading.units, reading.scale).arguments()
        self.begin += reading.arguments()
        self.anew = anew
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
