"""Pictures of docs/optimize.md: six designs before and after, with what it cost.

python docs/pictures_optimize.py [--folder FOLDER] [NAME ...]
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from ddgfab.grid import grid_mesh
from ddgfab.measures import planarity_percent
from ddgfab.mesh import Floats, Mesh
from ddgfab.optimize import optimize
from fabrication.pictures.change import write_change

FOLDER = Path(__file__).parent / "optimize"
SIZE = (1400, 630)
CELL = 1500.0
"""Mean cell of the designs [mm]."""


def grid(nx: int, ny: int) -> tuple[Floats, Floats]:
    """Parameters of a grid of nx x ny cells, 0 to nx and 0 to ny."""
    u, v = np.meshgrid(np.arange(nx + 1.0), np.arange(ny + 1.0), indexing="ij")
    return u, v


def wavy_roof() -> Mesh:
    """20 x 12 cells, two waves along and one across."""
    x, y = grid(20, 12)
    z = 0.8 * np.sin(4 * np.pi * x / 20 + 0.5) * np.cos(2 * np.pi * y / 12)
    return grid_mesh(CELL * np.stack([x, y, z], axis=-1))


def honeycomb_dome() -> Mesh:
    """Hexagons on a cap."""
    ring = np.exp(1j * (np.pi / 3 * np.arange(6) + np.pi / 6))
    names: dict[tuple[float, float], int] = {}
    faces = []
    for i in range(-7, 8):
        for j in range(-7, 8):
            center = np.sqrt(3) * (i + j / 2) + 1.5j * j
            if abs(center) < 11:
                keys = [(round(c.real, 5), round(c.imag, 5)) for c in center + ring]
                faces.append([names.setdefault(key, len(names)) for key in keys])
    flat = np.array(list(names))
    height = 5 - 0.03 * flat[:, 0] ** 2 - 0.04 * flat[:, 1] ** 2
    return Mesh.build(0.6 * CELL * np.c_[flat, height], faces)


def shell_with_hole() -> Mesh:
    """A free-form shell round an eye, wide on one side."""
    u, v = grid(36, 9)
    a, t = 2 * np.pi * u[:-1] / 36, v[:-1] / 9
    far = 3 + 8 * t * (1 + 0.25 * np.cos(a))
    x, y = 1.3 * far * np.cos(a), far * np.sin(a)
    z = 4.5 * np.sin(np.pi * (0.15 + 0.85 * t)) * (1 + 0.2 * np.cos(2 * a + 0.4))
    return grid_mesh(CELL * np.stack([x, y, z], axis=-1), (True, False))


def long_canopy() -> Mesh:
    """60 x 6 cells along a bend, rising and falling."""
    s, t = grid(60, 6)
    a = s / 60 * np.pi / 2
    across = t - 3
    z = 1.2 * np.sin(2 * np.pi * s / 30) - 0.06 * across**2 + 0.15 * across * np.sin(s / 12)
    return grid_mesh(CELL * np.stack([(38 + across) * np.cos(a), (38 + across) * np.sin(a), z], -1))


def twisted_tower() -> Mesh:
    """24 x 30 cells round a tower that turns by 60 degrees and is slimmer at half its height."""
    u, v = grid(24, 30)
    a, h = 2 * np.pi * u[:-1] / 24, v[:-1]
    turned = a + np.pi / 3 * h / 30
    far = (4.5 + 1.2 * np.cos(2 * np.pi * h / 30)) * (1 + 0.12 * np.cos(2 * a))
    z = 1.2 * h
    return grid_mesh(
        CELL * np.stack([far * np.cos(turned), far * np.sin(turned), z], -1), (True, False)
    )


def saddle() -> Mesh:
    """14 x 14 cells of a saddle, the net turned by 25 degrees off its straight lines."""
    u, v = grid(14, 14)
    u, v = u - 7, v - 7
    a = np.radians(25)
    x, y = np.cos(a) * u - np.sin(a) * v, np.sin(a) * u + np.cos(a) * v
    return grid_mesh(CELL * np.stack([u, v, 0.055 * x * y], axis=-1))


DESIGNS: dict[str, tuple[Callable[[], Mesh], dict[str, Any]]] = {
    "wavy_roof": (wavy_roof, {"diagonals": True}),
    "honeycomb_dome": (honeycomb_dome, {}),
    "shell_with_hole": (shell_with_hole, {}),
    "long_canopy": (long_canopy, {}),
    "twisted_tower": (twisted_tower, {}),
    "saddle": (saddle, {}),
}
"""Design and the options it is optimized with."""


def main() -> None:
    """Optimize and draw; a row of the table for each."""
    parser = argparse.ArgumentParser(description="pictures of docs/optimize.md")
    parser.add_argument("--folder", type=Path, default=FOLDER)
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"of {', '.join(DESIGNS)}")
    given = parser.parse_args()
    given.folder.mkdir(exist_ok=True)
    for name in given.names or DESIGNS:
        build, options = DESIGNS[name]
        mesh = build()
        begin = time.perf_counter()
        result = optimize(mesh, throw=False, **options)
        seconds = time.perf_counter() - begin
        change = result.change
        kept = "-" if change.rise_kept is None else f"{100 * change.rise_kept:.0f} %"
        edge = change.edge
        sys.stdout.write(
            f"| {name} | {mesh.n_faces} | {planarity_percent(mesh).max():.2g} "
            f"| {change.distance_mean:.0f} / {change.distance_max:.0f} "
            f"| {change.distance_mean / edge:.2f} / {change.distance_max / edge:.2f} "
            f"| {kept} | {np.degrees(change.crease[0]):.0f} | {seconds:.1f} "
            f"| {result.status}, {len(change.folded)} folded |\n"
        )
        write_change(given.folder / f"{name}.png", change, size=SIZE)


if __name__ == "__main__":
    main()
