"""Kits in poses: the proven range confirmed on the meshes of the parts, and refuted beyond it."""

from __future__ import annotations

import numpy as np
import pytest

from ddgfab.errors import KernelError
from ddgfab.linkages import crab_mechanism
from ddgfab.nets.knet.crab import crab_net
from fabrication.linkage.bodies import bodies
from fabrication.linkage.detail import detail_linkage
from fabrication.linkage.kit import Kit, kit
from fabrication.linkage.poses import check_poses, limit_on_pin
from fabrication.linkage.printing import PRINTED_CHORD_MM
from fabrication.linkage.settings import settings_for
from fabrication.motion.free_range import free_motion, poses_to_confirm, standing
from fabrication.parts.link import LINK
from fabrication.parts.pin import PIN
from fabrication.parts.ring import CAP
from fabrication.solids import mesh_of
from fabrication.specs import TriangleMesh

BEYOND = np.radians(1.0)
"""How far outside the proven range the meshes must meet."""


@pytest.fixture(scope="module")
def loop() -> Kit:
    return kit("bennett")


@pytest.fixture(scope="module")
def box() -> Kit:
    return kit("cube")


def meshes_of(made: Kit) -> dict[str, TriangleMesh]:
    return {family.number: mesh_of(family.shape, PRINTED_CHORD_MM) for family in made.families}


def faults(made: Kit, angle: float) -> set[frozenset[str]]:
    """Pairs of marks that the meshes find too near in one pose."""
    found = check_poses(made, meshes_of(made), angle)
    return {
        frozenset((mark, str(check.other)))
        for mark, checks in found.items()
        for check in checks
        if not check.passed
    }


@pytest.mark.parametrize("name", ["loop", "box"])
def test_default_kits(name: str, request: pytest.FixtureRequest) -> None:
    made: Kit = request.getfixturevalue(name)
    assert made.motion.proven
    assert np.degrees(made.motion.range) > 120
    assert standing(made.mechanism, bodies(made.linkage)) == ()


@pytest.mark.parametrize("name", ["loop", "box"])
def test_meshes_confirm_the_range(name: str, request: pytest.FixtureRequest) -> None:
    made: Kit = request.getfixturevalue(name)
    poses = poses_to_confirm(made.motion)
    assert poses[0] == made.motion.low
    assert poses[-1] == made.motion.high
    assert made.motion.design in poses
    assert {contact.t for contact in made.motion.tightest} <= set(poses)
    found = check_poses(made, meshes_of(made), poses)
    assert len(found) == len(made.linkage.pieces) - 2  # without the coupon and its pin
    assert [check for checks in found.values() for check in checks if not check.passed] == []


@pytest.mark.parametrize("name", ["loop", "box"])
def test_meshes_meet_beyond_the_range(name: str, request: pytest.FixtureRequest) -> None:
    made: Kit = request.getfixturevalue(name)
    ends = {frozenset(contact.marks) for contact in made.motion.contacts}
    for angle in (made.motion.low - BEYOND, made.motion.high + BEYOND):
        assert faults(made, angle) & ends


def test_a_penetration_has_a_depth(loop: Kit) -> None:
    """Folded flat, the bars are in each other, by more than their printed chord."""
    found = check_poses(loop, meshes_of(loop), 3.1)
    values = [check.value for checks in found.values() for check in checks if not check.passed]
    assert min(value for value in values if value is not None) < -1.0


def test_a_mesh_with_a_hole_is_named(loop: Kit) -> None:
    meshes = meshes_of(loop)
    number = next(family.number for family in loop.families if family.role == "link")
    whole = meshes[number]
    meshes[number] = TriangleMesh(whole.vertices, whole.triangles[1:])
    with pytest.raises(KernelError, match=number):
        check_poses(loop, meshes, 3.1)


def test_limits_on_a_pin_are_those_of_the_settings() -> None:
    settings = settings_for()
    assert limit_on_pin(settings, LINK, PIN) == settings.clearance == 0.2
    assert limit_on_pin(settings, PIN, CAP) == 0
    assert limit_on_pin(settings, LINK, LINK) == 0.1
    assert limit_on_pin(settings, CAP, LINK) == 0.1


def test_a_crab_opens() -> None:
    net = crab_net(6, np.radians(30), np.radians(60), 3)
    mechanism = crab_mechanism(net, scale_mm=140.0)
    made = detail_linkage(mechanism, settings_for())
    motion = free_motion(mechanism, bodies(made), 0.4)
    assert motion.proven
    assert motion.low < mechanism.design < motion.high
    assert np.degrees(motion.range) > 90
    # The symmetry of the net: what meets on one side meets on all.
    assert len(motion.above) >= 6
    gaps = np.array([contact.gap for contact in motion.above[:6]])
    assert np.ptp(gaps) < 1e-3
