"""A kind of part defined in this file alone goes from pieces to numbers, solids, checks and files.

Nothing in the package names it: its record brings key, variants, geometry, second volume and
dimensions; its kind brings role, part numbers, group, layer and color.
"""

from __future__ import annotations

import csv
import json
import math
import struct
from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Final, Self

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from ddgfab.errors import DetailError
from ddgfab.mesh import Floats
from fabrication.boundary import Boundary, Cut, Tool
from fabrication.checks.assembly import check_assembly
from fabrication.checks.mesh import check_mesh
from fabrication.checks.solid import check_solid
from fabrication.families import families
from fabrication.formats.glb import glb_bytes
from fabrication.formats.registry import defaults
from fabrication.formats.step import Material, StepProduct, assembly_bytes, part_bytes
from fabrication.formats.step.read import read_step
from fabrication.formats.stl import stl_bytes
from fabrication.formats.threemf import Body3MF, threemf_bytes
from fabrication.job.problems import problems_of
from fabrication.job.product import Product
from fabrication.job.run import make
from fabrication.parts.node import NODE, NodeShape
from fabrication.project.sections import OutputSettings, Verify
from fabrication.solids import boundary_of, genus_of, mesh_of, realise, second_volume_of, solid_of
from fabrication.solids.builder import BoundaryBuilder, Coedges
from fabrication.specs import Check, Family, Kind, Piece, Placement, TriangleMesh
from fabrication.table import Table
from fabrication.variants import Variants, key_of

GUSSET: Final = Kind("gusset", "G", "GP", "Gussets", (0.25, 0.5, 0.75), "glass")


@dataclass(frozen=True)
class GussetShape:
    """A right-angled triangular plate on z = 0, its right angle at the origin, with a round bore.

    along, up, thickness [mm]; bore : diameter [mm], centered at a quarter of both legs; drilled :
    diameter [mm] of a hole along y through the middle of the plate, 0 for none
    """

    along: float
    up: float
    thickness: float
    bore: float
    drilled: float = 0.0

    def key(self) -> Hashable:
        return tuple(map(key_of, (self.thickness, self.bore, self.drilled)))

    @classmethod
    def variants(cls, shapes: Sequence[Self]) -> Variants:
        corners = np.array([[[s.along, 0.0], [0.0, s.up]] for s in shapes])[:, None]
        return Variants.about_z(corners, np.zeros((len(shapes), 1)), np.zeros((len(shapes), 1, 3)))

    def geometry(self) -> Boundary | Cut:
        blank = self._blank()
        if self.drilled == 0.0:
            return blank
        foot = (self.along / 2.0, -1.0, self.thickness / 2.0)
        tool = Tool(foot, (0.0, 1.0, 0.0), (1.0, 0.0, 0.0), self.drilled / 2.0, self.up + 2.0)
        return Cut(blank, (tool,), blank.genus + 1)

    def _blank(self) -> Boundary:
        a, b, t, r = self.along, self.up, self.thickness, self.bore / 2.0
        room = min(a, b) / 4.0
        if r >= room:
            raise DetailError(f"a bore of {self.bore:g} mm leaves no wall; limit {2 * room:g} mm")
        builder = BoundaryBuilder()
        outline = [(0.0, 0.0), (a, 0.0), (0.0, b)]
        low = [builder.point((x, y, 0.0)) for x, y in outline]
        high = [builder.point((x, y, t)) for x, y in outline]
        long = math.hypot(a, b)
        normals = [(0.0, -1.0, 0.0), (b / long, a / long, 0.0), (-1.0, 0.0, 0.0)]
        for k, normal in enumerate(normals):
            j = (k + 1) % 3
            ring = [(low[k], low[j]), (low[j], high[j]), (high[j], high[k]), (high[k], low[k])]
            builder.plane(normal, [[builder.line(*ends) for ends in ring]])
        near, far = builder.round_hole((a / 4, b / 4, 0.0), (a / 4, b / 4, t), (1.0, 0.0, 0.0), r)
        bottom: Coedges = [builder.line(low[k], low[k - 1]) for k in (0, 2, 1)]
        top: Coedges = [builder.line(high[k - 1], high[k]) for k in range(3)]
        builder.plane((0.0, 0.0, -1.0), [bottom, near])
        builder.plane((0.0, 0.0, 1.0), [top, far])
        return builder.build()

    def second_volume(self) -> float:
        plate = (0.5 * self.along * self.up - 0.25 * math.pi * self.bore**2) * self.thickness
        # The plate's width falls linearly along x, so the drill's mean length is that at its axis.
        return plate - 0.25 * math.pi * self.drilled**2 * self.up / 2.0

    def dimensions(self) -> dict[str, Any]:
        return {"along_mm": self.along, "up_mm": self.up, "bore_mm": self.bore}


