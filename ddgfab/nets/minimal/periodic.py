"""Minimal surfaces from combinatorics: Scherk's tower, Schwarz' P with its cell, Schwarz' D."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from ddgfab.arguments import checked
from ddgfab.errors import DegenerateError, MeshError
from ddgfab.mesh import Floats, Mesh
from ddgfab.nets.integration import CLOSING
from ddgfab.nets.koebe.polyhedron import KoebePolyhedron, koebe
from ddgfab.nets.koebe.solids import cube_cells, pillow
from ddgfab.nets.minimal.net import MinimalNet, minimal_surface
from ddgfab.nets.sisothermic import SIsothermic
from ddgfab.nets.sisothermic_labels import DoubleCover, double_cover, piece
from ddgfab.quads import whole
from ddgfab.trees import tree_sums

JOIN = 1e-5
"""Vertices of copies nearer than this part of the shortest edge are one."""


def join(parts: Sequence[MinimalNet], moves: Sequence[Floats]) -> MinimalNet:
    """Copies of minimal nets (angle and scale of the first) moved (3,) each and grown together.

    Vertices at one place become one.

    Raises
    ------
    MeshError
        The parts do not make an oriented surface.
    DegenerateError
        Vertices at one place have different normals, so the edges do not fit.
    """
    first = parts[0]
    points = np.concatenate([p.mesh.vertices + m for p, m in zip(parts, moves, strict=True)])
    normals = np.concatenate([p.gauss.mesh.vertices for p in parts])
    radii = np.concatenate([p.gauss.radii for p in parts])
    shift = np.cumsum([0, *(p.mesh.n_vertices for p in parts[:-1])])
    near = JOIN * min(float(p.mesh.edge_lengths.min()) for p in parts)
    from scipy.spatial import KDTree  # heavy: only where it is needed

    pairs = KDTree(points).query_pairs(near, output_type="ndarray").reshape(-1, 2)
    graph = coo_array((np.ones(len(pairs)), tuple(pairs.T)), shape=(len(points),) * 2)
    vertex_of = connected_components(graph, directed=False)[1]
    own = np.unique(vertex_of, return_index=True)[1]
    faces = [
        vertex_of[face + s] for p, s in zip(parts, shift, strict=True) for face in p.mesh.faces
    ]
    mesh = Mesh.build(points[own], faces)
    gauss = SIsothermic(mesh.with_vertices(normals[own]), radii[own])
    turn = np.cos(first.angle) * gauss.mesh.edge_vectors + np.sin(first.angle) * np.cross(
        gauss.contacts, gauss.mesh.edge_vectors
    )
    labels = np.where(np.einsum("ex,ex->e", turn, mesh.edge_vectors) > 0, 1, -1)
    i, j = mesh.edges.T
    wanted = turn * (first.scale * labels / (gauss.radii[i] * gauss.radii[j]))[:, None]
    miss = np.linalg.norm(mesh.edge_vectors - wanted, axis=1)
    closing = float(miss.max()) / mesh.diameter
    if not closing <= CLOSING:
        raise DegenerateError(
            f"the copies do not fit: edge {int(miss.argmax())} misses by {closing:.1e} of the "
            f"diameter (limit {CLOSING:g})"
        )
    return MinimalNet(mesh, gauss, labels, first.angle, first.scale, closing)


def mirrored(net: MinimalNet, axis: int, place: float) -> MinimalNet:
    """The mirror image of a minimal net in the plane where a coordinate has the value `place`."""
    flip = np.ones(3)
    flip[axis] = -1.0
    lists = [face[::-1] for face in net.mesh.faces]
    points = net.mesh.vertices * flip
    points[:, axis] += 2.0 * place
    mesh = Mesh.build(points, lists)
    gauss = SIsothermic(mesh.with_vertices(net.gauss.mesh.vertices * flip), net.gauss.radii)
    labels = np.where(np.einsum("ex,ex->e", mesh.edge_vectors, gauss.mesh.edge_vectors) > 0, 1, -1)
    return MinimalNet(mesh, gauss, labels, net.angle, net.scale, net.closing)


def scherk_koebe(cells: int) -> KoebePolyhedron:
    """Koebe polyhedron of the pillow with cells x cells quads a side, its rim on the equator."""
    rough = pillow(cells)
    return koebe(rough).aligned(rough.vertices)


@checked
def scherk(cells: int, storeys: int = 1) -> MinimalNet:
    """Scherk's tower: one grid of `scherk_koebe` without its corner cells, and mirror copies.

    The four arcs of the boundary lie in horizontal planes, alternately at +h and -h; storeys are
    mirror images in them.

    Raises
    ------
    InputError
        Fewer than three cells or one storey.

    Source: mathematics.md 7.6.
    """
    cells, storeys = whole(cells, 3, "cells on a side of the pillow"), whole(storeys, 1, "storeys")
    solid = scherk_koebe(cells)
    upper = np.arange(solid.mesh.n_faces) < cells**2
    one = minimal_surface(solid.net(upper & (solid.mesh.face_sizes == 4)))
    height = float(one.mesh.vertices[:, 2].max())
    parts = [one]
    for storey in range(1, storeys):
        parts.append(mirrored(parts[-1], 2, height * (2 * storey - 1)))
    return one if storeys == 1 else join(parts, [np.zeros(3)] * storeys)


def schwarz_koebe(cells: int) -> KoebePolyhedron:
    """Koebe polyhedron of the cube with cells x cells quads a side, along the axes."""
    rough = cube_cells(cells)
    return koebe(rough).aligned(rough.vertices)


@checked
def schwarz_p(cells: int) -> MinimalNet:
    """One of the 12 pieces of a cell of Schwarz' P surface: the dual of one side of the cube.

    Its corners are a plane square, whose side is half the period.

    Raises
    ------
    InputError
        Fewer than one cell.

    Source: mathematics.md 7.6.
    """
    cells = whole(cells, 1, "cells on a side of the cube")
    solid = schwarz_koebe(cells)
    return minimal_surface(solid.net(np.arange(solid.mesh.n_faces) >= 5 * cells**2))


@checked
def schwarz_d(cells: int) -> MinimalNet:
    """A piece of Schwarz' D surface: the conjugate of `schwarz_p`."""
    return schwarz_p(cells).associated(0.5 * np.pi)


