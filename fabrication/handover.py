"""Solids for people who go on modelling: labelled build123d and cadquery objects."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from fabrication.formats.step import location
from fabrication.solids import solid_of
from fabrication.solids.kernel import load_kernel
from fabrication.specs import Family


def to_build123d(name: str, families: Sequence[Family]) -> Any:
    """The pieces as one labelled `build123d.Compound` [mm].

    Its children are compounds "Beams", "Nodes", "Panels" (those that exist), theirs the solids:
    label = piece mark, color by kind, one kernel shape shared by all pieces of a part number.
    """
    load_kernel()
    import build123d as b3

    groups = []
    for kind in dict.fromkeys(family.kind for family in families):
        solids = []
        for family in (f for f in families if f.kind == kind):
            shape = solid_of(family.shape)
            for instance in family.instances:
                solid = b3.Solid(shape.Located(location(instance.placement)))
                solid.label = instance.mark
                solid.color = b3.Color(*kind.color)
                solids.append(solid)
        if solids:
            groups.append(
                b3.Compound(label=kind.title, children=sorted(solids, key=lambda s: s.label))
            )
    return b3.Compound(label=name, children=groups)


def to_cadquery(name: str, families: Sequence[Family]) -> Any:
    """The pieces as a `cadquery.Assembly` [mm]: one child a piece, named by its mark, colored.

    The part number of a piece is in its metadata under "number".
    """
    load_kernel()
    import cadquery as cq

    assembly = cq.Assembly(name=name)
    for family in families:
        shape = cq.Solid(solid_of(family.shape))
        color = cq.Color(*family.kind.color)
        for instance in family.instances:
            assembly.add(
                shape,
                name=instance.mark,
                loc=cq.Location(location(instance.placement)),
                color=color,
                metadata={"number": family.number},
            )
    return assembly