@dataclass(frozen=True, eq=False)
class Gusset:
    """One gusset, with the edge that it stiffens."""

    mark: str
    edge: int
    shape: GussetShape
    placement: Placement
    kind: Kind = GUSSET
    checks: tuple[Check, ...] = ()


@dataclass(frozen=True, eq=False)
class Stub:
    """A piece of a kind that the package knows, beside the new one."""

    mark: str
    shape: NodeShape
    placement: Placement
    kind: Kind = NODE
    checks: tuple[Check, ...] = ()


PLAIN: Final = GussetShape(120.0, 80.0, 10.0, 9.0)
STEEL: Final = Material("S355", 7850.0)


def at(x: float, y: float = 0.0, z: float = 0.0, turn: float = 0.0) -> Floats:
    placement = np.eye(4)
    placement[:3, :3] = Rotation.from_rotvec([0.0, 0.0, turn]).as_matrix()
    placement[:3, 3] = x, y, z
    return placement


def pieces() -> list[Piece]:
    limit = Check("slope_deg", False, 12.0, 10.0)
    shapes = [PLAIN, replace(PLAIN, up=80.06), replace(PLAIN, up=95.0), replace(PLAIN, bore=11.0)]
    gussets = [Gusset(GUSSET.mark_of(k), k, s, at(200.0 * k)) for k, s in enumerate(shapes)]
    failed = Gusset(GUSSET.mark_of(4), 4, PLAIN, at(800.0), checks=(limit,))
    return [*gussets, failed, Stub("N-0000", NodeShape(20.0, 0.0, -30.0, 30.0), at(-60.0))]


def test_numbers() -> None:
    """Congruent within the tolerance shares one; another bore, legs or a failed check does not."""
    found = families(pieces(), 0.1)
    assert [(f.number, [i.mark for i in f.instances]) for f in found] == [
        ("GP-001", ["G-0000", "G-0001"]),
        ("GP-002", ["G-0002"]),
        ("GP-003", ["G-0003"]),
        ("GP-004", ["G-0004"]),
        ("NP-001", ["N-0000"]),
    ]
    assert found[0].deviation == pytest.approx(0.06)
    assert len(families(pieces(), 0.05)) == 6
    rows = Table([{"number": f.number, **f.shape.dimensions()} for f in found[:3]])
    assert rows.columns == ["number", "along_mm", "up_mm", "bore_mm"]
    assert rows.column("up_mm") == [80.0, 95.0, 80.0]


def test_solid_mesh_and_volume_two_ways() -> None:
    made = realise(PLAIN, 0.05, solid=False)
    assert made.boundary is not None
    made.boundary.validate()
    assert made.properties.volume == pytest.approx(second_volume_of(PLAIN), rel=1e-12)
    assert made.genus == genus_of(PLAIN) == 1
    checks = check_mesh(
        made.mesh, volume=made.properties.volume, area=made.properties.area, chord=0.05, genus=1
    )
    assert [check.name for check in checks if not check.passed] == []
    with pytest.raises(DetailError, match="leaves no wall; limit 40 mm"):
        boundary_of(replace(PLAIN, bore=41.0))


def test_clearances_and_problems() -> None:
    """Two gussets 0.5 mm apart, where 1 mm is asked: by role, without a table of roles."""
    near: list[Piece] = [
        Gusset("G-0000", 0, PLAIN, at(0.0)),
        Gusset("G-0001", 1, PLAIN, at(0.0, z=10.5)),
        Gusset("G-0002", 2, PLAIN, at(0.0, z=25.0)),
        Stub("N-0000", NodeShape(20.0, 0.0, -30.0, 30.0), at(-20.5, 10.0)),
    ]
    found = families(near)
    meshes = {family.number: mesh_of(family.shape) for family in found}
    checks = check_assembly(found, meshes, {("gusset", "gusset"): 1.0, ("node", "gusset"): 0.2})
    assert {mark: [check.passed for check in own] for mark, own in checks.items()} == {
        "G-0000": [False],
        "G-0001": [False],
        "G-0002": [True],
        "N-0000": [True],
    }
    roles = {piece.mark: piece.kind.role for piece in near}
    problems = problems_of(roles, [(mark, check) for mark, own in checks.items() for check in own])
    assert [problem.role for problem in problems] == ["gusset"]
    assert "G-0000/G-0001 0.5 mm" in str(problems[0])


