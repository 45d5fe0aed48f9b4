"""Pictures of docs/knets.md: K-nets beside the smooth surfaces that they tend to.

python docs/pictures_knets.py [NAME ...]

On the smooth side the lines are asymptotic lines, as many steps apart as those of the net.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from pictures_minimal import BACK, GLASS, LINE, PANEL, STYLE, draw_mesh, panel, surface
from scipy.spatial import cKDTree

from ddgfab.forms.registry import find_generator, generate
from ddgfab.grid import grid_mesh
from ddgfab.mesh import Floats, Mesh
from ddgfab.nets.knet import crab_net
from ddgfab.surfaces import amsler, breather, dini, kuen, pseudosphere, rotational_lines

FOLDER = Path(__file__).parent / "knets"
FINE = 6
Lattice = Callable[[Floats, Floats], Floats]


@dataclass(frozen=True)
class Sheet:
    """A smooth surface as fine mesh, polylines on it, and where known the net's own points."""

    mesh: Mesh
    lines: list[Floats]
    nodes: Floats | None = None


def rectangle(points: Lattice, first: tuple[int, int], second: tuple[int, int]) -> Sheet:
    """A surface at parameters (i, j) with every whole i and j as line."""
    i, j = (np.linspace(*ends, FINE * (ends[1] - ends[0]) + 1) for ends in (first, second))
    x = points(i[:, None], j)
    lines = [*x[::FINE], *x.transpose(1, 0, 2)[::FINE]]
    return Sheet(grid_mesh(x), lines, x[::FINE, ::FINE].reshape(-1, 3))


def band(points: Lattice, across: tuple[int, int], along: tuple[int, int]) -> Sheet:
    """A surface at parameters (i, j) within limits of j - i and i + j."""
    p, s = (np.linspace(*ends, FINE * (ends[1] - ends[0]) + 1) for ends in (across, along))
    p, s = p[:, None], s[None]
    lines = []
    for side in (1, -1):  # lines of constant i, then of constant j
        for c in range(along[0] - across[1], along[1] + across[1] + 1):
            if (c - along[0] - side * across[0]) % 2:
                continue
            low, high = sorted((side * (along[0] - c), side * (along[1] - c)))
            a, b = max(low, across[0]), min(high, across[1])
            if b > a:
                q = np.linspace(a, b, FINE * (b - a) + 1)
                t = c + side * q
                lines.append(points(0.5 * (t - q), 0.5 * (t + q)))
    return Sheet(grid_mesh(points(0.5 * (s - p), 0.5 * (s + p))), lines)


def values(kind: str, given: dict[str, float]) -> dict[str, Any]:
    """Parameters of a kind, the others at their defaults."""
    return {p.name: p.default for p in find_generator(kind).parameters} | given


def of_pseudosphere(given: dict[str, float]) -> Sheet:
    at = values("pseudosphere", given)
    alpha = np.pi / at["panels_around"]

    def points(i: Floats, j: Floats) -> Floats:
        return pseudosphere(alpha * i, alpha * j).points * [1.0, -1.0, -1.0]

    across = at["base_ring"], at["base_ring"] + at["rings"] + 1
    return band(points, across, (0, 2 * at["panels_around"]))


def of_dini(given: dict[str, float]) -> Sheet:
    at = values("dini", given)
    sigma = np.radians(90.0 - at["pitch_deg"])
    alpha = np.radians(at["twist_deg"])
    beta = np.tan(0.5 * sigma) ** 2 * alpha

    def points(i: Floats, j: Floats) -> Floats:
        return dini(alpha * i, beta * j, sigma).points * [1.0, -1.0, -1.0]

    last = at["base_line"] + at["rows"] + 1
    return band(points, (at["base_line"], last), (last, 2 * at["panels_along"] + last))


def middle(at: dict[str, Any]) -> tuple[int, tuple[int, int], tuple[int, int]]:
    """Half the rows, and the band of a net that is symmetric about its middle."""
    side = (at["rows"] + 2) // 2
    return side, (-side, at["rows"] + 1 - side), (side, side + 2 * at["panels_along"])


