"""The moving scene of a kit: meshes, pieces, and their placements pose by pose."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from ddgfab.linkages import Pose
from ddgfab.mesh import Floats
from fabrication.formats.html.page import ContactNote
from fabrication.linkage.kit import Kit
from fabrication.linkage.moving import Group, MovingPiece, MovingScene
from fabrication.motion.free_range import Contact
from fabrication.parts.link import LINK
from fabrication.solids import mesh_of
from fabrication.specs import Color, Family, Instance

SEEN_CHORD_MM: Final = 0.05
"""Distance [mm] of meshes that are only looked at from the exact surfaces."""

MOST_PLACEMENTS: Final = 30_000
"""Most placements in the report: two megabytes."""

FEWEST_POSES: Final = 13
"""Fewest poses in the report, however many placements they need."""

LINK_COLORS: Final[tuple[Color, ...]] = (
    (0.16, 0.42, 0.66),
    (0.72, 0.30, 0.28),
    (0.24, 0.56, 0.35),
    (0.62, 0.33, 0.60),
    (0.70, 0.62, 0.24),
    (0.20, 0.60, 0.64),
    (0.55, 0.38, 0.26),
    (0.45, 0.45, 0.62),
)
"""sRGB colors of the links, by part number; they repeat."""


def moving_scene(kit: Kit) -> MovingScene:
    """The kit through its free range, turned so that it lies broad and does not swing about.

    Every pose is moved as near to the design pose as it goes, all hinges counting alike.
    """
    angles, design = shown_angles(kit)
    motions = kit.motions(angles)
    still = standstill(kit, angles)
    families = [f for f in kit.families if any(i.mark in motions for i in f.instances)]
    colors = colors_of(families)
    groups, pieces, placed = [], [], []
    for body, family in enumerate(families):
        color = colors[family.number]
        own = [i.mark for i in family.instances if i.mark in motions]
        groups.append(Group(family.number, color))
        for mark in own:
            pieces.append(MovingPiece(body, body, mark))
            placed.append(still @ motions[mark])
    return MovingScene(
        bodies=[mesh_of(family.shape, SEEN_CHORD_MM) for family in families],
        groups=groups,
        pieces=pieces,
        motions=np.stack(placed, axis=1),
        driver="driving angle",
        values_deg=np.degrees(angles),
        design=design,
        touches=[_touch(contact, angles, still) for contact in kit.motion.contacts],
    )


def colors_of(families: Sequence[Family]) -> dict[str, Color]:
    """Colors by part number: links have those of `LINK_COLORS` in turn, others their kind's."""
    links = [f.number for f in families if f.kind == LINK]
    return {
        f.number: LINK_COLORS[links.index(f.number) % len(LINK_COLORS)]
        if f.kind == LINK
        else f.kind.color
        for f in families
    }


def _touch(contact: Contact, angles: Floats, still: Floats) -> ContactNote:
    """A contact where the scene shows it, in the pose that is nearest to it."""
    pose = int(np.abs(angles - contact.t).argmin())
    point = still[pose] @ np.array([*contact.point, 1.0])
    return ContactNote(pose, point[:3], f"{contact.marks[0]} meets {contact.marks[1]}")


def shown_angles(kit: Kit) -> tuple[Floats, int]:
    """Driving angles [rad] through the free range with the design's among them, and its place.

    As many as the project sets, fewer for linkages of very many parts.
    """
    most = MOST_PLACEMENTS // len(kit.linkage.pieces)
    angles = kit.angles(min(kit.project.motion.poses, max(most, FEWEST_POSES)))
    at = int(np.abs(angles - kit.mechanism.design).argmin())
    angles[at] = kit.mechanism.design
    return angles, at


def standstill(kit: Kit, angles: Floats) -> Floats:
    """(T, 4, 4) motions that bring poses upon the design pose, that one lying broad.

    Broad: the hinges spread least along z. The motion upon the design pose is the best one in the
    mean square of the hinges' distances (Kabsch 1976).
    """
    points = kit.mechanism.poses(angles).points
    design = kit.mechanism.pose(kit.mechanism.design)
    middle = design.points.mean(axis=0)
    aim = (design.points - middle) @ broad_axes(design)
    center = points.mean(axis=1)
    u, _, v = np.linalg.svd(np.einsum("tvi,vj->tij", points - center[:, None], aim))
    turn = np.swapaxes(v, 1, 2) @ np.swapaxes(u, 1, 2)
    v[:, 2] *= np.sign(np.linalg.det(turn))[:, None]
    motion = np.tile(np.eye(4), (len(angles), 1, 1))
    motion[:, :3, :3] = np.swapaxes(v, 1, 2) @ np.swapaxes(u, 1, 2)
    motion[:, :3, 3] = -np.einsum("tij,tj->ti", motion[:, :3, :3], center)
    return motion


def broad_axes(pose: Pose) -> Floats:
    """(3, 3) columns: the directions in which the hinges spread most, less, least; right-handed."""
    away = pose.points - pose.points.mean(axis=0)
    _, vectors = np.linalg.eigh(away.T @ away)
    axes = vectors[:, ::-1].copy()
    # Each direction towards the side of its greatest entry, so that rounding cannot turn it round.
    for k in (0, 1):
        axes[:, k] *= np.sign(axes[np.abs(axes[:, k]).argmax(), k])
    axes[:, 2] = np.cross(axes[:, 0], axes[:, 1])
    return np.asarray(axes, dtype=np.float64)


def lying_broad(kit: Kit) -> tuple[Family, ...]:
    """Part numbers of what moves, placed as the scene shows the design pose."""
    turn = standstill(kit, np.array([kit.mechanism.design]))[0]
    return tuple(
        replace(f, instances=tuple(Instance(i.mark, turn @ i.placement) for i in f.instances))
        for f in kit.placed()
    )
