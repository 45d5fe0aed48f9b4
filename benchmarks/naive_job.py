"""The whole job as a naive build123d script: the same parts and files from the same numbers.

    python benchmarks/naive_job.py MESH FOLDER [--families]

Gets all numbers for nothing (untimed); builds a solid for each piece, checks it, writes STEP and
STL of each, the assembly as STEP, GLB, and the schedules. With --families it is also given, for
nothing, which pieces are congruent, and builds one solid a part number. Prints the seconds of each
step as JSON.
"""

from __future__ import annotations

import copy
import csv
import json
import sys
import time
from pathlib import Path

import build123d as b3
import naive

from fabrication import design
from fabrication.formats.step import location


def main() -> None:
    """Do the job."""
    mesh, folder = Path(sys.argv[1]), Path(sys.argv[2])
    plan = design(mesh, project={"median_edge_mm": 1500.0})
    schedules = plan.schedules
    folder.mkdir(parents=True, exist_ok=True)
    seconds: dict[str, float] = {}
    begin = last = time.perf_counter()

    def lap(name: str) -> None:
        nonlocal last
        now = time.perf_counter()
        seconds[name], last = now - last, now

    if "--families" in sys.argv:
        solids = {family.number: naive.solid(family.shape) for family in plan.families}
    else:
        solids = {piece.mark: naive.solid(piece.shape) for piece in plan.gridshell.pieces}
    lap("build")
    assert all(solid.is_valid for solid in solids.values())
    lap("check")
    for number, solid in solids.items():
        b3.export_step(solid, folder / f"{number}.step")
    lap("step")
    for number, solid in solids.items():
        b3.export_stl(solid, folder / f"{number}.stl", tolerance=0.05)
    lap("stl")
    children = []
    own = {piece.mark: piece.placement for piece in plan.gridshell.pieces}
    for family in plan.families:
        for instance in family.instances:
            shared = family.number in solids
            child = copy.copy(solids[family.number if shared else instance.mark])
            at = instance.placement if shared else own[instance.mark]
            child.location = b3.Location(location(at))
            child.label = instance.mark
            children.append(child)
    whole = b3.Compound(label="roof", children=children)
    b3.export_step(whole, folder / "assembly.step")
    lap("assembly")
    b3.export_gltf(whole, str(folder / "model.glb"), binary=True)
    lap("glb")
    for name, table in schedules.items():
        with (folder / f"{name}.csv").open("w", newline="") as stream:
            writer = csv.DictWriter(stream, table.columns)
            writer.writeheader()
            writer.writerows(table.rows)
    lap("csv")
    seconds["total"] = time.perf_counter() - begin
    print(json.dumps(seconds))


if __name__ == "__main__":
    main()