def test_step_text_names_group_layer_and_color() -> None:
    found = families(pieces())
    products = []
    for family in found:
        made = realise(family.shape, solid=False)
        products.append(
            StepProduct(family.number, family.kind, None, made.properties, STEEL, made.boundary)
        )
    alone = part_bytes(products[0], "GP-001.step").decode("ascii")
    assert alone.count("PRESENTATION_LAYER_ASSIGNMENT('GUSSETS'") == 1
    assert "COLOUR_RGB('',0.250000,0.500000,0.750000)" in alone
    instances = [(f.number, i.mark, i.placement) for f in found for i in f.instances]
    whole = assembly_bytes(products, instances, name="roof", file_name="a.step").decode("ascii")
    for layer in ("GUSSETS", "NODES"):
        assert whole.count(f"PRESENTATION_LAYER_ASSIGNMENT('{layer}'") == 1
    # Groups in the order of the part numbers.
    assert 0 < whole.index("'Gussets'") < whole.index("'Nodes'")
    for mark in ("G-0000", "G-0004", "N-0000"):
        assert f"'{mark}'" in whole


def test_glb_stl_and_3mf() -> None:
    found = families(pieces())
    meshes = {family.number: mesh_of(family.shape) for family in found}
    data = glb_bytes(found, meshes, {"G-0004"})
    size = struct.unpack_from("<I", data, 12)[0]
    scene = json.loads(data[20 : 20 + size])
    groups = [scene["nodes"][child] for child in scene["nodes"][0]["children"]]
    assert [group["name"] for group in groups] == ["Gussets", "Nodes"]
    marks = [scene["nodes"][child]["name"] for child in groups[0]["children"]]
    assert marks == [f"G-{k:04d}" for k in range(5)]
    materials = {material["name"]: material for material in scene["materials"]}
    assert list(materials) == ["gusset", "node", "failed"]
    assert materials["gusset"]["alphaMode"] == "BLEND"  # its finish is glass
    linear = [((x + 0.055) / 1.055) ** 2.4 for x in GUSSET.color]
    seen = materials["gusset"]["pbrMetallicRoughness"]["baseColorFactor"]
    assert seen[:3] == pytest.approx(linear, abs=1e-6)
    mesh = meshes["GP-001"]
    assert len(stl_bytes(mesh, "GP-001")) == 84 + 50 * len(mesh.triangles)
    assert threemf_bytes([Body3MF("GP-001", mesh, GUSSET.color)], title="GP-001")[:2] == b"PK"


def test_two_kinds_of_one_role_keep_their_colors() -> None:
    """Nodes that are gussets beside those that the package knows: role and material are shared."""
    kind = replace(GUSSET, role="node")
    found = families([Gusset("G-0000", 0, PLAIN, at(0.0), kind), *pieces()[-1:]])
    meshes = {family.number: mesh_of(family.shape) for family in found}
    data = glb_bytes(found, meshes)
    scene = json.loads(data[20 : 20 + struct.unpack_from("<I", data, 12)[0]])
    assert [material["name"] for material in scene["materials"]] == ["node", "node"]
    used = [mesh["primitives"][0]["material"] for mesh in scene["meshes"]]
    colors = [m["pbrMetallicRoughness"]["baseColorFactor"][:3] for m in scene["materials"]]
    assert used == [0, 1]
    assert colors[0] != colors[1]


