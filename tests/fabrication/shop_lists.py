"""Checks the lists of a folder against each other, from its CSV files and manifest.json alone.

Nothing of the program is imported: what a bolt, a beam and a node say of one hole must agree.
"""

from __future__ import annotations

import csv
import json
import math
from collections import Counter
from pathlib import Path

import numpy as np

Row = dict[str, str]

NUTS = {"M8": 6.8, "M10": 8.4, "M12": 10.8, "M16": 14.8}
"""Heights of nuts (ISO 4032) [mm]."""

DIGITS = 2e-3
"""Lists have three decimals [mm], and sums of two of them as much."""


def read(folder: Path) -> dict[str, list[Row]]:
    """The lists of a folder by name."""
    found = {}
    for path in sorted((folder / "schedules").glob("*.csv")):
        with path.open(encoding="utf-8", newline="") as stream:
            found[path.stem] = list(csv.DictReader(stream))
    return found


def number(row: Row, column: str) -> float:
    return float(row[column])


def column_sum(rows: list[Row], column: str) -> float:
    return math.fsum(number(row, column) for row in rows if row[column])


def vector(row: Row, prefix: str, unit: str = "") -> np.ndarray:
    names = [f"{prefix}{c}{unit}" for c in "xyz"]
    return np.array([float(row[name]) for name in names])


def depth_of(profile: str) -> float:
    """Depth of "FL 80x40" and its like."""
    return float(profile.split(" ")[1].split("x")[0])


def wrong_totals(folder: Path, lists: dict[str, list[Row]]) -> list[str]:
    """Sums of the lists that are not those of the manifest."""
    parts = json.loads((folder / "manifest.json").read_text("utf-8"))["parts"]
    wrong = []

    def check(what: str, one: float, two: float, tolerance: float) -> None:
        if abs(one - two) > tolerance:
            wrong.append(f"{what}: {one} is not {two}")

    for role in {part["role"] for part in parts}:
        own = [part for part in parts if part["role"] == role]
        rows = [row for row in lists["bom"] if row["role"] == role]
        mass = math.fsum(part["mass_kg"] for part in own)
        check(f"mass of {role}s", column_sum(rows, "mass_kg"), mass, 5e-4 * len(rows) + 1e-9)
        check(f"{role}s", column_sum(rows, "quantity"), len(own), 0)
        marks = sorted(mark for row in rows for mark in row["marks"].split())
        if marks != sorted(part["mark"] for part in own):
            wrong.append(f"marks of {role}s")
        if role in ("beam", "node", "panel"):
            check(f"rows of {role}s", len(lists[role + "s"]), len(own), 0)
            each = column_sum(lists[role + "s"], "mass_kg")
            check(f"masses of {role}s", each, mass, 5e-4 * len(own) + 1e-9)
    for small, large in (("stock", "bars"), ("bars", "stock")):
        for column in ("quantity", "used_mm"):
            one, two = column_sum(lists[small], column), column_sum(lists[large], column)
            check(f"{column} of {small}", one, two, 1e-3 * len(lists["bars"]))
    lengths = column_sum(lists["beams"], "length_cut_mm")
    profiles = {row["profile"] for row in lists["beams"]}
    sawn = [row for row in lists["bars"] if row["profile"] in profiles]
    check("lengths of beams", column_sum(sawn, "used_mm"), lengths, 1e-3 * len(lists["beams"]))
    if lists.get("panels"):
        for column in ("area_m2", "mass_kg"):
            one, two = column_sum(lists["sizes"], column), column_sum(lists["panels"], column)
            check(f"{column} of sizes", one, two, 1e-3 * len(lists["panels"]))
        for kind in ("gasket", "clamp", "cap"):
            rows = [row for row in lists["strips"] if row["kind"] == kind]
            length = 1e3 * column_sum(rows, "length_m")
            check(kind, length, column_sum(lists["joints"], f"{kind}_mm"), len(lists["joints"]))
    if "fasteners" in lists:
        wanted: Counter[str] = Counter()
        for row in lists["bolts"]:
            wanted[row["fastener"]] += 1
            for kind in ("nut", "washer"):
                if row.get(kind):
                    wanted[row[kind]] += int(row[f"{kind}s"])
        counted = {row["designation"]: int(row["quantity"]) for row in lists["fasteners"]}
        if counted != dict(wanted):
            wrong.append(f"fasteners {counted} are not those of the bolts {dict(wanted)}")
    return wrong


