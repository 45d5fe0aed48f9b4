"""A kind of node defined in this file alone: sized, shaped, numbered, made and checked by a job."""

from __future__ import annotations

import csv
import math
from collections.abc import Hashable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Final, Self

import numpy as np
import pytest
from roofs import barrel

from ddgfab.errors import ProjectError
from ddgfab.mesh import Floats
from fabrication.boundary import Boundary
from fabrication.gridshell.design import design
from fabrication.gridshell.detailing.arm_room import least_radii
from fabrication.gridshell.detailing.connections.base import Joined
from fabrication.gridshell.detailing.nodes import registry
from fabrication.gridshell.detailing.nodes.base import Joints, NodeSize
from fabrication.gridshell.load import make_project
from fabrication.job.run import make
from fabrication.parts.node import NODE
from fabrication.solids.builder import BoundaryBuilder
from fabrication.variants import Variants, key_of

PRISM: Final = replace(NODE, prefix="XP", title="Prisms", color=(0.2, 0.6, 0.3))
SIDES: Final = 8


@dataclass(frozen=True)
class PrismShape:
    """An eight-sided prism about z from z0 to z1, its corners at `radius` [mm]."""

    radius: float
    z0: float
    z1: float

    def key(self) -> Hashable:
        return tuple(map(key_of, (self.radius, self.z0, self.z1)))

    @classmethod
    def variants(cls, shapes: Sequence[Self]) -> Variants:
        return Variants.equal(len(shapes))

    def geometry(self) -> Boundary:
        builder = BoundaryBuilder()
        turns = [2 * math.pi * k / SIDES for k in range(SIDES)]
        outline = [(self.radius * math.cos(t), self.radius * math.sin(t)) for t in turns]
        low = [builder.point((x, y, self.z0)) for x, y in outline]
        high = [builder.point((x, y, self.z1)) for x, y in outline]
        for k in range(SIDES):
            j, t = (k + 1) % SIDES, math.pi * (2 * k + 1) / SIDES
            ring = [(low[k], low[j]), (low[j], high[j]), (high[j], high[k]), (high[k], low[k])]
            builder.plane((math.cos(t), math.sin(t), 0.0), [[builder.line(*e) for e in ring]])
        builder.plane(
            (0.0, 0.0, -1.0), [[builder.line(low[-k], low[-k - 1]) for k in range(SIDES)]]
        )
        top = [builder.line(high[k], high[(k + 1) % SIDES]) for k in range(SIDES)]
        builder.plane((0.0, 0.0, 1.0), [top])
        return builder.build()

    def second_volume(self) -> float:
        area = 0.5 * SIDES * self.radius**2 * math.sin(2 * math.pi / SIDES)
        return area * (self.z1 - self.z0)

    def dimensions(self) -> dict[str, Any]:
        return {"corners_mm": 2 * self.radius}


@dataclass(frozen=True)
class Prism(NodeSize):
    """Prisms that are as large as the arms need, in steps of 5 mm."""

    keys = ("wall_mm",)
    kind = PRISM

    @classmethod
    def fit(cls, joints: Joints) -> Self:
        needs = least_radii(joints.arms, joints.width, joints.project.node.arm_clearance_mm)
        worst = int(needs.argmax())
        radius = 5.0 * math.ceil(needs[worst] / 5.0)
        cut = radius + joints.project.beam.clearance_mm
        at = int(joints.arms.node[worst])
        return cls(radius, radius, cut, joints.width, float(needs[worst]), at)

    def shapes(
        self, joints: Joints, joined: Joined, bottom: Floats, top: Floats, middle: Floats
    ) -> list[PrismShape]:
        used = np.flatnonzero(np.diff(joints.arms.start)).tolist()
        return [PrismShape(self.radius, float(bottom[v]), float(top[v])) for v in used]


@pytest.fixture
def prism() -> Iterator[None]:
    registry.register("prism", Prism)
    yield
    registry.unregister("prism")


@pytest.mark.slow
def test_a_whole_job(prism: None, tmp_path: Path) -> None:
    made = design(barrel(2, 2), node={"kind": "prism"}, output={"formats": ["step", "stl", "csv"]})
    result = make(made, tmp_path / "roof")
    assert result.exit_code == 0, result.problems
    rows = list(csv.DictReader((result.folder / "schedules" / "nodes.csv").open(encoding="utf-8")))
    assert len(rows) == 9
    assert {row["number"][:2] for row in rows} == {"XP"}
    assert {float(row["corners_mm"]) for row in rows} == {2 * made.gridshell.size.radius}
    parts = [part for part in result.manifest["parts"] if part["number"].startswith("XP")]
    assert all(check["passed"] for part in parts for check in part["checks"])
    assert {path.stem for path in (result.folder / "parts" / "step").glob("XP*")} == {
        part["number"] for part in parts
    }
    assert b"'PRISMS'" in (result.folder / "assembly.step").read_bytes()


def test_unknown_kinds_and_keys_of_other_kinds_are_named(prism: None) -> None:
    assert registry.names() == (*registry.MODULES, "prism")
    with pytest.raises(ProjectError, match="did you mean prism"):
        make_project({"node": {"kind": "prsm"}})
    with pytest.raises(ProjectError, match=r'wall_mm is for kind = "tube" or "prism", not for'):
        make_project({"node": {"kind": "cylinder", "wall_mm": 5.0}})
    assert make_project({"node": {"kind": "prism", "wall_mm": 5.0}}).node.wall_mm == 5.0
