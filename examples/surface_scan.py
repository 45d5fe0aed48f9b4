"""From a noisy scan to a net of planar panes: fit, trace, optimise, and what it costs.

python examples/surface_scan.py [net.obj]
"""

import sys

import numpy as np

from ddgfab.grid import grid_mesh
from ddgfab.io import write_mesh
from ddgfab.measures import planarity_percent
from ddgfab.mesh import Mesh
from ddgfab.optimize import optimize
from ddgfab.redesign.retrace import retrace


def scan(noise_mm: float = 2.0, seed: int = 1) -> Mesh:
    """3000 points of a roof of 20 x 14 m, triangulated, with noise in all directions."""
    rng = np.random.default_rng(seed)
    u, v = np.meshgrid(np.linspace(-10e3, 10e3, 60), np.linspace(-7e3, 7e3, 50), indexing="ij")
    z = 2600 * (1 - 0.7 * (v / 7e3) ** 2 - 0.3 * (u / 10e3) ** 2) + 200 * np.sin(u / 4e3)
    quads = grid_mesh(np.stack([u, v, z], axis=-1) + noise_mm * rng.normal(size=(*u.shape, 3)))
    faces = [t for a, b, c, d in quads.faces for t in ((a, b, c), (a, c, d))]
    return Mesh.build(quads.vertices, faces)


if __name__ == "__main__":
    found = retrace(scan(), 1500.0, name="scan")
    print(*found.notes(), sep="\n")
    result = optimize(found.mesh, keep="close", surface=found.reference, rim=found.reference)
    print(f"planar to {planarity_percent(result.mesh).max():.2g} %")
    print(found.distance_note(scan(), result.mesh))
    if len(sys.argv) > 1:
        write_mesh(sys.argv[1], result.mesh, units="mm")
