"""Heights of nodes: rolled beams are covered, ends lie on whole steps."""

from __future__ import annotations

import numpy as np
import pytest
from detailing_cases import Case, dome, placed

from ddgfab.mesh import unit

NO_GLASS = {"kind": "none"}


def test_height_covers_beams_that_torsion_rolls() -> None:
    """The corners of the end faces, from the shapes: rolled about the edges, cut askew."""
    case = dome()
    tilt = np.random.default_rng(5).normal(scale=0.06, size=case.axes.shape)
    shell = Case(case.mesh, unit(case.axes + tilt)).detail(
        beam={"profile": "RHS 100x50x4"}, panel=NO_GLASS, checks={"torsion_deg": 20.0}
    )
    beams = {beam.mark: beam for beam in shell.beams}
    over = []
    for node in shell.nodes:
        heights = []
        for arm in node.arms:
            beam = beams[arm.beam]
            cut = (beam.shape.start, beam.shape.end)[beam.vertices.index(node.vertex)]
            y, z = np.meshgrid([-25.0, 25.0], [-100.0, 0.0])
            x = cut.x + cut.slope * z + cut.skew * y
            points = placed(beam.placement, np.stack([x, y, z], axis=-1).reshape(-1, 3))
            heights += ((points - node.position) @ node.axis).tolist()
        assert min(heights) - node.shape.z0 >= 5 - 1e-6
        assert node.shape.z1 - max(heights) >= 0.5 - 1e-6
        over += [min(heights) - node.shape.z0 - 5, node.shape.z1 - max(heights) - 0.5]
    assert max(over) < 2.0  # no more than a millimetre beyond rounding up


@pytest.mark.parametrize("step", [0.5, 7.0, 40.0])
def test_heights_are_in_steps_and_the_least_of_them(step: float) -> None:
    fine = dome().detail(node={"height_step_mm": 1e-3}).nodes
    for node, exact in zip(dome().detail(node={"height_step_mm": step}).nodes, fine, strict=True):
        for end in (node.shape.z0, node.shape.z1):
            assert end / step == pytest.approx(round(end / step), abs=1e-9)
        assert -1e-6 <= exact.shape.z0 - node.shape.z0 < step + 2e-3
        assert -1e-6 <= node.shape.z1 - exact.shape.z1 < step + 2e-3
