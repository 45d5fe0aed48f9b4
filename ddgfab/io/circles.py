"""Circles and spheres to CSV (exact numbers) and OBJ (closed polylines)."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from ddgfab.arguments import checked
from ddgfab.circles import Circles, Spheres
from ddgfab.errors import InputError
from ddgfab.io.atomic import atomic_write

POINTS = 64
"""Points round a circle in an OBJ file."""

COLUMNS = ("kind", "id", "x_mm", "y_mm", "z_mm", "normal_x", "normal_y", "normal_z", "radius_mm")
"""Columns of the CSV file; spheres have no normal."""


@checked
def write_circles(
    path: str | Path, curves: Mapping[str, Circles | Spheres], points: int = POINTS
) -> None:
    """Write circles and spheres by kind, atomically; the suffix says the format: .csv or .obj.

    CSV: a row each with center, normal and radius as shortest exact decimals. OBJ: a group for
    each kind; a closed polyline for each circle, three great circles for each sphere.

    Parameters
    ----------
    curves : circles or spheres by the name of their kind; ids count from 0 in each
    points : of each polyline

    Raises
    ------
    InputError
        Another suffix, or fewer than three points.
    OutputError
        The file cannot be written; an old one is left as it was.
    """
    suffix = Path(path).suffix.lower()
    if suffix not in (".csv", ".obj"):
        raise InputError(f"circles are written as .csv or .obj, not as '{suffix}'")
    rows = _csv(curves) if suffix == ".csv" else _obj(curves, points)
    with atomic_write(path) as stream:
        stream.write(("\n".join(rows) + "\n").encode("ascii"))


def _csv(curves: Mapping[str, Circles | Spheres]) -> list[str]:
    rows = [",".join(COLUMNS)]
    for kind, given in curves.items():
        centers = given.centers.tolist()
        normals = given.normals.tolist() if isinstance(given, Circles) else [[""] * 3] * len(given)
        for i, (c, n, r) in enumerate(zip(centers, normals, given.radii.tolist(), strict=True)):
            rows.append(",".join([kind, str(i), *map(str, (*c, *n, r))]))
    return rows


def _obj(curves: Mapping[str, Circles | Spheres], points: int) -> list[str]:
    rows: list[str] = []
    count = 0
    for kind, given in curves.items():
        circles = given if isinstance(given, Circles) else given.great_circles()
        places = circles.points(points)
        rows.append(f"g {kind}")
        rows += [f"v {x!r} {y!r} {z!r}" for x, y, z in places.reshape(-1, 3).tolist()]
        first = count + 1 + points * np.arange(len(circles))
        ring = first[:, None] + np.append(np.arange(points), 0)
        rows += ["l " + " ".join(map(str, line)) for line in ring.tolist()]
        count += points * len(circles)
    return rows