def of_breather(given: dict[str, float]) -> Sheet:
    at = values("breather", given)
    delta, tau = np.radians(at["twist_deg"]), float(np.arctanh(at["waves"]))
    side, across, along = middle(at)
    phase = np.radians(at["phase_deg"]) + (side + at["panels_along"]) * at["waves"] * delta

    def points(i: Floats, j: Floats) -> Floats:
        return breather(delta * i, delta * j, tau, complex(np.exp(1j * phase))).points

    return band(points, across, along)


def of_kuen(given: dict[str, float]) -> Sheet:
    at = values("kuen", given)
    delta = np.radians(at["twist_deg"])
    side, across, along = middle(at)

    def points(i: Floats, j: Floats) -> Floats:
        return kuen(delta * i, delta * j, (side - at["first_row"]) * delta).points

    return band(points, across, along)


def of_crab(given: dict[str, float]) -> Sheet:
    """The waisted surface of the net's own waist; its asymptotic lines turn by du / z'."""
    at = values("crab", given)
    count = at["panels_around"]
    net = crab_net(count, np.radians(at["twist_deg"]), np.radians(at["slope_deg"]), at["rings"] + 2)
    waist = float(np.sqrt(net.radii[0] ** 2 - np.cos(net.thetas[0]) ** 2))
    start, end = (-np.arcsinh(np.cos(net.thetas[k]) / waist) for k in (0, -1))
    u = np.linspace(start, end, 2001)
    slope = 1.0 / np.sqrt(1.0 - (waist * np.sinh(u)) ** 2)
    turn = np.concatenate([[0.0], np.cumsum(0.5 * (slope[1:] + slope[:-1]) * np.diff(u))])
    turn *= (at["rings"] + 1) / turn[-1]

    def points(i: Floats, j: Floats) -> Floats:
        return rotational_lines(np.interp(j - i, turn, u), np.pi / count * (i + j), waist)

    return band(points, (0, at["rings"] + 1), (0, 2 * count))


def of_amsler(given: dict[str, float]) -> Sheet:
    at = values("amsler", given)
    delta, m, n = np.radians(at["twist_deg"]), at["panels_along"], at["panels_across"]

    def points(i: Floats, j: Floats) -> Floats:
        return amsler(delta * i[:, 0], delta * j, np.radians(at["crossing_deg"])).points

    return rectangle(points, (-m, m), (-n, n))


def of_knet(given: dict[str, float]) -> Sheet:
    """A net of the same boundary with steps a sixth as long."""
    at = values("knet", given)
    for name in ("twist_deg", "across_twist_deg", "bar_mm"):
        at[name] /= FINE
    for name in ("panels_along", "panels_across"):
        at[name] *= FINE
    mesh = generate("knet", at)
    x = mesh.vertices.reshape(at["panels_along"] + 1, at["panels_across"] + 1, 3)
    return Sheet(mesh, [*x[::FINE], *x.transpose(1, 0, 2)[::FINE]])


# Name: the kind, its smooth surface, parameters that are not the defaults, where the eye is.
GALLERY: dict[
    str,
    tuple[str, Callable[[dict[str, float]], Sheet], dict[str, float], tuple[float, float, float]],
] = {
    "crab": ("crab", of_crab, {}, (0.3, -1.0, 0.4)),
    "pseudosphere": ("pseudosphere", of_pseudosphere, {}, (0.3, -1.0, 0.3)),
    "dini": ("dini", of_dini, {}, (0.5, -1.0, 0.3)),
    "breather": ("breather", of_breather, {}, (0.4, -1.0, 0.5)),
    "breather_whole": (
        "breather",
        of_breather,
        {"panels_along": 50, "rows": 33, "phase_deg": 0.0},
        (0.3, -1.0, 0.7),
    ),
    "kuen": ("kuen", of_kuen, {}, (0.3, -1.0, 0.3)),
    "kuen_whole": (
        "kuen",
        of_kuen,
        {"panels_along": 60, "rows": 33, "first_row": -60},
        (1.0, 0.2, 0.25),
    ),
    "amsler": ("amsler", of_amsler, {}, (0.4, -1.0, 0.6)),
    "knet": ("knet", of_knet, {}, (0.4, -1.0, 0.55)),
}


