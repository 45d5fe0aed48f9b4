"""Free motion of real kits: parts as they are made, confirmed on their meshes; crab nets."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pytest

from ddgfab.errors import DetailError, KernelError
from ddgfab.linkages import Mechanism, bennett, crab_mechanism, cube
from ddgfab.nets.knet_crab import crab_net
from fabrication.linkage.bodies import bodies
from fabrication.linkage.links import Linkage, detail_linkage
from fabrication.linkage.settings import settings_for
from fabrication.motion.capsules import Body
from fabrication.motion.confirm import confirm, poses_to_confirm
from fabrication.motion.free_range import FreeMotion, free_motion, standing
from fabrication.solids import mesh_of
from fabrication.specs import TriangleMesh

CLEARANCE = 0.4


class Kit:
    """A linkage with its bodies, meshes and free motion."""

    def __init__(self, mechanism: Mechanism, linkage: Linkage) -> None:
        self.mechanism, self.linkage = mechanism, linkage
        self.bodies: list[Body] = list(bodies(linkage))
        self.meshes: dict[str, TriangleMesh] = {}
        for family in linkage.families:
            mesh = mesh_of(family.shape)
            for instance in family.instances:
                self.meshes[instance.mark] = mesh
        self.motion: FreeMotion = free_motion(mechanism, self.bodies, CLEARANCE)

    def placed(self, t: float) -> Mapping[str, np.ndarray]:
        return self.linkage.placements_at(self.mechanism.pose(t))


@pytest.fixture(scope="module")
def loop() -> Kit:
    mechanism = bennett(100.0, np.radians(40), beta=np.radians(70))
    return Kit(mechanism, detail_linkage(mechanism, settings_for()))


@pytest.fixture(scope="module")
def box() -> Kit:
    """The default cube: twists 58, 131 (49 of the other hand), 50 deg, at most 110 mm."""
    twists = np.radians([58.0, 131.0, 50.0])
    lengths = 110.0 * np.sin(twists) / np.sin(twists).max()
    mechanism = cube(
        lengths, twists, corners=(np.radians(123.0), np.radians(45.0)), rates=(8.0, -5.0)
    )
    levels = np.array([0, 2, 1])[mechanism.directions]
    linkage = detail_linkage(mechanism, settings_for(), levels=np.stack([levels, levels], axis=1))
    return Kit(mechanism, linkage)


@pytest.mark.parametrize("name", ["loop", "box"])
def test_default_kits(name: str, request: pytest.FixtureRequest) -> None:
    kit: Kit = request.getfixturevalue(name)
    assert kit.motion.proven
    assert np.degrees(kit.motion.range) > 120
    assert standing(kit.mechanism, kit.bodies) == ()


@pytest.mark.parametrize("name", ["loop", "box"])
def test_meshes_confirm_the_range(name: str, request: pytest.FixtureRequest) -> None:
    kit: Kit = request.getfixturevalue(name)
    ts = poses_to_confirm(kit.motion)
    assert ts[0] == kit.motion.low
    assert ts[-1] == kit.motion.high
    inside = confirm(kit.mechanism, kit.bodies, kit.meshes, kit.placed, ts, CLEARANCE)
    assert inside.passed, inside.faults[:3]
    assert inside.measured < inside.pairs
    outside = [kit.motion.low - np.radians(1), kit.motion.high + np.radians(1)]
    beyond = confirm(kit.mechanism, kit.bodies, kit.meshes, kit.placed, outside, CLEARANCE)
    assert not beyond.passed
    ends = {frozenset(contact.marks) for contact in kit.motion.contacts}
    assert ends & {frozenset(fault.marks) for fault in beyond.faults}
    assert {fault.t for fault in beyond.faults} == set(outside)


def test_volumes_are_measured(loop: Kit) -> None:
    """Folded flat, the bars are in each other: the common volume says how much."""
    found = confirm(loop.mechanism, loop.bodies, loop.meshes, loop.placed, [3.1], CLEARANCE)
    worst = max(found.faults, key=lambda fault: fault.volume)
    assert worst.volume > 100
    assert worst.gap == 0


def test_bad_meshes(loop: Kit) -> None:
    with pytest.raises(DetailError, match="no mesh"):
        confirm(loop.mechanism, loop.bodies, {}, loop.placed, [1.0], CLEARANCE)
    mark = loop.bodies[0].mark
    whole = loop.meshes[mark]
    broken = dict(loop.meshes)
    broken[mark] = TriangleMesh(whole.vertices, whole.triangles[1:])
    with pytest.raises(KernelError, match=mark):
        confirm(loop.mechanism, loop.bodies, broken, loop.placed, [1.0], CLEARANCE)


def test_a_crab_opens() -> None:
    net = crab_net(6, np.radians(30), np.radians(60), 3)
    mechanism = crab_mechanism(net, scale_mm=140.0)
    kit = detail_linkage(mechanism, settings_for())
    motion = free_motion(mechanism, bodies(kit), CLEARANCE)
    assert motion.proven
    assert motion.low < mechanism.design < motion.high
    assert np.degrees(motion.range) > 90
    # The symmetry of the net: what meets on one side meets on all.
    assert len(motion.above) >= 6
    gaps = np.array([contact.gap for contact in motion.above[:6]])
    assert np.ptp(gaps) < 1e-3
