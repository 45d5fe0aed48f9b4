"""Models for others: IFC of structures, beside ifcopenshell writing the same entities.

    python benchmarks/models.py [--pieces N]

Seconds of the processor; the lesser of two rounds. The canopy, where nearly every piece is a part
number of its own, and N beams of one number in fifty, as of a regular roof (20,000 by default).
Targets: 1 s for the canopy, 4 s for 20,000 pieces.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from fabrication.families import Family
from fabrication.formats.base import Header, Material, Part, Provenance, Whole
from fabrication.formats.ifc.model import model_bytes
from fabrication.gridshell.design import design
from fabrication.parts.beam import BEAM, BeamShape, EndCut
from fabrication.solids import realise
from fabrication.specs import Instance
from fabrication.standards.profiles import profile

ROUNDS = 2
A_NUMBER = 50


def canopy() -> Whole:
    """The built-in example."""
    product = design().product()
    parts = {
        family.number: Part.of(
            family, realise(family.shape, product.chord, solid=False), product.material(family)
        )
        for family in product.families
    }
    return Whole(product.about(), parts, product.families, product.families)


def beams(pieces: int) -> Whole:
    """Mitred hollow sections, so many of each length."""
    section, steel = profile("RHS 100x50x4"), Material("S355J2", 7850.0)
    families, parts = [], {}
    for k in range(pieces // A_NUMBER):
        shape = BeamShape(section, EndCut(50.0, 0.1), EndCut(1500.0 + k, -0.15))
        standing = []
        for j in range(A_NUMBER):
            at = np.eye(4)
            at[:3, 3] = (2000.0 * j, 100.0 * k, 10.0 * j)
            standing.append(Instance(f"B-{A_NUMBER * k + j:05d}", at))
        family = Family(f"BP-{k:03d}", BEAM, shape, tuple(standing), 0.0)
        families.append(family)
        parts[family.number] = Part.of(family, realise(shape, 0.5, solid=False), steel)
    return Whole(Provenance("roof", Header()), parts, families, families)


def seconds(run: Callable[[], object]) -> float:
    """Of the processor."""
    found = []
    for _ in range(ROUNDS):
        begin = time.process_time()
        run()
        found.append(time.process_time() - begin)
    return min(found)


def by_ifcopenshell(path: Path) -> float:
    """Seconds in which ifcopenshell makes and writes the entities of a file."""
    import ifcopenshell

    model = ifcopenshell.open(str(path))
    given = {
        entity.id(): (entity.is_a(), [entity[k] for k in range(len(entity))]) for entity in model
    }
    own = ifcopenshell.file(schema="IFC4")
    made: dict[int, object] = {}

    def moved(value: object) -> object:
        if isinstance(value, tuple):
            return tuple(moved(one) for one in value)
        if isinstance(value, ifcopenshell.entity_instance):
            if value.id():
                return entity_of(value.id())
            return own.create_entity(value.is_a(), value[0])
        return value

    def entity_of(identity: int) -> object:
        if identity not in made:
            name, values = given[identity]
            made[identity] = own.create_entity(name, *map(moved, values))
        return made[identity]

    begin = time.process_time()
    for identity in given:
        entity_of(identity)
    own.write(str(path.with_suffix(".other.ifc")))
    return time.process_time() - begin


def main() -> None:
    """Print a table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--pieces", type=int, default=20_000)
    wanted = parser.parse_args()
    for name, whole in (("canopy", canopy()), ("beams", beams(wanted.pieces))):
        took = seconds(lambda whole=whole: model_bytes(whole, "model.ifc"))  # type: ignore[misc]
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "model.ifc"
            path.write_bytes(model_bytes(whole, path.name))
            size, count = path.stat().st_size, len(list(whole.standing()))
            other = by_ifcopenshell(path)
        print(
            f"{name:7s} {count:6d} pieces, {len(whole.parts):5d} numbers, {size / 1e6:5.1f} MB: "
            f"{took:.2f} s, ifcopenshell {other:.1f} s, ratio {other / took:.1f}"
        )


if __name__ == "__main__":
    main()