def moved(sheet: Sheet, onto: Mesh) -> Sheet:
    """The sheet by the similarity that brings its principal axes and size to those of a mesh.

    Of the four right-handed ways the one nearest to the mesh; both must have one shape. Where the
    net's points are known on the sheet, the motion nearest to them (Kabsch).
    """
    if sheet.nodes is not None:
        a, b = sheet.nodes.mean(axis=0), onto.vertices.mean(axis=0)
        u, sizes, v = np.linalg.svd((sheet.nodes - a).T @ (onto.vertices - b))
        handed = np.array([1.0, 1.0, np.linalg.det(u @ v)])
        scale = (sizes @ handed) / ((sheet.nodes - a) ** 2).sum()
        return placed(sheet, onto, a, b, scale * (u * handed) @ v)
    x, y = sheet.mesh.vertices, onto.vertices
    weight = np.zeros(len(x))
    np.add.at(weight, sheet.mesh.corners, np.repeat(sheet.mesh.face_areas / 4, 4))
    other = np.zeros(len(y))
    np.add.at(other, onto.corners, np.repeat(onto.face_areas / 4, 4))

    def moments(points: Floats, mass: Floats) -> tuple[Floats, Floats, float]:
        center = mass @ points / mass.sum()
        away = points - center
        spread, axes = np.linalg.eigh((away * mass[:, None]).T @ away / mass.sum())
        return center, axes, float(np.sqrt(spread.sum()))

    (a, p, small), (b, q, large) = moments(x, weight), moments(y, other)
    best: tuple[float, Floats] | None = None
    for signs in ((1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)):
        handed = np.diag(signs) * [1, 1, np.linalg.det(p) * np.linalg.det(q)]
        turn = p @ handed @ q.T
        gap = float(cKDTree(large / small * (x - a) @ turn + b).query(y)[0].mean())
        if best is None or gap < best[0]:
            best = gap, turn
    assert best is not None
    return placed(sheet, onto, a, b, large / small * best[1])


def placed(sheet: Sheet, onto: Mesh, a: Floats, b: Floats, turn: Floats) -> Sheet:
    """The sheet moved from a to b, its faces on the side of the mesh's."""
    there = sheet.mesh.with_vertices((sheet.mesh.vertices - a) @ turn + b)
    near = cKDTree(onto.vertices).query(there.vertices)[1]
    if np.einsum("vx,vx->", there.vertex_normals, onto.vertex_normals[near]) < 0:
        there = Mesh.build(there.vertices, [face[::-1] for face in there.faces])
    return Sheet(there, [(line - a) @ turn + b for line in sheet.lines])


def draw_sheet(show: Any, sheet: Sheet, towards: Floats) -> None:
    """The surface smoothly shaded, its lines a little nearer to the eye."""
    import pyvista

    show.add_mesh(surface(sheet.mesh), color=GLASS, backface_params={"color": BACK}, **STYLE)
    ahead = 0.004 * sheet.mesh.diameter * towards / np.linalg.norm(towards)
    segments = [np.stack([x[:-1], x[1:]], axis=1).reshape(-1, 3) for x in sheet.lines]
    lines = pyvista.line_segments_from_points(np.concatenate(segments) + ahead)
    show.add_mesh(lines, color=LINE, line_width=1.3, lighting=False)


def pair(name: str) -> tuple[Mesh, Sheet]:
    """A K-net and the smooth surface, in one place."""
    kind, smooth, given, _ = GALLERY[name]
    net = generate(kind, given)
    return net, moved(smooth(given), net)


def picture(name: str) -> Path:
    """The net on the left, the surface on the right."""
    from PIL import Image

    net, sheet = pair(name)
    towards = np.array(GALLERY[name][3])
    both = np.concatenate([net.vertices, sheet.mesh.vertices])
    images = [
        panel(lambda show: draw_mesh(show, net, towards), both, towards),
        panel(lambda show: draw_sheet(show, sheet, towards), both, towards),
    ]
    whole = Image.new("RGB", (PANEL[0] * 2, PANEL[1]), "white")
    for k, image in enumerate(images):
        whole.paste(image, (PANEL[0] * k, 0))
    FOLDER.mkdir(exist_ok=True)
    target = FOLDER / f"{name}.png"
    whole.quantize(96).save(target, optimize=True)
    return target


def main() -> None:
    """Draw the pictures named, or all."""
    for name in sys.argv[1:] or GALLERY:
        path = picture(name)
        sys.stdout.write(f"{path.name}: {path.stat().st_size // 1024} kB\n")


if __name__ == "__main__":
    main()
