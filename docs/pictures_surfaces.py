"""Pictures of docs/surfaces.md: nets on surfaces, and a dome that moves for its lattice.

python docs/pictures_surfaces.py [--folder FOLDER]
"""

from __future__ import annotations

import argparse
import runpy
from pathlib import Path

import numpy as np

from ddgfab.redesign.dilemma import dilemma
from ddgfab.surfaces.analytic import named_surface
from ddgfab.surfaces.principal import principal
from ddgfab.trace import trace
from fabrication.pictures.fields import FieldPlot, write_panels

FOLDER = Path(__file__).parent / "surfaces"
SIZE = (1400, 560)
EXAMPLE = Path(__file__).parents[1] / "examples" / "surface_dilemma.py"


def nets(folder: Path) -> None:
    """A dome with two umbilics and the monkey saddle, each with its umbilics."""
    cap = {"width_mm": 15600.0, "depth_mm": 4800.0}
    for name, spacing, sizes in (("ellipsoid-cap", 700.0, cap), ("monkey-saddle", 1500.0, {})):
        surface = named_surface(name, sizes)
        found = trace(surface, spacing)
        places = np.array([umbilic.x for umbilic in found.network.umbilics])
        names = tuple(f"{umbilic.index:+g}" for umbilic in found.network.umbilics)
        certain = principal(surface.jets(found.traced.uv)).anisotropy
        panels = [
            FieldPlot(found.mesh, marks=places, captions=names),
            FieldPlot(found.mesh, certain, "anisotropy", (0.0, 1.0)),
        ]
        write_panels(folder / f"{name}.png", panels, size=SIZE)


def moved_dome(folder: Path) -> None:
    """The lattice of the example: angles before, movement after."""
    drawn = runpy.run_path(str(EXAMPLE))["lattice"](np.radians(30))
    found = dilemma(drawn, nearest=True)
    angles = np.full(drawn.n_faces, np.nan)
    angles[found.before.faces] = np.degrees(found.before.principal)
    panels = [
        FieldPlot(drawn, angles, "edges from principal [deg]", (0.0, 45.0)),
        FieldPlot(found.mesh, found.normal, "moved along the normal [mm]"),
    ]
    write_panels(folder / "dilemma.png", panels, size=SIZE)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--folder", type=Path, default=FOLDER)
    given = parser.parse_args().folder
    given.mkdir(parents=True, exist_ok=True)
    nets(given)
    moved_dome(given)
