"""The close-up in the preview: which node it shows, with which pieces, seen from where."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Final

import numpy as np

from ddgfab.mesh import Floats, Ints
from fabrication.specs import Color, Family, Form, Kind, Placement, TriangleMesh

RISE_DEG: Final = 35.0
"""Height of the eye above the plane normal to the node's axis [deg]."""

FIELD_DEG: Final = 22.0
"""Field of view of the close-up [deg]."""

REACH: Final = 2.7
"""Radius of what is shown, in radii of the sphere about the node."""

_STRAIGHT: Final = 1e-6  # an eye nearer to the axis than this angle [rad] is on it
_CENTRAL: Final = 2.0  # weight of being in the middle against facing the eye
_VALENCE: Final = 4  # arms that make a node worth showing; more are no better
_ASIDE: Final = 0.13  # how far the eye turns from between two beams to one of them
_PULLED: Final = 0.75  # how far the other one is pulled off its seat, in node diameters


@dataclass(frozen=True, eq=False)
class PlacedMesh:
    """A piece in the world: its kind, whether it failed a check, its mesh [mm]."""

    kind: Kind
    failed: bool
    placement: Placement
    vertices: Floats
    triangles: Ints

    @property
    def form(self) -> Form:
        """How it is drawn."""
        return self.kind.form


@dataclass(frozen=True, eq=False)
class View:
    """A camera: position, focal point [mm], up vector and vertical field of view [deg]."""

    position: Floats
    focus: Floats
    up: Floats
    field_deg: float


@dataclass(frozen=True, eq=False)
class Closeup:
    """What the close-up shows: pieces, view, and the sphere it pictures (middle, radius) [mm]."""

    pieces: tuple[PlacedMesh, ...]
    view: View
    middle: Floats
    radius: float


def placed(
    families: Sequence[Family],
    meshes: Mapping[str, TriangleMesh],
    failed: frozenset[str],
    colors: Mapping[str, Color] = MappingProxyType({}),
) -> list[PlacedMesh]:
    """Every piece where it stands, in the order of the families.

    `colors` are those of part numbers that have another one than their kind.
    """
    pieces: list[PlacedMesh] = []
    for family in families:
        mesh, kind = meshes[family.number], family.kind
        if family.number in colors:
            kind = replace(kind, shown=colors[family.number])
        for instance in family.instances:
            motion = instance.placement
            red = instance.mark in failed
            vertices = mesh.vertices @ motion[:3, :3].T + motion[:3, 3]
            pieces.append(PlacedMesh(kind, red, motion, vertices, mesh.triangles))
    return pieces


def merged(pieces: Sequence[PlacedMesh]) -> dict[tuple[Kind, bool], tuple[Floats, Ints]]:
    """Vertices and triangles of the pieces of a kind that failed, or did not: by (kind, failed)."""
    groups: dict[tuple[Kind, bool], list[PlacedMesh]] = {}
    for piece in pieces:
        groups.setdefault((piece.kind, piece.failed), []).append(piece)
    return {key: joined(group) for key, group in groups.items()}


def joined(pieces: Sequence[PlacedMesh]) -> tuple[Floats, Ints]:
    """Vertices and triangles of pieces as one mesh."""
    sizes = [len(p.vertices) for p in pieces]
    shift = np.repeat(np.cumsum([0, *sizes[:-1]]), [len(p.triangles) for p in pieces])
    triangles = np.concatenate([p.triangles for p in pieces]) + shift[:, None]
    return np.concatenate([p.vertices for p in pieces]), triangles


