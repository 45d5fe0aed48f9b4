"""The section [ground] of a gridshell's project: where it stands, and on what."""

from __future__ import annotations

from typing import Annotated, Literal, TypeAlias

from pydantic import Field

from fabrication.gridshell.where import BOUNDARY, Ids, known_place
from fabrication.project.sections import Finite, NotNegative, Positive, Section
from fabrication.standards.fasteners import BoltSize

NOWHERE = "none"

Supports: TypeAlias = Annotated[str, known_place(NOWHERE, BOUNDARY)] | Ids


class GroundSettings(Section):
    """[ground]: supports, the nodes at which the structure stands on the ground.

    Attributes
    ----------
    where : "none", "boundary", "group:NAME" (a group of the mesh file), or vertex numbers as in
        nodes.csv; rules with where = "supports" are for these
    below_mm : of these only the vertices up to so much above the lowest of them
    kind : "plate" (a base plate with anchors and a post up to the node) or "none"
    level_mm : height of the ground, the underside of all base plates; "auto": as near below the
        supports as posts and beams allow, all plates equally far below their vertices
    anchor : size of the four anchors of a plate
    embedment_mm : of the anchors in the ground; "auto": 10 diameters. What the concrete needs is
        in the assessment (ETA) of the anchor
    plate_mm : thickness of the plates; "auto": the first kept in stock from the anchor's diameter
    post_mm : diameter of the posts; "auto": the largest round bar whose end stays within the cuts
        of the beams
    fasteners : whether anchors, nuts and washers are parts, with files, in the assembly
    """

    where: Supports = NOWHERE
    below_mm: NotNegative | None = None
    kind: Literal["plate", "none"] = "plate"
    level_mm: Literal["auto"] | Finite = "auto"
    anchor: BoltSize = "M16"
    embedment_mm: Literal["auto"] | Annotated[float, Field(gt=0, le=2000)] = "auto"
    plate_mm: Literal["auto"] | Positive = "auto"
    post_mm: Literal["auto"] | Positive = "auto"
    fasteners: bool = False