@dataclass(frozen=True, eq=False)
class PeriodicCell:
    """Twelve pieces of a triply periodic surface, grown together.

    Attributes
    ----------
    net : the pieces as one surface with boundary
    periods : (3, 3) rows: translations under which the surface repeats
    """

    net: MinimalNet
    periods: Floats


@checked
def schwarz_p_cell(cells: int) -> PeriodicCell:
    """A translational cell of Schwarz' P surface: 12 pieces, as three tubes that meet.

    The pieces are the sheets of the branched double cover of the cube, a surface of genus 3; its
    periods are the sides of a cube. The cell has its tubes round the points half a period along
    each axis from the center of a chamber, which is the origin.

    Raises
    ------
    InputError
        Fewer than two cells (the double cover needs them).
    DegenerateError
        The pieces do not close up to multiples of the period.

    Source: mathematics.md 7.5, 7.6.
    """
    cells = whole(cells, 2, "cells on a side of the cube")
    solid = schwarz_koebe(cells)
    cover = double_cover(solid.mesh)
    patch = cover.faces // cells**2 + 6 * cover.sheets
    parts, places = [], []
    for number in range(12):
        part, place = _patch(solid, cover, patch == number)
        parts.append(part)
        places.append(place)
    left, right = cover.mesh.edge_faces.T
    seam = np.flatnonzero(patch[left] != patch[right])
    a, b = patch[left[seam]], patch[right[seam]]
    at = cover.mesh.edges[seam, 0]
    step = np.array([places[i][v] - places[j][v] for i, j, v in zip(a, b, at, strict=True)])
    moves, reached = tree_sums(12, a, b, step)
    if not reached.all():
        raise MeshError("the double cover of the cube falls apart")
    corner = parts[0].mesh.vertices[parts[0].mesh.valences == 2]
    period = 2.0 * float(np.linalg.norm(corner - corner[0], axis=1)[1:].min())
    turns = (moves[b] - moves[a] - step) / period
    if not np.abs(turns - np.rint(turns)).max() <= CLOSING:
        raise DegenerateError(
            "the pieces of Schwarz' P do not close up to its period: "
            f"off by {np.abs(turns - np.rint(turns)).max():.1e} (limit {CLOSING:g})"
        )
    # Corners go to odd multiples of a quarter period. Which of the chambers is at the origin is
    # tried out: the most seams close when three whole tubes lie in the window.
    moves = moves + 0.25 * period - (corner[0] + moves[0])
    best, closed = moves, -1
    for shift in product((0.0, 0.5 * period), repeat=3):
        tried = moves + shift
        window = -0.3 * period
        tried -= period * np.floor((tried - window) / period)
        gap = np.linalg.norm(tried[b] - tried[a] - step, axis=1)
        if (count := int((gap < 0.25 * period).sum())) > closed:
            best, closed = tried, count
    net = join(parts, list(best))
    return PeriodicCell(net, period * np.eye(3))


def _patch(
    solid: KoebePolyhedron, cover: DoubleCover, faces: NDArray[np.bool_]
) -> tuple[MinimalNet, dict[int, Floats]]:
    """Piece of the dual over some faces of the cover, centered; its vertices by their id there."""
    part = piece(cover.mesh, faces)
    gauss = SIsothermic(part.mesh, solid.radii[cover.vertices[part.vertices]])
    net = minimal_surface(gauss)
    # The sign of one edge as the cover has it.
    corner = int(cover.mesh.face_start[part.faces[0]])
    if cover.labels[cover.mesh.corner_edge[corner]] != net.labels[net.mesh.corner_edge[0]]:
        net = minimal_surface(gauss, labels=-net.labels)
    return net, dict(zip(part.vertices.tolist(), net.mesh.vertices, strict=True))
