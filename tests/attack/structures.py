"""Random structures with settings that let parts meet: every overlap is a failed check.

    python tests/attack/structures.py --count 500

A vault of four or six panes, a hexagonal shell or a box of random sizes, curvature and settings is
designed; the job's check of its clearances is compared with the common volumes of all pairs of
pieces, which manifold3d finds on finer meshes, without anything of the check.
"""

from __future__ import annotations

import itertools
import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

HERE = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(HERE), str(HERE / "tests" / "attack"), str(HERE / "tests" / "fabrication")]

import numpy as np  # noqa: E402
from watch import Watch, run  # noqa: E402

from ddgfab.mesh import Mesh  # noqa: E402
from fabrication import design  # noqa: E402
from fabrication.checks.mesh import to_manifold  # noqa: E402
from fabrication.gridshell.room import CHORD_MM  # noqa: E402
from fabrication.solids import mesh_of  # noqa: E402

CHORD = 1e-3
"""Chord tolerance [mm] of the meshes of this comparison; overlaps of twice that depth count."""


def vault(rng: np.random.Generator) -> Mesh:
    """Planar quads of a translation surface, of random size and curvature."""
    rows, columns = rng.choice([1, 2]), rng.choice([1, 2, 3])
    x, y = rng.uniform(500, 1600, 2)
    u, v = np.meshgrid(
        x * (np.arange(rows + 1) - rows / 2), y * (np.arange(columns + 1) - columns / 2)
    )
    z = -(u**2) / rng.uniform(1.2e3, 2e4) - v**2 / rng.uniform(1.2e3, 2e4) * rng.choice([-1, 1])
    points = np.stack([u, v, z], axis=-1)
    at = np.arange(points[..., 0].size).reshape(u.shape)
    faces = np.stack([at[:-1, :-1], at[:-1, 1:], at[1:, 1:], at[1:, :-1]], axis=-1).reshape(-1, 4)
    return Mesh.build(points.reshape(-1, 3), faces.tolist())


def pyramid(rng: np.random.Generator) -> Mesh:
    """Triangles or quads about an apex, three to seven."""
    sides, radius = int(rng.integers(3, 8)), rng.uniform(700, 1500)
    turn = 2 * np.pi * (np.arange(sides) + rng.uniform(-0.15, 0.15, sides)) / sides
    height = rng.uniform(100, 900)
    ring = np.stack([radius * np.cos(turn), radius * np.sin(turn), np.zeros(sides)], axis=1)
    points = np.concatenate([[[0.0, 0.0, height]], ring])
    faces = [[0, 1 + k, 1 + (k + 1) % sides] for k in range(sides)]
    return Mesh.build(points, faces)


def settings(rng: np.random.Generator) -> dict[str, dict[str, Any]]:
    """Settings that let parts come near each other, or through each other."""
    profile = str(rng.choice(["FL 60x8", "RHS 60x40x3", "T 50x50x6", "SHS 50x4"]))
    # A coped hollow section has no exact boundary: the kernel takes seconds for each fine mesh.
    ends = ["flat"] if "HS" in profile and rng.random() < 0.9 else ["flat", "cope"]
    return {
        "beam": {
            "profile": profile,
            "clearance_mm": float(rng.choice([0.0, 0.02, 0.5, 3.0])),
            "end": str(rng.choice(ends)),
            "eccentricity_mm": float(rng.uniform(-15, 15)),
            "min_length_mm": 50.0,
        },
        "panel": {
            "offset_mm": float(rng.choice([rng.uniform(-8, 12), rng.uniform(-0.1, 0.1)])),
            "gap_mm": float(rng.choice([0.0, 0.1, 2.0, 12.0])),
            "edge": str(rng.choice(["square", "mitred"])),
            "gap_at": str(rng.choice(["tightest", "inner", "outer"])),
            "thickness_mm": float(rng.uniform(4, 40)),
            "corner_radius_mm": float(rng.choice([0.0, 5.0])),
        },
        "node": {
            "top_margin_mm": float(rng.uniform(0, 6)),
            "kind": str(rng.choice(["cylinder", "tube"])),
        },
        "checks": {
            "family_tolerance_mm": 0.0,
            "plausibility": "ignore",
            "torsion_deg": 90.0,
            "min_angle_deg": float(rng.choice([0.0, 25.0])),
        },
    }


def compare(seed: int, found: dict[str, int]) -> None:
    """One structure: the check knows every pair that shares volume."""
    rng = np.random.default_rng(seed)
    plan = design((vault if rng.random() < 0.7 else pyramid)(rng), **settings(rng))
    product = plan.product()
    failed = {
        frozenset((mark, str(check.other)))
        for mark, rows in product.clearances(
            {f.number: mesh_of(f.shape, CHORD_MM) for f in plan.families}
        ).items()
        for check in rows
        if not check.passed
    }
    good = {p.mark for p in product.pieces if all(check.passed for check in p.checks)}
    placed = []
    for family in plan.families:
        body = to_manifold(mesh_of(family.shape, CHORD))
        for instance in family.instances:
            if instance.mark in good:
                placed.append((instance.mark, body.transform(instance.placement[:3])))
    boxes = [np.array(body.bounding_box()).reshape(2, 3) for _, body in placed]
    for (one, a), (two, b) in itertools.combinations(enumerate(placed), 2):
        if (boxes[one][0] > boxes[two][1]).any() or (boxes[two][0] > boxes[one][1]).any():
            continue
        common = a[1] ^ b[1]
        if common.volume() <= 0:
            continue
        depth = 2 * common.volume() / common.surface_area()
        if depth > 2 * CHORD:
            found["overlaps"] += 1
            assert frozenset((a[0], b[0])) in failed, f"{a[0]} in {b[0]} by {depth:.4f} mm passed"
    found["wrong" if failed else "sound"] += 1


SECONDS = 60.0
"""A structure may take so long, with the comparison."""

FOUND = {"overlaps": 0, "wrong": 0, "sound": 0}


def attack(watch: Watch, seed: int, folder: Path) -> None:
    """One structure."""
    watch.call(seed, lambda: compare(seed, FOUND), SECONDS)


if __name__ == "__main__":
    with TemporaryDirectory() as place:
        code = run(attack, __doc__, 500, Path(place))
    print(f"structures with failed checks {FOUND['wrong']}, without {FOUND['sound']}; "
          f"pairs that overlap {FOUND['overlaps']}")  # fmt: skip
    sys.exit(code)
