"""Parts of kits, as read back, placed through the range of motion: they never meet."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from linkage_cases import meshes_of
from near_pairs import near_pairs

from fabrication.checks.mesh import to_manifold
from fabrication.job.result import JobResult
from fabrication.job.run import make
from fabrication.linkage.kit import Kit, kit
from fabrication.linkage.poses import check_poses
from fabrication.parts.link import LinkShape

POSES = 50
FEWER_POSES = 8  # of kits with more pieces, both ends among them; the job has measured some already
COAXIAL_MM = 1e-6
OVERLAP_MM3 = 1e-3  # faces that touch, rounded to the single precision of STL


def test_placements_follow_the_kinematics(bennett: Kit) -> None:
    angles = bennett.angles(7)
    motions = bennett.motions(angles)
    links = bennett.linkage.links
    poses = bennett.mechanism.poses(angles)
    for link in links:
        for end, hinge in enumerate(link.hinges):
            point, axis = bore(link.shape, end, bennett, link.mark)
            placed = motions[link.mark]
            assert np.abs(np.cross(placed[:, :3, :3] @ axis, poses.axes[:, hinge])).max() < 1e-12
            away = placed[:, :3, :3] @ point + placed[:, :3, 3] - poses.points[:, hinge]
            along = np.einsum("ti,ti->t", away, poses.axes[:, hinge])
            off = away - along[:, None] * poses.axes[:, hinge]
            assert np.abs(off).max() < COAXIAL_MM
    assert np.abs(motions["L-0000"] - motions["L-0000"][0]).max() < 1e-12  # bar 0 is held


def bore(shape: Any, end: int, bennett: Kit, mark: str) -> tuple[np.ndarray, np.ndarray]:
    """A point of the axis of a bore and its direction, in the frame of the part number's shape.

    The piece's own end lies at either end of a shape that is shared.
    """
    piece = next(p for p in bennett.linkage.pieces if p.mark == mark)
    family = next(f for f in bennett.families if mark in [i.mark for i in f.instances])
    instance = next(i for i in family.instances if i.mark == mark)
    assert isinstance(shape, LinkShape)
    point = np.array([shape.length * end, 0, 0, 1.0])
    axis = np.array([0, -np.sin(shape.twist) * end, np.cos(shape.twist * end), 0])
    change = np.linalg.inv(instance.placement) @ piece.placement
    return (change @ point)[:3], (change @ axis)[:3]


@pytest.mark.slow
def test_bores_of_the_step_files_are_coaxial_with_the_pins(
    bennett: Kit, kit_job: JobResult
) -> None:
    """Cylinder axes read back from the kernel, placed at 50 poses, against the pins' own axes."""
    axes = {
        path.stem: cylinders(path)
        for path in sorted((kit_job.folder / "parts/step").glob("*.step"))
    }
    angles = bennett.angles(POSES)
    motions, poses = bennett.motions(angles), bennett.mechanism.poses(angles)
    settings = bennett.linkage.settings
    number = {i.mark: f.number for f in bennett.families for i in f.instances}
    checked = 0
    for hinge, stack in enumerate(bennett.linkage.stacks):
        point, axis = poses.points[:, hinge], poses.axes[:, hinge]
        for item in stack:
            radius = {"link": settings.bore, "pin": settings.pin_diameter}.get(item.kind.role)
            if radius is None:
                continue
            gaps = []
            for at, way, found in axes[number[item.mark]]:
                if abs(2 * found - radius) > 1e-6:
                    continue
                placed = motions[item.mark]
                here = placed[:, :3, :3] @ at + placed[:, :3, 3] - point
                off = here - np.einsum("ti,ti->t", here, axis)[:, None] * axis
                tilt = np.cross(placed[:, :3, :3] @ way, axis)
                gaps.append(max(np.abs(off).max(), np.abs(tilt).max() * settings.eye_height))
            assert min(gaps) < COAXIAL_MM
            checked += 1
    assert checked == 12  # four pins, and two eyes on each


def cylinders(path: Path) -> list[tuple[np.ndarray, np.ndarray, float]]:
    """Point of the axis, direction and radius of every cylindrical face of a STEP file."""
    from OCP.BRepAdaptor import BRepAdaptor_Surface
    from OCP.GeomAbs import GeomAbs_SurfaceType
    from OCP.TopAbs import TopAbs_ShapeEnum
    from OCP.TopExp import TopExp_Explorer
    from OCP.TopoDS import TopoDS
    from OCP.XCAFDoc import XCAFDoc_ShapeTool

    from fabrication.formats.step.xcaf import free_labels, read_document

    document, _ = read_document(path)
    found = []
    for label in free_labels(document):
        explorer = TopExp_Explorer(
            XCAFDoc_ShapeTool.GetShape_s(label), TopAbs_ShapeEnum.TopAbs_FACE
        )
        while explorer.More():
            surface = BRepAdaptor_Surface(TopoDS.Face_s(explorer.Current()))
            if surface.GetType() == GeomAbs_SurfaceType.GeomAbs_Cylinder:
                cylinder = surface.Cylinder()
                line = cylinder.Axis()
                at, way = line.Location(), line.Direction()
                found.append(
                    (
                        np.array([at.X(), at.Y(), at.Z()]),
                        np.array([way.X(), way.Y(), way.Z()]),
                        cylinder.Radius(),
                    )
                )
            explorer.Next()
    return found


@pytest.mark.slow
def test_read_back_meshes_never_meet_on_the_way(bennett: Kit, kit_job: JobResult) -> None:
    """50 poses through the free range: no common volume of any pair, and the clearances kept."""
    meshes = meshes_of(kit_job.folder)
    angles = bennett.angles(POSES)
    found = check_poses(bennett, meshes, angles)
    assert len(found) == len(bennett.linkage.pieces) - 2  # without the coupon and its pin
    assert all(check.passed for checks in found.values() for check in checks)
    solids = {number: to_manifold(mesh) for number, mesh in meshes.items()}
    motions = bennett.motions(angles)
    marks = list(motions)
    number = {i.mark: f.number for f in bennett.families for i in f.instances}
    for t in range(POSES):
        bodies = [solids[number[m]].transform(motions[m][t][:3]) for m in marks]
        for one, two in near_pairs(bodies):
            assert (bodies[one] ^ bodies[two]).volume() < OVERLAP_MM3


@pytest.mark.slow
@pytest.mark.parametrize(
    "settings",
    [
        {"source": "cube", "parts": {"pin": "printed", "label": "embossed"}},
        {"source": "knet", "cells": [2, 3], "longest_mm": 70.0},
        {"source": "crab", "rings": 3},
    ],
    ids=lambda settings: settings["source"],
)
def test_other_kits_never_meet_on_the_way_either(settings: dict[str, Any], tmp_path: Path) -> None:
    made = kit(**settings, output={"formats": ["stl"]})
    result = make(made, tmp_path / "kit")
    assert result.exit_code == 0, result.problems
    found = check_poses(made, meshes_of(result.folder), made.angles(FEWER_POSES))
    failed = [check for checks in found.values() for check in checks if not check.passed]
    assert not failed


@pytest.mark.slow
def test_beyond_the_range_the_pose_check_finds_the_contact(
    bennett: Kit, kit_job: JobResult
) -> None:
    meshes = meshes_of(kit_job.folder)
    contact = bennett.motion.contacts[0]
    end = contact.t + (0.1 if contact.t > bennett.mechanism.design else -0.1)
    found = check_poses(bennett, meshes, np.array([end]))
    clashes = {mark for mark, checks in found.items() if not all(c.passed for c in checks)}
    assert clashes & set(contact.marks)
