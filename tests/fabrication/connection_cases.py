"""Structures with bolted connections that several tests start from."""

from __future__ import annotations

from typing import Any

import numpy as np
from detailing_cases import Case, dome, fan, hexagons

from fabrication.gridshell.detailing.gridshell import Gridshell
from fabrication.solids import boundary_of

NO_GLASS = {"kind": "none"}
BAR = {"profile": "FL 80x40"}
STUD = {"kind": "stud"}
CASES = {"dome": dome, "fan": lambda: fan(5, True), "hexagons": hexagons}


def bolted(case: Case, **sections: Any) -> Gridshell:
    return case.detail(**{"beam": BAR, "connection": STUD, "panel": NO_GLASS, **sections})


def worst_off_axis(shell: Gridshell) -> float:
    """Greatest distance [mm] of the holes of a bolt from its axis, at both ends of its span.

    The holes are the cylinder faces of the exact boundaries, of the diameters that the bolt names,
    where the pieces are placed; infinite where one is missing.
    """
    pieces = {piece.mark: piece for piece in (*shell.nodes, *shell.beams)}
    holes: dict[str, np.ndarray] = {}
    worst = 0.0
    for bolt in shell.bolts:
        ends = bolt.point + np.outer(bolt.span, bolt.axis)
        for mark, diameter in bolt.holes:
            piece = pieces[mark]
            if mark not in holes:
                boundary = boundary_of(piece.shape)
                assert boundary is not None
                hollow = boundary.face_cylinder & (boundary.face_sign < 0)
                turn, shift = piece.placement[:3, :3], piece.placement[:3, 3]
                at = boundary.face_origin[hollow] @ turn.T + shift
                along = boundary.face_axis[hollow] @ turn.T
                holes[mark] = np.hstack([at, along, boundary.face_radius[hollow][:, None]])
            own = holes[mark][np.abs(holes[mark][:, 6] - 0.5 * diameter) < 1e-9]
            off = ends[None] - own[:, None, :3]
            away = np.linalg.norm(np.cross(off, own[:, None, 3:6]), axis=-1).max(axis=1)
            worst = max(worst, float(away.min(initial=np.inf)))
    return worst
