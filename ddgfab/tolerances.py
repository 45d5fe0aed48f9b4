"""Every tolerance of the geometry, named, with its unit. A project's limits are its own."""

from __future__ import annotations

from typing import Final

RELATIVE_DEGENERATE: Final = 1e-12
"""Below this part of the local length (or its square, for areas) a quantity counts as zero."""

WELD_STEPS: Final = 2.5
"""Vertices nearer than so many of the last digits of a file are one: two roundings, rounded up."""

WELD_FINE: Final = 1e-7
"""Vertices nearer than this part of the size of a mesh are one, whatever the digits of its file."""

WELD_COARSE: Final = 3e-5
"""The digits of a file never make vertices one that are further apart than this part of its
size."""

COORDINATE_LIMIT: Final = 1e60
"""Coordinates beyond this are refused in files: products of four lengths must not overflow."""

TORSION_EXACT_DEG: Final = 1e-6
"""A structure below this torsion [deg] counts as torsion-free."""

LEAN_LIMIT_DEG: Final = 30.0
"""Default limit [deg] on the angle between node axis and surface normal."""

LEAN_UPRIGHT_DEG: Final = 80.0
"""Axes that lean by more [deg] lie in the surface: nothing upright exists, nothing is built."""

NET_PLANAR_PERCENT: Final = 0.02
"""A net is called planar below this planarity [%, distance of diagonals over their mean]."""

NET_ANGLE_DEG: Final = 0.1
"""A net is called circular or conical below this defect [deg]."""

NET_STAR_DEG: Final = 0.1
"""Edges follow asymptotic lines when they leave the plane of their vertex star by less [deg]."""

NET_SIDES_PERCENT: Final = 0.1
"""Opposite sides of a quad count as equal below this difference [% of the mean side]."""

NET_EDGE_OFFSET: Final = 1e-4
"""A net is called parallel to a Koebe net when its offset's edges turn by less [rad] and their
distance varies by less, relative: what six digits in a file leave."""

NET_ISOTHERMIC: Final = 2e-3
"""A circular net is called isothermic below this logarithm of the product of cross-ratios round a
vertex."""

UNIT_NORMAL: Final = 1e-9
"""How far the length of a unit vector may be from one."""

NET_INPUT: Final = 1e-8
"""Data of a net (planar or circular quads) may miss their condition by this part of their size."""

CONDITION_LIMIT: Final = 1e12
"""Linear systems with a larger condition number count as unsolvable."""
