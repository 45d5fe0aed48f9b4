"""From combinatorics to a gridshell: a Koebe polyhedron, the minimal surface dual to a piece of it,
and its offset at a constant distance of edges, which makes all beams one height."""

from __future__ import annotations

import sys

import numpy as np

from ddgfab.nets.koebe import koebe
from ddgfab.nets.koebe.solids import cube_cells
from ddgfab.nets.minimal import minimal_surface
from ddgfab.offsets import classify_offset
from ddgfab.support import support_structure


def main() -> None:
    """A cube in 6 x 6 cells a side; one side is dualised into a piece of Schwarz' P surface."""
    rough = cube_cells(6)
    solid = koebe(rough).aligned(rough.vertices)
    sys.stdout.write(f"{solid}\nedges touch the sphere to {solid.residuals()['tangency']:.0e}\n")

    net = minimal_surface(solid.net(np.arange(solid.mesh.n_faces) >= 5 * 36))
    net = net.scaled(1500.0 / float(np.median(net.mesh.edge_lengths)))  # millimetres
    sys.stdout.write(f"{net}\ngreatest |H|: {np.abs(net.mean_curvatures()).max():.0e}\n")

    structure = support_structure(net.mesh, "edge")  # found again from the mesh alone
    report = classify_offset(net.mesh, net.offset(-80.0))
    sys.stdout.write(f"{structure}\nlower edges of beams 80 mm high: {report}\n")

    other = net.associated(0.5 * np.pi)  # the conjugate surface, a piece of Schwarz' D
    sys.stdout.write(f"{other}, closing {other.closing:.0e}\n")


if __name__ == "__main__":
    main()
