"""K-nets beside the smooth surfaces of curvature -1 that they tend to, and one of them as a job."""

from __future__ import annotations

import sys
from collections.abc import Callable

import numpy as np

from ddgfab import forms, surfaces
from ddgfab.curvature import skew_curvature, unit_curvature_scale
from ddgfab.mesh import Floats
from ddgfab.nets import knet
from fabrication import design

# Name: the K-net of constant normal angles, the surface at asymptotic parameters.
KINDS: dict[
    str,
    tuple[Callable[[Floats], knet.KNet], Callable[[Floats, Floats], surfaces.KSurface]],
] = {
    "Dini": (lambda a: knet.dini(a, a, 1.2), lambda u, v: surfaces.dini(u, v, 1.2)),
    "breather": (lambda a: knet.breather(a, a, 0.8), lambda u, v: surfaces.breather(u, v, 0.8)),
    "Kuen": (lambda a: knet.kuen(a, a), lambda u, v: surfaces.kuen(u, v)),
}


def distance(name: str, cells: int) -> tuple[float, float]:
    """Greatest distance of a net of the unit square from its surface, and of its K from -1."""
    net, surface = KINDS[name]
    made, at = net(np.full(cells, 1.0 / cells)), np.arange(cells + 1.0) / cells
    gap = np.abs(made.points - surface(at[:, None], at).points).max()
    curvature, _ = skew_curvature(made.points, made.normals)
    return float(gap), float(np.abs(curvature + 1.0).max())


def main() -> None:
    """Print distances and orders, the scale that makes K = -1 exactly, and a basket's parts."""
    sys.stdout.write(f"{'':10}{'x, 16':>9}{'x, 32':>9}{'order':>7}{'K, 16':>9}{'K, 32':>9}\n")
    for name in KINDS:
        (x, k), (finer_x, finer_k) = distance(name, 16), distance(name, 32)
        order = np.log2(x / finer_x)
        sys.stdout.write(f"{name:10}{x:9.1e}{finer_x:9.1e}{order:7.2f}{k:9.1e}{finer_k:9.1e}\n")
    delta = np.radians(14.0)
    angles, r = np.full(8, delta), unit_curvature_scale(delta, delta)
    net = knet.kuen(angles, angles, r=r)
    worst = np.abs(skew_curvature(net.points, net.normals)[0] + 1.0).max()
    sys.stdout.write(f"with r = {r:.6f}, 14 deg to a bar: K = -1 to {worst:.0e}\n")
    mesh = forms.generate("crab", {"twist_deg": 14.0})
    basket = design(
        mesh,
        support={"kind": "normals"},
        beam={"profile": "SHS 50x4", "eccentricity_mm": 25},
        panel={"kind": "none"},
        checks={"torsion_deg": 14.1},
    )
    beams = {row["number"] for row in basket.beams}
    nodes = {row["number"] for row in basket.nodes}
    sys.stdout.write(
        f"a crab net of {len(basket.beams)} bars of {len(beams)} part number and "
        f"{len(basket.nodes)} nodes of {len(nodes)}; torsion "
        f"{basket.support.torsion_deg_max:.1f} deg\n"
    )


if __name__ == "__main__":
    main()
