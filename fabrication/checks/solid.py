"""Checks of the exact solid: one, closed, valid, of the volume that another route gives."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

from fabrication.specs import Check

VOLUME_RELATIVE: Final = 1e-9
"""How far the volume of an exact solid may be from its closed form, relative to it."""


NEAR: Final = 1e-4
"""Volumes farther off, relative to the expected one, are wrong, not measured too coarsely."""

ADAPTIVE: Final = 1e-6
"""Relative accuracy asked of the kernel's adaptive quadrature, which then does much better."""


@dataclass(frozen=True)
class SolidReport:
    """What the kernel says of a shape: solids, closed, valid, volume [mm3], faulty sub-shapes."""

    solids: int
    closed: bool
    valid: bool | None
    volume: float
    faults: tuple[str, ...] = ()


def inspect_solid(shape: Any, *, validate: bool = True) -> SolidReport:
    """Measure a kernel shape: number of solids, closedness, BRepCheck, volume by integration.

    Without `validate`, BRepCheck (most of the time) is left out and `valid` is None.
    """
    from OCP.BRepCheck import BRepCheck_Analyzer
    from OCP.TopAbs import TopAbs_ShapeEnum
    from OCP.TopExp import TopExp_Explorer

    solids = 0
    explorer = TopExp_Explorer(shape, TopAbs_ShapeEnum.TopAbs_SOLID)
    while explorer.More():
        solids += 1
        explorer.Next()
    analyzer = BRepCheck_Analyzer(shape) if validate else None
    valid = None if analyzer is None else bool(analyzer.IsValid())
    return SolidReport(
        solids=solids,
        closed=_closed(shape),
        valid=valid,
        volume=_volume(shape),
        faults=_faults(shape, analyzer) if valid is False else (),
    )


def check_solid(
    shape: Any, expected_volume: float, *, relative: float = VOLUME_RELATIVE
) -> list[Check]:
    """The checks of one exact solid.

    Parameters
    ----------
    shape : TopoDS_Shape
    expected_volume : volume [mm3] by an independent route (the closed form of its boundary)
    relative : how far the kernel's volume may be from it, relative to it. Where the plain
        quadrature is farther off, as on faces that a boolean cut, the adaptive one decides

    Returns
    -------
    Checks "solid one", "solid closed", "solid valid", "solid volume"; the last one's value is the
    relative deviation.
    """
    report = inspect_solid(shape)
    deviation = abs(report.volume - expected_volume) / max(abs(expected_volume), 1e-300)
    if relative < deviation < NEAR:
        finer = abs(_volume(shape, ADAPTIVE) - expected_volume) / abs(expected_volume)
        deviation = min(deviation, finer)
    return [
        Check("solid one", report.solids == 1, float(report.solids), 1.0),
        Check("solid closed", report.closed),
        Check("solid valid", bool(report.valid), "; ".join(report.faults) or None),
        Check(
            "solid volume",
            expected_volume > 0 and deviation <= relative,
            deviation if report.volume > 0 else report.volume,
            relative,
        ),
    ]


def _volume(shape: Any, *accuracy: float) -> float:
    """Volume [mm3] by the kernel's quadrature: plain, or adaptive to a relative accuracy."""
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps

    properties = GProp_GProps()
    BRepGProp.VolumeProperties_s(shape, properties, *accuracy)
    return float(properties.Mass())


def _closed(shape: Any) -> bool:
    """Whether there is a shell, and every shell's edges have two faces (BRep_Tool::IsClosed)."""
    from OCP.BRep import BRep_Tool
    from OCP.TopAbs import TopAbs_ShapeEnum
    from OCP.TopExp import TopExp_Explorer

    explorer = TopExp_Explorer(shape, TopAbs_ShapeEnum.TopAbs_SHELL)
    found = False
    while explorer.More():
        found = True
        if not BRep_Tool.IsClosed_s(explorer.Current()):
            return False
        explorer.Next()
    return found


def _faults(shape: Any, analyzer: Any) -> tuple[str, ...]:
    """The faulty sub-shapes as text, at most five: "face 3", "edge 7"."""
    from OCP.TopAbs import TopAbs_ShapeEnum
    from OCP.TopExp import TopExp
    from OCP.TopTools import TopTools_IndexedMapOfShape

    faults = []
    for kind, name in (
        (TopAbs_ShapeEnum.TopAbs_SOLID, "solid"),
        (TopAbs_ShapeEnum.TopAbs_SHELL, "shell"),
        (TopAbs_ShapeEnum.TopAbs_FACE, "face"),
        (TopAbs_ShapeEnum.TopAbs_EDGE, "edge"),
        (TopAbs_ShapeEnum.TopAbs_VERTEX, "vertex"),
    ):
        shapes = TopTools_IndexedMapOfShape()
        TopExp.MapShapes_s(shape, kind, shapes)
        faults += [
            f"{name} {i - 1}"
            for i in range(1, shapes.Extent() + 1)
            if not analyzer.IsValid(shapes.FindKey(i))
        ]
    return tuple(faults[:5])