def closeup(pieces: Sequence[PlacedMesh], eye: Floats) -> Closeup | None:
    """The joint that shows best how the parts meet, as seen by who looks from `eye`.

    Among the joints with four bars or more and a sheet in each corner (or else those with most),
    the one nearest to the middle of the structure whose outside faces the eye. None: no joint has
    a bar.
    """
    nodes = [p for p in pieces if p.form == "joint"]
    others = [p for p in pieces if p.form != "joint"]
    if not nodes or not others:
        return None
    middles = np.array([(p.vertices.min(axis=0) + p.vertices.max(axis=0)) / 2 for p in nodes])
    ends = _ends(others, middles)
    beams = np.zeros(len(nodes), dtype=np.int64)
    panels = np.zeros(len(nodes), dtype=np.int64)
    for piece, at in zip(others, ends, strict=True):
        beams[at] += piece.form == "bar"
        panels[at] += piece.form == "sheet"
    if not beams.any():
        return None
    rank = np.where(beams > 0, np.minimum(beams, _VALENCE) + np.minimum(panels, _VALENCE), -1)
    towards = eye - middles
    towards /= np.linalg.norm(towards, axis=1)[:, None]
    facing = np.einsum("ij,ij->i", towards, np.array([p.placement[:3, 2] for p in nodes]))
    away = np.linalg.norm(middles - middles.mean(axis=0), axis=1)
    score = facing - _CENTRAL * away / (float(away.max()) or 1.0)
    best = int(np.lexsort((-score, -rank))[0])
    touching = [p for p, at in zip(others, ends, strict=True) if best in at]
    far = {int(i) for p, at in zip(others, ends, strict=True) if best in at for i in at} - {best}
    opened, view = _opened(nodes[best], middles[best], touching, eye)
    radius = REACH * float(np.linalg.norm(np.ptp(nodes[best].vertices, axis=0))) / 2
    shown = (nodes[best], *opened, *(nodes[i] for i in sorted(far)))
    return Closeup(shown, _at(middles[best], radius, view), middles[best], radius)


def _ends(pieces: Sequence[PlacedMesh], middles: Floats) -> list[Ints]:
    """For each piece the nodes at its corners: those nearest to one of its vertices."""
    from scipy.spatial import KDTree

    _, nearest = KDTree(middles).query(np.concatenate([p.vertices for p in pieces]))
    cuts = np.cumsum([len(p.vertices) for p in pieces])[:-1]
    return [np.unique(part) for part in np.split(nearest, cuts)]


def _opened(
    node: PlacedMesh, middle: Floats, touching: Sequence[PlacedMesh], eye: Floats
) -> tuple[list[PlacedMesh], tuple[Floats, Floats]]:
    """The pieces at a node opened towards the eye, and the directions back to the eye and up.

    The eye is above the node's outside, between the two beams that are nearest to where the whole
    is seen from. The pane between them is left out, and one of them is pulled off its seat.
    """
    axis = node.placement[:3, 2]
    y = np.cross(axis, eye - middle)
    if np.linalg.norm(y) < _STRAIGHT * np.linalg.norm(eye - middle):
        y = node.placement[:3, 1]
    y = y / np.linalg.norm(y)
    x = np.cross(y, axis)

    def azimuth(piece: PlacedMesh) -> float:
        out = piece.vertices.mean(axis=0) - middle
        return float(np.arctan2(out @ y, out @ x))

    arms = sorted((p for p in touching if p.form == "bar"), key=azimuth)
    angles = np.array([azimuth(p) for p in arms])
    gaps = np.diff(np.append(angles, angles[0] + 2 * np.pi))
    between = angles + gaps / 2
    between = np.arctan2(np.sin(between), np.cos(between))
    front = int(np.argmin(np.abs(between)))
    turn = between[front] - _ASIDE * gaps[front]
    rise = np.radians(RISE_DEG)
    back = np.cos(rise) * (np.cos(turn) * x + np.sin(turn) * y) + np.sin(rise) * axis

    panes = [p for p in touching if p.form == "sheet"]
    kept = panes
    if len(panes) > 1:
        off = [abs(np.angle(np.exp(1j * (azimuth(p) - between[front])))) for p in panes]
        kept = [p for i, p in enumerate(panes) if i != int(np.argmin(off))]
    pulled = arms[(front + 1) % len(arms)]
    along = pulled.placement[:3, 0] * np.sign(
        (pulled.vertices.mean(axis=0) - middle) @ pulled.placement[:3, 0]
    )
    local = node.vertices - node.placement[:3, 3]
    diameter = 2 * float(np.linalg.norm(local - np.outer(local @ axis, axis), axis=1).max())
    moved = replace(pulled, vertices=pulled.vertices + _PULLED * diameter * along)
    blocks = [p for p in touching if p.form == "block"]
    return [*(moved if p is pulled else p for p in arms), *kept, *blocks], (back, axis)


def _at(middle: Floats, radius: float, directions: tuple[Floats, Floats]) -> View:
    """The view in which a sphere just fits."""
    back, up = directions
    distance = radius / np.sin(np.radians(FIELD_DEG) / 2)
    return View(middle + distance * back, middle, up, FIELD_DEG)
