"""Parts of all roles, and where they stand, for the tests of STEP."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from gridshell_kinds import KINDS
from parts_table import BEAMS, NODES, PANELS

from fabrication.boundary import Boundary
from fabrication.formats.step import (
    Header,
    Material,
    StepProduct,
)
from fabrication.formats.step.direct import part_bytes
from fabrication.solids import boundary_of, properties_of
from fabrication.specs import Role, Shape

STEEL = Material("S355J2", 7850.0)
GLASS = Material("Glas für Dächer", 2500.0)
HEADER = Header("J. Müller", "Werk O'Neil", "C:\\jobs\\7")
ROLES: dict[str, Role] = {"BP": "beam", "NP": "node", "PP": "panel"}
SHAPES: dict[str, Shape] = {
    "BP-001": BEAMS["bar coped holes"][0],
    "BP-002": BEAMS["rhs mitred"][0],
    "BP-003": replace(
        BEAMS["rhs mitred"][0], start=replace(BEAMS["rhs mitred"][0].start, slope=0.2)
    ),
    "NP-001": NODES["valence 4 bored"][0],
    "PP-001": PANELS["quad mitred round"][0],
}


def boundary(number: str) -> Boundary:
    found = boundary_of(SHAPES[number])
    assert found is not None
    return found


def motion(seed: int) -> np.ndarray:
    """A random rigid motion."""
    rng = np.random.default_rng(seed)
    q, r = np.linalg.qr(rng.normal(size=(3, 3)))
    q *= np.sign(np.diag(r))
    if np.linalg.det(q) < 0:
        q[:, 0] *= -1
    placement = np.eye(4)
    placement[:3, :3], placement[:3, 3] = q, rng.uniform(-2e4, 2e4, 3)
    return placement


INSTANCES = [
    *(("BP-001", f"B-{i:04d}", motion(i)) for i in range(3)),
    ("BP-002", "B-0003", np.eye(4)),
    ("BP-003", "B-0004", motion(4)),
    *(("NP-001", f"N-{i:04d}", motion(10 + i)) for i in range(2)),
    ("PP-001", "P-0000", motion(20)),
]


def products() -> list[StepProduct]:
    return [
        StepProduct(
            number,
            KINDS[ROLES[number[:2]]],
            None,
            properties_of(shape),
            GLASS if number.startswith("PP") else STEEL,
            boundary(number),
        )
        for number, shape in SHAPES.items()
    ]


def text_of(shape: Shape, number: str = "BP-001") -> bytes:
    found = boundary_of(shape)
    assert found is not None
    return part_bytes(
        StepProduct(number, KINDS["beam"], None, properties_of(shape), None, found), "part.step"
    )
