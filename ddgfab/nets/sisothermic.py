"""s-isothermic nets: faces with incircles that touch, spheres about the vertices; their duals."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.arguments import checked, of_shape
from ddgfab.circles import Circles, Spheres
from ddgfab.errors import DegenerateError
from ddgfab.mesh import Floats, Ints, Mesh, unit
from ddgfab.nets.integration import CLOSING, integrate
from ddgfab.nets.sisothermic_labels import checked_labels, double_cover
from ddgfab.tolerances import NET_INPUT, RELATIVE_DEGENERATE


@dataclass(frozen=True, eq=False, repr=False)
class SIsothermic:
    """A mesh whose faces have incircles, and spheres about its vertices through their contacts.

    Make one with `SIsothermic.of`, which measures; the constructor trusts its arrays. Koebe nets
    (`KoebePolyhedron.net`) and their duals are of this kind.

    Attributes
    ----------
    mesh : planar faces; an edge is as long as the radii of its two spheres together
    radii : (V,) of the spheres about the vertices; zero at vertices without faces
    """

    mesh: Mesh
    radii: Floats

    @staticmethod
    @checked
    def of(mesh: Mesh, tolerance: float = NET_INPUT) -> SIsothermic:
        """The s-isothermic net on a mesh, with the radii that its incircles give.

        Parameters
        ----------
        tolerance : greatest defect in parts of the local edge length

        Raises
        ------
        DegenerateError
            A face that is not planar or has no incircle, or a vertex at which incircles touch its
            edges at different distances; names it, the defect and the limit.

        Source: Bobenko, Pinkall 1999, s-isothermic surfaces; Def. 4.3; mathematics.md 7.3.
        """
        found = tangential(mesh)
        for name, values in found.defects.items():
            worst = int(values.argmax())
            if not values[worst] <= tolerance:
                element = "vertex" if name == "spheres" else "face"
                raise DegenerateError(
                    f"not s-isothermic: {element} {worst} {_SAYS[name]} by {values[worst]:.1e} "
                    f"of its edge length (limit {tolerance:g})"
                )
        return SIsothermic(mesh, found.radii)

    def covered(self) -> SIsothermic:
        """Its branched double cover, whose edges can be labelled; see `double_cover`.

        An odd face winds twice round its incircle, an odd vertex has its edges twice. A net that
        can be labelled comes back in two copies, which are not connected.

        Raises
        ------
        MeshError
            The cover needs a finer mesh.
        """
        cover = double_cover(self.mesh)
        return SIsothermic(cover.mesh, self.radii[cover.vertices])

    @cached_property
    def contacts(self) -> Floats:
        """(E, 3) point of each edge where spheres and incircles touch."""
        i, j = self.mesh.edges.T
        way = (self.radii[i] / (self.radii[i] + self.radii[j]))[:, None]
        return np.asarray((1.0 - way) * self.mesh.vertices[i] + way * self.mesh.vertices[j])

    @cached_property
    def incircles(self) -> Circles:
        """Incircle of each face."""
        found = tangential(self.mesh)
        return Circles(found.centers, self.mesh.face_normals, found.face_radii)

    @property
    def spheres(self) -> Spheres:
        """Sphere about each vertex."""
        return Spheres(self.mesh.vertices, self.radii)

    @cached_property
    def vertex_circles(self) -> Circles | None:
        """Circle through the contact points round each vertex; None where they are not concyclic.

        Koebe nets have them: the second packing. Vertices with two edges or none are left out.
        """
        mesh = self.mesh
        away = np.concatenate([unit(mesh.edge_vectors), -unit(mesh.edge_vectors)])
        at = mesh.edges.T.ravel()
        vertices = np.flatnonzero(mesh.valences > 2)
        axes = np.zeros((mesh.n_vertices, 3))
        for valence in np.unique(mesh.valences[vertices]).tolist():
            ids = np.flatnonzero(mesh.valences == valence)
            edges = mesh.star_edges[mesh.star_start[ids, None] + np.arange(valence)]
            ends = np.where(mesh.edges[edges, 0] == ids[:, None], edges, edges + mesh.n_edges)
            axes[ids] = np.linalg.pinv(away[ends]).sum(axis=-1)
        miss = np.abs(np.einsum("ex,ex->e", away, axes[at]) - 1.0)
        if not miss[mesh.valences[at] > 2].max(initial=0.0) <= NET_INPUT or not len(vertices):
            return None
        axis, r = axes[vertices], self.radii[vertices]
        square = np.einsum("vx,vx->v", axis, axis)
        centers = mesh.vertices[vertices] + axis * (r / square)[:, None]
        return Circles(centers, -unit(axis), r * np.sqrt(np.maximum(1.0 - 1.0 / square, 0.0)))

    def curves(self) -> dict[str, Circles | Spheres]:
        """All its circles and spheres by kind: "incircle", "vertex-circle" (Koebe), "sphere"."""
        found: dict[str, Circles | Spheres] = {"incircle": self.incircles}
        if self.vertex_circles is not None:
            found["vertex-circle"] = self.vertex_circles
        return found | {"sphere": self.spheres}

    def residuals(self) -> dict[str, float]:
        """Greatest defect of each defining condition, in parts of the local edge length.

        planarity : of the faces
        incircles : edges against the tangents to the incircles at their ends
        spheres : tangents from one vertex to all its incircles
        radii : edges against the radii of their two spheres
        """
        i, j = self.mesh.edges.T
        edges = np.abs(self.mesh.edge_lengths - self.radii[i] - self.radii[j])
        found = {name: float(v.max()) for name, v in tangential(self.mesh).defects.items()}
        return found | {"radii": float((edges / self.mesh.edge_lengths).max())}

    @cached_property
    def regular(self) -> bool:
        """Whether inner vertices have four edges and faces an even number of sides (Def. 4.3)."""
        inner = ~self.mesh.boundary_vertex & (self.mesh.valences > 0)
        return bool(
            (self.mesh.valences[inner] == 4).all() and (self.mesh.face_sizes % 2 == 0).all()
        )

    def __repr__(self) -> str:
        return f"SIsothermic({self.mesh!r})"


_SAYS = {
    "planarity": "is off its plane",
    "incircles": "misses an incircle",
    "spheres": "has tangents to its incircles that differ",
}


@dataclass(frozen=True, eq=False)
class Tangential:
    """Incircles that fit the faces of a mesh best; `tangential` makes it.

    Attributes
    ----------
    centers, face_radii : (F, 3), (F,) of the incircles
    lengths : (C,) distance from each corner to its two contact points
    radii : (V,) their means at the vertices
    defects : "planarity" (F,), "incircles" (F,), "spheres" (V,), in parts of local edge lengths
    """

    centers: Floats
    face_radii: Floats
    lengths: Floats
    radii: Floats
    defects: dict[str, Floats]


def tangential(mesh: Mesh) -> Tangential:
    """Incircles of faces by the tangents at their corners: rho cot(alpha / 2) at an angle alpha.

    rho is half the perimeter over the sum of the cotangents, which is exact for tangential
    polygons, convex or winding round their circle several times.

    Raises
    ------
    DegenerateError
        A face without area or with a corner that is straight; names it.

    Source: mathematics.md 7.3.
    """
    first = mesh.face_start[:-1]
    here, ahead = mesh.corners, mesh.corners[mesh.corner_next]
    edge = mesh.edge_lengths[mesh.corner_edge]
    mean = np.add.reduceat(edge, first) / mesh.face_sizes
    flat = np.flatnonzero(mesh.face_areas <= RELATIVE_DEGENERATE * mean**2)
    cotangent = 1.0 / np.tan(np.maximum(mesh.corner_angles, RELATIVE_DEGENERATE) / 2.0)
    straight = np.flatnonzero(cotangent <= RELATIVE_DEGENERATE)
    if len(flat) or len(straight):
        face = int(flat[0] if len(flat) else mesh.corner_face[straight[0]])
        what = "has no area" if len(flat) else f"is straight at vertex {here[straight[0]]}"
        raise DegenerateError(f"face {face} {what}: it has no incircle")
    rho = np.add.reduceat(edge, first) / (2.0 * np.add.reduceat(cotangent, first))
    lengths = rho[mesh.corner_face] * cotangent
    to_next = unit(mesh.vertices[ahead] - mesh.vertices[here])
    to_last = unit(mesh.vertices[mesh.corners[mesh.corner_previous]] - mesh.vertices[here])
    half = mesh.corner_angles / 2.0
    towards = unit(to_next + to_last) * (lengths / np.cos(half))[:, None]
    centers = np.add.reduceat(mesh.vertices[here] + towards, first) / mesh.face_sizes[:, None]
    at = mesh.corner_face
    off = np.abs(np.einsum("cx,cx->c", mesh.vertices[here] - centers[at], mesh.face_normals[at]))
    miss = np.abs(edge - lengths - lengths[mesh.corner_next])
    count = np.maximum(np.bincount(here, minlength=mesh.n_vertices), 1)
    radii = np.bincount(here, lengths, mesh.n_vertices) / count
    local = np.bincount(here, edge, mesh.n_vertices) / count
    spread = np.zeros(mesh.n_vertices)
    np.maximum.at(spread, here, np.abs(lengths - radii[here]))
    return Tangential(
        centers,
        rho,
        lengths,
        radii,
        {
            "planarity": np.maximum.reduceat(off, first) / mean,
            "incircles": np.maximum.reduceat(miss, first) / mean,
            "spheres": np.divide(spread, local, out=np.zeros_like(spread), where=local > 0),
        },
    )


@checked
def dual_face(points: ArrayLike) -> Floats:
    """Corners of the dual of one polygon with an incircle; a polygon with an incircle again.

    With contact points q_j, center c and radius rho: q_j* - c* = (-1)^j (q_j - c) / rho^2, so the
    sides are v*_(j+1) - v*_j = -(-1)^j (v_(j+1) - v_j) / (r_j r_(j+1)). An odd polygon closes
    only after two turns.

    Parameters
    ----------
    points : (n, 3), planar

    Returns
    -------
    (n, 3), or (2 n, 3) for odd n: corners about the center c* = 0

    Raises
    ------
    DegenerateError
        The polygon has no incircle.

    Source: equations (16), (17) as corrected in mathematics.md 7.4.
    """
    polygon = of_shape(points, (None, 3), "points")
    net = SIsothermic.of(Mesh.build(polygon, [list(range(len(polygon)))]))
    circle, r = net.incircles, net.radii
    turns = 1 + len(polygon) % 2
    corner = np.arange(turns * len(polygon))
    # The side from corner j runs through q_j: from its contact on, half a side to v*_(j+1).
    j, last = corner % len(polygon), (corner - 1) % len(polygon)
    sign = np.where(corner % 2, -1.0, 1.0)[:, None]
    contact = polygon[j] + unit(polygon[(j + 1) % len(polygon)] - polygon[j]) * r[j, None]
    foot = sign * (contact - circle.centers[0]) / circle.radii[0] ** 2
    side = unit(polygon[j] - polygon[last])  # of the side before, whose sign is the other
    before = polygon[j] - side * r[j, None]
    foot_before = -sign * (before - circle.centers[0]) / circle.radii[0] ** 2
    from_next = foot + sign * unit(polygon[(j + 1) % len(polygon)] - polygon[j]) / r[j, None]
    from_last = foot_before + sign * side / r[j, None]
    return np.asarray(0.5 * (from_next + from_last))


@dataclass(frozen=True, eq=False)
class Dual:
    """The dual of an s-isothermic net.

    Attributes
    ----------
    net : the dual, with radii 1 / r
    labels : (E,) +1 and -1, alternating round every face
    closing : how far the worst edge is from closing, in parts of the diameter
    """

    net: SIsothermic
    labels: Ints
    closing: float


@checked
def dual(net: SIsothermic, labels: Ints | None = None, tolerance: float = CLOSING) -> Dual:
    """The dual s-isothermic net: edges e / (r_i r_j) with alternating signs, spheres 1 / r.

    Parameters
    ----------
    labels : (E,) +1 and -1 alternating round every face; found by default (`label_edges`)
    tolerance : by which the worst edge may miss, in parts of the size; nets from files with few
        digits need more than the default

    Raises
    ------
    InputError
        Labels of another shape, or others than +1 and -1.
    MeshError
        No labelling exists: names the faces; or the mesh has several components.
    DegenerateError
        The edges do not close: the net is not s-isothermic, or its dual has a period round a hole.

    Source: mathematics.md 7.4, 7.5.
    """
    signs = checked_labels(net.mesh, labels)
    i, j = net.mesh.edges.T
    scale = signs / (net.radii[i] * net.radii[j])
    points, closing = integrate(net.mesh, scale[:, None] * net.mesh.edge_vectors, tolerance)
    radii = np.divide(1.0, net.radii, out=np.zeros_like(net.radii), where=net.radii > 0)
    return Dual(SIsothermic(net.mesh.with_vertices(points), radii), signs, closing)
