"""The design dilemma: a lattice drawn 30 deg off the curvature lines of a dome, made principal.

The dome is a piece of a torus, R = 25 m, with curvatures 10 % apart. Before anything is
solved the forecast says 168 mm; the surface moves by 163 mm in 20 m.

    python examples/surface_dilemma.py [moved.obj]
"""

import sys

import numpy as np

from ddgfab.grid import grid_mesh
from ddgfab.io import write_mesh
from ddgfab.mesh import Floats, Mesh
from ddgfab.redesign.dilemma import dilemma, forecast_lines, mesh_forecast
from ddgfab.trace.alignment import alignment


def dome(x: Floats, y: Floats, radius: float = 25e3, apart: float = 0.1) -> Floats:
    """Points of a piece of a torus; meridians and parallels are a conformal image of x and y."""
    tube = radius / (1 + apart / 2)
    center = radius / (1 - apart / 2) - tube
    # conformal height: integral of tube d phi / (center + tube cos phi), tabulated
    phi = np.linspace(-1.2, 1.2, 20001)
    middle = 0.5 * (phi[1:] + phi[:-1])
    height = np.append(0.0, np.cumsum(np.diff(phi) * tube / (center + tube * np.cos(middle))))
    phi = np.interp(y / (center + tube), height - height[10000], phi)
    far = center + tube * np.cos(phi)
    angle = x / (center + tube)
    return np.stack([far * np.sin(angle), tube * np.sin(phi), far * np.cos(angle)], axis=-1)


def lattice(turn: float, radius: float = 25e3, apart: float = 0.1, side: float = 20e3) -> Mesh:
    """400 quads of an orthogonal lattice on a dome, turned from its curvature lines [rad].

    Squares of the plane, turned there: their conformal images meet at right angles on the dome.
    """
    along = np.linspace(-side / 2, side / 2, 21)
    u, v = np.meshgrid(along, along, indexing="ij")
    x, y = np.cos(turn) * u - np.sin(turn) * v, np.sin(turn) * u + np.cos(turn) * v
    return grid_mesh(dome(x, y, radius, apart))


if __name__ == "__main__":
    drawn = lattice(np.radians(30))
    before = alignment(drawn)
    print(*(f"{title:16}{text}" for title, text in before.lines()), sep="\n")
    print(*(text for _, text in forecast_lines(mesh_forecast(drawn, before, None))))
    found = dilemma(drawn, nearest=True)
    print(*(f"{title:20}{text}" for title, text in found.change_lines()), sep="\n")
    if len(sys.argv) > 1:
        write_mesh(sys.argv[1], found.mesh, units="mm")