@pytest.mark.slow
def test_a_cut_is_made_by_the_kernel() -> None:
    """The same plate with a hole through its long side: nothing but its blank and a cylinder."""
    drilled = replace(PLAIN, bore=4.0, drilled=5.0)
    assert boundary_of(drilled) is None
    solid = solid_of(drilled)
    checks = check_solid(solid, drilled.second_volume(), relative=1e-6)
    assert [check.name for check in checks if not check.passed] == []
    made = realise(drilled)
    assert made.properties.volume == drilled.second_volume()
    assert made.genus == 2
    volume, area = made.properties.volume, made.properties.area
    found = check_mesh(made.mesh, volume=volume, area=area, chord=0.05, genus=made.genus)
    assert [check.name for check in found if not check.passed] == []
    with_solid = StepProduct("GP-001", GUSSET, solid, made.properties, STEEL)
    assert b"'GUSSETS'" in part_bytes(with_solid, "GP-001.step")


class Brackets(Product):
    """A product of its own: gussets and a node, 1 mm apart or more."""

    name = "brackets"
    chord = 0.05
    verify: Verify = "all"

    def __init__(self, pieces: list[Piece]) -> None:
        self.pieces, self.families = pieces, families(pieces)
        self.output = OutputSettings(formats=defaults(printed=True))
        self.seconds: dict[str, float] = {}

    def material(self, family: Family) -> Material:
        return STEEL

    def schedules(self, masses: Mapping[str, float]) -> dict[str, Table]:
        rows = [
            {"number": f.number, **f.shape.dimensions(), "mass_kg": masses[f.number]}
            for f in self.families
        ]
        return {"brackets": Table(rows, name="brackets")}

    def clearances(self, meshes: Mapping[str, TriangleMesh]) -> dict[str, list[Check]]:
        limits = {("gusset", "gusset"): 1.0, ("gusset", "node"): 1.0}
        return check_assembly(self.families, meshes, limits)

    def facts(self) -> dict[str, Any]:
        return {"input": {"file": None}, "settings": {}}


@pytest.mark.slow
def test_a_whole_job(tmp_path: Path) -> None:
    """Every format, every check, manifest and exit code 0 with a kind that no room names."""
    good = [piece for piece in pieces() if all(check.passed for check in piece.checks)]
    result = make(Brackets(good), tmp_path / "brackets")
    assert result.exit_code == 0, result.problems
    manifest = result.manifest
    assert manifest["checks"]["failed"] == 0
    assert {part["role"] for part in manifest["parts"]} == {"gusset", "node"}
    assert len(manifest["parts"]) == len(good)
    gusset = manifest["parts"][0]
    assert gusset["volume_mm3"] == pytest.approx(PLAIN.second_volume(), abs=1e-3)
    assert gusset["mass_kg"] == pytest.approx(PLAIN.second_volume() * 7.85e-6, abs=1e-6)
    names = {check["name"] for check in gusset["checks"]}
    assert {"solid valid", "file volume", "stl watertight", "clearance"} <= names
    paths = {record["path"] for record in manifest["files"]}
    expected = {"assembly.step", "model.glb", "preview.png", "schedules/brackets.csv"}
    expected |= {f"parts/{kind}/GP-001.{kind}" for kind in ("step", "stl", "3mf")}
    assert expected <= paths


@pytest.mark.slow
def test_a_whole_job_with_a_piece_beyond_its_limit_and_a_clash(tmp_path: Path) -> None:
    near = [Gusset("G-0005", 5, PLAIN, at(0.0, z=10.5)), *pieces()]
    result = make(Brackets(near), tmp_path / "brackets", anyway=True)
    assert result.exit_code == 1
    assert len(result.problems) == 2
    assert result.problems[0].startswith("clearance to gussets: 1 gusset (limit 1 mm): G-0000/")
    assert result.problems[1].startswith("slope: 1 gusset (limit 10 deg): G-0004 12 deg")
    folder = tmp_path / "brackets"
    assert (folder / "rejected" / "step" / "GP-004.step").exists()
    with (folder / "schedules" / "brackets.csv").open(encoding="utf-8", newline="") as file:
        status = {row["number"]: row["status"] for row in csv.DictReader(file)}
    assert status.pop("GP-001") == "rejected: G-0005 G-0000"  # two of three
    assert status.pop("GP-004") == "rejected"
    assert status == {"GP-002": "ok", "GP-003": "ok", "NP-001": "ok"}
    content = read_step(folder / "assembly.step")
    apart = {mark for mark, names in content.layers.items() if names == {"REJECTED"}}
    assert apart == {"G-0000", "G-0004", "G-0005"} == set(result.manifest["rejected"])
    assert content.layers["G-0001"] == {"GUSSETS"}  # its number is in the file twice
