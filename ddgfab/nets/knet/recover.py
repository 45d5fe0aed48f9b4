"""Normals, angles and turns of a K-net that is given by its points, and how far it is from one.

Source: mathematics.md 3.1, 3.2, 3.5: normals are those of the planar vertex stars, their signs
those for which every edge is a positive multiple of m_k x m.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.arguments import checked
from ddgfab.errors import InputError
from ddgfab.mesh import Floats, Mesh
from ddgfab.net import Net
from ddgfab.nets.asymptotic import lelieuvre_edges, star_flatness, tangent_normals
from ddgfab.nets.knet.net import CauchyData, KNet
from ddgfab.nets.knet.oriented import oriented_angle
from ddgfab.quads import layer, net_points

KNET_DEFECT = 1e-2
"""Points count as a K-net when no vertex misses a condition by more than this, relative.

The scale of a fine net reacts most: it compares normals of neighbouring stars, which noise of the
points turns by noise / edge, to their small angle. Other Chebyshev nets miss it by about one."""

NAMED_VERTICES = 5
"""How many of the worst vertices an error names."""


@dataclass(frozen=True, eq=False, repr=False)
class KNetRecovery:
    """What `recover_knet` found.

    Attributes
    ----------
    knet : the exact K-net of the data, laid onto the given points by a rigid motion
    data : its Cauchy data
    points : (n1, ..., nd, 3) given points in the order of `knet`
    swapped : whether directions 0 and 1 were exchanged, so that direction 0 has positive twist
    defects : by name (n1, ..., nd), relative defects of the given points at every vertex: flatness
        of its star; length of its edges against the mean of their strip; scale: sines of normal
        angles against length / r
    distances : (n1, ..., nd) from the given points to `knet`
    """

    knet: KNet
    data: CauchyData
    points: Floats
    swapped: bool
    defects: dict[str, Floats]
    distances: Floats

    @property
    def vertex_defect(self) -> Floats:
        """(n1, ..., nd) greatest of the defects at every vertex."""
        return np.asarray(np.max(list(self.defects.values()), axis=0))

    @property
    def defect(self) -> float:
        """Greatest of all relative defects."""
        return float(self.vertex_defect.max())

    @property
    def distance(self) -> float:
        """Greatest distance of the given points from the exact K-net."""
        return float(self.distances.max())

    def __repr__(self) -> str:
        return (
            f"KNetRecovery({self.knet!r}, defect {self.defect:.1e}, distance {self.distance:.1e})"
        )


@checked
def recover_knet(source: Mesh | Net | ArrayLike, *, limit: float = KNET_DEFECT) -> KNetRecovery:
    """Data of a K-net that is given by its points, the exact K-net of these data, and the defect.

    Parameters
    ----------
    source : quad mesh that is a grid, net (closed directions are cut open), or points
        (n1, ..., nd, 3)
    limit : greatest relative defect of a vertex

    Raises
    ------
    InputError
        No K-net: names the worst vertices, their defect and what it is of. Fewer than two edges in
        a direction (a single row of quads has no planar stars to test).
    MeshError
        A mesh that is not a grid of quads.
    DegenerateError
        An edge of no length, a vertex whose edges are all parallel; names it.

    Source: mathematics.md 3.1, 3.5.
    """
    x = _points(source)
    if min(x.shape[:-1]) < 2:
        raise InputError(f"a K-net has two points or more in each direction; this one {x.shape}")
    m = _signed(x, tangent_normals(x))
    cosines = [float(np.mean(_products(m, k))) for k in range(m.ndim - 1)]
    swapped = m.ndim == 3 and cosines[0] > 0 > cosines[1]
    if swapped:
        x, m = np.swapaxes(x, 0, 1), np.swapaxes(m, 0, 1)
        cosines = cosines[::-1]
    lengths, sines = _edges(x, m)
    r = _scale(lengths, sines)
    defects = _defects(x, lengths, sines, r)
    worst = np.max(list(defects.values()), axis=0)
    if not worst.max() <= limit:
        raise InputError(_refusal(source, x, worst, defects, limit))
    data = _cauchy(x, m, lengths, r, cosines)
    made, data = _laid_onto(data, x)
    distances = np.sqrt(np.einsum("...i,...i->...", made.points - x, made.points - x))
    return KNetRecovery(made, data, x, swapped, defects, distances)


@checked
def knet_from_mesh(mesh: Mesh, *, limit: float = KNET_DEFECT) -> KNet:
    """The exact K-net next to a mesh; `recover_knet` also gives the distance."""
    return recover_knet(mesh, limit=limit).knet


def _points(source: Mesh | Net | ArrayLike) -> Floats:
    if isinstance(source, Mesh):
        # ddgfab.net makes meshes by ddgfab.grid, and so imports this package first.
        from ddgfab.net import Net

        source = Net.from_mesh(source)
    return net_points(np.asarray(source), 3)


def _products(m: Floats, axis: int) -> Floats:
    rows = np.moveaxis(m, axis, 0)
    return np.asarray(np.einsum("...i,...i->...", rows[1:], rows[:-1]))


def _signed(x: Floats, nu: Floats) -> Floats:
    """Normals with signs for which edges are positive multiples of m_k x m, along the axes."""
    d = x.ndim - 1
    m = nu.copy()
    for k in range(d):
        part = layer(d, k, slice(None))
        edges = np.diff(x[part], axis=k)
        way = np.einsum("...i,...i->...", lelieuvre_edges(nu[part], k), edges)
        # An edge across both normals fits neither sign; its defect will show it.
        signs = np.cumprod(np.where(way < 0, -1.0, 1.0), axis=k)
        start = layer(d, k, slice(0, 1))
        first = np.sign(np.einsum("...i,...i->...", m[start], nu[start]))
        rest = layer(d, k, slice(1, None))
        m[rest] = nu[rest] * (first * signs)[..., None]
    return m


def _edges(x: Floats, m: Floats) -> tuple[list[Floats], list[Floats]]:
    """Lengths of edges and signed sines of their normal angles, by direction."""
    lengths, sines = [], []
    for k in range(x.ndim - 1):
        edges = np.diff(x, axis=k)
        length = np.sqrt(np.einsum("...i,...i->...", edges, edges))
        lengths.append(length)
        sines.append(np.einsum("...i,...i->...", lelieuvre_edges(m, k), edges) / length)
    return lengths, sines


def _scale(lengths: list[Floats], sines: list[Floats]) -> float:
    """r by least squares from length = r sine."""
    over = sum(float(np.sum(a * s)) for a, s in zip(lengths, sines, strict=True))
    under = sum(float(np.sum(s * s)) for s in sines)
    if not over > 0:
        raise InputError(
            "no K-net: the normals do not turn about the edges, or as much one way as the other "
            f"(sum of length times sine {over:.3g}; a positive number is needed)"
        )
    return over / under


def _defects(x: Floats, lengths: list[Floats], sines: list[Floats], r: float) -> dict[str, Floats]:
    d = x.ndim - 1
    length, scale = np.zeros(x.shape[:-1]), np.zeros(x.shape[:-1])
    for k in range(d):
        others = tuple(a for a in range(d) if a != k)
        mean = lengths[k].mean(axis=others, keepdims=True)
        values = (
            (length, np.abs(lengths[k] / mean - 1.0)),
            (scale, np.abs(r * sines[k] / lengths[k] - 1.0)),
        )
        for field, value in values:
            rows, edges = np.moveaxis(field, k, 0), np.moveaxis(value, k, 0)
            rows[:-1] = np.maximum(rows[:-1], edges)
            rows[1:] = np.maximum(rows[1:], edges)
    return {"flatness": star_flatness(x), "length": length, "scale": scale}


def _refusal(
    source: Mesh | Net | ArrayLike,
    x: Floats,
    worst: Floats,
    defects: dict[str, Floats],
    limit: float,
) -> str:
    order = np.argsort(-worst, axis=None, kind="stable")[:NAMED_VERTICES]
    named = []
    for flat in order:
        at = tuple(int(i) for i in np.unravel_index(int(flat), worst.shape))
        name = str(at)
        if isinstance(source, Mesh):
            name = str(int(np.argmin(np.linalg.norm(source.vertices - x[at], axis=1))))
        kind = max(defects, key=lambda key: float(defects[key][at]))
        named.append(f"{name}: {worst[at]:.3g} ({kind})")
    bad = int((worst > limit).sum())
    return (
        f"no K-net: {bad} of {worst.size} vertices miss its conditions by more than {limit:g}, "
        f"relative; the worst are\n  {', '.join(named)}\n(flatness of the star; length of "
        "edges of a strip; scale: sine of the normals' angle over length)"
    )


def _cauchy(
    x: Floats, m: Floats, lengths: list[Floats], r: float, cosines: list[float]
) -> CauchyData:
    d = x.ndim - 1
    n = m * ((-1.0) ** np.arange(m.shape[0])).reshape(-1, *(1,) * d)
    deltas, turns, first = [], [], []
    for k in range(d):
        sine = np.moveaxis(lengths[k], k, 0).reshape(x.shape[k] - 1, -1).mean(axis=1) / r
        cosine = _products(n, k).reshape(x.shape[k] - 1, -1).mean(axis=1)
        # The better conditioned of sine and cosine; bounds are for the one that is not taken.
        acute = np.arcsin(np.minimum(sine, 1.0))
        by_sine = np.where(cosine < 0, np.pi - acute, acute)
        deltas.append(np.where(sine < np.abs(cosine), by_sine, np.arccos(np.clip(cosine, -1, 1))))
        line = tuple(slice(None) if a == k else 0 for a in range(d))
        e = np.diff(x[line], axis=0)
        turns.append(oriented_angle(n[line][1:-1], e[:-1], e[1:]))
        first.append(e[0])
    origin = (0,) * d
    corners = [float(oriented_angle(n[origin], first[0], e)) for e in first[1:]]
    return CauchyData(
        tuple(deltas), tuple(turns), np.array(corners), r, x[origin], n[origin], first[0]
    )


def _laid_onto(data: CauchyData, x: Floats) -> tuple[KNet, CauchyData]:
    """The net of the data after the rigid motion nearest to points, and the data moved likewise."""
    y = data.build().points.reshape(-1, 3)
    target = x.reshape(-1, 3)
    middle, goal = y.mean(axis=0), target.mean(axis=0)
    u, _, v = np.linalg.svd((y - middle).T @ (target - goal))
    # A rotation, not a reflection: Kabsch 1978.
    u[:, -1] *= np.sign(np.linalg.det(u) * np.linalg.det(v))
    turn = u @ v
    moved = replace(
        data,
        origin=(data.origin - middle) @ turn + goal,
        normal=data.normal @ turn,
        edge=data.edge @ turn,
    )
    return moved.build(), moved
