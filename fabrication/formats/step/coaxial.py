"""Holes that must have one axis, measured in a STEP file read back."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from ddgfab.mesh import Floats
from fabrication.specs import Check, Mate

if TYPE_CHECKING:
    from fabrication.formats.step.read import StepContent

COAXIAL_MM: Final = 0.01
"""Greatest distance [mm] of the axes of two holes that a bolt goes through, along the bolt."""

SAME_DIAMETER: Final = 1e-6
"""Diameters [mm] of a hole read back and of the one written agree within this."""

NEAR_MM: Final = 5.0
"""A hole counts as missing when no cylinder of its diameter is nearer [mm] to its axis."""

Cylinders = Floats
"""(n, 7): a point of the axis, its unit direction, the diameter [mm]; of faces looking inwards."""


def cylinders_of(shape: Any) -> Cylinders:
    """The hollow cylinder faces of a kernel shape, each axis and diameter once."""
    from OCP.BRepAdaptor import BRepAdaptor_Surface
    from OCP.GeomAbs import GeomAbs_SurfaceType
    from OCP.TopAbs import TopAbs_Orientation, TopAbs_ShapeEnum
    from OCP.TopExp import TopExp_Explorer
    from OCP.TopoDS import TopoDS

    found: dict[tuple[float, ...], None] = {}
    explorer = TopExp_Explorer(shape, TopAbs_ShapeEnum.TopAbs_FACE)
    while explorer.More():
        face = TopoDS.Face_s(explorer.Current())
        explorer.Next()
        surface = BRepAdaptor_Surface(face, False)
        if surface.GetType() != GeomAbs_SurfaceType.GeomAbs_Cylinder:
            continue
        cylinder = surface.Cylinder()
        inward = (face.Orientation() == TopAbs_Orientation.TopAbs_REVERSED) == cylinder.Direct()
        if not inward:
            continue
        at, along = cylinder.Axis().Location(), cylinder.Axis().Direction()
        row = (at.X(), at.Y(), at.Z(), along.X(), along.Y(), along.Z(), 2.0 * cylinder.Radius())
        found[tuple(round(value, 9) for value in row)] = None
    return np.array(list(found), dtype=np.float64).reshape(-1, 7)


def check_mates(content: StepContent, mates: Sequence[Mate]) -> list[Check]:
    """Whether every bolt has its holes, and these have one axis.

    Returns
    -------
    Checks "assembly holes" (number found) and "assembly coaxial_mm": the greatest distance of two
    axes over the length of a bolt.
    """
    if not mates:
        return []
    placed = {
        mark: (content.product_of[k], placement)
        for k, (_, mark, placement) in enumerate(content.instances)
    }
    of_product: Mapping[int, Cylinders] = {
        k: product.cylinders for k, product in enumerate(content.products)
    }
    missing: list[str] = []
    worst, holes = 0.0, 0
    for mate in mates:
        span = np.asarray(mate.point) + np.outer(mate.span, mate.axis)
        axes = []
        for mark, diameter in mate.holes:
            axis = None
            if mark in placed:
                product, placement = placed[mark]
                axis = _nearest(of_product[product], placement, diameter, span)
            if axis is None:
                missing.append(f"{mate.mark} in {mark}")
            else:
                axes.append(axis)
        holes += len(axes)
        for k, one in enumerate(axes):
            for two in axes[k + 1 :]:
                worst = max(worst, float(np.linalg.norm(one - two, axis=1).max()))
    wanted = float(sum(len(mate.holes) for mate in mates))
    shown = ", ".join(missing[:3]) or float(holes)
    value = worst if math.isfinite(worst) else None
    return [
        Check("assembly holes", not missing, shown, wanted),
        Check("assembly coaxial_mm", worst <= COAXIAL_MM, value, COAXIAL_MM),
    ]


def _nearest(
    cylinders: Cylinders, placement: Floats, diameter: float, span: Floats
) -> Floats | None:
    """Where the axis of a hole passes the two ends (2, 3) of a bolt's axis; None without a hole."""
    rows = cylinders[np.abs(cylinders[:, 6] - diameter) <= SAME_DIAMETER]
    if not len(rows):
        return None
    turn, shift = placement[:3, :3], placement[:3, 3]
    origin, along = rows[:, :3] @ turn.T + shift, rows[:, 3:6] @ turn.T
    bolt = span[1] - span[0]
    rate = along @ bolt
    with np.errstate(divide="ignore", invalid="ignore"):
        # where each axis pierces the planes across the bolt at both of its ends
        t = np.einsum("eki,i->ek", span[None] - origin[:, None], bolt) / rate[:, None]
        pierced = origin[:, None] + t[..., None] * along[:, None]
        away = np.linalg.norm(pierced - span[None], axis=-1).max(axis=1)
    away = np.where(np.isfinite(away), away, np.inf)
    best = int(away.argmin())
    return None if away[best] > NEAR_MM else np.asarray(pierced[best], dtype=np.float64)