def unexplained(lists: dict[str, list[Row]]) -> list[str]:
    """Columns without a line in columns.csv, and lines of it without a column."""
    explained = {
        (row["table"], row["column"]) for row in lists["columns"] if row["meaning"].strip()
    }
    columns = {
        (name, column)
        for name, rows in lists.items()
        if name != "columns" and rows
        for column in rows[0]
    }
    return sorted(" ".join(pair) for pair in explained ^ columns)


def arm_of(node: Row, beam: str) -> int:
    """The number of a beam's arm in the row of a node."""
    return next(k for k in range(1, 20) if node.get(f"beam_{k}") == beam)


def holes_of_node(node: Row, k: int) -> list[tuple[float, float | None]]:
    """(distance from the axis, height above the bottom or None for half way) of an arm's holes."""
    if node.get(f"hole_{k}_mm"):
        low, far = number(node, f"hole_{k}_mm"), number(node, f"seat_{k}_mm")
        along = float(node.get(f"hole_{k}_along_mm") or 0.0)
        count = int(node.get(f"hole_{k}_count") or 1)
        rows = max(count // 2, 1)
        across = 0.5 * float(node.get(f"hole_{k}_across_mm") or 0.0)
        levels = [low + (along * r / (rows - 1) if rows > 1 else 0.0) for r in range(rows)]
        return [(math.hypot(far, across), level) for level in levels]
    if node.get(f"plate_{k}_first_mm"):
        return [
            (number(node, f"plate_{k}_{n}_mm"), number(node, f"plate_{k}_{n}_up_mm"))
            for n in ("first", "second")
        ]
    return [(number(node, f"disc_{k}_{n}_mm"), None) for n in ("first", "second")]


def off_node(bolt: Row, node: Row) -> float:
    """How far [mm] a bolt is from the nearest hole that the node's row has for its beam."""
    axis = vector(node, "axis_")
    away = vector(bolt, "", "_mm") - vector(node, "", "_mm")
    up = float(away @ axis)
    far = float(np.linalg.norm(away - up * axis))
    height = up + number(node, "below_mm")
    middle = 0.5 * number(node, "height_mm")
    return min(
        max(abs(far - r), abs(height - (middle if z is None else z)))
        for r, z in holes_of_node(node, arm_of(node, bolt["beam"]))
    )


def off_beam(bolt: Row, beam: Row, nodes: dict[str, Row]) -> float:
    """How far [mm] the axis of a bolt is from the hole that the beam's row puts on it.

    In the plane of the beam: x from its start to its end along the top of the profile, z up.
    """
    end = bolt["beam_end"]
    here, there = (
        nodes[beam[f"node_{end}"]],
        nodes[beam["node_end" if end == "start" else "node_start"]],
    )
    origin = vector(here, "", "_mm")
    x = vector(there, "", "_mm") - origin
    x /= np.linalg.norm(x)
    up = vector(here, "axis_")
    z = up - (up @ x) * x
    z /= np.linalg.norm(z)
    # Seen from this end: positive mitres are longer at the top at both ends.
    lean = math.radians(number(beam, f"mitre_{end}_deg"))
    depth = depth_of(beam["profile"])
    cut_up = np.array([-math.sin(lean), math.cos(lean)])
    inwards = np.array([math.cos(lean), math.sin(lean)])

    def on_cut(height: float) -> np.ndarray:
        return np.array([number(beam, f"offset_{end}_mm"), 0.0]) + cut_up * (
            (height - depth) / cut_up[1]
        )

    away, along = vector(bolt, "", "_mm") - origin, vector(bolt, "axis_")
    point = np.array([away @ x, away @ z])
    direction = np.array([along @ x, along @ z])
    if beam.get(f"hole_{end}_up_mm"):  # along the beam: its line meets the plate there
        middle = on_cut(number(beam, f"hole_{end}_up_mm"))
        reach = 0.5 * float(beam.get(f"hole_{end}_along_mm") or 0.0)
        offset = (point - middle) @ cut_up
        if abs(abs(direction @ inwards) - 1.0) > 1e-6:
            return math.inf
        count = int(beam.get(f"hole_{end}_count") or 1)
        rows = max(count // 2, 1)
        levels = [-reach + 2.0 * reach * r / (rows - 1) for r in range(rows)] if rows > 1 else [0.0]
        return float(min(abs(offset - level) for level in levels))
    if beam.get("slot_hole_mm"):  # across: in the middle of the depth, square to the cut
        deep = (point - on_cut(0.5 * depth)) @ inwards
        steps = [number(beam, f"slot_{n}_hole_mm") for n in ("first", "second")]
        return max(min(abs(deep - s) for s in steps), abs(float(point[1]) + 0.5 * depth))
    start = on_cut(number(beam, f"slots_{end}_up_mm"))
    start = start + number(beam, f"slots_{end}_middle_mm") * cut_up
    steps = [number(beam, f"bolts_{end}_{n}_mm") for n in ("first", "second")]
    return float(min(np.linalg.norm(point - start - s * inwards) for s in steps))


def wrong_bolts(lists: dict[str, list[Row]]) -> list[str]:
    """Bolts that do not fit what nodes, beams and sizes say."""
    nodes = {row["mark"]: row for row in lists["nodes"]}
    beams = {row["mark"]: row for row in lists["beams"]}
    wrong = []
    ends: Counter[tuple[str, str]] = Counter()
    for bolt in lists.get("bolts", []):
        mark, node, beam = bolt["mark"], nodes[bolt["node"]], beams[bolt["beam"]]
        ends[bolt["beam"], bolt["beam_end"]] += 1
        if beam[f"node_{bolt['beam_end']}"] != bolt["node"]:
            wrong.append(f"{mark}: {bolt['beam']} has another node at its {bolt['beam_end']}")
            continue
        for what, off in (
            (bolt["node"], off_node(bolt, node)),
            (bolt["beam"], off_beam(bolt, beam, nodes)),
        ):
            if not off <= 10 * DIGITS:
                wrong.append(f"{mark}: {off:.4f} mm from its hole in {what}")
        length = float(bolt["fastener"].rsplit("x", 1)[1])
        grip = number(bolt, "grip_mm")
        nut = NUTS[bolt["size"]] if bolt.get("nut") else 0.0
        thread = float(bolt["thread_mm"] or 0.0)
        least, most = grip + thread + nut, math.inf
        if not nut:  # a bolt in a thread: one diameter or more of it, and not beyond its end
            least, most = grip + float(bolt["size"][1:]), grip + thread
        if not least - DIGITS <= length <= most + DIGITS:
            wrong.append(f"{mark}: {bolt['fastener']} is not {least} to {most} mm long")
    counts = set(ends.values())
    if lists.get("bolts") and (len(ends) != 2 * len(beams) or len(counts) != 1):
        wrong.append(f"bolts at {len(ends)} ends of {len(beams)} beams, {counts} an end")
    return wrong


def wrong_panes(lists: dict[str, list[Row]]) -> list[str]:
    """Sides of panes whose neighbours, joints or beams do not say the same."""
    panes = {row["mark"]: row for row in lists["panels"]}
    joints = {row["beam"]: row for row in lists["joints"]}
    wrong = []
    for mark, row in panes.items():
        for k in range(1, int(row["sides"]) + 1):
            joint = joints[row[f"beam_{k}"]]
            sides = {joint["panel_left"], joint["panel_right"]} - {""}
            other = row[f"neighbour_{k}"]
            if sides != {mark, other} - {""}:
                wrong.append(f"{mark} side {k}: {sorted(sides)}")
            back = [panes[other][f"neighbour_{j}"] for j in range(1, 20)
                    if f"neighbour_{j}" in panes[other]] if other else [mark]  # fmt: skip
            if mark not in back:
                wrong.append(f"{mark} side {k}: {other} does not know it")
    return wrong
